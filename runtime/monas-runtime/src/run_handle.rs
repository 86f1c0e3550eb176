//! A run as seen from outside: its hubs, its time, and the entry point for external publications.

use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::{Receiver, RecvTimeoutError, SyncSender, TrySendError, sync_channel};
use std::time::Duration;

use narukom::{Hub, Timestamp};

use prost::Message;
use yase::diagnostic::nearest;

use super::clock::{RunClock, SimulatedClock};
use super::host_status::{HostStatus, OUTSIDE};
use super::stall_watchdog::WatchedRun;
use super::supervisor_request::SupervisorHandle;
use monas_core::records::{
    AgentEntry, Agents, Change, Changed, ChartChoice, ChartState, Configuration, Inquiry, ModuleEntry,
    Modules, Reply,
};

/// Maximum number of external requests that wait for the next step of a simulated run.
const MAX_WAITING_REQUESTS: usize = 64;

/// Timeout of a request to a simulated run that is not being advanced.
const REQUEST_TIMEOUT: Duration = Duration::from_secs(2);

/// A handle for inspecting a run from outside: its hubs and its time. It may outlive the run.
#[derive(Clone)]
pub struct RunHandle {
    hubs: Vec<Hub>,
    time: RunTime,
}

#[derive(Clone)]
enum RunTime {
    Real(RunClock, SupervisorHandle),
    Simulated(Arc<SimulatedClock>, ExternalRequests),
}

/// Requests to a simulated run, and why it does not answer them.
#[derive(Clone)]
struct ExternalRequests {
    sender: SyncSender<QueuedRequest>,
    watched: Arc<WatchedRun>,
}

/// A request that waits for the next step of a run.
pub(crate) enum ExternalRequest {
    Message { hub: Hub, path: String, bytes: Vec<u8>, answer: SyncSender<Result<(), String>> },
    Change { host: String, change: Box<Change>, answer: SyncSender<Result<Changed, String>> },
    Look { chart: Option<ChartChoice>, answer: SyncSender<Vec<HostStatus>> },
}

/// A request in the queue of a run, claimed once: by the run, or by a requester that withdraws it.
struct QueuedRequest {
    request: ExternalRequest,
    is_claimed: Arc<AtomicBool>,
}

/// The external requests to a simulated run.
pub(crate) struct RequestQueue {
    sender: SyncSender<QueuedRequest>,
    waiting: Receiver<QueuedRequest>,
}

impl RequestQueue {
    pub(crate) fn new() -> RequestQueue {
        let (sender, waiting) = sync_channel(MAX_WAITING_REQUESTS);
        RequestQueue { sender, waiting }
    }

    fn sender(&self) -> SyncSender<QueuedRequest> {
        self.sender.clone()
    }

    /// Takes the oldest request that was not withdrawn.
    pub(crate) fn next(&self) -> Option<ExternalRequest> {
        let mut waiting = self.waiting.try_iter();
        let taken = waiting.find(|queued| !queued.is_claimed.swap(true, Ordering::SeqCst))?;
        Some(taken.request)
    }
}

/// Publishes the message encoded in `bytes`.
pub(crate) fn publish(hub: &Hub, path: &str, bytes: &[u8], now: Timestamp) -> Result<(), String> {
    let publisher = hub.publisher_by_name(path, OUTSIDE);
    publisher.and_then(|mut publisher| publisher.publish_bytes(bytes, now)).map_err(|error| error.to_string())
}

impl RunHandle {
    pub(crate) fn real(hubs: Vec<Hub>, clock: RunClock, supervisor: SupervisorHandle) -> RunHandle {
        RunHandle { hubs, time: RunTime::Real(clock, supervisor) }
    }

    pub(crate) fn simulated(
        hubs: Vec<Hub>,
        shown: Arc<SimulatedClock>,
        queue: &RequestQueue,
        watched: Arc<WatchedRun>,
    ) -> RunHandle {
        let requests = ExternalRequests { sender: queue.sender(), watched };
        RunHandle { hubs, time: RunTime::Simulated(shown, requests) }
    }

    /// The hubs of its hosts, and of the world if there is one.
    pub fn hubs(&self) -> &[Hub] {
        &self.hubs
    }

    /// The present time of the run.
    pub fn now(&self) -> Timestamp {
        match &self.time {
            RunTime::Real(clock, _) => clock.now(),
            RunTime::Simulated(shown, _) => shown.get(),
        }
    }

    /// Whether its time is simulated.
    pub fn is_simulated(&self) -> bool {
        matches!(self.time, RunTime::Simulated(..))
    }

