//! The parts of a run: hosts with their agents and bodies, and the world.

use std::sync::Arc;
use std::time::Duration;

use monas_core::activity::BoxError;
use monas_core::agent::Agent;
use monas_core::listener::ChartListener;
use monas_core::module::Module;
use monas_core::registry::Registry;
use monas_link::LinkConfig;
use monas_robot::Robot;
use narukom::{Blackboard, Observer, Timestamp};
use yase::Source;

use crate::recorded_publisher::RecordedPublisher;

/// The seed of a run in real time. Such a run is not deterministic, so any seed will do.
pub(crate) const REAL_TIME_SEED: u64 = 0;

/// The parts of a run.
#[derive(Default)]
pub(crate) struct RunConfig {
    pub(crate) registry: Option<Registry>,
    pub(crate) hosts: Vec<HostConfig>,
    pub(crate) world: Option<Box<dyn World>>,
    pub(crate) observers: Vec<Box<dyn Observer>>,
    pub(crate) listeners: Vec<Box<dyn ChartListener>>,
    /// Recorded publishers of the hosts, beside their agents and bodies.
    pub(crate) publishers: Vec<RecordedPublisher>,
}

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
