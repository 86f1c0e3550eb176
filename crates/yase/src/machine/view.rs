//! The world as an expression of a chart sees it.

use crate::chart::{Chart, RegionId};
use crate::expression::{CallError, Facts, MessageSource, ScriptId, TimerId, TimerState};
use crate::host::Host;
use crate::machine::run::Run;
use crate::machine::script::States;
use crate::statechart::NodeId;
use crate::vocabulary::{FieldId, FunctionId, Value};

/// One blackboard of a running chart.
pub(super) struct View<'a, H> {
    pub(super) chart: &'a Chart,
    pub(super) run: &'a Run,
    pub(super) host: &'a H,
    pub(super) region: RegionId,
}

impl<H: Host> Facts for View<'_, H> {
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
        let states = States { chart: self.chart, active: &self.run.active };
        self.host.condition(script, self.region, &states)
    }

    fn is_active(&self, state: NodeId) -> bool {
        self.chart.layout.place(state).is_some_and(|place| self.run.is_active(place))
    }
}
