//! The supervisor of the agents of a run in real time: it applies requested changes, reports the
//! status of agents, and ends the run when all agents have ended.

use std::sync::Arc;
use std::sync::mpsc::{Receiver, RecvTimeoutError, Sender, SyncSender, sync_channel};
use std::time::Duration;

use super::clock::RunClock;
use super::real_time_host::{RealTimeHost, poll_pause};
use super::run_handle::HostStatus;
use super::stop_handle::StopHandle;
use monas_core::records::{Change, Changed, ChartChoice};
use monas_core::statistics::AgentStatistics;

/// Interval of its periodic checks.
const CHECK_INTERVAL: Duration = Duration::from_millis(100);

/// Timeout for replies to requests.
const REPLY_TIMEOUT: Duration = Duration::from_secs(4);

/// A request to the supervisor.
pub(crate) enum SupervisorRequest {
    /// A change has been published on the host of this index.
    ChangePublished(usize),
    /// Apply an external change.
    Change { host: String, change: Box<Change>, answer: SyncSender<Result<Changed, String>> },
    /// Report the status of the agents, and the state of one of their charts.
    Inspect { chart: Option<ChartChoice>, answer: SyncSender<Vec<HostStatus>> },
    /// A thread of an agent has nothing left to do.
    ThreadFinished,
    /// The run ends.
    End,
}

/// A handle for sending requests to the supervisor.
#[derive(Clone)]
pub(crate) struct SupervisorHandle(pub(crate) Sender<SupervisorRequest>);

impl SupervisorHandle {
    pub(crate) fn change(&self, host: &str, change: Change) -> Result<Changed, String> {
        self.request(|answer| SupervisorRequest::Change {
            host: host.into(),
            change: Box::new(change),
            answer,
        })?
    }

    pub(crate) fn host_statuses(&self, chart: Option<ChartChoice>) -> Result<Vec<HostStatus>, String> {
        self.request(|answer| SupervisorRequest::Inspect { chart, answer })
    }

    fn request<T>(&self, what: impl FnOnce(SyncSender<T>) -> SupervisorRequest) -> Result<T, String> {
        let (answer, answered) = sync_channel(1);
        self.0.send(what(answer)).map_err(|_| "the run has ended".to_owned())?;
        answered.recv_timeout(REPLY_TIMEOUT).map_err(|error| match error {
            RecvTimeoutError::Timeout => "the run does not answer".to_owned(),
            RecvTimeoutError::Disconnected => "the run has ended".to_owned(),
        })
    }
}

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
        while !self.hosts.iter().all(RealTimeHost::is_finished) {
            poll_pause();
            self.check_agents();
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

/// Notifies the supervisor when the end of the run is requested.
pub(crate) fn wake_on_stop(line: &Sender<SupervisorRequest>, stopper: &StopHandle) {
    let line = line.clone();
    stopper.on_stop(Box::new(move || {
        // A supervisor that has ended needs no notification.
        let _ = line.send(SupervisorRequest::End);
    }));
}

/// A callback for the waker of a host, with a separate handle to the supervisor.
pub(crate) fn request_notifier(line: &Sender<SupervisorRequest>, host: usize) -> Arc<dyn Fn() + Send + Sync> {
    let line = line.clone();
    Arc::new(move || {
        let _ = line.send(SupervisorRequest::ChangePublished(host));
    })
}
