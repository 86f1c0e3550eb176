//! What a chart that runs has of its own, and what follows from it when one of its activities fails.

use yase::Activation;

use super::Runner;
use crate::agent::{ChartSettings, Policy};
use crate::call::Failure;
use crate::frequency::Frequency;
use crate::talws::Scheduling;

/// What an agent says of all its charts.
#[derive(Clone, Debug)]
pub(crate) struct OfAgent {
    pub(crate) frequency: Option<Frequency>,
    pub(crate) policy: Policy,
    pub(crate) scheduling: Scheduling,
    pub(crate) statistics_every: Option<u64>,
}

impl Runner {
    /// What it has of its own.
    pub(crate) fn own(&self) -> &ChartSettings {
        &self.own
    }

    /// Has other settings of its own from now on. Activities whose parameters are others take them, those that are being called when they return.
    pub(crate) fn settle(&mut self, own: ChartSettings) {
        for known in &own.activities {
            let before = self.own.parameters(&known.name);
            if !known.parameters.says_the_same(&before) {
                self.posts.configure(&known.name, &known.parameters);
            }
        }
        self.own = own;
    }

    /// How often it is stepped besides what wakes it.
    pub(crate) fn frequency(&self, of_agent: Option<Frequency>) -> Option<Frequency> {
        self.own.frequency.or(of_agent)
    }

    /// What happens when one of its activities fails of which nothing else is said, or the chart itself.
    pub(crate) fn policy(&self, of_agent: Policy) -> Policy {
        self.own.policy.unwrap_or(of_agent)
    }

    /// After how many steps its times are written to the log.
    pub(crate) fn statistics_every(&self, of_agent: Option<u64>) -> Option<u64> {
        self.own.statistics_every.unwrap_or(of_agent)
    }

    /// What happens when the activity of a state fails.
    pub(crate) fn policy_of(&self, activation: Activation, of_agent: Policy) -> Policy {
        let said = self.own.of_activity(self.posts.name(activation)).and_then(|known| known.policy);
        said.unwrap_or_else(|| self.policy(of_agent))
    }

    /// Says that an activity has failed in a cycle.
    ///
    /// # Errors
    /// Why the agent is to stop, if it is.
    pub(crate) fn has_failed(
        &mut self,
        activation: Activation,
        failure: &Failure,
        of_agent: Policy,
        cycle: u64,
    ) -> Result<(), String> {
        let (robot, agent, activity) = (&self.desk.host, &self.desk.agent, self.posts.name(activation));
        tracing::error!(%robot, %agent, %activity, cycle, "activity failed: {failure}");
        let policy = self.policy_of(activation, of_agent);
        match policy {
            Policy::Restart | Policy::Skip => Ok(()),
            Policy::StopAgent | Policy::SafeState => {
                let reason = format!("activity `{activity}` failed in cycle {cycle}: {failure}");
                self.rests_body = Some(policy == Policy::SafeState);
                Err(reason)
            }
        }
    }

    /// Whether the body is to rest when the agent stops because of this chart.
    pub(crate) fn rests_body(&mut self, of_agent: Policy) -> bool {
        self.rests_body.take().unwrap_or_else(|| self.policy(of_agent) == Policy::SafeState)
    }
}
