//! A chart of an agent in simulated time: activities are called at once, and their results take
//! effect when their declared duration has elapsed.

use narukom::Timestamp;
use yase::{MachineErrorKind, NodeId};

use super::agent_update::{AgentStatus, ChartStatus};
use super::call_meter::CallMeter;
use super::clock::RunClock;
use super::cycle_recorder::CycleRecorder;
use super::free_loop::{LOOP_REMEDY, RecentCalls};
use monas_core::chart_runner::{ActivityCall, AgentDefaults, ChartDriver, ChartError, ChartRunner, Dispatch};
use monas_core::frequency::Frequency;
use monas_core::monitors::PropertyViolation;
use monas_core::records::Delivery;
use monas_core::statistics::Timing;

/// A larger number of calls at one time is considered a livelock of activities that wake each
/// other.
const MAX_CALLS: u32 = 10_000;

/// A chart of an agent in simulated time.
pub(crate) struct SimulatedChart {
    pub(crate) runner: ChartRunner,
    calls: CallCount,
    meter: CallMeter,
    timing: Timing,
}

/// The calls at one time.
#[derive(Default)]
struct CallCount {
    at: Timestamp,
    count: u32,
    recent: RecentCalls,
}

struct SimulatedDriver<'a> {
    recorder: &'a mut CycleRecorder,
    calls: &'a mut CallCount,
    meter: &'a mut CallMeter,
    timing: &'a mut Timing,
}

impl ChartDriver for SimulatedDriver<'_> {
    fn call(&mut self, call: ActivityCall, now: Timestamp) -> Dispatch {
        if !self.calls.add(call.activation.node, now) {
            let reason = format!("activities are called more than {MAX_CALLS} times at one time");
            return Dispatch::Refused(Some(call), reason);
        }
        let until = now + call.duration;
        Dispatch::Finished(self.meter.call(call), until)
    }

    fn record_step(&mut self, now: Timestamp, delivered: &[Delivery], violations: &[PropertyViolation]) {
        self.recorder.record_step(now, delivered.iter().cloned(), violations);
    }

    fn step_ended(&mut self, _: &mut ChartRunner, _: Timestamp) {
        self.meter.measure(self.timing);
    }

    fn cycle(&self) -> u64 {
        self.recorder.number()
    }
}

impl CallCount {
    /// Adds a call. Returns false if there are too many at this time.
    fn add(&mut self, node: NodeId, now: Timestamp) -> bool {
        if self.at != now {
            (self.at, self.count) = (now, 0);
        }
        self.count += 1;
        self.recent.add(node);
        self.count <= MAX_CALLS
    }

    /// Why the agent stops, if its chart has failed because calls lead to calls at one time.
    fn loop_reason(&self, runner: &ChartRunner, error: &ChartError) -> Option<String> {
        let is_endless = match error {
            ChartError::Step { error, .. } => error.kind() == MachineErrorKind::NeverAdvances,
            ChartError::Stop(_) => self.count > MAX_CALLS,
        };
        if !is_endless || !self.recent.is_filled_by(self.count) {
            return None;
        }
        let (chart, states, at) = (runner.name(), runner.state_names(&self.recent.states()), self.at);
        Some(format!(
            "`{chart}` loops without a wait: {states}, {} calls at {at}; {LOOP_REMEDY}, or declare how long a call takes",
            self.count
        ))
    }
}

impl SimulatedChart {
    /// Starts a chart.
    pub(crate) fn new(mut runner: ChartRunner, defaults: AgentDefaults, now: Timestamp) -> SimulatedChart {
        runner.set_defaults(defaults);
        runner.start(now);
        runner.skip_ticks(now);
        let (calls, meter, timing) = (CallCount::default(), CallMeter::default(), Timing::default());
        SimulatedChart { runner, calls, meter, timing }
    }

    /// The same, measured by a clock if there is one.
    pub(crate) fn measured(self, clock: Option<RunClock>) -> SimulatedChart {
        SimulatedChart { meter: CallMeter::new(clock), ..self }
    }

    /// From now on measures steps and calls by a clock.
    pub(crate) fn measure(&mut self, clock: RunClock) {
        self.meter = CallMeter::new(Some(clock));
    }

    /// The durations of its steps.
    pub(crate) fn timing(&self) -> &Timing {
        &self.timing
    }

    /// Sets the frequency of the agent.
    pub(crate) fn set_frequency(&mut self, frequency: Frequency, now: Timestamp) {
        self.runner.update_defaults(|defaults| defaults.frequency = Some(frequency), now);
        self.runner.skip_ticks(now);
    }

    pub(crate) fn status(&self) -> ChartStatus {
        let status = if self.runner.is_over() { AgentStatus::Stopped } else { AgentStatus::Running };
        ChartStatus { active: self.runner.active_states(), status }
    }

    pub(crate) fn due(&self, now: Timestamp) -> Timestamp {
        if self.runner.is_over() { Timestamp::MAX } else { self.runner.due(now) }
    }

    /// Executes everything that is due at this time.
    ///
    /// # Errors
    /// Why the agent must stop.
    pub(crate) fn run(&mut self, now: Timestamp, recorder: &mut CycleRecorder) -> Result<(), String> {
        self.act(recorder, |runner, driver| runner.run_until_stable(driver, now))
    }

    /// Makes one step if one is due.
    ///
    /// # Errors
    /// Why the agent must stop.
    pub(crate) fn step_once(&mut self, now: Timestamp, recorder: &mut CycleRecorder) -> Result<(), String> {
        self.act(recorder, |runner, driver| runner.step_once(driver, now))
    }

    fn act(
        &mut self,
        recorder: &mut CycleRecorder,
        act: impl FnOnce(&mut ChartRunner, &mut SimulatedDriver<'_>) -> Result<(), ChartError>,
    ) -> Result<(), String> {
        let SimulatedChart { runner, calls, meter, timing } = self;
        meter.begin();
        let result = act(runner, &mut SimulatedDriver { recorder, calls, meter, timing });
        result.map_err(|error| calls.loop_reason(runner, &error).unwrap_or_else(|| error.to_string()))
    }
}
