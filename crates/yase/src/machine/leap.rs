//! The shortest way of a micro-step: what an event does to an innermost state is looked up (see `chart::Leaps`).

use crate::chart::{Cell, Does, Leap, More};
use crate::expression::EventId;
use crate::host::Host;
use crate::machine::Status;
use crate::machine::direct::ShortStep;

impl<'a, H: Host> ShortStep<'a, H> {
    /// Offers the first event that has arrived, if what it does can be looked up; false if not. Nothing has happened then.
    #[inline(always)]
    pub(super) fn leap(&mut self, event: EventId) -> bool {
        let direct = self.direct;
        let Some(cells) = direct.leaps.cells.get(event.0 as usize) else { return false };
        let leaves = self.run.active.first_word() & direct.leaves;
        if !leaves.is_power_of_two() {
            return self.leap_together(event, leaves);
        }
        let cell = cells[leaves.trailing_zeros() as usize % cells.len()];
        if cell == Cell::ENTANGLED {
            return false;
        }
        match self.find(cell) {
            Some(leap) => {
                self.run.queues.drop_arrived();
                self.take(leap);
                self.note_tips();
            }
            None => self.keep(),
        }
        true
    }

    /// The same for states that are active beside each other. Only if nothing has to do with another, all that is found happens.
    #[inline(never)]
    fn leap_together(&mut self, event: EventId, leaves: u64) -> bool {
        let direct = self.direct;
        let Some(cells) = direct.leaps.cells.get(event.0 as usize) else { return false };
        let (mut rest, mut is_any) = (leaves, false);
        while rest != 0 {
            let cell = cells[rest.trailing_zeros() as usize % cells.len()];
            if cell == Cell::ENTANGLED {
                return false;
            }
            is_any |= cell != Cell::NONE;
            rest &= rest - 1;
        }
        if !is_any {
            return false;
        }
        self.run.queues.drop_arrived();
        let mut rest = leaves;
        while rest != 0 && self.run.status == Status::Running {
            let cell = cells[rest.trailing_zeros() as usize % cells.len()];
            rest &= rest - 1;
            if let Some(leap) = direct.leaps.leaps.get(usize::from(cell.0)) {
                self.take(leap);
            }
        }
        self.note_tips();
        true
    }

    /// What an event does to the one innermost state that is active; false if nothing.
    #[inline(always)]
    pub(super) fn leap_from(&mut self, cell: Cell) -> bool {
        let Some(leap) = self.find(cell) else { return false };
        self.take(leap);
        self.note_tips();
        true
    }

    /// The first transition whose guard holds.
    #[inline(always)]
    fn find(&mut self, cell: Cell) -> Option<&'a Leap> {
        let direct = self.direct;
        let leap = direct.leaps.leaps.get(usize::from(cell.0))?;
        match leap.guard {
            None => Some(leap),
            Some(guard) => self.find_guarded(leap, guard),
        }
    }

    #[inline(never)]
    fn find_guarded(&mut self, mut leap: &'a Leap, mut guard: u32) -> Option<&'a Leap> {
        let direct = self.direct;
        while !self.holds::<false>(guard) {
            leap = direct.leaps.leaps.get(usize::from(leap.otherwise.0))?;
            let Some(next) = leap.guard else { break };
            guard = next;
        }
        Some(leap)
    }

    #[inline(always)]
    fn take(&mut self, leap: &Leap) {
        self.transitions += 1;
        self.run.bound.remember(leap.compound);
        let active = self.run.active.first_word();
        let moves = self.direct.leaps.moves.get(leap.moves.start as usize..leap.moves.end as usize);
        for step in moves.unwrap_or_default() {
            self.run.active.set_first_word(active & step.stays | step.entered);
            match step.does {
                Does::Script(script, at) => self.perform::<false>(script, step.region, at),
                Does::More(more) => self.do_more(more, leap),
            }
        }
        self.run.active.set_first_word(active & leap.stays | leap.enters);
    }

    #[inline(never)]
    fn do_more(&mut self, more: More, leap: &Leap) {
        let places = &self.direct.places;
        match more {
            More::Effects => self.act_on(leap.compound),
            More::Exit(place) => self.act_at_exit(&places[place.index()], place),
            More::Entry(place) => self.act_at_entry(&places[place.index()], place),
            More::Enter(place) => self.long_way().enter(place),
        }
    }

    /// The innermost active states.
    #[inline(always)]
    fn note_tips(&mut self) {
        let active = self.run.active.first_word();
        self.run.tips.set_first_word(active & self.direct.leaves);
    }
}
