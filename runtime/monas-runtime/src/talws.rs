//! Talws: the hosts of a run, their agents and bodies, and the world.

use std::path::Path;
use std::sync::Arc;
use std::time::Duration;

use monas_core::activity::BoxError;
use monas_core::agent::Agent;
use monas_core::error::{Error, ErrorKind};
use monas_core::listener::ChartListener;
use monas_core::module::Module;
use monas_core::registry::Registry;
use monas_core::statistics::Statistics;
use monas_link::LinkConfig;
use monas_robot::Robot;
use narukom::{Blackboard, Observer, Timestamp};
use yase::{Diagnostic, Source, Span};

use crate::real_time::RealTimeRun;
use crate::replay::RecordedPublisher;
use crate::setup;
use crate::simulation::Simulation;

/// The seed of a run in real time. Such a run is not deterministic, so any seed will do.
pub(crate) const REAL_TIME_SEED: u64 = 0;

/// A host: a robot or a computer, with its hub, its agents, and its body if it has one.
#[derive(Default)]
pub struct HostConfig {
    /// Its name, unique among all hosts.
    pub name: String,
    /// Its team's number.
    pub team: u32,
    /// Its number in the team.
    pub number: u32,
    /// Its body.
    pub body: Option<Box<dyn Robot>>,
    /// Its agents.
    pub agents: Vec<Agent>,
    /// Its links to other processes and hosts.
    pub links: Vec<LinkConfig>,
    /// The modules with activities of its agents. They are available to all agents of the run.
    pub modules: Vec<Module>,
    /// The text of its configuration, into which changes are saved.
    pub configuration: Option<Arc<Source>>,
}

impl std::fmt::Debug for HostConfig {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("HostConfig")
            .field("name", &self.name)
            .field("team", &self.team)
            .field("number", &self.number)
            .field("body", &self.body.as_ref().map(|body| &body.anatomy().model))
            .field("agents", &self.agents)
            .field("links", &self.links)
            .field("modules", &self.modules)
            .finish()
    }
}

/// The world of simulated bodies. It has its own hub, with the world's name, on which it may
/// publish ground truth.
pub trait World: Send {
    /// The name of its hub.
    fn name(&self) -> &str {
        "world"
    }

    /// The period of its advances.
    fn period(&self) -> Duration;

    /// Publishes the initial ground truth.
    fn start(&mut self, blackboard: &mut Blackboard) -> Result<(), BoxError> {
        let _ = blackboard;
        Ok(())
    }

    /// Advances by one period, to `now`.
    fn advance(&mut self, now: Timestamp, blackboard: &mut Blackboard) -> Result<(), BoxError>;
}

/// The hosts of a run with their agents and bodies, and the world around them.
///
/// Talws is the only part of Monas that determines the time: [`simulate`](Talws::simulate) advances
/// it as fast as the run can be computed, on one thread and in a defined order;
/// [`start`](Talws::start) uses real time.
///
/// ```
/// use monas::{Agent, Blackboard, Hz, Talws, Timestamp};
///
/// fn hello(blackboard: &mut Blackboard) {
///     println!("hello at {}", blackboard.now());
/// }
/// let talws = Talws::new().agent(Agent::new("greeter", Hz(10)).activity(hello));
/// let mut simulation = talws.simulate(7)?;
/// simulation.run_until(Timestamp::from_secs_f64(1.0))?;
/// assert_eq!(simulation.statistics().calls("local", "hello"), 10);
/// # Ok::<(), monas::Error>(())
/// ```
#[derive(Default)]
pub struct Talws {
    pub(crate) registry: Option<Registry>,
    pub(crate) hosts: Vec<HostConfig>,
    pub(crate) world: Option<Box<dyn World>>,
    pub(crate) observers: Vec<Box<dyn Observer>>,
    pub(crate) listeners: Vec<Box<dyn ChartListener>>,
    /// Recorded publishers of the hosts, beside their agents and bodies.
    pub(crate) publishers: Vec<RecordedPublisher>,
}

impl Talws {
    /// The host of agents that are added without a host.
    pub const LOCAL: &'static str = "local";

    /// No hosts, and the registry of everything linked into the program.
    pub fn new() -> Talws {
        Talws::default()
    }

    /// The agents and links of a configuration file, on the host [`LOCAL`](Talws::LOCAL).
    /// Activities come from the given registry.
    ///
    /// # Errors
    /// [`ErrorKind::Invalid`](monas_core::ErrorKind::Invalid) with every diagnostic of the file and of
    /// the models that it names.
    pub fn from_config(path: impl AsRef<Path>, registry: Registry) -> Result<Talws, Error> {
        let (setup, diagnostics) = monas_config::load(path, &registry);
        if diagnostics.iter().any(|diagnostic| diagnostic.is_error()) {
            return Err(Error::invalid(diagnostics));
        }
        diagnostics.iter().for_each(|diagnostic| tracing::warn!("{diagnostic}"));
        Ok(Talws::new().registry(registry).setup(setup))
    }

