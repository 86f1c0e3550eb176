//! Links of a host to other processes and hosts: what is configured, and what is known of them when they run.

use std::path::PathBuf;

use monas_link::LinkSettings;

use crate::activity::{Activity, BoxError, Progress, Topics};
use narukom::Blackboard;

/// A link of a host.
#[derive(Clone, PartialEq, Eq, Debug, Default)]
pub struct LinkConfig {
    /// What crosses it, and how.
    pub settings: LinkSettings,
    /// On which way.
    pub transport: LinkTransport,
    /// The name of the other end whose time the run takes for its own, so that moments inside messages mean the same at both: for
    /// processes of one robot. In real time only; agents start when the time is known.
    pub clock: Option<String>,
}

/// The way on which a link's packets travel.
#[derive(Clone, PartialEq, Eq, Debug)]
pub enum LinkTransport {
    /// Sockets of the same computer.
    Local {
        /// The folder of the sockets; `$XDG_RUNTIME_DIR/monas` if it is not said.
        folder: Option<PathBuf>,
    },
    /// Zenoh, in programs that are built with the feature `zenoh`.
    Zenoh(Endpoints),
}

/// How zenoh is reached.
#[derive(Clone, PartialEq, Eq, Debug, Default)]
pub struct Endpoints {
    /// The first segment of every key; links of different realms do not hear each other. `monas` if it is not said.
    pub realm: Option<String>,
    /// Where others may come, such as `tcp/127.0.0.1:7447`.
    pub listen: Vec<String>,
    /// Where this link goes, such as `tcp/192.168.1.20:7447`.
    pub connect: Vec<String>,
    /// Whether others are also looked for by multicast and by hearsay.
    pub scouting: bool,
    /// Whether large messages go through shared memory to readers on the same computer.
    pub shared_memory: bool,
    /// The files of the certificates, where endpoints are `tls/`.
    pub certificates: Option<Certificates>,
}

#[cfg(feature = "zenoh")]
impl Endpoints {
    /// The same for the transport.
    pub(crate) fn settings(&self) -> monas_link::ZenohSettings {
        let Endpoints { realm, listen, connect, scouting, shared_memory, certificates } = self.clone();
        let usual = monas_link::ZenohSettings::default();
        monas_link::ZenohSettings {
            realm: realm.unwrap_or(usual.realm),
            listen,
            connect,
            scouting,
            shared_memory,
            tls: certificates.map(|Certificates { authority, certificate, key }| monas_link::Tls {
                authority,
                certificate,
                key,
            }),
            ..usual
        }
    }
}

/// Files of certificates. Both sides show one, and both check it.
#[derive(Clone, PartialEq, Eq, Debug)]
pub struct Certificates {
    /// The certificate of the authority that signs all others.
    pub authority: PathBuf,
    /// This host's certificate.
    pub certificate: PathBuf,
    /// The key to it.
    pub key: PathBuf,
}

impl Default for LinkTransport {
    fn default() -> LinkTransport {
        LinkTransport::Local { folder: None }
    }
}

/// What a link of a host has done.
#[derive(Clone, PartialEq, Debug)]
pub struct LinkStatistics {
    /// The host.
    pub host: String,
    /// The name of the link's end.
    pub link: String,
    /// What is known of it.
    pub report: monas_link::Report,
}

/// Stands for an activity that another process runs: what that publishes comes over a link.
#[derive(Debug)]
pub(crate) struct Elsewhere {
    name: String,
}

impl Elsewhere {
    pub(crate) fn new(name: &str) -> Elsewhere {
        Elsewhere { name: name.into() }
    }
}

impl Activity for Elsewhere {
    fn execute(&mut self, _: &mut Blackboard) -> Result<Progress, BoxError> {
        Ok(Progress::Done)
    }

    fn name(&self) -> &str {
        &self.name
    }

    fn topics(&self) -> Topics {
        Topics::declared()
    }
}
