//! Settings of a running chart: its own, with those of its agent as defaults.

use narukom::Timestamp;
use yase::Activation;

use super::ChartRunner;
use crate::agent::{ChartSettings, FailurePolicy};
use crate::call::CallFailure;
use crate::frequency::Frequency;
use crate::scheduling::Scheduling;

/// The settings of an agent for charts without their own.
#[derive(Clone, Debug, Default)]
pub struct AgentDefaults {
    /// The highest frequency of steps.
    pub frequency: Option<Frequency>,
    /// The reaction to failing activities.
    pub policy: FailurePolicy,
    /// The scheduling of threads.
    pub scheduling: Scheduling,
    /// Number of steps after which times are logged.
    pub statistics_every: Option<u64>,
}

impl ChartRunner {
    /// The chart's own settings.
    pub fn own(&self) -> &ChartSettings {
        &self.settings
    }

    /// Replaces the settings of the agent without changing the next periodic step.
    pub fn set_defaults(&mut self, defaults: AgentDefaults) {
        self.defaults = defaults;
    }

    /// Changes the settings of the agent; a new frequency takes effect immediately.
    pub fn update_defaults(&mut self, change: impl FnOnce(&mut AgentDefaults), now: Timestamp) {
        let before = self.frequency();
        change(&mut self.defaults);
        if self.frequency() != before {
            self.skip_ticks(now);
        }
    }

    /// Replaces the chart's own settings. Activities whose parameters differ are configured;
    /// running ones when they return.
    pub fn apply_settings(&mut self, own: ChartSettings, now: Timestamp) {
        let before = self.frequency();
        for known in &own.activities {
            let parameters = self.settings.parameters(&known.name);
            if !known.parameters.has_same_values(&parameters) {
                self.host.slots.configure(&known.name, &known.parameters);
            }
        }
        self.settings = own;
        if self.frequency() != before {
            self.skip_ticks(now);
        }
    }

    /// The frequency of its periodic steps.
    fn frequency(&self) -> Option<Frequency> {
        self.settings.frequency.or(self.defaults.frequency)
    }

    /// The time of the next periodic step.
    pub(crate) fn tick(&self) -> Timestamp {
        self.frequency().map_or(Timestamp::MAX, |frequency| frequency.due(self.ticks))
    }

    /// Whether a periodic step is due.
    pub(crate) fn is_tick_due(&self, now: Timestamp) -> bool {
        self.frequency().is_some() && self.tick() <= now
    }

    /// Number of the next periodic step on the grid of the frequency.
    pub fn ticks(&self) -> u64 {
        self.ticks
    }

    /// Continues with a periodic step of this number.
    pub fn set_ticks(&mut self, ticks: u64) {
        self.ticks = ticks;
    }

    /// Continues with the first periodic step that is not before this time.
    pub fn skip_ticks(&mut self, now: Timestamp) {
        self.ticks = self.frequency().map_or(0, |frequency| frequency.first_due(now));
    }

    /// The scheduling of its thread.
    pub fn scheduling(&self) -> Scheduling {
        self.settings.scheduling(&self.defaults.scheduling)
    }

    /// Number of steps after which its times are logged.
    pub fn statistics_every(&self) -> Option<u64> {
        self.settings.statistics_every.unwrap_or(self.defaults.statistics_every)
    }

    /// The policy for failures of the chart and of activities without a policy.
    pub(crate) fn policy(&self) -> FailurePolicy {
        self.settings.policy.unwrap_or(self.defaults.policy)
    }

    /// The policy for failures of a state's activity.
    pub(crate) fn policy_of(&self, activation: Activation) -> FailurePolicy {
        let name = self.host.slots.name(activation);
        let policy = self.settings.of_activity(name).and_then(|known| known.policy);
        policy.unwrap_or_else(|| self.policy())
    }

    /// Logs the failure of an activity.
    ///
    /// # Errors
    /// Why the agent must stop, if its policy requires that.
    pub(crate) fn handle_failure(
        &mut self,
        activation: Activation,
        failure: &CallFailure,
        cycle: u64,
    ) -> Result<(), String> {
        let (robot, agent) = (&self.host.host, &self.host.agent);
        let activity = self.host.slots.name(activation);
        tracing::error!(%robot, %agent, %activity, cycle, "activity failed: {failure}");
        let policy = self.policy_of(activation);
        if !policy.stops_agent() {
            return Ok(());
        }
        let reason = format!("activity `{activity}` failed in cycle {cycle}: {failure}");
        self.enters_safe_state = Some(policy == FailurePolicy::SafeState);
        Err(reason)
    }

    /// Whether the body enters its safe state when the agent stops because of this chart.
    pub fn requires_safe_state(&mut self) -> bool {
        let of_policy = self.policy() == FailurePolicy::SafeState;
        self.enters_safe_state.take().unwrap_or(of_policy)
    }
}
