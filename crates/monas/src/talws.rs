//! Talws: what holds a team of agents, and runs it.

mod body;
mod chart_thread;
mod clock;
mod crew;
mod deadlines;
mod entry;
mod handover;
mod instance;
mod links;
mod list_thread;
mod management;
pub(crate) mod measured;
mod moved;
mod orders;
mod overview;
mod pool;
mod pulse;
mod real_time;
mod replay;
mod scheduling;
mod seeds;
mod setup;
mod simulated_chart;
mod simulation;
mod stopper;
mod supervisor;
mod teller;
mod turn;
mod unit;
mod workforce;

use monas_robot::Robot;
use narukom::{Blackboard, Moment, Observer};
use std::path::Path;
use std::sync::Arc;
use std::time::Duration;
use yase::{Diagnostic, Source, Span};

use crate::activity::BoxError;
use crate::agent::Agent;
use crate::config;
use crate::error::{Error, ErrorKind};
use crate::link::LinkConfig;
use crate::listener::ChartListener;
use crate::module::Module;
use crate::registry::Registry;
use crate::statistics::Statistics;

pub(crate) use clock::{Clock, cpu_time};
pub use overview::Overview;
pub(crate) use pulse::Pulse;
pub use real_time::Running;
pub use replay::{Company, Difference, Input, Recorded, RecordedMessage, Replay, Tally};
pub(crate) use scheduling::Scheduling;
pub(crate) use seeds::component_seed;
pub use simulation::Simulation;
pub use stopper::Stopper;

/// The seed of a run in real time, where chance comes in anyway: one is as good as any.
const REAL_TIME_SEED: u64 = 0;

/// Why an agent stops when nothing is wrong.
const ENDED: &str = "the run has ended";

/// A host: a robot or a computer, with a hub of its own, the agents that run on it, and its body if it has one.
#[derive(Default)]
pub struct HostConfig {
    /// Its name, unlike every other.
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
    /// The modules that its agents have activities of. All agents of the run may have them.
    pub modules: Vec<Module>,
    /// The text that its agents were read from, which they are saved into.
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

/// The world that simulated bodies live in. It has a hub of its own, named after it, on which it may publish what is true.
pub trait World: Send {
    /// The name of its hub.
    fn name(&self) -> &str {
        "world"
    }

    /// How often it moves on.
    fn period(&self) -> Duration;

    /// Publishes what is true before anything has happened.
    fn start(&mut self, blackboard: &mut Blackboard) -> Result<(), BoxError> {
        let _ = blackboard;
        Ok(())
    }

    /// Moves on by one period, to `now`.
    fn advance(&mut self, now: Moment, blackboard: &mut Blackboard) -> Result<(), BoxError>;
}

/// Hosts with their agents and bodies, and the world around them.
///
/// Talws is the only part of Monas that knows how time passes: [`simulate`](Talws::simulate) makes it pass as fast as it can be
/// computed, everything on one thread and in a defined order; [`start`](Talws::start) lets it pass by itself.
///
/// ```
/// use monas::{Agent, Blackboard, Hz, Moment, Talws};
///
/// fn hello(blackboard: &mut Blackboard) {
///     println!("hello at {}", blackboard.now());
/// }
/// let talws = Talws::new().agent(Agent::new("greeter", Hz(10)).activity(hello));
/// let mut simulation = talws.simulate(7)?;
/// simulation.run_until(Moment::from_secs_f64(1.0))?;
/// assert_eq!(simulation.statistics().calls("local", "hello"), 10);
/// # Ok::<(), monas::Error>(())
/// ```
#[derive(Default)]
pub struct Talws {
    registry: Option<Registry>,
    hosts: Vec<HostConfig>,
    world: Option<Box<dyn World>>,
    observers: Vec<Box<dyn Observer>>,
    listeners: Vec<Box<dyn ChartListener>>,
    /// Those who publish on the hosts beside their agents and bodies.
    company: Vec<Company>,
}

impl Talws {
    /// The name of the host of agents that are given none.
    pub const LOCAL: &'static str = "local";

    /// No hosts, and everything that is linked into the program.
    pub fn new() -> Talws {
        Talws::default()
    }

