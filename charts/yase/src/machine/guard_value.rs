//! The guards that a machine considers at present, for inspection.

use crate::host::Host;
use crate::ids::ScopeId;
use crate::statechart::{NodeId, NodeKind, TransitionId};

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
    /// Evaluates the guards of the transitions out of active states, and of the segments out of
    /// conditions, junctions and choices in active composites. A segment out of a connector follows
    /// the one into it. Nothing changes, and guards without a value are not reported.
    pub fn guard_values<H: Host>(&self, host: &H) -> Vec<GuardValue> {
        let statechart = self.chart.statechart();
        let is_considered = |source: NodeId| {
            let node = statechart.node(source);
            let branches = matches!(node.kind, NodeKind::Condition | NodeKind::Junction | NodeKind::Choice);
            self.is_active(source) || branches && node.parent.is_some_and(|parent| self.is_active(parent))
        };
        let mut values = Vec::new();
        for guard in &self.chart.guards {
            let scope = guard.region;
            let root = self.chart.region_node(scope);
            let is_open = root.is_some_and(|root| self.is_active(root));
            if is_open && is_considered(statechart.transition(guard.transition).source) {
                let view = ScopeView { chart: &self.chart, run: &self.run, host, region: scope };
                let holds = guard.guard.evaluate(&view).ok();
                values.push(GuardValue { transition: guard.transition, scope, holds });
            }
        }
        values
    }
}
