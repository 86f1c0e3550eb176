//! Changes of a list between two of its cycles. Whoever asks for them has made sure that the places are there.

use super::{Entry, Health, List};
use crate::agent::{Listed, Policy};
use crate::call;
use crate::logger;
use crate::parameters::Parameters;

/// A change of a list; places are counted from 0.
pub(crate) enum ListEdit {
    /// An activity comes in at a place, or at the end if there are not so many.
    Insert(usize, Listed),
    /// One is told to stop, and leaves.
    Remove(usize),
    /// One goes from a place to another.
    Move(usize, usize),
    /// One leaves, and another has its place.
    Replace(usize, Listed),
    /// One takes other parameters.
    Configure(usize, Parameters),
    /// Something else happens when one fails.
    SetPolicy(usize, Policy),
}

impl List {
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
                let Entry { name, activity, .. } = &mut self.entries[place];
                call::configure_again(name, &mut **activity, &parameters);
            }
            ListEdit::SetPolicy(place, policy) if place < count => self.entries[place].policy = Some(policy),
            // There is no such place.
            _ => {}
        }
    }

    fn entry(&self, listed: Listed) -> Entry {
        Entry::new(listed, self.blackboard.hub().host(), &self.agent)
    }

    pub(crate) fn set_policy(&mut self, policy: Policy) {
        self.policy = policy;
    }

    /// Has every activity started anew before its next call, after the list was [stopped](List::stop).
    pub(crate) fn restart(&mut self) {
        self.stopped = None;
        self.entries.iter_mut().for_each(|entry| entry.health = Health::new());
    }

    /// Tells an activity that runs to stop; what it writes then is published with the next cycle.
    pub(super) fn end(&mut self, place: usize) {
        let entry = &mut self.entries[place];
        if let Health::Up = entry.health
            && let Err(failure) = logger::calling(&entry.caller, self.cycles, || {
                call::stop(entry.activity.as_mut(), &mut self.blackboard)
            })
        {
            let robot = self.blackboard.hub().host();
            tracing::error!(%robot, agent = %self.agent, activity = %entry.name, "activity failed to stop: {failure}");
        }
    }
}
