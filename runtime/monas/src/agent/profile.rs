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
pub(crate) struct AgentProfile {
    pub(crate) name: String,
    pub(crate) frequency: Option<Frequency>,
    pub(crate) priority: i32,
    pub(crate) real_time: bool,
    pub(crate) statistics_every: Option<u64>,
    pub(crate) workers: Option<NonZeroUsize>,
    pub(crate) cores: Vec<usize>,
    pub(crate) policy: FailurePolicy,
    pub(crate) semantics: Semantics,
    pub(crate) elsewhere: Vec<String>,
    /// In the order of the list.
    pub(crate) activities: Vec<ActivityProfile>,
    pub(crate) charts: Vec<ChartProfile>,
    /// Properties monitored on its only chart.
    pub(crate) property_sets: Vec<PropertySet>,
}

/// An activity of a list.
#[derive(Clone, Debug)]
pub(crate) struct ActivityProfile {
    pub(crate) name: String,
    pub(crate) parameters: Parameters,
    /// Its failure policy, if it differs from the agent's.
    pub(crate) policy: Option<FailurePolicy>,
}

impl ActivityProfile {
    pub(crate) fn of(listed: &ListedActivity) -> ActivityProfile {
        let ListedActivity { name, parameters, policy, .. } = listed;
        ActivityProfile { name: name.clone(), parameters: parameters.clone(), policy: *policy }
    }
}

/// A chart of an agent.
#[derive(Clone, Debug)]
pub(crate) struct ChartProfile {
    /// The file it was read from, or its registered name.
    pub(crate) model: String,
    pub(crate) statechart: Statechart,
    /// Its compiled form, if it was compiled on loading.
    pub(crate) compiled: Option<CompiledModel>,
    /// Whether it is a generated chart.
    pub(crate) is_generated: bool,
    /// Its settings.
    pub(crate) own: ChartSettings,
}

impl AgentProfile {
    pub(crate) fn of(agent: &Agent) -> AgentProfile {
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
