//! Runs in simulated time: one thread, exact nanoseconds, a defined order.

mod simulated_host;

use std::collections::BTreeMap;
use std::sync::Arc;
use std::time::Duration;

use narukom::{Hub, Timestamp};

use super::agent_instance::AgentInstance;
use super::clock::{RunClock, SimulatedClock};
use super::links::RunningLink;
use super::run_config::RunConfig;
use super::run_handle::{self, ExternalRequest, RequestQueue, RunHandle};
use super::setup::{PreparedHost, PreparedRun, WorldDriver};
use super::simulation_thread::SimulationThread;
use super::stall_watchdog::{StallWatchdog, WatchedRun};
use super::stop_handle::StopHandle;
use monas_core::activity_context::SimulatedTimeGuard;
use monas_core::coverage::ChartCoverage;
use monas_core::error::{Error, ErrorKind};
use monas_core::records::{Change, Changed};
use monas_core::statistics::Statistics;
use monas_log::LogHosts;
use monas_log::LogHostsGuard;

use simulated_host::SimulatedHost;

/// A run in simulated time.
///
/// Time jumps from one due time to the next. At each time the order is: the world advances; bodies
/// sense; agents run; bodies act. Hosts are ordered by team and number (then name), agents of a
/// host by name; an agent that is woken by a message runs at the same time, in its next turn.
pub struct Simulation {
    now: Timestamp,
    /// The same time, for other threads.
    shown: Arc<SimulatedClock>,
    world: Option<WorldDriver>,
    hosts: Vec<SimulatedHost>,
    links: Vec<RunningLink>,
    requests: RequestQueue,
    /// Attributes log lines that are written during the simulation to its hosts.
    log_hosts: LogHosts,
    /// Scripted changes of agents, by time and the order in which they were added.
    script: BTreeMap<(Timestamp, usize), (usize, Change)>,
    /// The number of changes that have been scheduled.
    scripted: usize,
    watchdog: StallWatchdog,
    thread: Option<SimulationThread>,
}

impl Simulation {
    pub(crate) fn new(config: RunConfig, seed: u64) -> Result<Simulation, Error> {
        let PreparedRun { world, hosts: prepared_hosts, factory } = PreparedRun::new(config, seed)?;
        let shown = Arc::new(SimulatedClock::default());
        let mut links = Vec::new();
        let watchdog = StallWatchdog::new(limits(&prepared_hosts));
        let hosts = prepared_hosts
            .into_iter()
            .map(|prepared| SimulatedHost::new(prepared, &factory, &shown, &mut links));
        let hosts = hosts.collect::<Result<Vec<SimulatedHost>, Error>>()?;
        let hubs = world.iter().map(WorldDriver::hub).chain(hosts.iter().map(SimulatedHost::hub));
        let hosting = LogHosts::simulated(hubs);
        let (queue, script) = (RequestQueue::new(), BTreeMap::new());
        let (now, thread) = (Timestamp::ZERO, None);
        Ok(Simulation {
            now,
            shown,
            world,
            hosts,
            links,
            requests: queue,
            log_hosts: hosting,
            script,
            scripted: 0,
            watchdog,
            thread,
        })
    }

    /// Sets the simulated time and log hosts of this thread until the guards are dropped.
    fn enter(&mut self) -> (SimulatedTimeGuard, LogHostsGuard) {
        self.watchdog.watch_this_thread(&self.shown);
        (SimulatedTimeGuard::begin(self.now), self.log_hosts.begin())
    }

    /// The time up to which the run is complete.
    pub fn now(&self) -> Timestamp {
        self.now
    }

    /// Executes everything that is due before `end`. Events due at `end` itself belong to the
    /// next call, so that an agent at 10 Hz runs ten times in the first second: at 0 ms, 100 ms and
    /// so on to 900 ms.
    ///
    /// # Errors
    /// The world or a body failed. Failures of agents are not errors: see
    /// [`FailurePolicy`](monas_core::FailurePolicy).
    pub fn run_until(&mut self, end: Timestamp) -> Result<(), Error> {
        let _time = self.enter();
        loop {
            self.drain_requests();
            let next = self.due();
            if next >= end {
                self.advance_clock(self.now.max(end));
                return Ok(());
            }
            self.advance_clock(next);
            self.follow_script();
            self.run_moment(next)?;
        }
    }

