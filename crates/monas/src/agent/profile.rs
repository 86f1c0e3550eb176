//! What an agent is made of, as data: what remains known of it when it runs, so that it can be listed, begun anew and saved.

use std::num::NonZeroUsize;

use yase::{Semantics, Statechart};

use super::{Agent, ChartSettings, Listed, Policy};
use crate::frequency::Frequency;
use crate::monitors::Rules;
use crate::parameters::Parameters;

/// What an agent is made of.
#[derive(Clone, Debug)]
pub(crate) struct Profile {
    pub(crate) name: String,
    pub(crate) frequency: Option<Frequency>,
    pub(crate) priority: i32,
    pub(crate) real_time: bool,
    pub(crate) statistics_every: Option<u64>,
    pub(crate) workers: Option<NonZeroUsize>,
    pub(crate) cores: Vec<usize>,
    pub(crate) policy: Policy,
    pub(crate) semantics: Semantics,
    pub(crate) elsewhere: Vec<String>,
    /// In the order of the list.
    pub(crate) activities: Vec<ActivityProfile>,
    pub(crate) charts: Vec<ChartProfile>,
    /// What its one chart is to keep to.
    pub(crate) rules: Vec<Rules>,
}

/// An activity of a list.
#[derive(Clone, Debug)]
pub(crate) struct ActivityProfile {
    pub(crate) name: String,
    pub(crate) parameters: Parameters,
    /// What happens when it fails, if it has a policy of its own.
    pub(crate) policy: Option<Policy>,
}

impl ActivityProfile {
    pub(crate) fn of(listed: &Listed) -> ActivityProfile {
        let Listed { name, parameters, policy, .. } = listed;
        ActivityProfile { name: name.clone(), parameters: parameters.clone(), policy: *policy }
    }
}

/// A chart of an agent.
#[derive(Clone, Debug)]
pub(crate) struct ChartProfile {
    /// The file it was read from, or the name it is registered under.
    pub(crate) model: String,
    pub(crate) statechart: Statechart,
    /// Whether it is code.
    pub(crate) is_generated: bool,
    /// What it has of its own.
    pub(crate) own: ChartSettings,
}

impl Profile {
    pub(crate) fn of(agent: &Agent) -> Profile {
        let charts = agent.models.iter().zip(&agent.charts).zip(&agent.own).enumerate();
        Profile {
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
            rules: agent.rules.clone(),
            activities: agent.activities.iter().map(ActivityProfile::of).collect(),
            charts: charts
                .map(|(place, ((model, statechart), own))| ChartProfile {
                    model: model.clone(),
                    statechart: statechart.clone(),
                    is_generated: agent.generated.contains_key(&place),
                    own: own.clone(),
                })
                .collect(),
        }
    }
}
