//! Runs in simulated time: one thread, exact nanoseconds, a defined order.

mod host;

use std::collections::BTreeMap;
use std::sync::Arc;

use narukom::{Moment, Narukom};

use super::Talws;
use super::clock::Clock;
use super::instance::Instance;
use super::links::RunningLink;
use super::overview::{self, HandedIn, Inlet, Overview, ShownMoment};
use super::setup::{Environment, Stage};
use super::stopper::Stopper;
use crate::coverage::ChartCoverage;
use crate::error::{Error, ErrorKind};
use crate::logger::{Hosted, Hosting, Simulating};
use crate::records::{Change, Changed};
use crate::statistics::Statistics;

use host::Host;

/// A run in simulated time.
///
/// Time jumps from one moment at which something is due to the next. What is due at one moment happens in this order: the world moves
/// on; bodies sense; agents run; bodies act. Hosts come in the order of team and number (then name), agents of a host in the order
/// of their names; an agent that a message wakes runs in the same moment, when it is its turn again.
pub struct Simulation {
    now: Moment,
    /// The same, for other threads.
    shown: Arc<ShownMoment>,
    world: Option<Environment>,
    hosts: Vec<Host>,
    links: Vec<RunningLink>,
    inlet: Inlet,
    /// To whom the lines of the log belong that are written meanwhile.
    hosting: Hosting,
    /// Changes of agents at moments to come, by these and the order in which they were written.
    script: BTreeMap<(Moment, usize), (usize, Change)>,
}

impl Simulation {
    pub(super) fn new(talws: Talws, seed: u64) -> Result<Simulation, Error> {
        let Stage { world, stations, crew } = Stage::new(talws, seed)?;
        let shown = Arc::new(ShownMoment::default());
        let mut links = Vec::new();
        let hosts = stations.into_iter().map(|station| Host::new(station, &crew, &shown, &mut links));
        let hosts = hosts.collect::<Result<Vec<Host>, Error>>()?;
        let hubs = world.iter().map(Environment::hub).chain(hosts.iter().map(Host::hub));
        let hosting = Hosting::simulated(hubs);
        let (inlet, script) = (Inlet::new(), BTreeMap::new());
        Ok(Simulation { now: Moment::ZERO, shown, world, hosts, links, inlet, hosting, script })
    }

    /// Until what is given is dropped, this thread is in the simulation.
    fn enter(&self) -> (Simulating, Hosted) {
        (Simulating::begin(self.now), self.hosting.begin())
    }

    /// The moment up to which everything has happened.
    pub fn now(&self) -> Moment {
        self.now
    }

    /// Lets everything happen that is due before `end`. What is due at `end` itself belongs to the next call, so that an agent
    /// at 10 Hz runs ten times in the first second: at 0 ms, 100 ms and so on to 900 ms.
    ///
    /// # Errors
    /// The world or a body failed. Agents do not fail: see [`Policy`](crate::Policy).
    pub fn run_until(&mut self, end: Moment) -> Result<(), Error> {
        let _time = self.enter();
        loop {
            self.let_in();
            let next = self.due();
            if next >= end {
                self.pass(self.now.max(end));
                return Ok(());
            }
            self.pass(next);
            self.follow_script();
            self.happen(next)?;
        }
    }

    /// As [`run_until`](Simulation::run_until), but no faster than time really passes, from the first moment of this call on. A stopper
    /// ends it early.
    ///
    /// # Errors
    /// As in [`run_until`](Simulation::run_until).
    pub fn run_paced(&mut self, end: Moment, stopper: &Stopper) -> Result<(), Error> {
        let _time = self.enter();
        let (clock, begun) = (Clock::start(), self.now);
        while self.due() < end {
            self.let_in();
            let next = self.due();
            if !stopper.wait_until(Moment::ZERO + next.since(begun), &clock) {
                return Ok(());
            }
            self.pass(next);
            self.follow_script();
            self.happen(next)?;
        }
        self.run_until(end)
    }

    /// Makes a change of the agents of a host now, between two of their cycles; it is published like one that anybody asks for, and so is
    /// the answer.
    ///
    /// # Errors
    /// There is no such host. That a change is refused is said by the answer.
    pub fn change(&mut self, host: &str, change: Change) -> Result<Changed, Error> {
        let (place, now) = (self.place(host)?, self.now);
        let _time = self.enter();
        Ok(self.hosts[place].change(change, now))
    }

    /// Has a change made when its moment comes, before anything else happens then; the answer is published. The same script gives the
    /// same run.
    ///
    /// # Errors
    /// There is no such host.
    pub fn change_at(&mut self, moment: Moment, host: &str, change: Change) -> Result<(), Error> {
        let place = self.place(host)?;
        self.script.insert((moment.max(self.now), self.script.len()), (place, change));
        Ok(())
    }

