//! Leaving states.

use std::cmp::Reverse;

use crate::chart::{Owner, Place};
use crate::host::{ActionPlace, Host};
use crate::machine::act::Scene;
use crate::machine::activities::Phase;
use crate::machine::step::Step;
use crate::semantics::{ExitOrder, TimerScope};
use crate::statechart::NodeKind;

impl<H: Host> Step<'_, H> {
    /// Leaves all that is active from one place to another, innermost first. What HISTORYs remember is noted before anything happens.
    pub(super) fn leave_between(&mut self, first: Place, last: Place) {
        self.run.record_histories(self.chart, first, last);
        if self.semantics().exits == ExitOrder::Forward {
            let mut next = self.run.active.next(first.index(), last.index());
            while let Some(index) = next {
                self.leave(Place(index as u32));
                next = self.run.active.next(index + 1, last.index());
            }
            return;
        }
        self.collect_between(first, last);
        self.leave_collected();
    }

    /// Adds all that is active from one place to another to what is to be left.
    pub(super) fn collect_between(&mut self, first: Place, last: Place) {
        let mut next = self.run.active.next(first.index(), last.index());
        while let Some(index) = next {
            self.run.leaving.push(Place(index as u32));
            next = self.run.active.next(index + 1, last.index());
        }
    }

    /// Leaves what was collected, in the order that is meant.
    pub(super) fn leave_collected(&mut self) {
        let layout = &self.chart.layout;
        match self.semantics().exits {
            ExitOrder::Forward => self.run.leaving.sort_unstable(),
            ExitOrder::ReverseDocument => {
                self.run.leaving.sort_unstable_by_key(|&place| Reverse(layout.rank(place)));
            }
        }
        let mut index = 0;
        while let Some(&place) = self.run.leaving.get(index) {
            self.leave(place);
            index += 1;
        }
        self.run.leaving.clear();
    }

    #[inline(never)]
    fn leave(&mut self, place: Place) {
        let state = &self.chart.states[place.index()];
        if let Some(activity) = state.activity {
            self.release_activity(place, activity);
        }
        let scene = Scene {
            place: ActionPlace::Exit(self.chart.layout.node(place)),
            region: state.region,
            owner: Owner::None,
        };
        self.perform(&state.exit, scene);
        self.run.active.remove(place.index());
        self.run.tips.remove(place.index());
        if state.kind == NodeKind::Start {
            self.run.waiting_starts.remove(place.index());
        }
        self.run.forget_completion(self.chart, place);
        if self.semantics().timers == TimerScope::State {
            self.run.release_timers(self.chart, place);
        }
        if self.run.log.wanted {
            self.run.log.exits.push(self.chart.layout.node(place));
        }
    }

    /// The activity of a state that is left: one that waited to be called again is told; one that runs can only be here to be
    /// interrupted, or since its state was entered in the same micro-step: then it does not start.
    fn release_activity(&mut self, place: Place, activity: usize) {
        let slot = self.run.activities.slot(activity);
        let activation = self.run.activation(self.chart, place, slot);
        match slot.phase {
            Phase::Ongoing => self.host.stop(activation),
            Phase::Running if !slot.cancelled => self.host.cancel(activation),
            _ => {}
        }
        self.run.activities.slot_mut(activity).phase = Phase::Idle;
        if self.run.running.contains(place.index()) {
            self.run.unlock(self.chart, place);
        }
    }
}
