//! Prepares the hosts of a run on their hubs, for simulated and real time.

use std::sync::Arc;
use std::time::Duration;

use monas_link::LinkSettings;
use narukom::{Blackboard, Hub, Timestamp};

use yase::Source;

use super::agent_factory::{AgentFactory, HostContext, PreparedAgent};
use super::body::BodyBridge;
use super::links::LinkedTopics;
use super::observers::SharedObservers;
use super::recorded_publisher::names_on;
use super::run_config::{HostConfig, RunConfig, World};
use monas_core::activity::BoxError;
use monas_core::agent::AgentProfile;
use monas_core::binder::Binder;
use monas_core::error::{Error, ErrorKind, collect_all};
use monas_core::listener::ListenerSet;
use monas_core::records::{self, CHANGE, HOST};
use monas_core::registry::Registry;
use monas_core::seeds::component_seed;
use monas_link::LinkConfig;
use monas_link::LinkTransport;

/// Everything that runs, in execution order.
pub(crate) struct PreparedRun {
    pub(crate) world: Option<WorldDriver>,
    pub(crate) hosts: Vec<PreparedHost>,
    pub(crate) factory: Arc<AgentFactory>,
}

/// A host with its agents, ready to run.
pub(crate) struct PreparedHost {
    pub(crate) hub: Hub,
    pub(crate) body: Option<BodyBridge>,
    pub(crate) agents: Vec<PreparedAgent>,
    pub(crate) links: Vec<LinkConfig>,
    pub(crate) context: HostContext,
    /// The profiles of its agents.
    pub(crate) profiles: Vec<AgentProfile>,
    /// The text of its configuration.
    pub(crate) configuration: Option<Arc<Source>>,
}

/// The world and the time of its next advance.
pub(crate) struct WorldDriver {
    world: Box<dyn World>,
    blackboard: Blackboard,
    ticks: u64,
}

impl PreparedRun {
    /// Sorts hosts by team, number and name, agents by name, and binds all charts.
    pub(crate) fn new(config: RunConfig, seed: u64) -> Result<PreparedRun, Error> {
        let RunConfig { registry, hosts: mut configs, world, observers, listeners, publishers } = config;
        configs.sort_by(|a, b| (a.team, a.number, &a.name).cmp(&(b.team, b.number, &b.name)));
        let names = configs.iter().map(|host| host.name.as_str());
        distinct("hosts", names.chain(world.iter().map(|world| world.name())))?;
        let factory = AgentFactory {
            registry: with_modules(registry.unwrap_or_else(Registry::linked), &configs)?,
            listeners: ListenerSet::new(listeners),
            observers: SharedObservers::new(observers),
            seed,
            publishers,
        };
        let world = world.map(|world| factory.environment(world)).transpose()?;
        let binder = Binder::new(&factory.registry)?;
        let prepared_hosts =
            collect_all(configs.into_iter().map(|config| factory.prepare_host(&binder, config)))?;
        Ok(PreparedRun { world, hosts: prepared_hosts, factory: Arc::new(factory) })
    }
}

/// The registry with the modules of all hosts.
fn with_modules(registry: Registry, hosts: &[HostConfig]) -> Result<Registry, Error> {
    let mut modules = hosts.iter().flat_map(|host| &host.modules);
    modules.try_fold(registry, |registry, module| match registry.module(module.name()) {
        Some(known) if known.digest() == module.digest() => Ok(registry),
        Some(known) => {
            let (one, other) = (known.file().display(), module.file().display());
            let message = format!("two modules have the name `{}`: {one} and {other}", module.name());
            Err(Error::new(ErrorKind::Module, message))
        }
        None => registry.with_module(module.clone()),
    })
}

impl AgentFactory {
    fn environment(&self, mut world: Box<dyn World>) -> Result<WorldDriver, Error> {
        let hub = self.hub(world.name())?;
        let mut blackboard = hub.blackboard(world.name());
        blackboard.set_random(component_seed(self.seed, world.name()));
        world.start(&mut blackboard).map_err(world_failed)?;
        blackboard.publish_all(Timestamp::ZERO);
        Ok(WorldDriver { world, blackboard, ticks: 0 })
    }

    fn hub(&self, name: &str) -> Result<Hub, Error> {
        let hub = Hub::with_linked_topics(name).map_err(Error::hub)?;
        hub.observe(Box::new(self.observers.clone()));
        Ok(hub)
    }

