//! Converts the settings of a link to a zenoh configuration.

use std::fs;
use std::path::{Path, PathBuf};

use zenoh::Config;

use crate::error::{Error, ErrorKind};
use crate::protocol::AccessList;

/// Settings of the zenoh transport.
#[derive(Clone, PartialEq, Eq, Debug)]
pub struct ZenohSettings {
    /// The first segment of every key; links of different realms are isolated.
    pub realm: String,
    /// Endpoints to listen on: `tcp/127.0.0.1:7447`, `tls/0.0.0.0:7447`. Without any, the link
    /// accepts no connections.
    pub listen: Vec<String>,
    /// Endpoints to connect to: `tcp/192.168.1.20:7447`. The link retries until it is connected.
    pub connect: Vec<String>,
    /// Whether other hosts are also discovered by multicast and gossip.
    pub scouting: bool,
    /// Whether large messages use shared memory to processes of the same user on the same computer.
    pub shared_memory: bool,
    /// Certificates, for `tls/` endpoints. With them the access list is also checked against the
    /// common name of each peer's certificate, and hosts that the list does not name publish
    /// nothing, also not what `*` permits. Without them only the protocol checks it, which has to
    /// trust the names that others claim.
    pub tls: Option<Tls>,
    /// The most simultaneous connections.
    pub sessions: usize,
    /// Longest message in bytes, with key and stamp; the same for all hosts of a realm. Longer ones
    /// are not reassembled.
    pub largest: usize,
}

/// Certificate files. Both sides present and verify certificates.
#[derive(Clone, PartialEq, Eq, Debug)]
pub struct Tls {
    /// The certificate of the signing authority.
    pub authority: PathBuf,
    /// This host's certificate. Its common name is the host's name; it also lists the addresses at
    /// which others reach this host.
    pub certificate: PathBuf,
    /// The private key.
    pub key: PathBuf,
}

impl Default for ZenohSettings {
    fn default() -> ZenohSettings {
        ZenohSettings {
            realm: "monas".to_owned(),
            listen: Vec::new(),
            connect: Vec::new(),
            scouting: false,
            shared_memory: true,
            tls: None,
            sessions: 16,
            largest: 4 << 20,
        }
    }
}

impl ZenohSettings {
    /// Checks the settings as far as possible without opening a session.
    ///
    /// # Errors
    /// An endpoint is invalid, or a certificate file is missing or invalid.
    pub fn check(&self, access: &AccessList) -> Result<(), Error> {
        self.config(access).map(drop)
    }

    pub(super) fn config(&self, access: &AccessList) -> Result<Config, Error> {
        let mut words = ZenohConfig(Config::default());
        words.set("mode", text("peer"))?;
        words.set("listen/endpoints", list(&self.listen))?;
        words.set("connect/endpoints", list(&self.connect))?;
        // Does not wait for absent hosts, and retries.
        words.set("connect/timeout_ms", "-1".to_owned())?;
        words.set("connect/exit_on_failure", "false".to_owned())?;
        let retry = r#"{"period_init_ms":100,"period_max_ms":1000,"period_increase_factor":2}"#;
        words.set("connect/retry", retry.to_owned())?;
        words.set("open/return_conditions/connect_scouted", "false".to_owned())?;
        words.set("scouting/multicast/enabled", self.scouting.to_string())?;
        words.set("scouting/gossip/enabled", self.scouting.to_string())?;
        words.set("transport/shared_memory/enabled", self.shared_memory.to_string())?;
        words.set("transport/unicast/max_sessions", self.sessions.to_string())?;
        words.set("transport/link/rx/max_message_size", self.largest.to_string())?;
        if let Some(tls) = &self.tls {
            words.set_tls(tls)?;
            if !access.is_open() {
                words.set("access_control", access_control(access, &self.realm))?;
            }
        }
        Ok(words.0)
    }
}

struct ZenohConfig(Config);

impl ZenohConfig {
    fn set(&mut self, key: &str, value: String) -> Result<(), Error> {
        self.0.insert_json5(key, &value).map_err(|error| {
            Error::new(ErrorKind::Settings, format!("zenoh does not take {value} for {key}: {error}"))
        })
    }

    fn set_tls(&mut self, tls: &Tls) -> Result<(), Error> {
        let Tls { authority, certificate, key } = tls;
        self.set("transport/link/tls/enable_mtls", "true".to_owned())?;
        self.set("transport/link/tls/verify_name_on_connect", "true".to_owned())?;
        self.set("transport/link/tls/close_link_on_expiration", "true".to_owned())?;
        self.set("transport/link/tls/root_ca_certificate", pem(authority, "CERTIFICATE")?)?;
        for side in ["listen", "connect"] {
            self.set(&format!("transport/link/tls/{side}_certificate"), pem(certificate, "CERTIFICATE")?)?;
            self.set(&format!("transport/link/tls/{side}_private_key"), pem(key, "PRIVATE KEY")?)?;
        }
        Ok(())
    }
}

