//! Requests to the supervisor of a run in real time.

use std::sync::Arc;
use std::sync::mpsc::{RecvTimeoutError, Sender, SyncSender, sync_channel};
use std::time::Duration;

use monas_core::records::{Change, Changed, ChartChoice};

use super::host_status::HostStatus;
use super::stop_handle::StopHandle;

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
