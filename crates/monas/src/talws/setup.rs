//! Puts a team on its hubs: what a run in simulated time and one in real time begin with.

use std::sync::{Arc, Mutex, PoisonError};
use std::time::Duration;

use monas_link::LinkSettings;
use narukom::{Blackboard, Moment, Narukom, Observer, Publication};

use yase::Source;

use super::body::Body;
use super::crew::{Crew, Ground, Member};
use super::links::Brought;
use super::replay::names_on;
use super::seeds::component_seed;
use super::{HostConfig, Talws, World};
use crate::activity::BoxError;
use crate::agent::Profile;
use crate::binder::Binder;
use crate::error::{Error, ErrorKind};
use crate::link::{LinkConfig, LinkTransport};
use crate::listener::Listeners;
use crate::records::{self, CHANGE, HOST};
use crate::registry::Registry;

/// Everything that runs, in the order in which it runs.
pub(super) struct Stage {
    pub(super) world: Option<Environment>,
    pub(super) stations: Vec<Station>,
    pub(super) crew: Arc<Crew>,
}

/// A host.
pub(super) struct Station {
    pub(super) hub: Narukom,
    pub(super) body: Option<Body>,
    pub(super) members: Vec<Member>,
    pub(super) links: Vec<LinkConfig>,
    pub(super) ground: Ground,
    /// What its agents are made of.
    pub(super) profiles: Vec<Profile>,
    /// The text they were read from.
    pub(super) configuration: Option<Arc<Source>>,
}

/// The world and when it moves on.
pub(super) struct Environment {
    world: Box<dyn World>,
    blackboard: Blackboard,
    ticks: u64,
}

/// The observers of all hubs, called one at a time.
#[derive(Clone)]
pub(super) struct Observers(Arc<Mutex<Vec<Box<dyn Observer>>>>);

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
        let crew = Crew {
            registry: equipped(registry.unwrap_or_else(Registry::linked), &configs)?,
            listeners: Listeners::new(listeners),
            observers: Observers(Arc::new(Mutex::new(observers))),
            seed,
            company,
        };
        let world = world.map(|world| crew.environment(world)).transpose()?;
        let binder = Binder::new(&crew.registry)?;
        let stations = collect_all(configs.into_iter().map(|config| crew.station(&binder, config)))?;
        Ok(Stage { world, stations, crew: Arc::new(crew) })
    }
}

/// The registry with the modules of all hosts.
fn equipped(registry: Registry, hosts: &[HostConfig]) -> Result<Registry, Error> {
    let mut modules = hosts.iter().flat_map(|host| &host.modules);
    modules.try_fold(registry, |registry, module| match registry.module(module.name()) {
        Some(known) if known.digest() == module.digest() => Ok(registry),
        Some(known) => {
            let (one, other) = (known.file().display(), module.file().display());
            let message = format!("two modules are called `{}`: {one} and {other}", module.name());
            Err(Error::new(ErrorKind::Module, message))
        }
        None => registry.with_module(module.clone()),
    })
}

impl Crew {
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

    fn station(&self, binder: &Binder<'_>, config: HostConfig) -> Result<Station, Error> {
        let HostConfig { name, team, number, body, mut agents, links, configuration, .. } = config;
        agents.sort_by(|a, b| a.name.cmp(&b.name));
        distinct("agents", agents.iter().map(|agent| agent.name.as_str()))
            .map_err(|error| error.with_hint(format!("both are on host `{name}`")))?;
        let hub = self.hub(&name)?;
        introduce(&hub, team, number)?;
        let body = body.map(|robot| Body::new(robot, &hub)).transpose()?;
        let mut others: Vec<String> = names_on(&self.company, hub.host()).collect();
        others.extend(body.iter().map(|_| Body::PUBLISHER.to_owned()));
        let ground = Ground { brought: Brought::by(&links, &hub)?, others, hub: hub.clone() };
        refuse_changes_from_strangers(&ground, &links)?;
        let names: Vec<String> = agents.iter().map(|agent| agent.name.clone()).collect();
        let profiles = agents.iter().map(Profile::of).collect();
        let members =
            agents.into_iter().map(|agent| self.member(binder, agent, &ground, &names, Moment::ZERO));
        let members = collect_all(members)?;
        Ok(Station { hub, body, members, links, ground, profiles, configuration })
    }
}

/// Whoever may publish changes on a host may do anything to its agents. What comes over a link as the host's own may be such a change, so
/// the link has to name those who may, and say that they may manage. Over a network names count only where certificates show them.
fn refuse_changes_from_strangers(ground: &Ground, links: &[LinkConfig]) -> Result<(), Error> {
    for link in links {
        let brought = Brought::by(std::slice::from_ref(link), &ground.hub)?;
        if !brought.own.iter().any(|slot| Some(*slot) == ground.hub.topic(CHANGE.path())) {
            continue;
        }
        let LinkSettings { access, name, .. } = &link.settings;
        // The robots of a team share one list. A link takes nothing that comes under its own name.
        let own = if name.is_empty() { ground.hub.host() } else { name };
        let mut hosts = access.publishers().map(|(host, _)| host).filter(|host| *host != own);
        let stranger = hosts.find(|host| access.may_publish(host, CHANGE.path()) && !access.may_manage(host));
        let host = ground.hub.host();
        let (message, hint) = match (access.is_open(), stranger) {
            (true, _) => (
                format!("a link of `{host}` lets anybody change its agents"),
                "give the link an `access` list that says who may, or do not receive `monas/change` as its own".into(),
            ),
            (false, Some(stranger)) => (
                format!("a link of `{host}` lets `{stranger}` publish changes of its agents, who may not manage them"),
                format!("add `{stranger} manage` to the access list, or name the topics that `{stranger}` may publish"),
            ),
            (false, None) if is_believed(&link.transport) => continue,
            (false, None) => (
                format!("a link of `{host}` lets anybody change its agents who takes the name of one who may manage them"),
                "give the link `certificates`, and endpoints that begin with `tls/`".into(),
            ),
        };
        return Err(Error::new(ErrorKind::Link, message).with_hint(hint));
    }
    Ok(())
}

/// Whether a name that comes over it is that of whoever says it: a folder of sockets is open to its owner alone.
fn is_believed(transport: &LinkTransport) -> bool {
    match transport {
        LinkTransport::Local { .. } => true,
        LinkTransport::Zenoh(endpoints) => endpoints.certificates.is_some(),
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
pub(super) fn collect_all<T>(results: impl Iterator<Item = Result<T, Error>>) -> Result<Vec<T>, Error> {
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
