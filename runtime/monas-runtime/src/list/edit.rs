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
            ListEdit::Insert(index, listed) => {
                let entry = self.entry(listed);
                self.entries.insert(index.min(count), entry);
            }
            ListEdit::Remove(index) if index < count => {
                self.end(index);
                self.entries.remove(index);
            }
            ListEdit::Move(from, to) if from < count => {
                let entry = self.entries.remove(from);
                self.entries.insert(to.min(count - 1), entry);
            }
            ListEdit::Replace(index, listed) if index < count => {
                self.end(index);
                self.entries[index] = self.entry(listed);
            }
            ListEdit::Configure(index, parameters) if index < count => {
                let ListEntry { name, activity, .. } = &mut self.entries[index];
                call::configure_again(name, &mut **activity, &parameters);
            }
            ListEdit::SetPolicy(index, policy) if index < count => self.entries[index].policy = Some(policy),
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
    pub(crate) fn end(&mut self, index: usize) {
        let entry = &mut self.entries[index];
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
