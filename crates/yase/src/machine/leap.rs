//! The shortest way of a micro-step: what an event does to an innermost state is looked up (see `chart::Leaps`).

use crate::chart::{Cell, Does, Leap, More, Reactions};
use crate::expression::EventId;
use crate::host::Host;
use crate::machine::Status;
use crate::machine::direct::ShortStep;

impl<'a, H: Host> ShortStep<'a, H> {
    /// Offers the first event that has arrived, if what it does can be looked up; false if not. Nothing has happened then.
    #[inline(always)]
    pub(super) fn leap(&mut self, event: EventId) -> bool {
        let leaves = self.run.active.first_word() & self.direct.leaves;
        let Some(reactions) = self.direct.leaps.of(event, leaves) else { return false };
        if !leaves.is_power_of_two() {
            self.run.queues.drop_arrived();
            self.leap_together(reactions, leaves);
            return true;
        }
        match self.find(reactions.cell(leaves)) {
            Some(leap) => {
                self.run.queues.drop_arrived();
                self.take(leap);
                self.note_tips();
            }
            None => self.keep(),
        }
        true
    }

    /// What an event that does not queue does to these innermost states; false if nothing.
    #[inline(always)]
    pub(super) fn leap_from(&mut self, reactions: &Reactions, leaves: u64) -> bool {
        if !leaves.is_power_of_two() {
            self.leap_together(reactions, leaves);
            return true;
        }
        let Some(leap) = self.find(reactions.cell(leaves)) else { return false };
        self.take(leap);
        self.note_tips();
        true
    }

    /// The same for states that are active beside each other: as none has to do with another, all that is found happens.
    #[inline(never)]
    fn leap_together(&mut self, reactions: &Reactions, leaves: u64) {
        let direct = self.direct;
        let mut rest = reactions.reacting(leaves);
        while rest != 0 && self.run.status == Status::Running {
            let cell = reactions.cell(rest);
            rest &= rest - 1;
            if let Some(leap) = direct.leaps.leaps.get(usize::from(cell.0)) {
                self.take(leap);
            }
        }
        self.note_tips();
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
