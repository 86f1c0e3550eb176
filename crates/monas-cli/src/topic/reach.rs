//! `monas topic --link`: topics that come over a link, from other processes and computers.
//!
//! The links of a configuration are opened here, with nobody on this end, and looked at through a control socket of their own: what is asked
//! of a run on this computer is asked of them in the same words.

use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::time::Duration;

use monas::{HostConfig, LinkConfig, Registry, Running, Talws};
use monas_link::control::ControlServer;
use tempfile::TempDir;
use yase::Diagnostic;

use super::connect::failure;
use crate::arguments::Format;
use crate::failure::Failure;
use crate::run::{WallClock, not_started};

/// Who does not answer for this long is not there.
const PATIENCE: Duration = Duration::from_secs(5);

/// How often it is looked whether somebody is.
const LOOK: Duration = Duration::from_millis(5);

/// The other ends of links.
pub(super) struct Reach {
    server: ControlServer,
    running: Running,
    /// The patterns of what is sent.
    sent: Vec<String>,
    format: Format,
    _folder: TempDir,
}

impl Reach {
    /// Opens the links of a configuration, and waits until somebody answers and what is held for late readers has come.
    pub(super) fn open(config: &Path, format: Format) -> Result<Reach, Failure> {
        let links = links(config, format)?;
        let sent = links.iter().flat_map(|link| link.settings.send.iter().map(|rule| rule.topics.clone()));
        let sent = sent.collect();
        let name = links.iter().map(|link| link.settings.name.as_str()).find(|name| !name.is_empty());
        let name = name.unwrap_or(Talws::LOCAL).to_owned();
        let mut talws = Talws::new();
        talws.host(HostConfig { name, links, ..HostConfig::default() });
        let running = talws.start().map_err(|error| not_started(format, error))?;
        let folder = tempfile::tempdir().map_err(|error| Failure::failed(format, error))?;
        let server = ControlServer::start(folder.path(), "link", Arc::new(running.overview()));
        let server = server.map_err(failure(format))?;
        let reach = Reach { server, running, sent, format, _folder: folder };
        reach.wait_until(Reach::is_there)?;
        Ok(reach)
    }

    /// The socket through which they are looked at.
    pub(super) fn socket(&self) -> PathBuf {
        self.server.path().to_owned()
    }

    /// A topic is to be published, which has to be sent.
    pub(super) fn check_sent(&self, topic: &str) -> Result<(), Failure> {
        if self.sent.iter().any(|pattern| narukom::pattern_fits(pattern, topic)) {
            return Ok(());
        }
        let message = format!("the link does not send `{topic}`: give it `<send topics=\"{topic}\"/>`");
        Err(Failure::Usage(message))
    }

    /// Waits until everything has left that was published.
    pub(super) fn wait_until_sent(&self) -> Result<(), Failure> {
        self.wait_until(|reach| {
            let links = reach.running.links();
            links.iter().all(|link| link.report.counters.sent.iter().all(|(_, sent)| sent.waiting == 0))
        })
    }

    /// Whether somebody has been heard, and nothing is missing of what he has said.
    fn is_there(&self) -> bool {
        self.running.links().iter().any(|link| {
            let received = &link.report.counters.received;
            !link.report.peers.is_empty() && received.iter().all(|(_, _, topic)| topic.missing == 0)
        })
    }

    fn wait_until(&self, is_so: impl Fn(&Reach) -> bool) -> Result<(), Failure> {
        let clock = WallClock::start();
        while !is_so(self) && clock.elapsed() < PATIENCE {
            clock.wait_until_or(clock.elapsed() + LOOK, || false);
        }
        match is_so(self) {
            true => Ok(()),
            false => Err(Failure::Unreachable(self.format, "nobody answers over the link".into())),
        }
    }
}

/// The links of a configuration; its agents are not wanted here.
fn links(config: &Path, format: Format) -> Result<Vec<LinkConfig>, Failure> {
    let (setup, diagnostics) = monas::config::load(config, &Registry::linked());
    if diagnostics.iter().any(Diagnostic::is_error) {
        return Err(Failure::Invalid(format, diagnostics));
    }
    match setup.links.is_empty() {
        true => Err(Failure::Usage(format!("{} has no `<link>`", config.display()))),
        false => Ok(setup.links),
    }
}
