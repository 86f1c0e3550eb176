//! Talws: the hosts of a run, their agents and bodies, and the world.

use std::path::Path;

use monas_core::agent::Agent;
use monas_core::error::{Error, ErrorKind};
use monas_core::listener::ChartListener;
use monas_core::registry::Registry;
use monas_core::statistics::Statistics;
use monas_link::LinkConfig;
use monas_robot::BodySettings;
use narukom::Observer;
use yase::{Diagnostic, Span};

use crate::real_time::RealTimeRun;
use crate::recorded_publisher::RecordedPublisher;
use crate::replay::Replay;
use crate::run_config::{HostConfig, REAL_TIME_SEED, RunConfig, World};
use crate::setup::PreparedRun;
use crate::simulation::Simulation;

/// The hosts of a run with their agents and bodies, and the world around them.
///
/// Talws is the only part of Monas that determines the time: [`simulate`](Talws::simulate) advances
/// it as fast as the run can be computed, on one thread and in a defined order;
/// [`start`](Talws::start) uses real time.
///
/// All agents of a run subscribe before the first of them publishes, and links bring messages only
/// after the agents of their host have subscribed: no first message is lost. An agent that is added
/// later has missed the signals, and the events of messages, that were published before the change
/// that adds it was applied; it begins with the latest states and with the histories.
///
/// ```
/// use monas_core::{Agent, Blackboard, Hz, Timestamp};
/// use monas_runtime::Talws;
///
/// fn hello(blackboard: &mut Blackboard) {
///     println!("hello at {}", blackboard.now());
/// }
/// let talws = Talws::new().agent(Agent::new("greeter", Hz(10)).activity(hello));
/// let mut simulation = talws.simulate(7)?;
/// simulation.run_until(Timestamp::from_secs_f64(1.0))?;
/// assert_eq!(simulation.statistics().calls("local", "hello"), 10);
/// # Ok::<(), monas_core::Error>(())
/// ```
#[derive(Default)]
pub struct Talws {
    config: RunConfig,
    /// The body of the host [`LOCAL`](Talws::LOCAL) that a configuration names.
    body: Option<BodySettings>,
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
    /// [`ErrorKind::Invalid`](monas_core::ErrorKind::Invalid) with every diagnostic of the file and
    /// of the models that it names.
    pub fn from_config(path: impl AsRef<Path>, registry: Registry) -> Result<Talws, Error> {
        let (setup, diagnostics) = monas_config::load(path, &registry);
        if diagnostics.iter().any(|diagnostic| diagnostic.is_error()) {
            return Err(Error::invalid(diagnostics));
        }
        diagnostics.iter().for_each(|diagnostic| tracing::warn!("{diagnostic}"));
        Ok(Talws::new().registry(registry).setup(setup))
    }

    /// Adds the agents, links, modules and body of a configuration to the host
    /// [`LOCAL`](Talws::LOCAL). The body is opened when the run begins. Changes at runtime can be
    /// saved into its text.
    pub fn setup(mut self, setup: monas_config::HostSetup) -> Talws {
        let monas_config::HostSetup { agents, links, modules, body, source } = setup;
        self.body = body.or(self.body);
        let local = self.local();
        local.modules.extend(modules);
        local.agents.extend(agents);
        local.links.extend(links);
        local.configuration = source.or(local.configuration.take());
        self
    }

    /// Whether the body that a configuration names has a time of its own: the run is then one in
    /// [simulated time](Talws::simulate), each cycle of which waits for the body.
    pub fn has_own_time(&self) -> bool {
        self.body.as_ref().is_some_and(BodySettings::has_own_time)
    }

    /// Takes activities and functions from this registry instead of the linked ones.
    pub fn registry(mut self, registry: Registry) -> Talws {
        self.config.registry = Some(registry);
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
        let known = self.config.hosts.iter().position(|host| host.name == Talws::LOCAL);
        let index = known.unwrap_or_else(|| {
            self.config.hosts.push(HostConfig { name: Talws::LOCAL.into(), ..HostConfig::default() });
            self.config.hosts.len() - 1
        });
        &mut self.config.hosts[index]
    }