    /// As [`run_until`](Simulation::run_until), but no faster than real time, from the start of
    /// this call. A stop handle ends it early.
    ///
    /// # Errors
    /// As in [`run_until`](Simulation::run_until).
    pub fn run_paced(&mut self, end: Timestamp, stopper: &StopHandle) -> Result<(), Error> {
        let _time = self.enter();
        let (clock, begun) = (RunClock::start(), self.now);
        while self.due() < end {
            self.drain_requests();
            let next = self.due();
            if !stopper.wait_until(Timestamp::ZERO + next.since(begun), &clock) {
                return Ok(());
            }
            self.advance_clock(next);
            self.follow_script();
            self.run_moment(next)?;
        }
        self.run_until(end)
    }

    /// Applies a change to the agents of a host now, between two of their cycles; the change is
    /// published like any request, and so is the reply.
    ///
    /// # Errors
    /// There is no such host. The refusal of a change is part of the reply.
    pub fn change(&mut self, host: &str, change: Change) -> Result<Changed, Error> {
        let (index, now) = (self.host_index(host)?, self.now);
        let _time = self.enter();
        Ok(self.hosts[index].change(change, now))
    }

    /// Schedules a change that is applied at its time before anything else; the reply is published.
    /// Equal scripts give equal runs.
    ///
    /// # Errors
    /// There is no such host.
    pub fn change_at(&mut self, moment: Timestamp, host: &str, change: Change) -> Result<(), Error> {
        let index = self.host_index(host)?;
        self.script.insert((moment.max(self.now), self.scripted), (index, change));
        self.scripted += 1;
        Ok(())
    }

    fn host_index(&self, host: &str) -> Result<usize, Error> {
        self.hosts.iter().position(|known| known.name() == host).ok_or_else(|| {
            let known = self.hosts.iter().map(SimulatedHost::name);
            Error::new(ErrorKind::UnknownHost, format!("no host is named `{host}`")).with_nearest(host, known)
        })
    }

    fn follow_script(&mut self) {
        while let Some(entry) = self.script.first_entry().filter(|entry| entry.key().0 <= self.now) {
            let (host, change) = entry.remove();
            self.hosts[host].change(change, self.now);
        }
    }

    /// From now on measures cycles and calls of activities in real time, and the memory that
    /// activities hold, as in a run in real time. The measurements are part of the
    /// [statistics](Self::statistics) and of the entries of a [`RunHandle`]. They reach no topic
    /// and no agent: the run stays the same.
    pub fn measure(&mut self) {
        let clock = RunClock::start();
        self.hosts.iter_mut().for_each(|host| host.measure(clock));
    }

    /// The statistics of the agents so far.
    pub fn statistics(&self) -> Statistics {
        let agents = self.hosts.iter().flat_map(SimulatedHost::statistics);
        let links = self.links.iter().map(RunningLink::statistics).collect();
        Statistics { agents: agents.collect(), links, ..Statistics::default() }
    }

    /// A handle for inspecting the run and publishing from outside. External messages are published
    /// between two steps, while the run is being advanced.
    pub fn run_handle(&self) -> RunHandle {
        let world = self.world.iter().map(WorldDriver::hub);
        let hubs = self.hosts.iter().map(SimulatedHost::hub).chain(world).cloned();
        let watched = self.watched().clone();
        RunHandle::simulated(hubs.collect(), self.shown.clone(), &self.requests, watched)
    }

    /// The hub of a host or of the world, for inspection, and for participation with a separate
    /// blackboard or publisher: what is published between two calls of
    /// [`run_until`](Simulation::run_until) wakes its readers at the beginning of the second.
    pub fn hub(&self, host: &str) -> Option<&Hub> {
        let world = self.world.iter().map(WorldDriver::hub);
        let hosts = self.hosts.iter().map(SimulatedHost::hub);
        world.chain(hosts).find(|hub| hub.host() == host)
    }

    /// Stops all agents and their activities.
    pub fn stop(&mut self) {
        let _time = self.enter();
        self.hosts.iter_mut().for_each(|host| host.stop(self.now));
    }

    /// As [`stop`](Simulation::stop), for at most this real time.
    ///
    /// # Errors
    /// [`ErrorKind::Stuck`](monas_core::ErrorKind::Stuck): an activity, which the error names, has
    /// not returned by then. It keeps its thread and the simulation until the process ends.
    pub fn stop_within(self, limit: Duration) -> Result<Simulation, Error> {
        let stop = |simulation: &mut Simulation| {
            simulation.stop();
            Ok(())
        };
        SimulationThread::work(self, stop)?.wait(|| true, limit)
    }

    /// As [`run_until`](Simulation::run_until), but abandoned if it has not returned within
    /// `limit`, in real time, after `is_cancelled`.
    ///
    /// # Errors
    /// As in [`run_until`](Simulation::run_until) and [`stop_within`](Simulation::stop_within).
    pub fn run_until_cancelled(
        self,
        end: Timestamp,
        is_cancelled: impl Fn() -> bool,
        limit: Duration,
    ) -> Result<Simulation, Error> {
        SimulationThread::work(self, move |simulation| simulation.run_until(end))?.wait(is_cancelled, limit)
    }

