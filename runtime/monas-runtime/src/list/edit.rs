//! Changes of a list between two cycles. The caller has checked that the positions exist.

use super::{ActivityHealth, ActivityList, ListEntry};
use monas_core::activity_context::calling;
use monas_core::agent::{FailurePolicy, ListedActivity};
use monas_core::call;
use monas_core::parameters::Parameters;

/// A change of a list; positions are counted from 0.
pub(crate) enum ListEdit {
    /// Inserts an activity at a position, or at the end if the list is shorter.
    Insert(usize, ListedActivity),
    /// Stops and removes an activity.
    Remove(usize),
    /// Moves an activity from one position to another.
    Move(usize, usize),
    /// Stops an activity and puts another in its place.
    Replace(usize, ListedActivity),
    /// Configures an activity with other parameters.
    Configure(usize, Parameters),
    /// Sets the failure policy of an activity.
    SetPolicy(usize, FailurePolicy),
}

impl ActivityList {
    pub(crate) fn edit(&mut self, edit: ListEdit) {
        let count = self.entries.len();
        match edit {
            ListEdit::Insert(place, listed) => {
                let entry = self.entry(listed);
                self.entries.insert(place.min(count), entry);
            }
            ListEdit::Remove(place) if place < count => {
                self.end(place);
                self.entries.remove(place);
            }
            ListEdit::Move(from, to) if from < count => {
                let entry = self.entries.remove(from);
                self.entries.insert(to.min(count - 1), entry);
            }
            ListEdit::Replace(place, listed) if place < count => {
                self.end(place);
                self.entries[place] = self.entry(listed);
            }
            ListEdit::Configure(place, parameters) if place < count => {
                let ListEntry { name, activity, .. } = &mut self.entries[place];
                call::configure_again(name, &mut **activity, &parameters);
            }
            ListEdit::SetPolicy(place, policy) if place < count => self.entries[place].policy = Some(policy),
            // No such position.
            _ => {}
        }
    }

    fn entry(&self, listed: ListedActivity) -> ListEntry {
        ListEntry::new(listed, self.blackboard.hub().host(), &self.agent)
    }

    pub(crate) fn set_policy(&mut self, policy: FailurePolicy) {
        self.policy = policy;
    }

    /// Starts every activity again before its next call, after the list was stopped.
    pub(crate) fn restart(&mut self) {
        self.stopped = None;
        self.entries.iter_mut().for_each(|entry| entry.health = ActivityHealth::new());
    }

    /// Stops a running activity; its outputs are published with the next cycle.
    pub(crate) fn end(&mut self, place: usize) {
        let entry = &mut self.entries[place];
        if let ActivityHealth::Up = entry.health
            && let Err(failure) = calling(&entry.caller, self.cycles, || {
                call::stop(entry.activity.as_mut(), &mut self.blackboard)
            })
        {
            let robot = self.blackboard.hub().host();
            tracing::error!(%robot, agent = %self.agent, activity = %entry.name, "activity failed to stop: {failure}");
        }
    }
}
