//! Topics of other processes and computers, for `monas topic --link`.
//!
//! Opens the links of a configuration on a host without agents, and serves a control socket for it,
//! so that the same commands work as on a run of this computer.

use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::time::Duration;

use monas::{HostConfig, LinkConfig, RealTimeRun, Registry, Talws};
use monas_link::control::ControlServer;
use monas_terminal::{CommandFailure, Format, WallClock};
use tempfile::TempDir;
use yase::Diagnostic;

use super::connection::failure;

/// Maximum time to wait for a peer.
const TIMEOUT: Duration = Duration::from_secs(5);

/// The interval between checks.
const CHECK_INTERVAL: Duration = Duration::from_millis(5);

/// The remote ends of links.
pub(crate) struct LinkTargets {
    server: ControlServer,
    running: RealTimeRun,
    /// The patterns of the topics that the links send.
    sent: Vec<String>,
    format: Format,
    _folder: TempDir,
}

impl LinkTargets {
    /// Opens the links of a configuration, and waits until a peer answers and its retained messages
    /// have arrived.
    pub(crate) fn open(config: &Path, format: Format) -> Result<LinkTargets, CommandFailure> {
        let links = links(config, format)?;
        let sent = links.iter().flat_map(|link| link.settings.send.iter().map(|rule| rule.topics.clone()));
        let sent = sent.collect();
        let name = links.iter().map(|link| link.settings.name.as_str()).find(|name| !name.is_empty());
        let name = name.unwrap_or(Talws::LOCAL).to_owned();
        let mut talws = Talws::new();
        talws.host(HostConfig { name, links, ..HostConfig::default() });
        let running = talws.start().map_err(|error| CommandFailure::not_started(format, error))?;
        let folder = tempfile::tempdir().map_err(|error| CommandFailure::failed(format, error))?;
        let server =
            ControlServer::start(&folder.path().join("monas"), "link", Arc::new(running.run_handle()));
        let server = server.map_err(failure(format))?;
        let reach = LinkTargets { server, running, sent, format, _folder: folder };
        reach.wait_until(LinkTargets::is_connected)?;
        Ok(reach)
    }

    /// The control socket.
    pub(crate) fn socket(&self) -> PathBuf {
        self.server.path().to_owned()
    }

    /// Fails if the links do not send a topic.
    pub(crate) fn check_sent(&self, topic: &str) -> Result<(), CommandFailure> {
        if self.sent.iter().any(|pattern| narukom::pattern_fits(pattern, topic)) {
            return Ok(());
        }
        let message = format!("the link does not send `{topic}`: add `<send topics=\"{topic}\"/>`");
        Err(CommandFailure::Usage(message))
    }

    /// Waits until all published messages are sent.
    pub(crate) fn wait_until_sent(&self) -> Result<(), CommandFailure> {
        self.wait_until(|reach| {
            let links = reach.running.links();
            links.iter().all(|link| link.report.counters.sent.iter().all(|(_, sent)| sent.waiting == 0))
        })
    }

    /// Whether a peer is connected and none of its messages is missing.
    fn is_connected(&self) -> bool {
        self.running.links().iter().any(|link| {
            let received = &link.report.counters.received;
            !link.report.peers.is_empty() && received.iter().all(|(_, _, topic)| topic.missing == 0)
        })
    }

    fn wait_until(&self, is_so: impl Fn(&LinkTargets) -> bool) -> Result<(), CommandFailure> {
        let clock = WallClock::start();
        while !is_so(self) && clock.elapsed() < TIMEOUT {
            clock.wait_until_or(clock.elapsed() + CHECK_INTERVAL, || false);
        }
        match is_so(self) {
            true => Ok(()),
            false => Err(CommandFailure::Unreachable(self.format, "no peer answers over the link".into())),
        }
    }
}

/// The links of a configuration, without its agents.
fn links(config: &Path, format: Format) -> Result<Vec<LinkConfig>, CommandFailure> {
    let (setup, diagnostics) = monas::config::load(config, &Registry::linked());
    if diagnostics.iter().any(Diagnostic::is_error) {
        return Err(CommandFailure::Invalid(format, diagnostics));
    }
    match setup.links.is_empty() {
        true => Err(CommandFailure::Usage(format!("{} has no `<link>`", config.display()))),
        false => Ok(setup.links),
    }
}
