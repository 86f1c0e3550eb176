//! Links of a host to other processes and hosts: their configuration, and their statistics in a
//! run.

use std::path::PathBuf;

use crate::settings::LinkSettings;

/// A link of a host.
#[derive(Clone, PartialEq, Eq, Debug, Default)]
pub struct LinkConfig {
    /// Topics that cross it, and their settings.
    pub settings: LinkSettings,
    /// Its transport.
    pub transport: LinkTransport,
    /// The name of the peer whose clock the run adopts, so that timestamps inside messages mean the
    /// same at both ends: for processes of one robot. In real time only; agents start when the
    /// clock is synchronized.
    pub clock: Option<String>,
}

/// The transport of a link's packets.
#[derive(Clone, PartialEq, Eq, Debug)]
pub enum LinkTransport {
    /// Local sockets of one computer.
    Local {
        /// The folder of the sockets; default `$XDG_RUNTIME_DIR/monas`, or without it a
        /// private folder of this user.
        folder: Option<PathBuf>,
    },
    /// Zenoh, in programs that are built with the feature `zenoh`.
    Zenoh(ZenohEndpoints),
}

/// Settings of the zenoh transport.
#[derive(Clone, PartialEq, Eq, Debug, Default)]
pub struct ZenohEndpoints {
    /// The first segment of every key; links of different realms do not communicate. Default
    /// `monas`.
    pub realm: Option<String>,
    /// Endpoints to listen on, such as `tcp/127.0.0.1:7447`.
    pub listen: Vec<String>,
    /// Endpoints to connect to, such as `tcp/192.168.1.20:7447`.
    pub connect: Vec<String>,
    /// Whether to discover peers by multicast and gossip.
    pub scouting: bool,
    /// Whether large messages go through shared memory to readers on the same computer.
    pub shared_memory: bool,
    /// The files of the certificates, where endpoints are `tls/`.
    pub certificates: Option<Certificates>,
}

#[cfg(feature = "zenoh")]
impl ZenohEndpoints {
    /// The corresponding settings of the transport.
    pub fn settings(&self) -> crate::ZenohSettings {
        let ZenohEndpoints { realm, listen, connect, scouting, shared_memory, certificates } = self.clone();
        let usual = crate::ZenohSettings::default();
        crate::ZenohSettings {
            realm: realm.unwrap_or(usual.realm),
            listen,
            connect,
            scouting,
            shared_memory,
            tls: certificates.map(|Certificates { authority, certificate, key }| crate::Tls {
                authority,
                certificate,
                key,
            }),
            ..usual
        }
    }
}

/// Certificate files. Both sides present a certificate, and both verify it.
#[derive(Clone, PartialEq, Eq, Debug)]
pub struct Certificates {
    /// The certificate of the authority that signs the others.
    pub authority: PathBuf,
    /// This host's certificate.
    pub certificate: PathBuf,
    /// Its private key.
    pub key: PathBuf,
}

impl Default for LinkTransport {
    fn default() -> LinkTransport {
        LinkTransport::Local { folder: None }
    }
}

/// Statistics of a link of a host.
#[derive(Clone, PartialEq, Debug)]
pub struct LinkStatistics {
    /// The host.
    pub host: String,
    /// The name of the link's end.
    pub link: String,
    /// State and counters of the link.
    pub report: crate::LinkReport,
}
