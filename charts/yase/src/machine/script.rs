//! The machine during an action in the host's own language.

use crate::compile::CompiledChart;
use crate::machine::machine_state::MachineState;
use crate::script::{ActiveStates, ScriptMachine};
use crate::statechart::NodeId;
use crate::timestamp::Timestamp;

/// A chart and its state, lent to a script.
#[derive(Debug)]
pub(crate) struct ScriptedMachine<'a> {
    pub(crate) chart: &'a CompiledChart,
    pub(crate) run: &'a mut MachineState,
}

impl ScriptMachine for ScriptedMachine<'_> {
    fn active_states(&self) -> ActiveStates<'_> {
        ActiveStates { chart: self.chart, active: &self.run.active }
    }

    fn is_complete(&self, node: NodeId) -> bool {
        let index = self.chart.layout.find_index(node);
        index.is_some_and(|index| self.run.is_active(index) && self.run.is_complete(self.chart, index))
    }

    fn now(&self) -> Timestamp {
        self.run.now
    }

    fn raise(&mut self, name: &str, token: u64) -> bool {
        let (event, is_known) = self.chart.event(name);
        self.run.raise(self.chart, event, is_known, token);
        is_known
    }
}
