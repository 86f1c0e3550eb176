//! The evaluation context of the expressions of a chart.

use crate::compile::CompiledChart;
use crate::expression::{CallError, EvalContext, MessageSource, ScriptId, TimerId, TimerState};
use crate::host::Host;
use crate::ids::ScopeId;
use crate::machine::machine_state::MachineState;
use crate::script::ActiveStates;
use crate::statechart::NodeId;
use crate::vocabulary::{FieldId, FunctionId, Value};

/// One scope of a running chart.
pub(crate) struct ScopeView<'a, H> {
    pub(crate) chart: &'a CompiledChart,
    pub(crate) run: &'a MachineState,
    pub(crate) host: &'a H,
    pub(crate) region: ScopeId,
}

impl<H: Host> EvalContext for ScopeView<'_, H> {
    fn field(&self, source: &MessageSource, path: &[FieldId]) -> Value<'_> {
        self.host.field(self.region, source, path)
    }

    fn message(&self, source: &MessageSource) -> Value<'_> {
        self.host.message(self.region, source)
    }

    fn call(&self, function: FunctionId, arguments: &[Value<'_>]) -> Result<Value<'_>, CallError> {
        self.host.call(function, arguments)
    }

    fn timer(&self, timer: TimerId) -> TimerState {
        let first = self.chart.regions[self.region.index()].timers;
        self.run.timers.state(first + timer.0 as usize, self.run.now)
    }

    fn script(&self, script: ScriptId) -> Result<bool, CallError> {
        let states = ActiveStates { chart: self.chart, active: &self.run.active };
        self.host.condition(script, self.region, &states)
    }

    fn is_active(&self, state: NodeId) -> bool {
        self.chart.layout.find_index(state).is_some_and(|node| self.run.is_active(node))
    }
}
