//! Puts a team on its hubs: what a run in simulated time and one in real time begin with.

use std::num::NonZeroUsize;
use std::sync::{Arc, Mutex, PoisonError};
use std::time::Duration;

use narukom::{Blackboard, Moment, Narukom, Observer, Publication};

use super::body::Body;
use super::links::Brought;
use super::replay::{Company, names_on};
use super::seeds::component_seed;
use super::teller::Teller;
use super::{HostConfig, Talws, World};
use crate::activity::BoxError;
use crate::agent::{Agent, Policy};
use crate::binder::{Binder, BoundChart};
use crate::chart::{Home, Runner};
use crate::error::{Error, ErrorKind};
use crate::frequency::Frequency;
use crate::link::{Elsewhere, LinkConfig};
use crate::list::List;
use crate::listener::Listeners;
use crate::reach::{Reach, out_of_reach};
use crate::records::{self, HOST};
use crate::registry::Registry;

/// Everything that runs, in the order in which it runs.
pub(super) struct Stage {
    pub(super) world: Option<Environment>,
    pub(super) stations: Vec<Station>,
}

/// A host.
pub(super) struct Station {
    pub(super) hub: Narukom,
    pub(super) body: Option<Body>,
    pub(super) members: Vec<Member>,
    pub(super) links: Vec<LinkConfig>,
}

/// An agent with its list and its charts, each with its blackboards.
pub(super) struct Member {
    pub(super) name: String,
    pub(super) policy: Policy,
    pub(super) frequency: Option<Frequency>,
    pub(super) statistics_every: Option<u64>,
    pub(super) workers: Option<NonZeroUsize>,
    pub(super) list: Option<List>,
    pub(super) charts: Vec<Runner>,
    pub(super) teller: Teller,
}

/// The world and when it moves on.
pub(super) struct Environment {
    world: Box<dyn World>,
    blackboard: Blackboard,
    ticks: u64,
}

/// What every agent is set up with.
struct Crew<'a> {
    binder: Binder<'a>,
    listeners: Listeners,
    observers: Observers,
    seed: u64,
    company: Vec<Company>,
}

/// The observers of all hubs, called one at a time.
#[derive(Clone)]
struct Observers(Arc<Mutex<Vec<Box<dyn Observer>>>>);

impl Observers {
    fn each(&self, act: impl FnMut(&mut Box<dyn Observer>)) {
        self.0.lock().unwrap_or_else(PoisonError::into_inner).iter_mut().for_each(act);
    }
}

impl Observer for Observers {
    fn observe(&mut self, publication: Publication<'_>) {
        self.each(|observer| observer.observe(publication));
    }

    fn observe_received(&mut self, publication: Publication<'_>) {
        self.each(|observer| observer.observe_received(publication));
    }
}

impl Stage {
    /// Sorts hosts by team, number and name, agents by name, and binds all charts.
    pub(super) fn new(talws: Talws, seed: u64) -> Result<Stage, Error> {
        let Talws { registry, hosts: mut configs, world, observers, listeners, company } = talws;
        configs.sort_by(|a, b| (a.team, a.number, &a.name).cmp(&(b.team, b.number, &b.name)));
        let names = configs.iter().map(|host| host.name.as_str());
        distinct("hosts", names.chain(world.iter().map(|world| world.name())))?;
        let registry = registry.unwrap_or_else(Registry::linked);
        let crew = Crew {
            binder: Binder::new(&registry)?,
            listeners: Listeners::new(listeners),
            observers: Observers(Arc::new(Mutex::new(observers))),
            seed,
            company,
        };
        let world = world.map(|world| crew.environment(world)).transpose()?;
        let stations = configs.into_iter().map(|config| crew.station(config));
        Ok(Stage { world, stations: collect_all(stations)? })
    }
}