/// The name of a file that exists and has the expected content: zenoh checks it only on connecting.
fn pem(path: &Path, what: &str) -> Result<String, Error> {
    let failed = |message: String| Err(Error::new(ErrorKind::File, format!("{}: {message}", path.display())));
    match fs::read_to_string(path) {
        Err(error) => failed(error.to_string()),
        Ok(content) if !content.contains(&format!("{what}-----")) => {
            failed(format!("holds no {} in PEM", what.to_lowercase()))
        }
        Ok(_) => match path.to_str() {
            Some(name) => Ok(text(name)),
            None => failed("is not a name in UTF-8".to_owned()),
        },
    }
}

/// A JSON5 string; every character that is not ASCII graphic is escaped.
fn text(value: &str) -> String {
    let escaped = value.encode_utf16().map(|unit| match char::from_u32(unit.into()) {
        Some(c) if c.is_ascii_graphic() && c != '"' && c != '\\' => c.to_string(),
        _ => format!("\\u{unit:04x}"),
    });
    format!("\"{}\"", escaped.collect::<String>())
}

fn list(values: &[String]) -> String {
    let values: Vec<String> = values.iter().map(|value| text(value)).collect();
    format!("[{}]", values.join(","))
}

/// The access list as zenoh configuration: each peer may put what the name in its certificate
/// allows, under its own name only, and every listed host may introduce itself. All may subscribe,
/// and outgoing messages are not filtered.
///
/// The rules of `*` are added to those of each listed host. One rule for all subjects would need
/// keys with any host, since keys cannot refer to the certificate, and each peer could then publish
/// under the names of others.
fn access_control(access: &AccessList, realm: &str) -> String {
    let mut rules = vec![
        r#"{"id":"read","messages":["declare_subscriber"],"flows":["ingress","egress"],"permission":"allow","key_exprs":["**"]}"#.to_owned(),
        r#"{"id":"out","messages":["put"],"flows":["egress"],"permission":"allow","key_exprs":["**"]}"#.to_owned(),
    ];
    let mut subjects = vec![r#"{"id":"all"}"#.to_owned()];
    let mut policies = vec![r#"{"rules":["read","out"],"subjects":["all"]}"#.to_owned()];
    let shared: Vec<&String> =
        access.publishers().filter(|(host, _)| *host == "*").flat_map(|(_, patterns)| patterns).collect();
    for (number, (host, patterns)) in access.publishers().filter(|(host, _)| *host != "*").enumerate() {
        let own = patterns.iter().chain(shared.iter().copied());
        let keys = own.flat_map(|pattern| {
            [format!("{realm}/{host}/m/{pattern}"), format!("{realm}/{host}/r/*/{pattern}")]
        });
        let keys: Vec<String> = keys.chain([format!("{realm}/{host}/c")]).collect();
        rules.push(format!(
            r#"{{"id":"put{number}","messages":["put"],"flows":["ingress"],"permission":"allow","key_exprs":{}}}"#,
            list(&keys)
        ));
        subjects.push(format!(r#"{{"id":"host{number}","cert_common_names":[{}]}}"#, text(host)));
        policies.push(format!(r#"{{"rules":["put{number}"],"subjects":["host{number}"]}}"#));
    }
    format!(
        r#"{{"enabled":true,"default_permission":"deny","rules":[{}],"subjects":[{}],"policies":[{}]}}"#,
        rules.join(","),
        subjects.join(","),
        policies.join(",")
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_access_list_is_one_that_zenoh_takes() {
        let (access, errors) = AccessList::parse(
            "robot_1 publish soccer/**\nrobot_2 publish soccer/ball\n* publish soccer/hello",
        );
        assert_eq!(errors, []);
        let mut words = ZenohConfig(Config::default());
        words.set("access_control", access_control(&access, "monas")).unwrap();
        let rules = words.0.get_json("access_control").unwrap();
        assert!(rules.contains("monas/robot_2/m/soccer/ball"), "{rules}");
        assert!(!rules.contains("monas/robot_2/m/soccer/**"), "{rules}");
        assert!(rules.contains("monas/robot_2/m/soccer/hello"), "{rules}");
        // No peer may use the names of others.
        assert!(!rules.contains("monas/*"), "{rules}");
    }

    #[test]
    fn discovery_and_listening_are_off_by_default() {
        let config = ZenohSettings::default().config(&AccessList::open()).unwrap();
        for (key, value) in [
            ("scouting/multicast/enabled", "false"),
            ("scouting/gossip/enabled", "false"),
            ("listen/endpoints", "[]"),
        ] {
            assert_eq!(config.get_json(key).unwrap(), value, "{key}");
        }
        let config = ZenohSettings { scouting: true, ..ZenohSettings::default() };
        let config = config.config(&AccessList::open()).unwrap();
        assert_eq!(config.get_json("scouting/multicast/enabled").unwrap(), "true");
    }

    #[test]
    fn an_endpoint_that_is_none_is_refused() {
        let settings = ZenohSettings { listen: vec!["7447".to_owned()], ..ZenohSettings::default() };
        let error = settings.config(&AccessList::open()).unwrap_err();
        assert_eq!(error.kind(), ErrorKind::Settings);
        assert!(error.to_string().contains("7447"), "{error}");
    }

    #[test]
    fn texts_of_all_kinds_are_taken() {
        assert_eq!(text("a\"b\\c d"), r#""a\u0022b\u005cc\u0020d""#);
    }
}
