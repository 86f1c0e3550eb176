//! The timers of a chart.

use crate::bits::BitSet;
use crate::compile::NodeIndex;
use crate::expression::TimerState;
use crate::machine::chooser::Chooser;
use crate::timestamp::Timestamp;

/// The timers of a chart, by index.
#[derive(Clone, Debug)]
pub(crate) struct TimerTable {
    slots: Box<[Option<ArmedTimer>]>,
    /// The timers that are set, expired or not: few of a large chart.
    armed: BitSet,
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
        TimerTable { slots: vec![None; count].into(), armed: BitSet::new(count), next: None }
    }

    /// Copies the timers of another machine of the same chart.
    pub(crate) fn copy_from(&mut self, other: &TimerTable) {
        for timer in self.armed.members().chain(other.armed.members()) {
            self.slots[timer] = other.slots[timer];
        }
        self.armed.copy_from(&other.armed);
        self.next = other.next;
    }

    pub(crate) fn reset(&mut self) {
        for timer in self.armed.members() {
            self.slots[timer] = None;
        }
        self.armed.clear();
        self.next = None;
    }

    /// A timer that is set.
    #[inline]
    pub(crate) fn slot(&self, timer: usize) -> Option<ArmedTimer> {
        self.slots.get(timer).copied().flatten()
    }

    /// Changes a timer; the caller [updates](TimerTable::recompute_next) the earliest deadline.
    pub(crate) fn set_slot(&mut self, timer: usize, armed: Option<ArmedTimer>) {
        match armed {
            Some(_) => self.armed.insert(timer),
            None => self.armed.remove(timer),
        }
        self.slots[timer] = armed;
    }

    /// The timers that are set, in ascending order.
    pub(crate) fn armed(&self) -> impl Iterator<Item = (usize, ArmedTimer)> {
        self.armed.members().filter_map(|timer| Some((timer, self.slots[timer]?)))
    }

    /// Gives all timers that have not expired the same deadline.
    pub(crate) fn postpone(&mut self, moment: Timestamp) {
        for timer in self.armed.members() {
            if let Some(timer) = self.slots[timer].as_mut().filter(|timer| !timer.expired) {
                timer.moment = moment;
            }
        }
        self.recompute_next();
    }

    /// The memory of the timers, in bytes.
    pub(crate) fn bytes(&self) -> usize {
        size_of_val(&*self.slots)
    }

    /// Sets a deadline, and returns whether the previous expiry had been processed.
    pub(crate) fn set(&mut self, timer: usize, moment: Timestamp) -> bool {
        let Some(slot) = self.slots.get_mut(timer) else { return false };
        let before = slot.replace(ArmedTimer { moment, expired: false, owner: None });
        self.armed.insert(timer);
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
        let (timer, _) = self.armed().find(|(_, deadline)| deadline.owner == Some(owner))?;
        self.set_slot(timer, None);
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
        let is_due = |(_, timer): &(usize, ArmedTimer)| !timer.expired && timer.moment == next;
        let chosen = match chooser.is_declared() {
            true => 0,
            false => chooser.choose(self.armed().filter(is_due).count()),
        };
        let (timer, _) = self.armed().filter(is_due).nth(chosen)?;
        self.slots[timer].as_mut()?.expired = true;
        self.recompute_next();
        Some(timer)
    }

    /// Updates the earliest deadline after a change.
    pub(crate) fn recompute_next(&mut self) {
        let waiting = self.armed().filter(|(_, timer)| !timer.expired);
        self.next = waiting.map(|(_, timer)| timer.moment).min();
    }
}