    /// The agents and links of a configuration file, on the host [`LOCAL`](Talws::LOCAL), with the registry that they are taken from.
    ///
    /// # Errors
    /// [`ErrorKind::Invalid`](crate::ErrorKind::Invalid) with every diagnostic of the file and of the models it names.
    pub fn from_config(path: impl AsRef<Path>, registry: Registry) -> Result<Talws, Error> {
        let (setup, diagnostics) = config::load(path, &registry);
        if diagnostics.iter().any(|diagnostic| diagnostic.is_error()) {
            return Err(Error::invalid(diagnostics));
        }
        diagnostics.iter().for_each(|diagnostic| tracing::warn!("{diagnostic}"));
        Ok(Talws::new().registry(registry).setup(setup))
    }

    /// Adds the agents, links and modules of a configuration to the host [`LOCAL`](Talws::LOCAL). What is changed while they run can be saved into
    /// its text.
    pub fn setup(mut self, setup: config::Setup) -> Talws {
        let config::Setup { agents, links, modules, source } = setup;
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

    /// Puts a world around the bodies, in place of the one before.
    pub fn world(&mut self, world: Box<dyn World>) -> &mut Talws {
        self.world = Some(world);
        self
    }

    /// Lets an observer see every message that is published on any host, in order of publication.
    pub fn observe(&mut self, observer: Box<dyn Observer>) -> &mut Talws {
        self.observers.push(observer);
        self
    }

    /// Lets a listener see every micro-step of every chart.
    pub fn listen(&mut self, listener: Box<dyn ChartListener>) -> &mut Talws {
        self.listeners.push(listener);
        self
    }

    /// Prepares a run in simulated time. The same seed gives the same run, in whatever order hosts and agents were added.
    ///
    /// # Errors
    /// Two hosts or two agents of a host with one name, topics that contradict each other, and every diagnostic of every chart; and
    /// [`ErrorKind::Link`](crate::ErrorKind::Link) if a host has links: other processes do not wait for simulated time.
    pub fn simulate(self, seed: u64) -> Result<Simulation, Error> {
        if let Some(host) = self.hosts.iter().find(|host| !host.links.is_empty()) {
            let message =
                format!("`{}` has links, and other processes do not wait for simulated time", host.name);
            return Err(Error::new(ErrorKind::Link, message).with_hint("pace it, with `simulate_linked`"));
        }
        Simulation::new(self, seed)
    }

    /// As [`simulate`](Talws::simulate), with the links of all hosts. What comes over them comes when it comes, so whoever advances the
    /// run paces it, as [`Simulation::run_paced`] does, and it is a function of its seed no longer.
    ///
    /// # Errors
    /// As in [`simulate`](Talws::simulate), and when a link cannot be opened.
    pub fn simulate_linked(self, seed: u64) -> Result<Simulation, Error> {
        Simulation::new(self, seed)
    }

    /// What a run would say before anything starts: charts that do not fit the program, sources that can never be heard, names that
    /// stand twice. Nothing runs, and no link is opened.
    pub fn check(self) -> Vec<Diagnostic> {
        match setup::Stage::new(self, 0) {
            Ok(_) => Vec::new(),
            Err(error) if error.kind() == ErrorKind::Invalid => error.diagnostics().to_vec(),
            Err(error) => vec![refusal(&error)],
        }
    }

    /// Starts a run in real time: a thread for each list of activities, each chart, each body and the world, and a pool of threads
    /// for the activities of each agent's charts.
    ///
    /// # Errors
    /// As in [`simulate`](Talws::simulate), and when the system gives no thread.
    pub fn start(self) -> Result<Running, Error> {
        Running::start(self, REAL_TIME_SEED)
    }

    /// Runs in real time until somebody [stops](Stopper::stop) it.
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

/// What is said of the whole run and of no place in a file.
fn refusal(error: &Error) -> Diagnostic {
    let diagnostic = Diagnostic::error("E0323", Span::default(), error.to_string());
    match error.hint() {
        Some(hint) => diagnostic.with_hint(hint),
        None => diagnostic,
    }
}
