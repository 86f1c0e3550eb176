//! The short way of a step.
//!
//! It does what [`select`](super::select), [`step`](super::step) and [`fire`](super::fire) do, for steps in which most of that has nothing to
//! do: nobody traces, no activity runs, nothing is held, deferred, raised or pending, and out of the active states lead only ways that are
//! [direct](crate::chart::Direct). When one of these does not hold, the step goes on the long way, from where it is.

use crate::chart::{CompoundId, Direct, DirectWay, Place};
use crate::host::{ActionPlace, Host};
use crate::machine::queues::Occurrence;
use crate::machine::step::Step;
use crate::machine::{MachineErrorKind, Status};

impl<'a, H: Host> Step<'a, H> {
    /// Takes arrived events the short way, as long as it serves. Says whether the chart is at rest then.
    #[inline]
    pub(super) fn take_directly(&mut self) -> Result<bool, MachineErrorKind> {
        let chart = self.chart;
        let Some(direct) = &chart.direct else { return Ok(false) };
        if self.run.log.wanted {
            return Ok(false);
        }
        while self.serves(direct) {
            let Some(occurrence) = self.run.queues.next_arrived() else { return Ok(true) };
            self.admit()?;
            self.host.offered(occurrence.event, occurrence.is_known, occurrence.token);
            self.choose(direct, &occurrence);
            if self.run.selection.selected.is_empty() {
                self.run.selection.clear();
                self.keep(occurrence);
            } else {
                self.fire_directly(direct);
            }
        }
        Ok(false)
    }

    /// What runs an activity, or may go on without an event, is a detour; so nothing runs.
    #[inline(always)]
    fn serves(&self, direct: &Direct) -> bool {
        let run = &*self.run;
        run.status == Status::Running
            && run.active.first_word() & direct.detours == 0
            && run.queues.is_simple()
            && run.pending.is_empty()
    }

    /// Selects transitions for an event, as [`select`](Step::select) and [`resolve`](Step::resolve) do: from the innermost states outward,
    /// not where all that is active inside has found one, and none that leaves what an earlier one leaves.
    #[inline(always)]
    fn choose(&mut self, direct: &'a Direct, occurrence: &Occurrence) {
        let active = self.run.active.first_word();
        let (mut closed, mut left, mut last_key, mut in_order) = (0, 0, 0, true);
        self.run.selection.selected.clear();
        let mut sources = active & direct.sources;
        while sources != 0 {
            let place = &direct.places[sources.trailing_zeros() as usize];
            sources &= sources - 1;
            let open = active & direct.leaves & place.inside & !closed;
            let Some(way) = self.way(direct.ways(place), open, occurrence) else { continue };
            closed |= place.inside;
            if way.exits & left == 0 {
                left |= way.exits;
                let key = self.compound(way.compound).key;
                in_order &= last_key <= key;
                last_key = key;
                self.run.selection.selected.push(way.compound);
            }
        }
        if !in_order {
            let chart = self.chart;
            self.run.selection.selected.sort_unstable_by_key(|&id| chart.compounds[id.0 as usize].key);
        }
    }

    #[inline(always)]
    fn way<'w>(&mut self, ways: &'w [DirectWay], open: u64, occurrence: &Occurrence) -> Option<&'w DirectWay> {
        for way in ways {
            if way.event == occurrence.event && open != 0 && way.guard.is_none_or(|guard| self.holds(guard as usize)) {
                return Some(way);
            }
        }
        None
    }

    #[inline(always)]
    fn fire_directly(&mut self, direct: &Direct) {
        let mut index = 0;
        while let Some(&id) = self.run.selection.selected.get(index) {
            if self.run.status == Status::Running && self.run.is_active(self.compound(id).source) {
                self.summary.transitions += 1;
                self.run.bound.remember(id);
                self.go(direct, id);
            }
            index += 1;
        }
    }

    #[inline(always)]
    fn go(&mut self, direct: &Direct, id: CompoundId) {
        let chart = self.chart;
        let compound = &chart.compounds[id.0 as usize];
        if let Some((first, last)) = compound.exits {
            let mut exits = self.run.active.first_word() & (u64::MAX >> (63 - last.0)) & (u64::MAX << first.0);
            while exits != 0 {
                let place = exits.trailing_zeros();
                exits &= exits - 1;
                let state = &chart.states[place as usize];
                self.perform(&state.exit, state.region, || ActionPlace::Exit(chart.layout.node(Place(place))));
                self.run.active.remove(place as usize);
            }
        }
        for (segment, effects) in &compound.effects {
            self.perform(effects, compound.region, || ActionPlace::Transition(*segment));
        }
        for &place in &compound.entries {
            let state = &chart.states[place.index()];
            if direct.plain >> place.0 & 1 == 1 {
                self.run.active.insert(place.index());
                self.perform(&state.entry, state.region, || ActionPlace::Entry(chart.layout.node(place)));
            } else {
                self.enter(place);
            }
        }
    }
}
