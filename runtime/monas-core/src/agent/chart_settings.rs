//! Settings of a statechart that override those of its agent.

use std::num::NonZeroUsize;

use aseme_verify::properties::Property;

use super::{ActivityProfile, FailurePolicy};
use crate::frequency::Frequency;
use crate::monitors::{PropertySet, ViolationResponse};
use crate::parameters::Parameters;
use crate::scheduling::Scheduling;

/// Settings of one statechart of an agent: scheduling of the thread that steps it, threads that
/// call its activities, failure policy, and parameters of its activities. Settings not given
/// default to the agent's.
///
/// ```
/// use std::num::NonZeroUsize;
/// use monas_core::{ChartSettings, FailurePolicy, Hz};
///
/// let quick = ChartSettings::new().every(Hz(50)).priority(20).workers(NonZeroUsize::MIN).on_failure(FailurePolicy::Skip);
/// assert!(format!("{quick:?}").contains("priority: Some(20)"));
/// ```
#[derive(Clone, Debug, Default)]
pub struct ChartSettings {
    /// The highest frequency of steps.
    pub frequency: Option<Frequency>,
    /// The priority of the thread, 1 to 99, higher values first.
    pub priority: Option<i32>,
    /// Whether the thread requests real-time scheduling.
    pub real_time: Option<bool>,
    /// An inner `None` means never.
    pub statistics_every: Option<Option<u64>>,
    /// Number of threads for the activities of this chart.
    pub workers: Option<NonZeroUsize>,
    /// Numbers of the permitted cores; empty for any core.
    pub cores: Option<Vec<usize>>,
    /// The reaction to failing activities.
    pub policy: Option<FailurePolicy>,
    /// Settings of states' activities, by name of the activity.
    pub activities: Vec<ActivityProfile>,
    /// Activities executed by another process.
    pub elsewhere: Vec<String>,
    /// Properties monitored on this chart.
    pub property_sets: Vec<PropertySet>,
}

impl ChartSettings {
    /// No settings.
    pub fn new() -> ChartSettings {
        ChartSettings::default()
    }

    /// Sets the frequency at which it is stepped in addition to its events.
    pub fn every(mut self, frequency: Frequency) -> ChartSettings {
        self.frequency = Some(frequency);
        self
    }

    /// Sets the priority of the thread that steps it, 1 (lowest) to 99.
    pub fn priority(mut self, priority: i32) -> ChartSettings {
        self.priority = Some(priority);
        self
    }

    /// Sets whether the thread that steps it requests real-time scheduling.
    pub fn real_time(mut self, is_wanted: bool) -> ChartSettings {
        self.real_time = Some(is_wanted);
        self
    }

    /// Sets the CPU cores that the thread that steps it may use, by number.
    pub fn cores(mut self, cores: impl IntoIterator<Item = usize>) -> ChartSettings {
        self.cores = Some(cores.into_iter().collect());
        self
    }

    /// Sets the number of steps after which its timing is written to the log; 0 for never.
    pub fn statistics_every(mut self, steps: u64) -> ChartSettings {
        self.statistics_every = Some((steps > 0).then_some(steps));
        self
    }

    /// Sets the number of dedicated threads that call its activities in real time; by default the
    /// agent's threads call them.
    pub fn workers(mut self, workers: NonZeroUsize) -> ChartSettings {
        self.workers = Some(workers);
        self
    }

    /// Sets the failure policy of its activities.
    pub fn on_failure(mut self, policy: FailurePolicy) -> ChartSettings {
        self.policy = Some(policy);
        self
    }

    /// Sets the parameters of the activity of that name, in every state that has it, and its
    /// failure policy if it differs from the chart's.
    pub fn activity(
        mut self,
        name: impl Into<String>,
        parameters: Parameters,
        policy: Option<FailurePolicy>,
    ) -> ChartSettings {
        self.activities.push(ActivityProfile { name: name.into(), parameters, policy });
        self
    }

    /// Marks an activity of its states as executed by another process.
    pub fn elsewhere(mut self, activity: impl Into<String>) -> ChartSettings {
        self.elsewhere.push(activity.into());
        self
    }

    /// Monitors [properties](aseme_verify::properties) of the chart while it runs.
    pub fn monitor(self, properties: Vec<Property>, on_violation: ViolationResponse) -> ChartSettings {
        self.with_property_set(PropertySet { file: String::new(), properties, on_violation, source: None })
    }

    /// Adds a set of properties to monitor.
    pub fn with_property_set(mut self, rules: PropertySet) -> ChartSettings {
        self.property_sets.push(rules);
        self
    }

    /// The settings of the activity of that name.
    pub fn of_activity(&self, name: &str) -> Option<&ActivityProfile> {
        self.activities.iter().find(|known| known.name == name)
    }

    /// As [`of_activity`](ChartSettings::of_activity), mutable; creates empty settings if none
    /// exist.
    pub fn of_activity_mut(&mut self, name: &str) -> &mut ActivityProfile {
        let index = self.activities.iter().position(|known| known.name == name).unwrap_or_else(|| {
            let (name, parameters) = (name.to_owned(), Parameters::new());
            self.activities.push(ActivityProfile { name, parameters, policy: None });
            self.activities.len() - 1
        });
        &mut self.activities[index]
    }

    /// The parameters of the activity of that name.
    pub fn parameters(&self, name: &str) -> Parameters {
        let parameters = self.of_activity(name).map(|known| known.parameters.without_accesses());
        parameters.unwrap_or_default()
    }

    /// The scheduling of the thread that steps it, given that of its agent.
    pub(crate) fn scheduling(&self, of_agent: &Scheduling) -> Scheduling {
        Scheduling {
            priority: self.priority.unwrap_or(of_agent.priority),
            real_time: self.real_time.unwrap_or(of_agent.real_time),
            cores: self.cores.clone().unwrap_or_else(|| of_agent.cores.clone()),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn agent_settings_are_the_defaults_of_a_chart() {
        let of_agent = Scheduling { priority: 5, real_time: true, cores: vec![0] };
        assert_eq!(ChartSettings::new().scheduling(&of_agent), of_agent);
        let own = ChartSettings::new().priority(7).cores([1, 2]);
        let expected = Scheduling { priority: 7, real_time: true, cores: vec![1, 2] };
        assert_eq!(own.scheduling(&of_agent), expected);
        let anywhere = ChartSettings::new().real_time(false).cores([]);
        let expected = Scheduling { priority: 5, real_time: false, cores: Vec::new() };
        assert_eq!(anywhere.scheduling(&of_agent), expected);
    }

    #[test]
    fn an_activity_has_only_the_given_parameters() {
        let said = Parameters::new().with("speed", "2");
        let mut own = ChartSettings::new().activity("Kick", said, None);
        assert_eq!(own.parameters("Kick").iter().collect::<Vec<_>>(), [("speed", "2")]);
        assert!(own.parameters("Walk").is_empty());
        own.of_activity_mut("Walk").policy = Some(FailurePolicy::Skip);
        assert_eq!(own.of_activity("Walk").and_then(|known| known.policy), Some(FailurePolicy::Skip));
    }
}