    fn prepare_host(&self, binder: &Binder<'_>, config: HostConfig) -> Result<PreparedHost, Error> {
        let HostConfig { name, team, number, body, mut agents, links, configuration, .. } = config;
        agents.sort_by(|a, b| a.name.cmp(&b.name));
        distinct("agents", agents.iter().map(|agent| agent.name.as_str()))
            .map_err(|error| error.with_hint(format!("both are on host `{name}`")))?;
        let hub = self.hub(&name)?;
        publish_host_record(&hub, team, number)?;
        let body = body.map(|robot| BodyBridge::new(robot, &hub)).transpose()?;
        let mut others: Vec<String> = names_on(&self.publishers, hub.host()).collect();
        others.extend(body.iter().map(|_| BodyBridge::PUBLISHER.to_owned()));
        let ground = HostContext { linked_topics: LinkedTopics::by(&links, &hub)?, others, hub: hub.clone() };
        reject_changes_over_links(&ground, &links)?;
        let names: Vec<String> = agents.iter().map(|agent| agent.name.clone()).collect();
        let profiles = agents.iter().map(AgentProfile::of).collect();
        let members = agents
            .into_iter()
            .map(|agent| self.prepare_agent(binder, agent, &ground, &names, Timestamp::ZERO));
        let members = collect_all(members)?;
        Ok(PreparedHost { hub, body, agents: members, links, context: ground, profiles, configuration })
    }
}

/// Refuses links that would let unauthenticated peers change agents. A publisher of changes on a
/// host controls its agents, and messages that a link delivers as the host's own may be changes, so
/// the link must name the permitted peers and grant them that permission. Over a network, names are
/// trusted only if certificates prove them.
fn reject_changes_over_links(ground: &HostContext, links: &[LinkConfig]) -> Result<(), Error> {
    for link in links {
        let brought = LinkedTopics::by(std::slice::from_ref(link), &ground.hub)?;
        if !brought.own.iter().any(|slot| Some(*slot) == ground.hub.topic(CHANGE.path())) {
            continue;
        }
        let LinkSettings { access, name, .. } = &link.settings;
        // The robots of a team share one list. A link ignores its own name in it.
        let own = if name.is_empty() { ground.hub.host() } else { name };
        let mut hosts = access.publishers().map(|(host, _)| host).filter(|host| *host != own);
        let stranger = hosts.find(|host| access.may_publish(host, CHANGE.path()) && !access.may_manage(host));
        let host = ground.hub.host();
        let (message, hint) = match (access.is_open(), stranger) {
            (true, _) => (
                format!("a link of `{host}` lets any peer change its agents"),
                "give the link an `access` list, or do not receive `monas/change` as its own".into(),
            ),
            (false, Some(stranger)) => (
                format!(
                    "a link of `{host}` lets `{stranger}` publish changes of its agents without the right to manage them"
                ),
                format!(
                    "add `{stranger} manage` to the access list, or name the topics that `{stranger}` may publish"
                ),
            ),
            (false, None) if is_believed(&link.transport) => continue,
            (false, None) => (
                format!("a link of `{host}` lets any peer change its agents under the name of a manager"),
                "give the link `certificates` and `tls/` endpoints".into(),
            ),
        };
        return Err(Error::new(ErrorKind::Link, message).with_hint(hint));
    }
    Ok(())
}

/// Whether the transport authenticates the names of peers: a directory of sockets is accessible
/// only to its owner.
fn is_believed(transport: &LinkTransport) -> bool {
    match transport {
        LinkTransport::Local { .. } => true,
        LinkTransport::Zenoh(endpoints) => endpoints.certificates.is_some(),
    }
}

impl WorldDriver {
    /// The time of its next advance.
    pub(crate) fn due(&self) -> Timestamp {
        tick(self.world.period(), self.ticks + 1)
    }

    pub(crate) fn advance(&mut self, now: Timestamp) -> Result<(), Error> {
        self.ticks += 1;
        self.blackboard.process_messages(now);
        self.world.advance(now, &mut self.blackboard).map_err(world_failed)?;
        self.blackboard.publish_all(now);
        Ok(())
    }

    pub(crate) fn hub(&self) -> &Hub {
        self.blackboard.hub()
    }
}

/// The due time of a tick of something periodic, counted from 0.
pub(crate) fn tick(period: Duration, number: u64) -> Timestamp {
    // A period of zero would stop the time.
    let nanos = period.as_nanos().max(1).saturating_mul(u128::from(number));
    Timestamp::from_nanos(u64::try_from(nanos).unwrap_or(u64::MAX))
}

/// The first tick that is due at `moment` or later.
pub(crate) fn first_tick(period: Duration, moment: Timestamp) -> u64 {
    let nanos = u64::try_from(period.as_nanos().max(1)).unwrap_or(u64::MAX);
    moment.as_nanos().div_ceil(nanos)
}

/// Publishes the record of the host.
fn publish_host_record(hub: &Hub, team: u32, number: u32) -> Result<(), Error> {
    let record = records::Host { name: hub.host().into(), team, number };
    hub.publisher(HOST, "monas").map_err(Error::hub)?.publish(record, Timestamp::ZERO);
    Ok(())
}

fn world_failed(error: BoxError) -> Error {
    Error::new(ErrorKind::World, format!("the world failed: {error}")).caused_by(error)
}

/// Refuses duplicate names.
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
