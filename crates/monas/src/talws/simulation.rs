//! Runs in simulated time: one thread, exact nanoseconds, a defined order.

use std::sync::Arc;

use narukom::{Moment, Narukom};

use super::body::Body;
use super::clock::Clock;
use super::instance::Instance;
use super::links::RunningLink;
use super::moved::Moved;
use super::overview::{Inlet, Overview, ShownMoment};
use super::setup::{Environment, Stage, Station, tick};
use super::stopper::Stopper;
use super::{ENDED, Talws};
use crate::coverage::ChartCoverage;
use crate::error::{Error, ErrorKind};
use crate::list::Outcome;
use crate::statistics::Statistics;

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
}

/// A host with all that runs on it.
struct Host {
    hub: Narukom,
    moved: Moved,
    body: Option<(Body, u64)>,
    instances: Vec<Instance>,
}

impl Simulation {
    pub(super) fn new(talws: Talws, seed: u64) -> Result<Simulation, Error> {
        let Stage { world, stations } = Stage::new(talws, seed)?;
        let shown = Arc::new(ShownMoment::default());
        let mut links = Vec::new();
        let hosts = stations.into_iter().map(|station| Host::new(station, &shown, &mut links));
        let hosts = hosts.collect::<Result<_, Error>>()?;
        Ok(Simulation { now: Moment::ZERO, shown, world, hosts, links, inlet: Inlet::new() })
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
        loop {
            self.let_in();
            let next = self.due();
            if next >= end {
                self.pass(self.now.max(end));
                return Ok(());
            }
            self.pass(next);
            self.happen(next)?;
        }
    }

    /// As [`run_until`](Simulation::run_until), but no faster than time really passes, from the first moment of this call on. A stopper
    /// ends it early.
    ///
    /// # Errors
    /// As in [`run_until`](Simulation::run_until).
    pub fn run_paced(&mut self, end: Moment, stopper: &Stopper) -> Result<(), Error> {
        let (clock, begun) = (Clock::start(), self.now);
        while self.due() < end {
            self.let_in();
            let next = self.due();
            if !stopper.wait_until(Moment::ZERO + next.since(begun), &clock) {
                return Ok(());
            }
            self.pass(next);
            self.happen(next)?;
        }
        self.run_until(end)
    }

    /// What agents have done so far.
    pub fn statistics(&self) -> Statistics {
        let agents =
            self.hosts.iter().flat_map(|host| host.instances.iter().map(|i| i.statistics(host.hub.host())));
        let links = self.links.iter().map(RunningLink::statistics).collect();
        Statistics { agents: agents.collect(), links }
    }

    /// The run, for those who look on and publish from outside. What they publish is published between two moments of the run, as long
    /// as somebody lets it run.
    pub fn overview(&self) -> Overview {
        let world = self.world.iter().map(Environment::hub);
        let hubs = self.hosts.iter().map(|host| &host.hub).chain(world).cloned();
        Overview::simulated(hubs.collect(), self.shown.clone(), &self.inlet)
    }

    /// The hub of a host or of the world, for those who look on.
    pub fn hub(&self, host: &str) -> Option<&Narukom> {
        let world = self.world.iter().map(Environment::hub);
        let hosts = self.hosts.iter().map(|host| &host.hub);
        world.chain(hosts).find(|hub| hub.host() == host)
    }

    /// Stops all agents; their activities are told so.
    pub fn stop(&mut self) {
        let instances = self.hosts.iter_mut().flat_map(|host| &mut host.instances);
        instances.for_each(|instance| instance.stop(ENDED, self.now));
    }

    /// Which states and transitions of each chart there was use of.
    pub fn coverage(&self) -> Vec<ChartCoverage> {
        self.hosts.iter().flat_map(|host| host.instances.iter().flat_map(Instance::coverage)).collect()
    }

    /// Raises an event in the charts of an agent, to be taken in the next step; false if there is no such agent, or none of its charts
    /// names the event.
    pub fn raise(&mut self, host: &str, agent: &str, event: &str) -> bool {
        let host = self.hosts.iter_mut().find(|known| known.hub.host() == host);
        let agent = host.and_then(|host| host.instances.iter_mut().find(|known| known.name() == agent));
        agent.is_some_and(|agent| agent.raise(event))
    }

    fn due(&self) -> Moment {
        let world = self.world.iter().map(Environment::due);
        world.chain(self.hosts.iter().map(|host| host.due(self.now))).min().unwrap_or(Moment::MAX)
    }

    /// Time comes to a moment.
    fn pass(&mut self, now: Moment) {
        self.now = now;
        self.shown.set(now);
    }

    /// Publishes what was handed in from outside since the last moment, and tells agents of it and of what links have brought.
    fn let_in(&mut self) {
        let now = self.now;
        if self.inlet.publish_waiting(now) || !self.links.is_empty() {
            self.hosts.iter_mut().for_each(|host| host.wake(now));
        }
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
        let hosts: Vec<&str> = self.hosts.iter().map(|host| host.hub.host()).collect();
        f.debug_struct("Simulation").field("now", &self.now).field("hosts", &hosts).finish_non_exhaustive()
    }
}

impl Host {
    fn new(
        station: Station,
        shown: &Arc<ShownMoment>,
        running: &mut Vec<RunningLink>,
    ) -> Result<Host, Error> {
        let Station { hub, body, members, links } = station;
        let moved = Moved::default();
        let mut linked = Vec::new();
        for link in links {
            if let Some(other) = &link.clock {
                let message =
                    format!("the time of `{}` is simulated, and cannot be that of `{other}`", hub.host());
                return Err(Error::new(ErrorKind::Link, message));
            }
            let shown = shown.clone();
            let link = RunningLink::start(&hub, link, move || shown.get())?;
            linked.push(link.waker());
            running.push(link);
        }
        let note = moved.noting();
        hub.set_waker(Arc::new(move |topic, host| {
            note(topic, host);
            linked.iter().for_each(|wake| wake(topic, host));
        }));
        let instances = members.into_iter().map(Instance::new).collect();
        Ok(Host { hub, moved, body: body.map(|body| (body, 0)), instances })
    }

    fn due(&self, now: Moment) -> Moment {
        let body = self.body.iter().map(|(body, ticks)| tick(body.period(), *ticks));
        body.chain(self.instances.iter().map(|instance| instance.due(now))).min().unwrap_or(Moment::MAX)
    }

    fn sense(&mut self, now: Moment) -> Result<(), Error> {
        if let Some((body, ticks)) = &mut self.body
            && tick(body.period(), *ticks) <= now
        {
            *ticks += 1;
            body.sense(now)?;
            self.wake(now);
        }
        Ok(())
    }

    /// Gives each agent its turn; false if none had anything to do.
    fn run_agents(&mut self, now: Moment) -> Result<bool, Error> {
        let mut any = false;
        for index in 0..self.instances.len() {
            if self.instances[index].due(now) > now {
                continue;
            }
            any = true;
            if self.instances[index].run(now) == Outcome::SafeState
                && let Some((body, _)) = &mut self.body
            {
                body.rest(now)?;
            }
            self.wake(now);
        }
        Ok(any)
    }

    /// Tells every agent which topics have moved.
    fn wake(&mut self, now: Moment) {
        self.moved.tell(self.instances.iter_mut(), now);
    }

    /// Hands the newest commands to the body, which may move no topic.
    fn act(&mut self, now: Moment) -> Result<(), Error> {
        self.body.as_mut().map_or(Ok(()), |(body, _)| body.act(now))
    }
}