    /// Publishes the message encoded in `bytes` on a topic of a host, like an agent of that host:
    /// recorders record it. In simulated time the publication waits for the next step of the run.
    ///
    /// # Errors
    /// The host or the topic is unknown, the bytes are not a message of the topic, or the run is
    /// not being advanced.
    pub fn publish(&self, host: &str, path: &str, bytes: &[u8]) -> Result<(), String> {
        let hub = self.hubs.iter().find(|hub| hub.host() == host);
        let hub = hub.ok_or_else(|| unknown_host(host, self.hubs.iter().map(Hub::host)))?;
        match &self.time {
            RunTime::Real(clock, _) => publish(hub, path, bytes, clock.now()),
            RunTime::Simulated(_, requests) => {
                let (path, bytes) = (path.into(), bytes.into());
                requests.submit(|answer| ExternalRequest::Message {
                    hub: hub.clone(),
                    path,
                    bytes,
                    answer,
                })?
            }
        }
    }

    /// Requests a change of the agents of a host through [`CHANGE`](monas_core::records::CHANGE).
    /// It is applied between two of their cycles.
    ///
    /// # Errors
    /// The request could not be delivered; the refusal of a change is part of the reply.
    pub fn change(&self, host: &str, change: Change) -> Result<Changed, String> {
        match &self.time {
            RunTime::Real(_, supervisor) => supervisor.change(host, change),
            RunTime::Simulated(_, requests) => {
                let (host, change) = (host.into(), Box::new(change));
                requests.submit(|answer| ExternalRequest::Change { host, change, answer })?
            }
        }
    }

    /// The present entries of the agents of a host, or of all hosts.
    ///
    /// # Errors
    /// There is no such host, or the run is not being advanced.
    pub fn agents(&self, host: Option<&str>) -> Result<Vec<AgentEntry>, String> {
        Ok(self.host_statuses(host)?.into_iter().flat_map(|view| view.agents).collect())
    }

    /// The modules that are loaded on a host, or on all hosts.
    ///
    /// # Errors
    /// There is no such host, or the run is not being advanced.
    pub fn modules(&self, host: Option<&str>) -> Result<Vec<ModuleEntry>, String> {
        Ok(self.host_statuses(host)?.into_iter().flat_map(|view| view.modules).collect())
    }

    /// The present configuration of a host as text that can be read again: the text it was read
    /// from, brought up to date.
    ///
    /// # Errors
    /// There is no such host, or the run is not being advanced.
    pub fn configuration(&self, host: &str) -> Result<Configuration, String> {
        let view = self.host_statuses(Some(host))?.into_iter().next();
        view.map(|view| view.configuration).ok_or_else(|| format!("no agents run on `{host}`"))
    }

    /// The state of a statechart of an agent at the end of its last step.
    ///
    /// # Errors
    /// There is no such host, agent or chart, or the run is not being advanced.
    pub fn chart(&self, host: &str, choice: &ChartChoice) -> Result<ChartState, String> {
        let view = self.host_statuses_with(Some(host), Some(choice))?.into_iter().next();
        view.and_then(|view| view.chart).ok_or_else(|| format!("no agents run on `{host}`"))?
    }

    fn host_statuses(&self, host: Option<&str>) -> Result<Vec<HostStatus>, String> {
        self.host_statuses_with(host, None)
    }

    fn host_statuses_with(
        &self,
        host: Option<&str>,
        chart: Option<&ChartChoice>,
    ) -> Result<Vec<HostStatus>, String> {
        let chart = chart.cloned();
        let mut views = match &self.time {
            RunTime::Real(_, supervisor) => supervisor.host_statuses(chart)?,
            RunTime::Simulated(_, requests) => match requests.watched.stuck_agent() {
                // The run does not answer, but why is known.
                Some(agent) if chart.is_none() => vec![stuck_host(agent)],
                _ => requests.submit(|answer| ExternalRequest::Look { chart, answer })?,
            },
        };
        if let Some(host) = host {
            let unknown = unknown_host(host, views.iter().map(|view| view.host.as_str()));
            views.retain(|view| view.host == host);
            if views.is_empty() {
                return Err(unknown);
            }
        }
        Ok(views)
    }

    /// Answers a query of a tool: takes an encoded [`Inquiry`] and returns an encoded [`Reply`].
    ///
    /// # Errors
    /// Why the query cannot be answered.
    pub fn manage(&self, inquiry: &[u8]) -> Result<Vec<u8>, String> {
        let inquiry = Inquiry::decode(inquiry).map_err(|_| "invalid request".to_owned())?;
        let host = (!inquiry.host.is_empty()).then_some(inquiry.host.as_str());
        let mut reply = Reply::default();
        if inquiry.agents {
            reply.agents = Some(Agents { agents: self.agents(host)? });
        } else if inquiry.modules {
            reply.modules = Some(Modules { modules: self.modules(host)? });
        } else if inquiry.configuration {
            reply.configuration = Some(self.configuration(&self.only_host(host)?)?);
        } else if let Some(choice) = inquiry.chart {
            reply.chart = Some(self.chart(&self.host_of(host, &choice.agent)?, &choice)?);
        } else if let Some(change) = inquiry.change {
            reply.changed = Some(self.change(&self.only_host(host)?, change)?);
        } else {
            return Err("nothing is asked".into());
        }
        Ok(reply.encode_to_vec())
    }

