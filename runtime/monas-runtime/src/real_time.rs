//! Runs in real time: a thread for each list, each chart and each body, and a pool for the
//! activities of each agent's charts.

use std::fmt;
use std::sync::Arc;
use std::sync::atomic::AtomicBool;
use std::sync::mpsc::{Sender, channel};
use std::thread::JoinHandle;

use narukom::{Hub, Timestamp};

use super::agent_factory::AgentFactory;
use super::body::BodyBridge;
use super::body_thread::BodyThread;
use super::clock::RunClock;
use super::links::{RunningLink, time_of_other};
use super::real_time_host::{ConnectedAgent, HostSite, RealTimeHost, WakeCallback, spawn};
use super::run_config::RunConfig;
use super::run_handle::RunHandle;
use super::setup::{PreparedHost, PreparedRun, WorldDriver};
use super::stop_handle::StopHandle;
use super::supervisor::Supervisor;
use super::supervisor_request::{SupervisorHandle, SupervisorRequest, wake_on_stop};
use monas_core::error::{Error, ErrorKind};
use monas_core::statistics::{AgentStatistics, BodyStatistics, Statistics};
use monas_link::LinkStatistics;
use monas_log::LogHosts;

/// A run in real time. It ends when it is [stopped](RealTimeRun::stop) or dropped, or when its
/// [stop handle](RealTimeRun::stopper) is used.
pub struct RealTimeRun {
    stopper: StopHandle,
    clock: RunClock,
    line: Sender<SupervisorRequest>,
    supervisor: Option<JoinHandle<Vec<AgentStatistics>>>,
    world: Option<JoinHandle<Result<(), Error>>>,
    bodies: Vec<JoinHandle<BodyStatistics>>,
    links: Vec<RunningLink>,
    hubs: Vec<Hub>,
}

/// A host whose agents receive messages and whose threads have not been started.
struct ConnectedHost {
    agents: Vec<ConnectedAgent>,
    body: Option<(BodyBridge, Hub)>,
    safe_state: Arc<AtomicBool>,
}

impl RealTimeRun {
    /// Prepares all hosts, then starts the threads.
    pub(crate) fn start(config: RunConfig, seed: u64) -> Result<RealTimeRun, Error> {
        let PreparedRun { world, hosts: prepared_hosts, factory } = PreparedRun::new(config, seed)?;
        let (line, events) = channel();
        let mut running = RealTimeRun {
            stopper: StopHandle::new(),
            clock: run_clock(&prepared_hosts)?,
            line,
            supervisor: None,
            world: None,
            bodies: Vec::new(),
            links: Vec::new(),
            hubs: Vec::new(),
        };
        let mut hosts = Vec::new();
        let hub_of_world = world.as_ref().map(|world| world.hub().clone());
        let launched = running.launch(world, prepared_hosts, &factory, &mut hosts);
        running.hubs.extend(hub_of_world);
        wake_on_stop(&running.line, &running.stopper);
        let supervisor = Supervisor { hosts, events, stopper: running.stopper.clone(), clock: running.clock };
        if launched.is_err() {
            // Stops the threads that have already started.
            running.stopper.stop();
        }
        let clock = running.clock;
        let hosting = LogHosts::real(&running.hubs, move || clock.now());
        running.supervisor = Some(spawn("supervisor", move || hosting.during(|| supervisor.run()))?);
        launched.map(|()| running)
    }

    /// A handle that stops the run from any thread.
    pub fn stopper(&self) -> StopHandle {
        self.stopper.clone()
    }

    /// A handle for inspecting the run and publishing from outside.
    pub fn run_handle(&self) -> RunHandle {
        RunHandle::real(self.hubs.clone(), self.clock, SupervisorHandle(self.line.clone()))
    }

    /// The hub of a host or of the world, for inspection or participation with a separate
    /// blackboard.
    pub fn hub(&self, host: &str) -> Option<&Hub> {
        self.hubs.iter().find(|hub| hub.host() == host)
    }

    /// The statistics of its links so far.
    pub fn links(&self) -> Vec<LinkStatistics> {
        self.links.iter().map(RunningLink::statistics).collect()
    }

    /// The present time of the run.
    pub fn now(&self) -> Timestamp {
        self.clock.now()
    }

    /// Waits until a moment of the run; returns false if the run is stopped before.
    pub fn wait_until(&self, moment: Timestamp) -> bool {
        self.stopper.wait_until(moment, &self.clock)
    }

    /// Whether the run has been stopped, or every agent has ended.
    pub fn has_ended(&self) -> bool {
        self.stopper.is_stopped()
    }

    /// Waits until the run is stopped or every agent has ended, and returns its statistics.
    pub fn wait(self) -> Statistics {
        self.stopper.wait();
        self.stop()
    }

    /// Stops the run after the present cycles of its agents, and returns its statistics.
    pub fn stop(mut self) -> Statistics {
        self.end()
    }