    /// Adds a host.
    pub fn host(&mut self, host: HostConfig) -> &mut Talws {
        self.config.hosts.push(host);
        self
    }

    /// Sets the world around the bodies and replaces a previous one.
    pub fn world(&mut self, world: Box<dyn World>) -> &mut Talws {
        self.config.world = Some(world);
        self
    }

    /// Adds an observer of every message published on any host, in order of publication.
    pub fn observe(&mut self, observer: Box<dyn Observer>) -> &mut Talws {
        self.config.observers.push(observer);
        self
    }

    /// Adds a listener to every micro-step of every chart.
    pub fn listen(&mut self, listener: Box<dyn ChartListener>) -> &mut Talws {
        self.config.listeners.push(listener);
        self
    }

    /// Prepares a run in simulated time. Equal seeds give equal runs, whatever the order in which
    /// hosts and agents were added.
    ///
    /// # Errors
    /// Duplicate names of hosts, or of agents of one host; topics that contradict each other; every
    /// diagnostic of every chart; and [`ErrorKind::Link`](monas_core::ErrorKind::Link) if a host
    /// has links: other processes do not wait for simulated time.
    pub fn simulate(self, seed: u64) -> Result<Simulation, Error> {
        if let Some(host) = self.config.hosts.iter().find(|host| !host.links.is_empty()) {
            let message =
                format!("`{}` has links, and other processes do not wait for simulated time", host.name);
            return Err(Error::new(ErrorKind::Link, message).with_hint("pace it, with `simulate_linked`"));
        }
        Simulation::new(self.with_body(seed)?.config, seed)
    }

    /// As [`simulate`](Talws::simulate), with the links of all hosts. Messages of links arrive in
    /// real time, so the caller paces the run, as [`Simulation::run_paced`] does, and the seed no
    /// longer determines it.
    ///
    /// # Errors
    /// As in [`simulate`](Talws::simulate), and when a link cannot be opened.
    pub fn simulate_linked(self, seed: u64) -> Result<Simulation, Error> {
        Simulation::new(self.with_body(seed)?.config, seed)
    }

    /// The diagnostics of a run before its start: charts that do not fit the program, sources
    /// without a publisher, duplicate names. Executes nothing and opens no link.
    pub fn check(self) -> Vec<Diagnostic> {
        match PreparedRun::new(self.config, 0) {
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
        RealTimeRun::start(self.with_body(REAL_TIME_SEED)?.config, REAL_TIME_SEED)
    }

    /// Opens the body that a configuration named.
    fn with_body(mut self, seed: u64) -> Result<Talws, Error> {
        if let Some(settings) = self.body.take() {
            let opened = settings.open(None, seed).map_err(|error| {
                let message = format!("the body `{}` cannot be opened: {error}", settings.kind);
                Error::new(ErrorKind::Body, message).caused_by(error)
            });
            self.local().body = Some(opened?);
        }
        Ok(self)
    }

    /// Prepares a replay of the agents of these hosts, which need no bodies, on a recording of
    /// simulated time. The seed is that of the recorded run; `publishers` lists all publishers of
    /// the hosts.
    ///
    /// # Errors
    /// As in [`simulate`](Talws::simulate).
    pub fn replay(self, seed: u64, publishers: &[RecordedPublisher]) -> Result<Replay, Error> {
        Replay::simulated(self.config, seed, publishers)
    }

    /// As [`replay`](Talws::replay), on a recording of real time.
    ///
    /// # Errors
    /// As there, and if an agent has neither charts nor activities when the run begins.
    pub fn replay_real_time(self, publishers: &[RecordedPublisher]) -> Result<Replay, Error> {
        Replay::real_time(self.config, publishers)
    }

    /// Runs in real time until the run is [stopped](crate::StopHandle::stop).
    ///
    /// # Errors
    /// As in [`start`](Talws::start).
    pub fn run(self) -> Result<Statistics, Error> {
        Ok(self.start()?.wait())
    }
}

impl std::fmt::Debug for Talws {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Talws").field("hosts", &self.config.hosts).finish_non_exhaustive()
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