    /// The host of a query: the one that is named, or the only one with that agent.
    fn host_of(&self, host: Option<&str>, agent: &str) -> Result<String, String> {
        let having = |view: &&HostStatus| view.agents.iter().any(|known| known.name == agent);
        let statuses = self.host_statuses(host)?;
        let mut hosts: Vec<String> = statuses.iter().filter(having).map(|view| view.host.clone()).collect();
        match (hosts.pop(), hosts.is_empty()) {
            (Some(only), true) => Ok(only),
            (None, _) => {
                let known = statuses.iter().flat_map(|view| &view.agents).map(|known| known.name.as_str());
                let near = nearest(agent, known).map(|near| format!("; did you mean `{near}`?"));
                let on_host = host.map(|host| format!(" on `{host}`")).unwrap_or_default();
                Err(format!("no agent is named `{agent}`{on_host}{}", near.unwrap_or_default()))
            }
            (Some(last), false) => {
                Err(format!("`{agent}` is on several hosts: name one of {}, {last}", hosts.join(", ")))
            }
        }
    }

    /// The host of a query: the one that is named, or the only one.
    fn only_host(&self, host: Option<&str>) -> Result<String, String> {
        if let Some(host) = host {
            return Ok(host.to_owned());
        }
        let hosts: Vec<String> = self.host_statuses(None)?.into_iter().map(|view| view.host).collect();
        match &hosts[..] {
            [only] => Ok(only.clone()),
            [] => Err("the run has no host".into()),
            several => Err(format!("there are several hosts: name one of {}", several.join(", "))),
        }
    }
}

fn unknown_host<'a>(host: &str, known: impl Iterator<Item = &'a str>) -> String {
    let known: Vec<String> = known.map(|known| format!("`{known}`")).collect();
    format!("no host is named `{host}`; there are {}", known.join(", "))
}

/// The status of a host whose agent does not return.
fn stuck_host(agent: AgentEntry) -> HostStatus {
    HostStatus {
        host: agent.host.clone(),
        agents: vec![agent],
        configuration: Configuration::default(),
        modules: Vec::new(),
        chart: None,
    }
}

impl ExternalRequests {
    /// Submits a request and waits for its reply. Withdraws the request if the run does not take
    /// it in time.
    fn submit<T>(&self, what: impl FnOnce(SyncSender<T>) -> ExternalRequest) -> Result<T, String> {
        self.submit_within(REQUEST_TIMEOUT, what)
    }

    fn submit_within<T>(
        &self,
        timeout: Duration,
        what: impl FnOnce(SyncSender<T>) -> ExternalRequest,
    ) -> Result<T, String> {
        let (answer, answered) = sync_channel(1);
        let is_claimed = Arc::new(AtomicBool::new(false));
        let queued = QueuedRequest { request: what(answer), is_claimed: is_claimed.clone() };
        self.sender.try_send(queued).map_err(|error| match error {
            TrySendError::Full(_) => format!("{MAX_WAITING_REQUESTS} messages from outside wait already"),
            TrySendError::Disconnected(_) => "the run has ended".to_owned(),
        })?;
        let mut reply = answered.recv_timeout(timeout);
        if matches!(reply, Err(RecvTimeoutError::Timeout)) && is_claimed.swap(true, Ordering::SeqCst) {
            reply = answered.recv_timeout(timeout);
        }
        reply.map_err(|error| match (error, self.watched.stalled()) {
            (RecvTimeoutError::Timeout, Some(call)) => format!("the run stands still: {call}"),
            (RecvTimeoutError::Timeout, None) => "the run stands still and takes nothing".to_owned(),
            (RecvTimeoutError::Disconnected, _) => "the run has ended".to_owned(),
        })
    }
}

#[cfg(unix)]
impl monas_link::control::ControlTarget for RunHandle {
    fn hubs(&self) -> &[Hub] {
        RunHandle::hubs(self)
    }

    fn now(&self) -> Timestamp {
        RunHandle::now(self)
    }

    fn is_simulated(&self) -> bool {
        RunHandle::is_simulated(self)
    }

    fn publish(&self, host: &str, path: &str, bytes: &[u8]) -> Result<(), String> {
        RunHandle::publish(self, host, path, bytes)
    }

    fn manage(&self, inquiry: &[u8]) -> Result<Vec<u8>, String> {
        RunHandle::manage(self, inquiry)
    }
}

impl std::fmt::Debug for RunHandle {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "RunHandle({} hubs at {})", self.hubs.len(), self.now())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_request_that_the_run_did_not_take_in_time_is_withdrawn() {
        let queue = RequestQueue::new();
        let requests = ExternalRequests { sender: queue.sender(), watched: Arc::default() };
        let look = |answer| ExternalRequest::Look { chart: None, answer };
        let error = requests.submit_within(Duration::ZERO, look).map(|views| views.len());
        assert_eq!(error, Err("the run stands still and takes nothing".to_owned()));
        assert!(queue.next().is_none());
    }
}
