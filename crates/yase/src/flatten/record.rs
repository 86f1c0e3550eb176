//! A world in which conditions have the values that are planned for them, and which takes note of what happens.

use std::cell::RefCell;

use super::words::Word;
use crate::chart::RegionId;
use crate::expression::{CallError, ScriptId};
use crate::host::{Activation, Host};
use crate::machine::{Performance, States};

/// What happened.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub(super) enum Record {
    /// A condition was asked.
    Asked(usize),
    /// An action was done.
    Did(usize),
}

/// A world for one step.
pub(super) struct Recorder<'w> {
    /// What the chart's scripts stand for.
    words: &'w [Option<Word>],
    /// The values of the first conditions that are asked; later ones do not hold.
    planned: &'w [bool],
    notes: RefCell<Notes>,
}

#[derive(Default)]
struct Notes {
    records: Vec<Record>,
    /// What was asked since something was last done.
    known: Vec<(usize, bool)>,
    asked: usize,
}

impl<'w> Recorder<'w> {
    pub(super) fn new(words: &'w [Option<Word>], planned: &'w [bool]) -> Recorder<'w> {
        Recorder { words, planned, notes: RefCell::default() }
    }

    pub(super) fn records(self) -> Vec<Record> {
        self.notes.into_inner().records
    }

    fn word(&self, script: ScriptId) -> Result<Word, CallError> {
        let word = self.words.get(script.0 as usize).copied().flatten();
        word.ok_or_else(|| CallError::new("no such script"))
    }
}

impl Host for Recorder<'_> {
    fn condition(&self, script: ScriptId, _: RegionId, _: &States<'_>) -> Result<bool, CallError> {
        let Word::Condition(condition) = self.word(script)? else {
            return Err(CallError::new("no condition"));
        };
        let mut notes = self.notes.borrow_mut();
        if let Some(&(_, value)) = notes.known.iter().find(|(known, _)| *known == condition) {
            return Ok(value);
        }
        let value = self.planned.get(notes.asked).copied().unwrap_or(false);
        notes.asked += 1;
        notes.known.push((condition, value));
        notes.records.push(Record::Asked(condition));
        Ok(value)
    }

    /// What is done may change what holds.
    fn perform(&mut self, script: ScriptId, _: RegionId, _: &mut Performance<'_>) -> Result<(), CallError> {
        let Word::Action(action) = self.word(script)? else { return Err(CallError::new("no action")) };
        let notes = self.notes.get_mut();
        notes.known.clear();
        notes.records.push(Record::Did(action));
        Ok(())
    }

    fn start(&mut self, _: Activation) {}

    fn cancel(&mut self, _: Activation) {}

    fn stop(&mut self, _: Activation) {}
}
