//! Runs in simulated time: one thread, exact nanoseconds, a defined order.

use std::sync::{Arc, Mutex, PoisonError};
use std::time::Duration;

use narukom::{Blackboard, Moment, Narukom, Observer, Publication, TopicSlot};

use super::body::Body;
use super::instance::Instance;
use super::{HostConfig, Talws, World};
use crate::agent::Agent;
use crate::binder::Binder;
use crate::coverage::ChartCoverage;
use crate::error::{Error, ErrorKind};
use crate::list::Outcome;
use crate::listener::Listeners;
use crate::records::{self, HOST};
use crate::registry::Registry;
use crate::statistics::Statistics;

/// A run in simulated time.
///
/// Time jumps from one moment at which something is due to the next. What is due at one moment happens in this order: the world moves
/// on; bodies sense; agents run; bodies act. Hosts come in the order of team and number (then name), agents of a host in the order
/// of their names; an agent that a message wakes runs in the same moment, when it is its turn again.
pub struct Simulation {
    now: Moment,
    world: Option<Environment>,
    hosts: Vec<Host>,
}

/// The world and when it moves on.
struct Environment {
    world: Box<dyn World>,
    blackboard: Blackboard,
    ticks: u64,
}

/// A host with all that runs on it.
struct Host {
    hub: Narukom,
    moved: Arc<Moved>,
    /// Where the topics that moved are looked through; kept for its memory.
    looked_through: Vec<TopicSlot>,
    body: Option<(Body, u64)>,
    instances: Vec<Instance>,
}

/// What every agent is set up with.
struct Crew<'a> {
    binder: Binder<'a>,
    listeners: Listeners,
    seed: u64,
}

/// The topics on which something was published since somebody looked.
#[derive(Default)]
struct Moved {
    topics: Mutex<Vec<TopicSlot>>,
}

/// The observers of all hubs, called one at a time.
type Observers = Arc<Mutex<Vec<Box<dyn Observer>>>>;