impl Crew<'_> {
    fn environment(&self, mut world: Box<dyn World>) -> Result<Environment, Error> {
        let hub = self.hub(world.name())?;
        let mut blackboard = hub.blackboard(world.name());
        blackboard.set_random(component_seed(self.seed, world.name()));
        world.start(&mut blackboard).map_err(world_failed)?;
        blackboard.publish_all(Moment::ZERO);
        Ok(Environment { world, blackboard, ticks: 0 })
    }

    fn hub(&self, name: &str) -> Result<Narukom, Error> {
        let hub = Narukom::with_linked_topics(name).map_err(Error::hub)?;
        hub.observe(Box::new(self.observers.clone()));
        Ok(hub)
    }

    fn station(&self, config: HostConfig) -> Result<Station, Error> {
        let HostConfig { name, team, number, body, mut agents, links } = config;
        agents.sort_by(|a, b| a.name.cmp(&b.name));
        distinct("agents", agents.iter().map(|agent| agent.name.as_str()))
            .map_err(|error| error.with_hint(format!("both are on host `{name}`")))?;
        let hub = self.hub(&name)?;
        introduce(&hub, team, number)?;
        let body = body.map(|robot| Body::new(robot, &hub)).transpose()?;
        let mut publishers: Vec<String> = agents.iter().map(|agent| agent.name.clone()).collect();
        publishers.extend(body.iter().map(|_| Body::PUBLISHER.to_owned()));
        publishers.extend(names_on(&self.company, hub.host()));
        let brought = Brought::by(&links, &hub)?;
        let reach = Reach {
            hub: &hub,
            publishers: &publishers,
            from_others: &brought.others,
            from_own: &brought.own,
        };
        let members = agents.into_iter().map(|agent| self.member(agent, &reach));
        let members = collect_all(members)?;
        Ok(Station { hub, body, members, links })
    }

    fn member(&self, agent: Agent, reach: &Reach<'_>) -> Result<Member, Error> {
        let hub = reach.hub;
        let Agent {
            name,
            policy,
            frequency,
            activities,
            charts,
            mut generated,
            semantics,
            statistics_every,
            workers,
            elsewhere,
            ..
        } = agent;
        if frequency.is_none() && !activities.is_empty() {
            let message = format!("agent `{name}` has activities, but nothing says how often they run");
            return Err(Error::new(ErrorKind::NoFrequency, message).with_hint("say so with `every`"));
        }
        let charts = charts.iter().zip(0..).map(|(chart, number)| {
            let home = Home { hub, agent: &name, number, seed: self.seed, listeners: &self.listeners };
            let bound = match generated.remove(&(number as usize)) {
                Some(generated) => self.binder.bind_generated(generated, semantics),
                None => self.binder.bind(chart, semantics, None),
            };
            let mut bound = bound.map_err(Error::invalid)?;
            put_elsewhere(&mut bound, &elsewhere);
            match out_of_reach(&bound.chart, reach) {
                wrong if wrong.is_empty() => Runner::new(bound, home),
                wrong => Err(Error::invalid(wrong)),
            }
        });
        let charts = collect_all(charts)?;
        let list = (!activities.is_empty()).then(|| {
            let mut blackboard = hub.blackboard(&name);
            blackboard.set_random(component_seed(self.seed, &format!("{}/{name}", hub.host())));
            List::new(&name, policy, activities, blackboard)
        });
        let teller = Teller::new(hub, &name)?;
        Ok(Member { name, policy, frequency, statistics_every, workers, list, charts, teller })
    }
}

/// Takes the activities out of a chart that another process runs.
fn put_elsewhere(bound: &mut BoundChart, names: &[String]) {
    for (entry, activity) in bound.chart.activities().zip(&mut bound.activities) {
        if names.iter().any(|name| name == entry.name) {
            *activity = Box::new(Elsewhere::new(entry.name));
        }
    }
}

impl Environment {
    /// When it moves on next.
    pub(super) fn due(&self) -> Moment {
        tick(self.world.period(), self.ticks + 1)
    }

    pub(super) fn advance(&mut self, now: Moment) -> Result<(), Error> {
        self.ticks += 1;
        self.blackboard.process_messages(now);
        self.world.advance(now, &mut self.blackboard).map_err(world_failed)?;
        self.blackboard.publish_all(now);
        Ok(())
    }

    pub(super) fn hub(&self) -> &Narukom {
        self.blackboard.hub()
    }
}

/// When a tick of something periodic is due, counted from 0.
pub(super) fn tick(period: Duration, number: u64) -> Moment {
    // A period of nothing would never let time pass.
    let nanos = period.as_nanos().max(1).saturating_mul(u128::from(number));
    Moment::from_nanos(u64::try_from(nanos).unwrap_or(u64::MAX))
}

/// The first tick that is due at a moment or later.
pub(super) fn first_tick(period: Duration, moment: Moment) -> u64 {
    let nanos = u64::try_from(period.as_nanos().max(1)).unwrap_or(u64::MAX);
    moment.as_nanos().div_ceil(nanos)
}

/// Publishes who the host is and which topics it has.
fn introduce(hub: &Narukom, team: u32, number: u32) -> Result<(), Error> {
    let topics = hub.topics().iter().map(|topic| topic.path().to_owned()).collect();
    let record = records::Host { name: hub.host().into(), team, number, topics };
    hub.publisher(HOST, "monas").map_err(Error::hub)?.publish(record, Moment::ZERO);
    Ok(())
}

fn world_failed(error: BoxError) -> Error {
    Error::new(ErrorKind::World, format!("the world failed: {error}")).caused_by(error)
}

/// All values, or all diagnostics of those that are invalid, or the first other error.
fn collect_all<T>(results: impl Iterator<Item = Result<T, Error>>) -> Result<Vec<T>, Error> {
    let mut values = Vec::new();
    let mut diagnostics = Vec::new();
    for result in results {
        match result {
            Ok(value) => values.push(value),
            Err(error) if error.kind() == ErrorKind::Invalid => {
                diagnostics.extend_from_slice(error.diagnostics())
            }
            Err(error) => return Err(error),
        }
    }
    if diagnostics.is_empty() { Ok(values) } else { Err(Error::invalid(diagnostics)) }
}

/// Refuses two of one name.
fn distinct<'a>(kind: &str, names: impl Iterator<Item = &'a str>) -> Result<(), Error> {
    let mut names: Vec<&str> = names.collect();
    names.sort_unstable();
    match names.windows(2).find(|pair| pair[0] == pair[1]) {
        Some(pair) => {
            Err(Error::new(ErrorKind::DuplicateName, format!("two {kind} are named `{}`", pair[0])))
        }
        None => Ok(()),
    }
}
