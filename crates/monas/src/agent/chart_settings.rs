//! What a statechart has of its own where it does not go by its agent.

use std::num::NonZeroUsize;

use aseme::properties::Property;

use super::{ActivityProfile, Policy};
use crate::frequency::Frequency;
use crate::monitors::{OnViolation, Rules};
use crate::parameters::Parameters;
use crate::talws::Scheduling;

/// What a statechart of an agent has of its own: how the thread that steps it runs, how many threads call its activities, what happens when one of
/// them fails, and their parameters. What is not said is as its agent says.
///
/// ```
/// use std::num::NonZeroUsize;
/// use monas::{ChartSettings, Hz, Policy};
///
/// let quick = ChartSettings::new().every(Hz(50)).priority(20).workers(NonZeroUsize::MIN).on_failure(Policy::Skip);
/// assert!(format!("{quick:?}").contains("priority: Some(20)"));
/// ```
#[derive(Clone, Debug, Default)]
pub struct ChartSettings {
    pub(crate) frequency: Option<Frequency>,
    pub(crate) priority: Option<i32>,
    pub(crate) real_time: Option<bool>,
    /// None within says never.
    pub(crate) statistics_every: Option<Option<u64>>,
    pub(crate) workers: Option<NonZeroUsize>,
    pub(crate) cores: Option<Vec<usize>>,
    pub(crate) policy: Option<Policy>,
    /// Of states whose activities have these names.
    pub(crate) activities: Vec<ActivityProfile>,
    /// Activities that another process runs.
    pub(crate) elsewhere: Vec<String>,
    pub(crate) rules: Vec<Rules>,
}

impl ChartSettings {
    /// Nothing of its own.
    pub fn new() -> ChartSettings {
        ChartSettings::default()
    }

    /// Says how often it is stepped besides what wakes it anyway.
    pub fn every(mut self, frequency: Frequency) -> ChartSettings {
        self.frequency = Some(frequency);
        self
    }

    /// Says how urgent the thread is that steps it, from 1 to 99, the higher the sooner.
    pub fn priority(mut self, priority: i32) -> ChartSettings {
        self.priority = Some(priority);
        self
    }

    /// Says whether real-time scheduling is wanted for the thread that steps it.
    pub fn real_time(mut self, is_wanted: bool) -> ChartSettings {
        self.real_time = Some(is_wanted);
        self
    }

    /// Says on which of the computer's cores the thread that steps it may run, by their numbers.
    pub fn cores(mut self, cores: impl IntoIterator<Item = usize>) -> ChartSettings {
        self.cores = Some(cores.into_iter().collect());
        self
    }

    /// Says after how many of its steps its times are written to the log; 0 for never.
    pub fn statistics_every(mut self, steps: u64) -> ChartSettings {
        self.statistics_every = Some((steps > 0).then_some(steps));
        self
    }

    /// Says how many threads of its own call its activities in real time; those of its agent do, if it is not said.
    pub fn workers(mut self, workers: NonZeroUsize) -> ChartSettings {
        self.workers = Some(workers);
        self
    }

    /// Says what happens when one of its activities fails.
    pub fn on_failure(mut self, policy: Policy) -> ChartSettings {
        self.policy = Some(policy);
        self
    }

    /// Says the parameters of the activity of that name, in every state that has it, and what happens when it fails, if that is not what happens when
    /// any of the chart's does.
    pub fn activity(
        mut self,
        name: impl Into<String>,
        parameters: Parameters,
        policy: Option<Policy>,
    ) -> ChartSettings {
        self.activities.push(ActivityProfile { name: name.into(), parameters, policy });
        self
    }

    /// Says that another process runs an activity of its states.
    pub fn elsewhere(mut self, activity: impl Into<String>) -> ChartSettings {
        self.elsewhere.push(activity.into());
        self
    }

    /// Has [properties](aseme::properties) of it followed while it runs.
    pub fn monitor(self, properties: Vec<Property>, on_violation: OnViolation) -> ChartSettings {
        self.ruled(Rules { file: String::new(), properties, on_violation, source: None })
    }

    pub(crate) fn ruled(mut self, rules: Rules) -> ChartSettings {
        self.rules.push(rules);
        self
    }

    /// What is said of the activity of that name.
    pub(crate) fn of_activity(&self, name: &str) -> Option<&ActivityProfile> {
        self.activities.iter().find(|known| known.name == name)
    }

    /// As [`of_activity`](ChartSettings::of_activity), to be changed; nothing is said of it before.
    pub(crate) fn of_activity_mut(&mut self, name: &str) -> &mut ActivityProfile {
        let place = self.activities.iter().position(|known| known.name == name).unwrap_or_else(|| {
            let (name, parameters) = (name.to_owned(), Parameters::new());
            self.activities.push(ActivityProfile { name, parameters, policy: None });
            self.activities.len() - 1
        });
        &mut self.activities[place]
    }

    /// The parameters of the activity of that name.
    pub(crate) fn parameters(&self, name: &str) -> Parameters {
        let parameters = self.of_activity(name).map(|known| known.parameters.fresh());
        parameters.unwrap_or_default()
    }

    /// How the thread that steps it is scheduled, if the agent's threads are so.
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
    fn what_a_chart_does_not_say_is_as_its_agent_says() {
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
    fn of_an_activity_the_parameters_are_those_that_are_said() {
        let said = Parameters::new().with("speed", "2");
        let mut own = ChartSettings::new().activity("Kick", said, None);
        assert_eq!(own.parameters("Kick").iter().collect::<Vec<_>>(), [("speed", "2")]);
        assert!(own.parameters("Walk").is_empty());
        own.of_activity_mut("Walk").policy = Some(Policy::Skip);
        assert_eq!(own.of_activity("Walk").and_then(|known| known.policy), Some(Policy::Skip));
    }
}
