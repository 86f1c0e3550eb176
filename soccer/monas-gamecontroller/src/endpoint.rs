//! Addresses of the protocol.

use std::fmt;
use std::net::{IpAddr, Ipv4Addr, Ipv6Addr, SocketAddr};
use std::str::FromStr;

use crate::CONTROL_PORT;

/// The address and port of control data: `127.0.0.1`, which has the league's port, or
/// `10.0.255.255:4838`.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub struct Endpoint(pub(crate) SocketAddr);

/// The address of a computer at the other end, or of a robot on this one.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub struct Peer(pub(crate) IpAddr);

impl Endpoint {
    /// Any free port of the loopback interface.
    pub const LOOPBACK: Endpoint = Endpoint(SocketAddr::new(IpAddr::V4(Ipv4Addr::LOCALHOST), 0));

    /// The interface at which robots reach the sender of packets to this address: the loopback
    /// interface for one of its addresses, otherwise all.
    pub(crate) fn reporting_interface(self) -> IpAddr {
        match self.0.ip() {
            IpAddr::V4(to) if to.is_loopback() => Ipv4Addr::LOCALHOST.into(),
            IpAddr::V6(to) if to.is_loopback() => Ipv6Addr::LOCALHOST.into(),
            IpAddr::V4(_) => Ipv4Addr::UNSPECIFIED.into(),
            IpAddr::V6(_) => Ipv6Addr::UNSPECIFIED.into(),
        }
    }
}

impl Peer {
    /// The address from which a robot of this host reports to this peer; `before` counts the robots
    /// that reported before it.
    pub(crate) fn source(self, before: usize) -> IpAddr {
        match self.0 {
            IpAddr::V4(peer) if peer.is_loopback() => {
                let offset = u32::try_from(before).unwrap_or(u32::MAX);
                Ipv4Addr::from(u32::from(Ipv4Addr::new(127, 0, 0, 2)).saturating_add(offset)).into()
            }
            IpAddr::V4(_) => Ipv4Addr::UNSPECIFIED.into(),
            IpAddr::V6(_) => Ipv6Addr::UNSPECIFIED.into(),
        }
    }
}

impl FromStr for Endpoint {
    type Err = String;

    fn from_str(text: &str) -> Result<Endpoint, String> {
        let only_host = text.parse::<IpAddr>().map(|host| SocketAddr::new(host, CONTROL_PORT));
        let address = only_host.or_else(|_| text.parse());
        address.map(Endpoint).map_err(|_| "expected an IP address, or one with a port: 127.0.0.1:3838".into())
    }
}

impl fmt::Display for Endpoint {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        self.0.fmt(f)
    }
}

impl fmt::Display for Peer {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        self.0.fmt(f)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_address_has_the_leagues_port_unless_it_says_another() {
        let text = |text: &str| text.parse::<Endpoint>().map(|endpoint| endpoint.to_string());
        assert_eq!(text("127.0.0.1"), Ok("127.0.0.1:3838".into()));
        assert_eq!(text("10.0.2.255:4000"), Ok("10.0.2.255:4000".into()));
        assert_eq!(text("::1"), Ok("[::1]:3838".into()));
        assert!(text("localhost").is_err());
    }

    #[test]
    fn robots_reach_the_sender_at_the_interface_of_its_packets() {
        let interface = |text: &str| text.parse::<Endpoint>().map(|to| to.reporting_interface().to_string());
        assert_eq!(interface("127.255.255.255"), Ok("127.0.0.1".into()));
        assert_eq!(interface("10.0.255.255"), Ok("0.0.0.0".into()));
        let source = |peer: [u8; 4], before| Peer(peer.into()).source(before).to_string();
        assert_eq!([source([127, 0, 0, 1], 0), source([127, 0, 0, 1], 3)], ["127.0.0.2", "127.0.0.5"]);
        assert_eq!(source([10, 0, 0, 1], 3), "0.0.0.0");
    }
}
