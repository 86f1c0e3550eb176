//! A run as others see it: its hubs, its time, and a way in for what is published from outside.

use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};
use std::sync::mpsc::{Receiver, RecvTimeoutError, SyncSender, TrySendError, sync_channel};
use std::time::Duration;

use narukom::{Moment, Narukom};

use prost::Message;

use super::clock::Clock;
use super::supervisor::SupervisorLine;
use crate::records::{
    AgentEntry, Agents, Change, Changed, ChartChoice, ChartState, Configuration, Inquiry, ModuleEntry,
    Modules, Reply,
};

/// Whoever publishes from outside does so under this name.
pub(super) const OUTSIDE: &str = "outside";

/// So many messages from outside wait at most for the next moment of a simulated run.
const WAITING: usize = 64;

/// A run in simulated time that nobody advances for this long does not take what is handed in.
const PATIENCE: Duration = Duration::from_secs(2);

/// A run as those see it who look on: its hubs, and how far it is. It may be kept longer than the run.
#[derive(Clone)]
pub struct Overview {
    hubs: Vec<Narukom>,
    time: Time,
}

#[derive(Clone)]
enum Time {
    Real(Clock, SupervisorLine),
    Simulated(Arc<ShownMoment>, SyncSender<HandedIn>),
}

/// How far a simulated run is.
#[derive(Default)]
pub(super) struct ShownMoment(AtomicU64);

impl ShownMoment {
    pub(super) fn set(&self, moment: Moment) {
        self.0.store(moment.as_nanos(), Ordering::Release);
    }

    pub(super) fn get(&self) -> Moment {
        Moment::from_nanos(self.0.load(Ordering::Acquire))
    }
}

/// What waits for the next moment of a run.
pub(super) enum HandedIn {
    Message { hub: Narukom, path: String, bytes: Vec<u8>, answer: SyncSender<Result<(), String>> },
    Change { host: String, change: Box<Change>, answer: SyncSender<Result<Changed, String>> },
    Look { chart: Option<ChartChoice>, answer: SyncSender<Vec<View>> },
}

/// A host as it is now.
pub(super) struct View {
    pub(super) host: String,
    pub(super) agents: Vec<AgentEntry>,
    pub(super) configuration: Configuration,
    pub(super) modules: Vec<ModuleEntry>,
    /// The chart that was asked for, or why it cannot be told.
    pub(super) chart: Option<Result<ChartState, String>>,
}

/// Where a simulated run finds what was handed in.
pub(super) struct Inlet {
    sender: SyncSender<HandedIn>,
    waiting: Receiver<HandedIn>,
}

impl Inlet {
    pub(super) fn new() -> Inlet {
        let (sender, waiting) = sync_channel(WAITING);
        Inlet { sender, waiting }
    }

    fn sender(&self) -> SyncSender<HandedIn> {
        self.sender.clone()
    }

    /// What waits longest.
    pub(super) fn next(&self) -> Option<HandedIn> {
        self.waiting.try_recv().ok()
    }
}

/// Publishes the message that `bytes` encode.
pub(super) fn publish(hub: &Narukom, path: &str, bytes: &[u8], now: Moment) -> Result<(), String> {
    let publisher = hub.publisher_by_name(path, OUTSIDE);
    publisher.and_then(|mut publisher| publisher.publish_bytes(bytes, now)).map_err(|error| error.to_string())
}

impl Overview {
    pub(super) fn real(hubs: Vec<Narukom>, clock: Clock, supervisor: SupervisorLine) -> Overview {
        Overview { hubs, time: Time::Real(clock, supervisor) }
    }

    pub(super) fn simulated(hubs: Vec<Narukom>, shown: Arc<ShownMoment>, inlet: &Inlet) -> Overview {
        Overview { hubs, time: Time::Simulated(shown, inlet.sender()) }
    }

    /// The hubs of its hosts, and of the world if there is one.
    pub fn hubs(&self) -> &[Narukom] {
        &self.hubs
    }

