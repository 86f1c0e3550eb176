//! Leaving states.

use std::cmp::Reverse;

use crate::compile::{NodeIndex, Owner};
use crate::host::Host;
use crate::ids::ActionLocation;
use crate::machine::actions::ActionContext;
use crate::machine::activities::{ActivityState, InvocationPhase};
use crate::machine::step::Macrostep;
use crate::semantics::{ExitOrder, TimerScope};
use crate::statechart::NodeKind;

impl<H: Host> Macrostep<'_, H> {
    /// Leaves all active nodes from one index to another, innermost first. The values of HISTORYs
    /// are recorded before any exit action.
    pub(crate) fn leave_between(&mut self, first: NodeIndex, last: NodeIndex) {
        self.run.record_histories(self.chart, first, last);
        if self.semantics().exits == ExitOrder::Forward {
            let mut next = self.run.active.next(first.index(), last.index());
            while let Some(index) = next {
                self.leave(NodeIndex(index as u32));
                next = self.run.active.next(index + 1, last.index());
            }
            return;
        }
        self.collect_between(first, last);
        self.leave_collected();
    }

    /// Collects all active nodes from one index to another for leaving.
    pub(crate) fn collect_between(&mut self, first: NodeIndex, last: NodeIndex) {
        let mut next = self.run.active.next(first.index(), last.index());
        while let Some(index) = next {
            self.run.leaving.push(NodeIndex(index as u32));
            next = self.run.active.next(index + 1, last.index());
        }
    }

    /// Leaves the collected nodes, in the order that the semantics specifies.
    pub(crate) fn leave_collected(&mut self) {
        let layout = &self.chart.layout;
        match self.semantics().exits {
            ExitOrder::Forward => self.run.leaving.sort_unstable(),
            ExitOrder::ReverseDocument => {
                self.run.leaving.sort_unstable_by_key(|&node| Reverse(layout.rank(node)));
            }
        }
        // transitions that arrive in one place may leave the same states
        self.run.leaving.dedup();
        let mut index = 0;
        while let Some(&node) = self.run.leaving.get(index) {
            self.leave(node);
            index += 1;
        }
        self.run.leaving.clear();
    }

    #[inline(never)]
    fn leave(&mut self, node: NodeIndex) {
        let state = &self.chart.states[node.index()];
        if let Some(activity) = state.activity {
            self.release_activity(node, activity);
        }
        let scene = ActionContext {
            location: ActionLocation::Exit(self.chart.layout.node(node)),
            region: state.region,
            owner: Owner::None,
        };
        self.perform(&state.exit, scene);
        self.run.active.remove(node.index());
        self.run.active_leaves.remove(node.index());
        if state.kind == NodeKind::Start {
            self.run.waiting_starts.remove(node.index());
        }
        self.run.forget_completion(self.chart, node);
        if self.semantics().timers == TimerScope::State {
            self.run.release_timers(self.chart, node);
        }
        if self.run.log.wanted {
            self.run.log.exits.push(self.chart.layout.node(node));
        }
    }

    /// Ends the activity of a state that is left: one that waits for the next call is stopped; a
    /// running one is interrupted; one whose state was entered in the same micro-step does not
    /// start.
    fn release_activity(&mut self, node: NodeIndex, activity: usize) {
        let slot = self.run.activities.slot(activity);
        let activation = self.run.activation(self.chart, node, slot);
        match slot.phase {
            InvocationPhase::Ongoing => self.host.stop(activation),
            InvocationPhase::Running if !slot.cancelled => self.host.cancel(activation),
            _ => {}
        }
        self.run.activities.set(activity, ActivityState { phase: InvocationPhase::Idle, ..slot });
        if self.run.running.contains(node.index()) {
            self.run.unlock(self.chart, node);
        }
    }
}
