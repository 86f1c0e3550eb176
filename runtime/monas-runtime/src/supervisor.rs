//! The supervisor of the agents of a run in real time: it applies requested changes, reports the
//! status of agents, and ends the run when all agents have ended.

use std::sync::mpsc::{Receiver, RecvTimeoutError};
use std::time::Duration;

use super::clock::RunClock;
use super::real_time_host::{RealTimeHost, poll_pause};
use super::stop_handle::StopHandle;
use super::supervisor_request::SupervisorRequest;
use monas_core::statistics::AgentStatistics;

/// Interval of its periodic checks.
const CHECK_INTERVAL: Duration = Duration::from_millis(100);

/// The supervisor of a run.
pub(crate) struct Supervisor {
    pub(crate) hosts: Vec<RealTimeHost>,
    pub(crate) events: Receiver<SupervisorRequest>,
    pub(crate) stopper: StopHandle,
    pub(crate) clock: RunClock,
}

impl Supervisor {
    /// Supervises the agents until the run ends; then stops them and returns their statistics.
    pub(crate) fn run(mut self) -> Vec<AgentStatistics> {
        while !self.stopper.is_stopped() {
            match self.events.recv_timeout(CHECK_INTERVAL) {
                Ok(event) => self.handle(event),
                Err(RecvTimeoutError::Timeout) => {}
                Err(RecvTimeoutError::Disconnected) => break,
            }
            self.check_agents();
        }
        self.hosts.iter().for_each(RealTimeHost::end);
        let asked = self.clock.now();
        while !self.hosts.iter().all(RealTimeHost::is_finished) {
            poll_pause();
            self.check_agents();
            let now = self.clock.now();
            self.hosts.iter().for_each(|host| host.abandon(asked, now));
        }
        self.hosts.into_iter().flat_map(RealTimeHost::join).collect()
    }

    /// Checks whether all agents make progress.
    fn check_agents(&mut self) {
        let now = self.clock.now();
        if self.hosts.iter().filter(|host| host.check_agents(now)).count() > 0 {
            self.check_completion();
        }
    }

    fn handle(&mut self, event: SupervisorRequest) {
        let now = self.clock.now();
        match event {
            SupervisorRequest::ChangePublished(host) => {
                if let Some(host) = self.hosts.get_mut(host) {
                    host.apply_requests(now);
                }
            }
            SupervisorRequest::Change { host, change, answer } => {
                let known = self.hosts.iter_mut().find(|known| known.name() == host);
                let changed = known.map(|known| known.change(*change, now));
                // The requester may have timed out.
                let _ = answer.try_send(changed.ok_or_else(|| format!("no host is named `{host}`")));
            }
            SupervisorRequest::Inspect { chart, answer } => {
                let views = self.hosts.iter_mut().map(|host| host.status(chart.as_ref()));
                let _ = answer.try_send(views.collect());
            }
            SupervisorRequest::ThreadFinished => self.check_completion(),
            SupervisorRequest::End => {}
        }
    }

    /// Brings the body of a host into its safe state when all its agents have ended; ends the run
    /// when all agents have ended.
    fn check_completion(&mut self) {
        self.hosts.iter().filter(|host| host.is_over()).for_each(RealTimeHost::request_safe_state);
        if self.hosts.iter().all(|host| host.is_over() || host.is_empty()) {
            tracing::info!("every agent has ended, and so does the run");
            self.stopper.stop();
        }
    }
}