    /// How far it is.
    pub fn now(&self) -> Moment {
        match &self.time {
            Time::Real(clock, _) => clock.now(),
            Time::Simulated(shown, _) => shown.get(),
        }
    }

    /// Whether its time is simulated.
    pub fn is_simulated(&self) -> bool {
        matches!(self.time, Time::Simulated(..))
    }

    /// Publishes the message that `bytes` encode on a topic of a host, as any agent there could: whoever records the run records it. In
    /// simulated time it waits for the next moment of the run.
    ///
    /// # Errors
    /// Why not: nobody knows the host or the topic, the bytes are no message of it, or the run stands still.
    pub fn publish(&self, host: &str, path: &str, bytes: &[u8]) -> Result<(), String> {
        let hub = self.hubs.iter().find(|hub| hub.host() == host);
        let hub = hub.ok_or_else(|| format!("no host is named `{host}`"))?;
        match &self.time {
            Time::Real(clock, _) => publish(hub, path, bytes, clock.now()),
            Time::Simulated(_, inlet) => {
                let (path, bytes) = (path.into(), bytes.into());
                handed_in(inlet, |answer| HandedIn::Message { hub: hub.clone(), path, bytes, answer })?
            }
        }
    }

    /// Asks for a change of the agents of a host, as [`CHANGE`](crate::records::CHANGE) has it. It is made between two of their cycles.
    ///
    /// # Errors
    /// Why nobody could be asked; that the change is refused is said by the answer.
    pub fn change(&self, host: &str, change: Change) -> Result<Changed, String> {
        match &self.time {
            Time::Real(_, supervisor) => supervisor.change(host, change),
            Time::Simulated(_, inlet) => {
                let (host, change) = (host.into(), Box::new(change));
                handed_in(inlet, |answer| HandedIn::Change { host, change, answer })?
            }
        }
    }

    /// The agents of a host as they are now, or those of all hosts.
    ///
    /// # Errors
    /// There is no such host, or the run stands still.
    pub fn agents(&self, host: Option<&str>) -> Result<Vec<AgentEntry>, String> {
        Ok(self.views(host)?.into_iter().flat_map(|view| view.agents).collect())
    }

    /// The modules that are loaded on a host, or those of all hosts.
    ///
    /// # Errors
    /// There is no such host, or the run stands still.
    pub fn modules(&self, host: Option<&str>) -> Result<Vec<ModuleEntry>, String> {
        Ok(self.views(host)?.into_iter().flat_map(|view| view.modules).collect())
    }

    /// What the agents of a host are made of now, as a text that can be read again: the one they were read from, brought up to date.
    ///
    /// # Errors
    /// There is no such host, or the run stands still.
    pub fn configuration(&self, host: &str) -> Result<Configuration, String> {
        let view = self.views(Some(host))?.into_iter().next();
        view.map(|view| view.configuration).ok_or_else(|| format!("no agents run on `{host}`"))
    }

    /// What a statechart of an agent is doing at the end of its last step.
    ///
    /// # Errors
    /// There is no such host, agent or chart, or the run stands still.
    pub fn chart(&self, host: &str, choice: &ChartChoice) -> Result<ChartState, String> {
        let view = self.views_with(Some(host), Some(choice))?.into_iter().next();
        view.and_then(|view| view.chart).ok_or_else(|| format!("no agents run on `{host}`"))?
    }

    fn views(&self, host: Option<&str>) -> Result<Vec<View>, String> {
        self.views_with(host, None)
    }

    fn views_with(&self, host: Option<&str>, chart: Option<&ChartChoice>) -> Result<Vec<View>, String> {
        let chart = chart.cloned();
        let mut views = match &self.time {
            Time::Real(_, supervisor) => supervisor.views(chart)?,
            Time::Simulated(_, inlet) => handed_in(inlet, |answer| HandedIn::Look { chart, answer })?,
        };
        if let Some(host) = host {
            let known: Vec<String> = views.iter().map(|view| format!("`{}`", view.host)).collect();
            views.retain(|view| view.host == host);
            if views.is_empty() {
                return Err(format!("no host is named `{host}`; there are {}", known.join(", ")));
            }
        }
        Ok(views)
    }