    fn place(&self, host: &str) -> Result<usize, Error> {
        self.hosts.iter().position(|known| known.name() == host).ok_or_else(|| {
            let known = self.hosts.iter().map(Host::name);
            Error::new(ErrorKind::UnknownHost, format!("no host is named `{host}`")).with_nearest(host, known)
        })
    }

    fn follow_script(&mut self) {
        while let Some(entry) = self.script.first_entry().filter(|entry| entry.key().0 <= self.now) {
            let (host, change) = entry.remove();
            self.hosts[host].change(change, self.now);
        }
    }

    /// What agents have done so far.
    pub fn statistics(&self) -> Statistics {
        let agents = self.hosts.iter().flat_map(Host::statistics);
        let links = self.links.iter().map(RunningLink::statistics).collect();
        Statistics { agents: agents.collect(), links }
    }

    /// The run, for those who look on and publish from outside. What they publish is published between two moments of the run, as long
    /// as somebody lets it run.
    pub fn overview(&self) -> Overview {
        let world = self.world.iter().map(Environment::hub);
        let hubs = self.hosts.iter().map(Host::hub).chain(world).cloned();
        Overview::simulated(hubs.collect(), self.shown.clone(), &self.inlet)
    }

    /// The hub of a host or of the world, for those who look on.
    pub fn hub(&self, host: &str) -> Option<&Narukom> {
        let world = self.world.iter().map(Environment::hub);
        let hosts = self.hosts.iter().map(Host::hub);
        world.chain(hosts).find(|hub| hub.host() == host)
    }

    /// Stops all agents; their activities are told so.
    pub fn stop(&mut self) {
        let _time = self.enter();
        self.hosts.iter_mut().for_each(|host| host.stop(self.now));
    }

    /// Which states and transitions of each chart there was use of.
    pub fn coverage(&self) -> Vec<ChartCoverage> {
        self.hosts.iter().flat_map(|host| host.instances().iter().flat_map(Instance::coverage)).collect()
    }

    /// Raises an event in the charts of an agent, to be taken in the next step; false if there is no such agent, or none of its charts
    /// names the event.
    pub fn raise(&mut self, host: &str, agent: &str, event: &str) -> bool {
        let host = self.hosts.iter_mut().find(|known| known.name() == host);
        host.is_some_and(|host| host.raise(agent, event))
    }

    fn due(&self) -> Moment {
        let world = self.world.iter().map(Environment::due);
        let script = self.script.keys().next().map(|(moment, _)| *moment);
        let hosts = self.hosts.iter().map(|host| host.due(self.now));
        world.chain(script).chain(hosts).min().unwrap_or(Moment::MAX)
    }

    /// Time comes to a moment.
    fn pass(&mut self, now: Moment) {
        Simulating::pass(now);
        self.now = now;
        self.shown.set(now);
    }

    /// Takes what was handed in from outside since the last moment, makes the changes that were asked for, and tells agents of that and of
    /// what links have brought.
    fn let_in(&mut self) {
        let now = self.now;
        let mut any = !self.links.is_empty();
        while let Some(handed_in) = self.inlet.next() {
            any = true;
            self.take(handed_in);
        }
        for host in &mut self.hosts {
            host.attend(now);
            if any {
                host.wake(now);
            }
        }
    }

    fn take(&mut self, handed_in: HandedIn) {
        let now = self.now;
        // Whoever has given up is not told.
        let _ = match handed_in {
            HandedIn::Message { hub, path, bytes, answer } => {
                answer.try_send(overview::publish(&hub, &path, &bytes, now)).is_ok()
            }
            HandedIn::Change { host, change, answer } => match self.change(&host, *change) {
                Ok(changed) => answer.try_send(Ok(changed)).is_ok(),
                Err(error) => answer.try_send(Err(error.to_string())).is_ok(),
            },
            HandedIn::Look { chart, answer } => {
                let views = self.hosts.iter_mut().map(|host| host.view(chart.as_ref()));
                answer.try_send(views.collect()).is_ok()
            }
        };
    }

    fn happen(&mut self, now: Moment) -> Result<(), Error> {
        if let Some(world) = self.world.as_mut().filter(|world| world.due() <= now) {
            world.advance(now)?;
        }
        for host in &mut self.hosts {
            host.sense(now)?;
        }
        while self.run_agents(now)? {}
        self.hosts.iter_mut().try_for_each(|host| host.act(now))
    }

    /// Gives each agent its turn; false if none had anything to do.
    fn run_agents(&mut self, now: Moment) -> Result<bool, Error> {
        let mut any = false;
        for host in &mut self.hosts {
            any |= host.run_agents(now)?;
        }
        Ok(any)
    }
}

impl std::fmt::Debug for Simulation {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let hosts: Vec<&str> = self.hosts.iter().map(Host::name).collect();
        f.debug_struct("Simulation").field("now", &self.now).field("hosts", &hosts).finish_non_exhaustive()
    }
}