    /// The thread for work that may be abandoned.
    pub(crate) fn thread(&mut self) -> Result<&SimulationThread, Error> {
        match &mut self.thread {
            Some(thread) => Ok(thread),
            none => Ok(none.insert(SimulationThread::start()?)),
        }
    }

    /// The run as the watchdog sees it.
    pub(crate) fn watched(&self) -> &Arc<WatchedRun> {
        self.watchdog.watched()
    }

    /// The coverage of the states and transitions of each chart.
    pub fn coverage(&self) -> Vec<ChartCoverage> {
        self.hosts.iter().flat_map(|host| host.instances().iter().flat_map(AgentInstance::coverage)).collect()
    }

    /// Raises an event in the charts of an agent for their next step; returns false if there is no
    /// such agent, or none of its charts names the event.
    pub fn raise(&mut self, host: &str, agent: &str, event: &str) -> bool {
        let host = self.hosts.iter_mut().find(|known| known.name() == host);
        host.is_some_and(|host| host.raise(agent, event))
    }

    /// The time of the next moment. Calls that became due while an agent was paused are due
    /// now when it resumes: time does not go back.
    fn due(&self) -> Timestamp {
        let world = self.world.iter().map(WorldDriver::due);
        let script = self.script.keys().next().map(|(moment, _)| *moment);
        let hosts = self.hosts.iter().map(|host| host.due(self.now));
        world.chain(script).chain(hosts).min().unwrap_or(Timestamp::MAX).max(self.now)
    }

    /// Advances the time of the run.
    fn advance_clock(&mut self, now: Timestamp) {
        SimulatedTimeGuard::pass(now);
        self.now = now;
        self.shown.set(now);
    }

    /// Processes the external requests since the last step, applies the requested changes, and
    /// notifies agents of everything published since: by requests, by links, and by the caller
    /// through a [`hub`](Simulation::hub).
    fn drain_requests(&mut self) {
        let now = self.now;
        while let Some(handed_in) = self.requests.next() {
            self.handle_request(handed_in);
        }
        for host in &mut self.hosts {
            host.apply_requests(now);
            host.deliver_publications(now);
        }
    }

    fn handle_request(&mut self, handed_in: ExternalRequest) {
        let now = self.now;
        // The requester may have timed out.
        let _ = match handed_in {
            ExternalRequest::Message { hub, path, bytes, answer } => {
                answer.try_send(run_handle::publish(&hub, &path, &bytes, now)).is_ok()
            }
            ExternalRequest::Change { host, change, answer } => match self.change(&host, *change) {
                Ok(changed) => answer.try_send(Ok(changed)).is_ok(),
                Err(error) => answer.try_send(Err(error.to_string())).is_ok(),
            },
            ExternalRequest::Look { chart, answer } => {
                let views = self.hosts.iter_mut().map(|host| host.status(chart.as_ref()));
                answer.try_send(views.collect()).is_ok()
            }
        };
    }

    fn run_moment(&mut self, now: Timestamp) -> Result<(), Error> {
        if let Some(world) = self.world.as_mut().filter(|world| world.due() <= now) {
            world.advance(now)?;
        }
        for host in &mut self.hosts {
            host.sense(now)?;
        }
        while self.run_agents(now)? {}
        self.hosts.iter_mut().try_for_each(|host| host.act(now))
    }

    /// Gives each agent its turn; returns false if none had anything to do.
    fn run_agents(&mut self, now: Timestamp) -> Result<bool, Error> {
        let mut any = false;
        for host in &mut self.hosts {
            any |= host.run_agents(now)?;
        }
        Ok(any)
    }
}

/// The limits for calls of the agents that set one.
fn limits(prepared_hosts: &[PreparedHost]) -> BTreeMap<(String, String), Duration> {
    let agents =
        prepared_hosts.iter().flat_map(|prepared| prepared.agents.iter().map(move |agent| (prepared, agent)));
    let limited = agents.filter_map(|(prepared, agent)| {
        Some(((prepared.hub.host().to_owned(), agent.name.clone()), agent.stuck_after?))
    });
    limited.collect()
}

impl std::fmt::Debug for Simulation {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let hosts: Vec<&str> = self.hosts.iter().map(SimulatedHost::name).collect();
        f.debug_struct("Simulation").field("now", &self.now).field("hosts", &hosts).finish_non_exhaustive()
    }
}
