//! Access control of requests.

use std::net::{IpAddr, SocketAddr};

use crate::error::{Error, ErrorKind};

/// The name of the cookie with the token.
const COOKIE_NAME: &str = "monas_studio";

/// The rules for requests: they name this server, come from its own page, and carry the token if
/// other computers can connect.
///
/// A page of another origin cannot read from the studio: a browser sends the origin of a page that
/// opens a WebSocket (`Origin`), and the name from which the page was loaded (`Host`), which
/// reveals DNS rebinding.
#[derive(Clone, Debug)]
pub(crate) struct AccessPolicy {
    address: SocketAddr,
    token: Option<String>,
}

/// The fields of a request on which access depends.
#[derive(Clone, Copy, Default, Debug)]
pub(crate) struct RequestOrigin<'a> {
    pub(crate) host: Option<&'a str>,
    pub(crate) origin: Option<&'a str>,
    pub(crate) cookie: Option<&'a str>,
    /// The token in the address.
    pub(crate) token: Option<&'a str>,
}

/// Why a request is refused, for people.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub(crate) struct Refusal(pub(crate) &'static str);

impl AccessPolicy {
    /// The rules for a server at an address; a token is drawn unless the address is loopback.
    pub(crate) fn for_address(address: SocketAddr) -> Result<AccessPolicy, Error> {
        let token = match address.ip().is_loopback() {
            true => None,
            false => Some(random_token()?),
        };
        Ok(AccessPolicy { address, token })
    }

    /// The token that is needed, if any.
    #[cfg(test)]
    fn token(&self) -> Option<&str> {
        self.token.as_deref()
    }

    /// The address of the page.
    pub(crate) fn url(&self) -> String {
        let token = self.token.as_ref().map(|token| format!("?token={token}")).unwrap_or_default();
        format!("http://{}/{token}", self.address)
    }

    /// The header that makes the browser remember the token.
    pub(crate) fn cookie(&self) -> Option<String> {
        let token = self.token.as_ref()?;
        Some(format!("Set-Cookie: {COOKIE_NAME}={token}; HttpOnly; SameSite=Strict; Path=/\r\n"))
    }

    /// Checks whether a request may be answered.
    pub(crate) fn check(&self, request: &RequestOrigin<'_>) -> Result<(), Refusal> {
        let host = request.host.ok_or(Refusal("the request names no host"))?;
        if !self.is_own(host) {
            return Err(Refusal("the request is for another host"));
        }
        if request.origin.is_some_and(|origin| origin.strip_prefix("http://") != Some(host)) {
            return Err(Refusal("the request comes from another origin"));
        }
        let Some(token) = &self.token else { return Ok(()) };
        let given = request.token.or_else(|| request.cookie.and_then(token_of_cookies));
        match given {
            Some(given) if is_equal(given, token) => Ok(()),
            Some(_) => Err(Refusal("the token is wrong; open the address that the program printed")),
            None => Err(Refusal("a token is needed; open the address that the program printed")),
        }
    }

    /// Whether a `Host` names this server: by its address; on loopback by any of its names; if it
    /// listens on all addresses by any address. A name that a resolver would have to look up is
    /// never accepted.
    fn is_own(&self, host: &str) -> bool {
        let port = self.address.port();
        if let Ok(address) = host.parse::<SocketAddr>() {
            return address.port() == port && self.is_own_address(address.ip());
        }
        if let (Ok(ip), 80) = (host.trim_matches(['[', ']']).parse::<IpAddr>(), port) {
            return self.is_own_address(ip);
        }
        let name = host.strip_suffix(&format!(":{port}")).or((port == 80).then_some(host));
        name.is_some_and(|name| name.eq_ignore_ascii_case("localhost")) && self.listens_on_loopback()
    }

    fn is_own_address(&self, ip: IpAddr) -> bool {
        ip == self.address.ip()
            || self.address.ip().is_unspecified()
            || (ip.is_loopback() && self.address.ip().is_loopback())
    }

    fn listens_on_loopback(&self) -> bool {
        self.address.ip().is_loopback() || self.address.ip().is_unspecified()
    }
}

fn token_of_cookies(cookies: &str) -> Option<&str> {
    let values = cookies.split(';').filter_map(|cookie| cookie.trim().split_once('='));
    values.filter(|(name, _)| *name == COOKIE_NAME).map(|(_, value)| value).next()
}

/// Compares in a time that does not depend on where two texts differ.
fn is_equal(a: &str, b: &str) -> bool {
    let difference = a.bytes().zip(b.bytes()).fold(0, |all, (a, b)| all | (a ^ b));
    a.len() == b.len() && difference == 0
}

/// 128 random bits.
fn random_token() -> Result<String, Error> {
    let mut bytes = [0; 16];
    getrandom::fill(&mut bytes)
        .map_err(|error| Error::new(ErrorKind::System, format_args!("no random numbers: {error}")))?;
    Ok(bytes.iter().map(|byte| format!("{byte:02x}")).collect())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn policy(address: &str) -> AccessPolicy {
        AccessPolicy::for_address(address.parse().unwrap()).unwrap()
    }

    fn of_host(host: &str) -> RequestOrigin<'_> {
        RequestOrigin { host: Some(host), ..RequestOrigin::default() }
    }

    #[test]
    fn only_names_of_this_server_are_accepted() {
        let policy = policy("127.0.0.1:4810");
        for host in ["127.0.0.1:4810", "localhost:4810", "LOCALHOST:4810", "[::1]:4810"] {
            assert_eq!(policy.check(&of_host(host)), Ok(()), "{host}");
        }
        for host in ["127.0.0.1:4811", "localhost", "127.0.0.1", "evil.example:4810", "10.0.0.1:4810", ""] {
            assert!(policy.check(&of_host(host)).is_err(), "{host}");
        }
        assert!(policy.check(&RequestOrigin::default()).is_err());
    }

    #[test]
    fn pages_of_other_origins_are_refused() {
        let policy = policy("127.0.0.1:4810");
        let from = |origin| RequestOrigin { origin: Some(origin), ..of_host("localhost:4810") };
        assert_eq!(policy.check(&from("http://localhost:4810")), Ok(()));
        for origin in ["null", "http://localhost:9", "https://localhost:4810", "http://evil.example"] {
            assert!(policy.check(&from(origin)).is_err(), "{origin}");
        }
    }

    #[test]
    fn other_addresses_than_loopback_need_the_token() {
        assert_eq!(policy("127.0.0.1:1").token(), None);
        let policy = policy("0.0.0.0:4810");
        let token = policy.token().unwrap().to_owned();
        assert_eq!(token.len(), 32);
        let request = of_host("10.1.2.3:4810");
        assert!(policy.check(&request).is_err());
        assert_eq!(policy.check(&RequestOrigin { token: Some(&token), ..request }), Ok(()));
        let cookies = format!("a=b; monas_studio={token}");
        assert_eq!(policy.check(&RequestOrigin { cookie: Some(&cookies), ..request }), Ok(()));
        for wrong in ["", "0", &token[1..], &format!("{token}0")] {
            assert!(policy.check(&RequestOrigin { token: Some(wrong), ..request }).is_err(), "{wrong}");
        }
        assert_ne!(token, random_token().unwrap());
        assert!(policy.url().ends_with(&format!("/?token={token}")));
    }

    #[test]
    fn names_that_need_a_resolver_are_refused_on_all_addresses() {
        let policy = policy("0.0.0.0:4810");
        let token = policy.token();
        assert!(policy.check(&RequestOrigin { token, ..of_host("rebound.example:4810") }).is_err());
    }
}
