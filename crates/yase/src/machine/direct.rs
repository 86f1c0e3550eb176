//! The short way of a step.
//!
//! It does what selecting and firing do, for steps in which most of that has nothing to do: nobody traces, no activity runs, nothing is held,
//! deferred, raised or pending, and out of the active states lead only ways that are direct (see `chart::Direct`). When one of these does not
//! hold, the step goes on the long way, from where it is.

use crate::chart::{Direct, DirectPlace, DirectWay, Owner, Place};
use crate::expression::EventId;
use crate::host::{ActionPlace, Host};
use crate::machine::Status;
use crate::machine::act::Scene;
use crate::machine::errors::Fault;
use crate::machine::step::Step;

impl<'a, H: Host> Step<'a, H> {
    /// Takes arrived events the short way, as long as it serves. Says whether the chart is at rest then.
    #[inline]
    pub(super) fn take_directly(&mut self) -> Result<bool, Fault> {
        let Some(direct) = &self.chart.direct else { return Ok(false) };
        if self.run.log.wanted || self.run.failure.is_some() {
            return Ok(false);
        }
        while self.serves(direct) {
            let Some(&occurrence) = self.run.queues.first_arrived() else { return Ok(true) };
            self.admit()?;
            self.host.offered(occurrence.event, occurrence.is_known, occurrence.token);
            self.choose(direct, occurrence.event);
            self.run.queues.next_arrived();
            if self.run.selection.ways.is_empty() {
                self.run.selection.clear();
                self.keep(occurrence);
            } else {
                self.fire_directly(direct);
            }
        }
        Ok(false)
    }

    /// States with activities, and those that may go on without an event, are detours: so nothing runs, and nothing waits but events.
    #[inline(always)]
    fn serves(&self, direct: &Direct) -> bool {
        let run = &*self.run;
        run.active.first_word() & direct.detours == 0
            && run.queues.only_arrived_wait()
            && run.pending.is_empty()
            && run.status == Status::Running
    }

    /// Selects transitions: from the innermost states outward, not where all that is active inside has found one, and none that leaves
    /// what an earlier one leaves.
    #[inline(always)]
    fn choose(&mut self, direct: &'a Direct, event: EventId) {
        let active = self.run.active.first_word();
        let (mut closed, mut left, mut last_key, mut in_order) = (0, 0, 0, true);
        self.run.selection.ways.clear();
        let mut sources = active & direct.sources;
        while sources != 0 {
            let place = &direct.places[sources.trailing_zeros() as usize];
            sources &= sources - 1;
            let open = active & direct.leaves & place.inside & !closed;
            let Some(index) = self.open_way_for(direct, place, open, event) else { continue };
            let way = &direct.ways[index];
            closed |= place.inside;
            if way.exits & left == 0 {
                left |= way.exits;
                in_order &= last_key <= way.key;
                last_key = way.key;
                self.run.selection.ways.push(index);
            }
        }
        if !in_order {
            self.run.selection.ways.sort_unstable_by_key(|&index| direct.ways[index].key);
        }
    }

    /// The first way out of a state that an event opens, if something active inside has found none yet.
    #[inline(always)]
    fn open_way_for(
        &mut self,
        direct: &Direct,
        place: &DirectPlace,
        open: u64,
        event: EventId,
    ) -> Option<usize> {
        place.ways.clone().find(|&index| {
            let way = &direct.ways[index];
            way.event == event && open != 0 && way.guard.is_none_or(|guard| self.holds(guard as usize))
        })
    }

    /// A way whose source another has left is not taken, nor one after the end.
    #[inline(always)]
    fn fire_directly(&mut self, direct: &Direct) {
        let mut index = 0;
        while let Some(&number) = self.run.selection.ways.get(index) {
            let way = &direct.ways[number];
            if self.run.active.first_word() & way.source != 0 && self.run.status == Status::Running {
                self.count_fired(way.compound);
                self.go(direct, way);
            }
            index += 1;
        }
        let active = self.run.active.first_word();
        self.run.tips.set_first_word(active & direct.leaves);
    }

    #[inline(always)]
    fn go(&mut self, direct: &Direct, way: &DirectWay) {
        let mut exits = self.run.active.first_word() & way.exits;
        while exits != 0 {
            let place = Place(exits.trailing_zeros());
            exits &= exits - 1;
            self.leave_directly(place);
        }
        if way.acts {
            self.do_actions(&self.chart.compounds[way.compound.0 as usize]);
        }
        for &place in &way.entries {
            match direct.plain >> place.0 & 1 {
                1 => self.enter_directly(place),
                _ => self.enter(place),
            }
        }
    }

    #[inline(always)]
    fn leave_directly(&mut self, place: Place) {
        let state = &self.chart.states[place.index()];
        if !state.exit.is_empty() {
            let at = ActionPlace::Exit(self.chart.layout.node(place));
            self.perform(&state.exit, Scene { place: at, region: state.region, owner: Owner::None });
        }
        let active = self.run.active.first_word();
        self.run.active.set_first_word(active & !(1 << place.0));
    }

    #[inline(always)]
    fn enter_directly(&mut self, place: Place) {
        let state = &self.chart.states[place.index()];
        let active = self.run.active.first_word();
        self.run.active.set_first_word(active | 1 << place.0);
        if !state.entry.is_empty() {
            let at = ActionPlace::Entry(self.chart.layout.node(place));
            self.perform(&state.entry, Scene { place: at, region: state.region, owner: Owner::State(place) });
        }
    }
}
