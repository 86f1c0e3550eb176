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
    /// The name.
    pub name: String,
    /// The frequency of the list; `None` without a list.
    pub frequency: Option<Frequency>,
    /// The priority of its threads.
    pub priority: i32,
    /// Whether its threads request real-time scheduling.
    pub real_time: bool,
    /// Number of cycles after which times are logged; `None` for never.
    pub statistics_every: Option<u64>,
    /// Number of threads for the activities of its charts.
    pub workers: Option<NonZeroUsize>,
    /// Numbers of the permitted cores; empty for any core.
    pub cores: Vec<usize>,
    /// The reaction to failing activities.
    pub policy: FailurePolicy,
    /// The semantics of its charts.
    pub semantics: Semantics,
    /// Activities executed by another process.
    pub elsewhere: Vec<String>,
    /// In the order of the list.
    pub activities: Vec<ActivityProfile>,
    /// The charts, by index.
    pub charts: Vec<ChartProfile>,
    /// Properties monitored on its only chart.
    pub property_sets: Vec<PropertySet>,
}

/// An activity of a list.
#[derive(Clone, Debug)]
pub struct ActivityProfile {
    /// The name.
    pub name: String,
    /// The parameters with which it was configured.
    pub parameters: Parameters,
    /// Its failure policy, if it differs from the agent's.
    pub policy: Option<FailurePolicy>,
}

impl ActivityProfile {
    /// Describes an activity.
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
    /// The chart as data.
    pub statechart: Statechart,
    /// Its compiled form, if it was compiled on loading.
    pub compiled: Option<CompiledModel>,
    /// Whether it is a generated chart.
    pub is_generated: bool,
    /// Its settings.
    pub settings: ChartSettings,
}

impl AgentProfile {
    /// Describes an agent.
    pub fn of(agent: &Agent) -> AgentProfile {
        let charts = agent.models.iter().zip(&agent.charts).zip(&agent.chart_settings).enumerate();
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
                .map(|(index, ((model, statechart), own))| ChartProfile {
                    model: model.clone(),
                    statechart: statechart.clone(),
                    compiled: agent.compiled[index].clone(),
                    is_generated: agent.generated.contains_key(&index),
                    settings: own.clone(),
                })
                .collect(),
        }
    }
}
