//! The timers of a chart.

use crate::compile::NodeIndex;
use crate::expression::TimerState;
use crate::machine::chooser::Chooser;
use crate::timestamp::Timestamp;

/// The timers of a chart, by index.
#[derive(Clone, Debug)]
pub(crate) struct TimerTable {
    pub(crate) slots: Box<[Option<ArmedTimer>]>,
    /// The earliest deadline whose expiry has not been processed.
    next: Option<Timestamp>,
}

#[derive(Clone, Copy, Debug)]
pub(crate) struct ArmedTimer {
    pub(crate) moment: Timestamp,
    /// Whether its expiry has been processed.
    pub(crate) expired: bool,
    /// The state on whose exit it is discarded.
    pub(crate) owner: Option<NodeIndex>,
}

impl TimerTable {
    pub(crate) fn new(count: usize) -> TimerTable {
        TimerTable { slots: vec![None; count].into(), next: None }
    }

    /// Copies the timers of another machine of the same chart.
    pub(crate) fn copy_from(&mut self, other: &TimerTable) {
        self.slots.copy_from_slice(&other.slots);
        self.next = other.next;
    }

    pub(crate) fn reset(&mut self) {
        self.slots.fill(None);
        self.next = None;
    }

    /// Sets a deadline, and returns whether the previous expiry had been processed.
    pub(crate) fn set(&mut self, timer: usize, moment: Timestamp) -> bool {
        let Some(slot) = self.slots.get_mut(timer) else { return false };
        let before = slot.replace(ArmedTimer { moment, expired: false, owner: None });
        match before {
            Some(before) if !before.expired && Some(before.moment) == self.next => self.recompute_next(),
            _ => self.next = Some(self.next.map_or(moment, |next| next.min(moment))),
        }
        before.is_some_and(|before| before.expired)
    }

    /// Binds a timer that is set to a state.
    pub(crate) fn bind(&mut self, timer: usize, owner: NodeIndex) {
        if let Some(Some(deadline)) = self.slots.get_mut(timer) {
            deadline.owner = Some(owner);
        }
    }

    /// Discards a timer that belongs to a state, and returns its index; `None` if there is none
    /// left.
    pub(crate) fn release(&mut self, owner: NodeIndex) -> Option<usize> {
        let owned = |slot: &Option<ArmedTimer>| slot.is_some_and(|deadline| deadline.owner == Some(owner));
        let timer = self.slots.iter().position(owned)?;
        self.slots[timer] = None;
        self.recompute_next();
        Some(timer)
    }

    #[inline]
    pub(crate) fn state(&self, timer: usize, now: Timestamp) -> TimerState {
        match self.slots.get(timer) {
            Some(Some(deadline)) if deadline.moment <= now => TimerState::Over,
            Some(Some(_)) => TimerState::Running,
            _ => TimerState::Unset,
        }
    }

    /// The earliest deadline whose expiry has not been processed.
    #[inline]
    pub(crate) fn next_deadline(&self) -> Option<Timestamp> {
        self.next
    }

    /// Processes the earliest unprocessed expiry up to `now`; among several at one time, the first
    /// timer or the one that the chooser selects.
    pub(crate) fn expire(&mut self, now: Timestamp, chooser: &mut Chooser) -> Option<usize> {
        let next = self.next.filter(|&next| next <= now)?;
        let is_due = |slot: &Option<ArmedTimer>| slot.is_some_and(|at| !at.expired && at.moment == next);
        let chosen = match chooser.is_declared() {
            true => 0,
            false => chooser.choose(self.slots.iter().filter(|slot| is_due(slot)).count()),
        };
        let mut due = (0..self.slots.len()).filter(|&timer| is_due(&self.slots[timer]));
        let timer = due.nth(chosen)?;
        self.slots[timer].as_mut()?.expired = true;
        self.recompute_next();
        Some(timer)
    }

    /// Updates the earliest deadline after a change.
    pub(crate) fn recompute_next(&mut self) {
        let waiting = self.slots.iter().flatten().filter(|timer| !timer.expired);
        self.next = waiting.map(|timer| timer.moment).min();
    }
}
