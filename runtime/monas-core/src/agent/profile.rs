//! Description of a running agent as data, used to list, restart and save it.

use std::num::NonZeroUsize;

use yase::{Semantics, Statechart};

use super::{Agent, ChartSettings, FailurePolicy, ListedActivity};
use crate::binder::CompiledModel;
use crate::frequency::Frequency;
use crate::monitors::PropertySet;
use crate::parameters::Parameters;

/// The description of an agent.
#[derive(Clone, Debug)]
pub struct AgentProfile {
    pub name: String,
    pub frequency: Option<Frequency>,
    pub priority: i32,
    pub real_time: bool,
    pub statistics_every: Option<u64>,
    pub workers: Option<NonZeroUsize>,
    pub cores: Vec<usize>,
    pub policy: FailurePolicy,
    pub semantics: Semantics,
    pub elsewhere: Vec<String>,
    /// In the order of the list.
    pub activities: Vec<ActivityProfile>,
    pub charts: Vec<ChartProfile>,
    /// Properties monitored on its only chart.
    pub property_sets: Vec<PropertySet>,
}

/// An activity of a list.
#[derive(Clone, Debug)]
pub struct ActivityProfile {
    pub name: String,
    pub parameters: Parameters,
    /// Its failure policy, if it differs from the agent's.
    pub policy: Option<FailurePolicy>,
}

impl ActivityProfile {
    pub fn of(listed: &ListedActivity) -> ActivityProfile {
        let ListedActivity { name, parameters, policy, .. } = listed;
        ActivityProfile { name: name.clone(), parameters: parameters.clone(), policy: *policy }
    }
}

/// A chart of an agent.
#[derive(Clone, Debug)]
pub struct ChartProfile {
    /// The file it was read from, or its registered name.
    pub model: String,
    pub statechart: Statechart,
    /// Its compiled form, if it was compiled on loading.
    pub compiled: Option<CompiledModel>,
    /// Whether it is a generated chart.
    pub is_generated: bool,
    /// Its settings.
    pub own: ChartSettings,
}

impl AgentProfile {
    pub fn of(agent: &Agent) -> AgentProfile {
        let charts = agent.models.iter().zip(&agent.charts).zip(&agent.own).enumerate();
        AgentProfile {
            name: agent.name.clone(),
            frequency: agent.frequency,
            priority: agent.priority,
            real_time: agent.real_time,
            statistics_every: agent.statistics_every,
            workers: agent.workers,
            cores: agent.cores.clone(),
            policy: agent.policy,
            semantics: agent.semantics,
            elsewhere: agent.elsewhere.clone(),
            property_sets: agent.property_sets.clone(),
            activities: agent.activities.iter().map(ActivityProfile::of).collect(),
            charts: charts
                .map(|(place, ((model, statechart), own))| ChartProfile {
                    model: model.clone(),
                    statechart: statechart.clone(),
                    compiled: agent.compiled[place].clone(),
                    is_generated: agent.generated.contains_key(&place),
                    own: own.clone(),
                })
                .collect(),
        }
    }
}