    fn end(&mut self) -> Statistics {
        self.stopper.stop();
        let agents = self.supervisor.take().map(JoinHandle::join);
        let supervised = match &agents {
            Some(Err(_)) => Some("the thread of the supervisor has panicked".to_owned()),
            _ => None,
        };
        let agents = agents.and_then(Result::ok);
        supervised.iter().for_each(|failure| tracing::error!("{failure}"));
        let failure = match self.world.take().map(JoinHandle::join) {
            None | Some(Ok(Ok(()))) => supervised,
            Some(Ok(Err(error))) => Some(error.to_string()),
            Some(Err(_)) => Some("the thread of the world has panicked".to_owned()),
        };
        let mut bodies = Vec::new();
        for thread in self.bodies.drain(..) {
            match thread.join() {
                Ok(body) => bodies.push(body),
                Err(_) => tracing::error!("the thread of a body has panicked"),
            }
        }
        let links = self.links.drain(..).map(RunningLink::stop).collect();
        Statistics { agents: agents.unwrap_or_default(), bodies, links, failure }
    }

    fn launch_world(&mut self, mut world: WorldDriver) -> Result<(), Error> {
        let (stopper, clock) = (self.stopper.clone(), self.clock);
        let hosting = LogHosts::real([world.hub()], move || clock.now());
        let thread = spawn("world", move || {
            let _hosted = hosting.begin();
            while stopper.wait_until(world.due(), &clock) {
                if let Err(error) = world.advance(world.due()) {
                    tracing::error!("{error}");
                    stopper.stop();
                    return Err(error);
                }
            }
            Ok(())
        })?;
        self.world = Some(thread);
        Ok(())
    }

    /// Starts everything. All subscriptions stand before the first thread publishes.
    fn launch(
        &mut self,
        world: Option<WorldDriver>,
        prepared_hosts: Vec<PreparedHost>,
        factory: &Arc<AgentFactory>,
        hosts: &mut Vec<RealTimeHost>,
    ) -> Result<(), Error> {
        let connected =
            prepared_hosts.into_iter().map(|prepared| self.connect_host(prepared, factory, hosts));
        let connected = connected.collect::<Result<Vec<ConnectedHost>, Error>>()?;
        world.map_or(Ok(()), |world| self.launch_world(world))?;
        for (host, ConnectedHost { agents, body, safe_state }) in hosts.iter_mut().zip(connected) {
            host.start(agents)?;
            body.map_or(Ok(()), |(body, hub)| self.launch_body(body, &hub, safe_state))?;
        }
        Ok(())
    }

    /// Subscribes the agents of a host, then its links, which bring messages at once.
    fn connect_host(
        &mut self,
        host: PreparedHost,
        factory: &Arc<AgentFactory>,
        hosts: &mut Vec<RealTimeHost>,
    ) -> Result<ConnectedHost, Error> {
        let PreparedHost { hub, body, agents: members, links, context: ground, profiles, configuration } =
            host;
        self.hubs.push(hub.clone());
        let clock = self.clock;
        let safe_state = Arc::new(AtomicBool::new(false));
        let (index, line) = (hosts.len(), self.line.clone());
        let site = HostSite {
            hub: hub.clone(),
            host: index,
            clock,
            safe_state: safe_state.clone(),
            supervisor: line,
        };
        hosts.push(RealTimeHost::new(site, factory.clone(), ground, profiles, configuration)?);
        let agents = hosts[index].connect(members)?;
        let links = links.into_iter().map(|link| RunningLink::start(&hub, link, move || clock.now()));
        let links = links.collect::<Result<Vec<_>, Error>>()?;
        hosts[index].connect_links(links.iter().map(|link| Arc::new(link.waker()) as WakeCallback));
        self.links.extend(links);
        Ok(ConnectedHost { agents, body: body.map(|body| (body, hub)), safe_state })
    }

    /// Starts the cycles of a body.
    fn launch_body(&mut self, body: BodyBridge, hub: &Hub, rests: Arc<AtomicBool>) -> Result<(), Error> {
        let clock = self.clock;
        let hosting = LogHosts::real([hub], move || clock.now());
        let name = format!("{} body", hub.host());
        let thread = BodyThread::new(body, hub.host().to_owned(), self.stopper.clone(), clock, rests);
        self.bodies.push(spawn(&name, move || hosting.during(|| thread.run()))?);
        Ok(())
    }
}

/// The clock of the run: its own, or that of the other end of a link configured for it.
fn run_clock(hosts: &[PreparedHost]) -> Result<RunClock, Error> {
    let links = hosts.iter().flat_map(|host| host.links.iter().map(|link| (&host.hub, link)));
    let mut followed = links.filter_map(|(hub, link)| Some((hub, link, link.clock.as_deref()?)));
    match (followed.next(), followed.next()) {
        (None, _) => Ok(RunClock::start()),
        (Some((hub, link, other)), None) => time_of_other(hub, link, other),
        (Some((.., one)), Some((.., other))) => {
            let message = format!("links follow the clocks of both `{one}` and `{other}`");
            Err(Error::new(ErrorKind::Link, message))
        }
    }
}

impl Drop for RealTimeRun {
    fn drop(&mut self) {
        self.end();
    }
}

impl fmt::Debug for RealTimeRun {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("RealTimeRun").field("stopper", &self.stopper).finish_non_exhaustive()
    }
}
