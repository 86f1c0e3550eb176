//! Deadlines.

use crate::chart::Place;
use crate::expression::TimerState;
use crate::machine::chooser::Chooser;
use crate::moment::Moment;

/// The timers of a chart, by their number in it.
#[derive(Clone, Debug)]
pub(super) struct Timers {
    pub(super) slots: Box<[Option<Deadline>]>,
    /// The earliest deadline whose expiry has not been noticed.
    next: Option<Moment>,
}

#[derive(Clone, Copy, Debug)]
pub(super) struct Deadline {
    pub(super) moment: Moment,
    /// Whether its expiry has been noticed.
    pub(super) expired: bool,
    /// The state whose end is its end.
    pub(super) owner: Option<Place>,
}

impl Timers {
    pub(super) fn new(count: usize) -> Timers {
        Timers { slots: vec![None; count].into(), next: None }
    }

    /// Becomes equal to those of another machine of the same chart.
    pub(super) fn copy_from(&mut self, other: &Timers) {
        self.slots.copy_from_slice(&other.slots);
        self.next = other.next;
    }

    pub(super) fn reset(&mut self) {
        self.slots.fill(None);
        self.next = None;
    }

    /// Sets a deadline, and says whether the expiry of the one before had been noticed.
    pub(super) fn set(&mut self, timer: usize, moment: Moment) -> bool {
        let Some(slot) = self.slots.get_mut(timer) else { return false };
        let before = slot.replace(Deadline { moment, expired: false, owner: None });
        self.look_again();
        before.is_some_and(|before| before.expired)
    }

    /// A timer that is set belongs to a state.
    pub(super) fn bind(&mut self, timer: usize, owner: Place) {
        if let Some(Some(deadline)) = self.slots.get_mut(timer) {
            deadline.owner = Some(owner);
        }
    }

    /// Forgets a timer that belongs to a state, and says which; none if there is none left.
    pub(super) fn release(&mut self, owner: Place) -> Option<usize> {
        let owned = |slot: &Option<Deadline>| slot.is_some_and(|deadline| deadline.owner == Some(owner));
        let timer = self.slots.iter().position(owned)?;
        self.slots[timer] = None;
        self.look_again();
        Some(timer)
    }

    pub(super) fn state(&self, timer: usize, now: Moment) -> TimerState {
        match self.slots.get(timer) {
            Some(Some(deadline)) if deadline.moment <= now => TimerState::Over,
            Some(Some(_)) => TimerState::Running,
            _ => TimerState::Unset,
        }
    }

    /// The earliest deadline whose expiry has not been noticed.
    pub(super) fn next_deadline(&self) -> Option<Moment> {
        self.next
    }

    /// Notices the earliest expiry up to now that was not noticed; of several at one moment, that of the first timer or as is chosen.
    pub(super) fn expire(&mut self, now: Moment, chooser: &mut Chooser) -> Option<usize> {
        let next = self.next.filter(|&next| next <= now)?;
        let is_due = |slot: &Option<Deadline>| slot.is_some_and(|at| !at.expired && at.moment == next);
        let chosen = match chooser.is_declared() {
            true => 0,
            false => chooser.choose(self.slots.iter().filter(|slot| is_due(slot)).count()),
        };
        let mut due = (0..self.slots.len()).filter(|&timer| is_due(&self.slots[timer]));
        let timer = due.nth(chosen)?;
        self.slots[timer].as_mut()?.expired = true;
        self.look_again();
        Some(timer)
    }

    /// Some deadlines have changed.
    pub(super) fn look_again(&mut self) {
        self.next = self.earliest().map(|(moment, _)| moment);
    }

    fn earliest(&self) -> Option<(Moment, usize)> {
        let waiting = |slot: &Option<Deadline>| slot.filter(|deadline| !deadline.expired);
        let deadlines = self.slots.iter().enumerate();
        deadlines.filter_map(|(timer, slot)| Some((waiting(slot)?.moment, timer))).min()
    }
}
