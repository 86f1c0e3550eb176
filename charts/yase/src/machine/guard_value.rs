//! The guards that a machine considers at present, for inspection.

use crate::host::Host;
use crate::ids::ScopeId;
use crate::statechart::TransitionId;

use super::Machine;
use super::view::ScopeView;

/// A guard that was evaluated for inspection.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub struct GuardValue {
    /// The transition, or the segment of a compound transition, with the guard.
    pub transition: TransitionId,
    /// The scope whose blackboard it reads.
    pub scope: ScopeId,
    /// Whether it holds; none if it has no value.
    pub holds: Option<bool>,
}

impl Machine {
    /// Evaluates the guards of the transitions that are considered at present, see
    /// [`Statechart::is_considered`](crate::Statechart::is_considered). A segment out of a
    /// connector follows the one into it. Nothing changes, and guards without a value are not
    /// reported.
    pub fn guard_values<H: Host>(&self, host: &H) -> Vec<GuardValue> {
        let statechart = self.chart.statechart();
        let mut values = Vec::new();
        for guard in &self.chart.guards {
            let scope = guard.region;
            let root = self.chart.region_node(scope);
            let is_open = root.is_some_and(|root| self.is_active(root));
            let source = statechart.transition(guard.transition).source;
            if is_open && statechart.is_considered(source, |node| self.is_active(node)) {
                let view = ScopeView { chart: &self.chart, run: &self.run, host, region: scope };
                let holds = guard.guard.evaluate(&view).ok();
                values.push(GuardValue { transition: guard.transition, scope, holds });
            }
        }
        values
    }
}