    /// Adds the agents, links and modules of a configuration to the host [`LOCAL`](Talws::LOCAL).
    /// Changes at runtime can be saved into its text.
    pub fn setup(mut self, setup: monas_config::HostSetup) -> Talws {
        let monas_config::HostSetup { agents, links, modules, source } = setup;
        let local = self.local();
        local.modules.extend(modules);
        local.agents.extend(agents);
        local.links.extend(links);
        local.configuration = source.or(local.configuration.take());
        self
    }

    /// Takes activities and functions from this registry instead of the linked ones.
    pub fn registry(mut self, registry: Registry) -> Talws {
        self.registry = Some(registry);
        self
    }

    /// Adds an agent to the host [`LOCAL`](Talws::LOCAL).
    pub fn agent(mut self, agent: Agent) -> Talws {
        self.local().agents.push(agent);
        self
    }

    /// Adds a link to the host [`LOCAL`](Talws::LOCAL).
    pub fn link(mut self, link: LinkConfig) -> Talws {
        self.local().links.push(link);
        self
    }

    fn local(&mut self) -> &mut HostConfig {
        let known = self.hosts.iter().position(|host| host.name == Talws::LOCAL);
        let place = known.unwrap_or_else(|| {
            self.hosts.push(HostConfig { name: Talws::LOCAL.into(), ..HostConfig::default() });
            self.hosts.len() - 1
        });
        &mut self.hosts[place]
    }

    /// Adds a host.
    pub fn host(&mut self, host: HostConfig) -> &mut Talws {
        self.hosts.push(host);
        self
    }

    /// Sets the world around the bodies and replaces a previous one.
    pub fn world(&mut self, world: Box<dyn World>) -> &mut Talws {
        self.world = Some(world);
        self
    }

    /// Adds an observer of every message published on any host, in order of publication.
    pub fn observe(&mut self, observer: Box<dyn Observer>) -> &mut Talws {
        self.observers.push(observer);
        self
    }

    /// Adds a listener to every micro-step of every chart.
    pub fn listen(&mut self, listener: Box<dyn ChartListener>) -> &mut Talws {
        self.listeners.push(listener);
        self
    }

    /// Prepares a run in simulated time. Equal seeds give equal runs, regardless of the order in
    /// which hosts and agents were added.
    ///
    /// # Errors
    /// Duplicate names of hosts, or of agents of one host; topics that contradict each other; every
    /// diagnostic of every chart; and [`ErrorKind::Link`](monas_core::ErrorKind::Link) if a host has
    /// links: other processes do not wait for simulated time.
    pub fn simulate(self, seed: u64) -> Result<Simulation, Error> {
        if let Some(host) = self.hosts.iter().find(|host| !host.links.is_empty()) {
            let message =
                format!("`{}` has links, and other processes do not wait for simulated time", host.name);
            return Err(Error::new(ErrorKind::Link, message).with_hint("pace it, with `simulate_linked`"));
        }
        Simulation::new(self, seed)
    }

    /// As [`simulate`](Talws::simulate), with the links of all hosts. Messages of links arrive in
    /// real time, so the caller paces the run, as [`Simulation::run_paced`] does, and the seed no
    /// longer determines it.
    ///
    /// # Errors
    /// As in [`simulate`](Talws::simulate), and when a link cannot be opened.
    pub fn simulate_linked(self, seed: u64) -> Result<Simulation, Error> {
        Simulation::new(self, seed)
    }

    /// The diagnostics of a run before its start: charts that do not fit the program, sources
    /// without a publisher, duplicate names. Executes nothing and opens no link.
    pub fn check(self) -> Vec<Diagnostic> {
        match setup::PreparedRun::new(self, 0) {
            Ok(_) => Vec::new(),
            Err(error) if error.kind() == ErrorKind::Invalid => error.diagnostics().to_vec(),
            Err(error) => vec![refusal(&error)],
        }
    }

    /// Starts a run in real time: a thread for each list of activities, each chart, each body and
    /// the world, and a pool of threads for the activities of each agent's charts.
    ///
    /// # Errors
    /// As in [`simulate`](Talws::simulate), and when a thread cannot be created.
    pub fn start(self) -> Result<RealTimeRun, Error> {
        RealTimeRun::start(self, REAL_TIME_SEED)
    }

    /// Runs in real time until the run is [stopped](StopHandle::stop).
    ///
    /// # Errors
    /// As in [`start`](Talws::start).
    pub fn run(self) -> Result<Statistics, Error> {
        Ok(self.start()?.wait())
    }
}

impl std::fmt::Debug for Talws {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Talws").field("hosts", &self.hosts).finish_non_exhaustive()
    }
}

/// A diagnostic about the whole run, without a location in a file.
fn refusal(error: &Error) -> Diagnostic {
    let diagnostic = Diagnostic::error("E0323", Span::default(), error.to_string());
    match error.hint() {
        Some(hint) => diagnostic.with_hint(hint),
        None => diagnostic,
    }
}