    /// Answers what a tool asks of the run: an [`Inquiry`] in its encoding is answered by a [`Reply`] in its.
    ///
    /// # Errors
    /// Why not.
    pub fn manage(&self, inquiry: &[u8]) -> Result<Vec<u8>, String> {
        let inquiry = Inquiry::decode(inquiry).map_err(|_| "what is asked is not understood".to_owned())?;
        let host = (!inquiry.host.is_empty()).then_some(inquiry.host.as_str());
        let mut reply = Reply::default();
        if inquiry.agents {
            reply.agents = Some(Agents { agents: self.agents(host)? });
        } else if inquiry.modules {
            reply.modules = Some(Modules { modules: self.modules(host)? });
        } else if inquiry.configuration {
            reply.configuration = Some(self.configuration(&self.only(host)?)?);
        } else if let Some(choice) = inquiry.chart {
            reply.chart = Some(self.chart(&self.host_of(host, &choice.agent)?, &choice)?);
        } else if let Some(change) = inquiry.change {
            reply.changed = Some(self.change(&self.only(host)?, change)?);
        } else {
            return Err("nothing is asked".into());
        }
        Ok(reply.encode_to_vec())
    }

    /// The host that is meant: the one that is named, or the only one with that agent.
    fn host_of(&self, host: Option<&str>, agent: &str) -> Result<String, String> {
        let having = |view: &View| view.agents.iter().any(|known| known.name == agent);
        let mut hosts: Vec<String> =
            self.views(host)?.into_iter().filter(having).map(|view| view.host).collect();
        match (hosts.pop(), hosts.is_empty()) {
            (Some(only), true) => Ok(only),
            (None, _) => Err(format!("no agent is named `{agent}`")),
            (Some(last), false) => {
                Err(format!("`{agent}` is on several hosts: say which of {}, {last}", hosts.join(", ")))
            }
        }
    }

    /// The host that is meant, if it is not named.
    fn only(&self, host: Option<&str>) -> Result<String, String> {
        if let Some(host) = host {
            return Ok(host.to_owned());
        }
        let hosts: Vec<String> = self.views(None)?.into_iter().map(|view| view.host).collect();
        match &hosts[..] {
            [only] => Ok(only.clone()),
            [] => Err("the run has no host".into()),
            several => Err(format!("there are several hosts: say which of {}", several.join(", "))),
        }
    }
}

/// Hands something in, and waits for the answer.
fn handed_in<T>(
    inlet: &SyncSender<HandedIn>,
    what: impl FnOnce(SyncSender<T>) -> HandedIn,
) -> Result<T, String> {
    let (answer, answered) = sync_channel(1);
    inlet.try_send(what(answer)).map_err(|error| match error {
        TrySendError::Full(_) => format!("{WAITING} messages from outside wait already"),
        TrySendError::Disconnected(_) => "the run has ended".to_owned(),
    })?;
    answered.recv_timeout(PATIENCE).map_err(|error| match error {
        RecvTimeoutError::Timeout => "the run stands still and takes nothing".to_owned(),
        RecvTimeoutError::Disconnected => "the run has ended".to_owned(),
    })
}

#[cfg(unix)]
impl monas_link::control::Observed for Overview {
    fn hubs(&self) -> &[Narukom] {
        Overview::hubs(self)
    }

    fn now(&self) -> Moment {
        Overview::now(self)
    }

    fn is_simulated(&self) -> bool {
        Overview::is_simulated(self)
    }

    fn publish(&self, host: &str, path: &str, bytes: &[u8]) -> Result<(), String> {
        Overview::publish(self, host, path, bytes)
    }

    fn manage(&self, inquiry: &[u8]) -> Result<Vec<u8>, String> {
        Overview::manage(self, inquiry)
    }
}

impl std::fmt::Debug for Overview {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "Overview({} hubs at {})", self.hubs.len(), self.now())
    }
}