impl Simulation {
    pub(super) fn new(talws: Talws, seed: u64) -> Result<Simulation, Error> {
        let observers = Arc::new(Mutex::new(talws.observers));
        let mut configs = talws.hosts;
        configs.sort_by(|a, b| (a.team, a.number, &a.name).cmp(&(b.team, b.number, &b.name)));
        distinct(
            "host",
            configs.iter().map(|host| host.name.as_str()).chain(talws.world.iter().map(|w| w.name())),
        )?;
        let registry = talws.registry.unwrap_or_else(Registry::linked);
        let crew = Crew { binder: Binder::new(&registry)?, listeners: Listeners::new(talws.listeners), seed };
        let world = talws.world.map(|world| Environment::new(world, &observers)).transpose()?;
        let hosts = configs.into_iter().map(|config| Host::new(config, &observers, &crew));
        Ok(Simulation { now: Moment::ZERO, world, hosts: hosts.collect::<Result<_, _>>()? })
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
            let next = self.due();
            if next >= end {
                self.now = self.now.max(end);
                return Ok(());
            }
            self.now = next;
            self.happen(next)?;
        }
    }

    /// What agents have done so far.
    pub fn statistics(&self) -> Statistics {
        let agents =
            self.hosts.iter().flat_map(|host| host.instances.iter().map(|i| i.statistics(host.hub.host())));
        Statistics { agents: agents.collect() }
    }

    /// The hub of a host or of the world, for those who look on.
    pub fn hub(&self, host: &str) -> Option<&Narukom> {
        let world = self.world.iter().map(|environment| environment.blackboard.hub());
        let hosts = self.hosts.iter().map(|host| &host.hub);
        world.chain(hosts).find(|hub| hub.host() == host)
    }

    /// Stops all agents; their activities are told so.
    pub fn stop(&mut self) {
        let instances = self.hosts.iter_mut().flat_map(|host| &mut host.instances);
        instances.for_each(|instance| instance.stop("the run has ended", self.now));
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

impl Environment {
    fn new(mut world: Box<dyn World>, observers: &Observers) -> Result<Environment, Error> {
        let hub = hub(world.name(), observers)?;
        let mut blackboard = hub.blackboard(world.name());
        world.start(&mut blackboard).map_err(world_failed)?;
        blackboard.publish_all(Moment::ZERO);
        Ok(Environment { world, blackboard, ticks: 0 })
    }

    fn due(&self) -> Moment {
        tick(self.world.period(), self.ticks + 1)
    }

    fn advance(&mut self, now: Moment) -> Result<(), Error> {
        self.ticks += 1;
        self.blackboard.process_messages(now);
        self.world.advance(now, &mut self.blackboard).map_err(world_failed)?;
        self.blackboard.publish_all(now);
        Ok(())
    }
}

impl Host {
    fn new(config: HostConfig, observers: &Observers, crew: &Crew<'_>) -> Result<Host, Error> {
        let hub = hub(&config.name, observers)?;
        let mut agents = config.agents;
        agents.sort_by(|a, b| a.name.cmp(&b.name));
        distinct("agent", agents.iter().map(|agent| agent.name.as_str()))
            .map_err(|error| error.with_hint(format!("both are on host `{}`", config.name)))?;
        introduce(&hub, config.team, config.number)?;
        let body = config.body.map(|robot| Body::new(robot, &hub)).transpose()?;
        let instances = set_up(agents, &hub, crew)?;
        let moved = Arc::new(Moved::default());
        let waker = moved.clone();
        hub.set_waker(Arc::new(move |topic| waker.note(topic)));
        Ok(Host { moved, looked_through: Vec::new(), body: body.map(|body| (body, 0)), instances, hub })
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
        self.moved.take(&mut self.looked_through);
        for topic in self.looked_through.drain(..) {
            self.instances.iter_mut().for_each(|instance| instance.message_arrived(topic, now));
        }
    }

    /// Hands the newest commands to the body, which may move no topic.
    fn act(&mut self, now: Moment) -> Result<(), Error> {
        self.body.as_mut().map_or(Ok(()), |(body, _)| body.act(now))
    }
}

impl Moved {
    fn note(&self, topic: TopicSlot) {
        self.topics.lock().unwrap_or_else(PoisonError::into_inner).push(topic);
    }

    /// Swaps what was noted for an empty list.
    fn take(&self, into: &mut Vec<TopicSlot>) {
        into.clear();
        std::mem::swap(&mut *self.topics.lock().unwrap_or_else(PoisonError::into_inner), into);
    }
}

/// When a tick of something periodic is due, counted from 0.
fn tick(period: Duration, number: u64) -> Moment {
    // A period of nothing would never let time pass.
    let nanos = period.as_nanos().max(1).saturating_mul(u128::from(number));
    Moment::from_nanos(u64::try_from(nanos).unwrap_or(u64::MAX))
}

fn hub(name: &str, observers: &Observers) -> Result<Narukom, Error> {
    let hub = Narukom::with_linked_topics(name).map_err(Error::hub)?;
    let observers = observers.clone();
    hub.observe(Box::new(move |publication: Publication<'_>| {
        let mut observers = observers.lock().unwrap_or_else(PoisonError::into_inner);
        observers.iter_mut().for_each(|observer| observer.observe(publication));
    }));
    Ok(hub)
}

/// Puts agents on a hub. What is wrong with the charts of one does not keep those of the others from being looked at.
fn set_up(agents: Vec<Agent>, hub: &Narukom, crew: &Crew<'_>) -> Result<Vec<Instance>, Error> {
    let mut diagnostics = Vec::new();
    let mut instances = Vec::new();
    for agent in agents {
        match Instance::new(agent, hub, crew.seed, &crew.binder, &crew.listeners) {
            Ok(instance) => instances.push(instance),
            Err(error) if error.kind() == ErrorKind::Invalid => {
                diagnostics.extend_from_slice(error.diagnostics())
            }
            Err(error) => return Err(error),
        }
    }
    if diagnostics.is_empty() { Ok(instances) } else { Err(Error::invalid(diagnostics)) }
}

/// Publishes who the host is and which topics it has.
fn introduce(hub: &Narukom, team: u32, number: u32) -> Result<(), Error> {
    let topics = hub.topics().iter().map(|topic| topic.path().to_owned()).collect();
    let record = records::Host { name: hub.host().into(), team, number, topics };
    hub.publisher(HOST, "monas").map_err(Error::hub)?.publish(record, Moment::ZERO);
    Ok(())
}

fn world_failed(error: crate::activity::BoxError) -> Error {
    Error::new(ErrorKind::World, format!("the world failed: {error}")).caused_by(error)
}

/// Refuses two of one name.
fn distinct<'a>(kind: &str, names: impl Iterator<Item = &'a str>) -> Result<(), Error> {
    let mut names: Vec<&str> = names.collect();
    names.sort_unstable();
    match names.windows(2).find(|pair| pair[0] == pair[1]) {
        Some(pair) => {
            Err(Error::new(ErrorKind::DuplicateName, format!("two {kind}s are named `{}`", pair[0])))
        }
        None => Ok(()),
    }
}
