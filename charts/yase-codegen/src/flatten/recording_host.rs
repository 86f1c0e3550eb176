//! A host that assigns planned values to conditions and records the calls.

use std::cell::RefCell;

use super::symbols::Symbol;
use yase::ScopeId;
use yase::expression::{CallError, ScriptId};
use yase::{Activation, Host};
use yase::{ActiveStates, ScriptContext};

/// A recorded call.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub(crate) enum RecordedCall {
    /// A condition was read.
    ConditionRead(usize),
    /// An action was executed.
    ActionExecuted(usize),
}

/// The host of one step.
pub(crate) struct RecordingHost<'w> {
    /// The symbols of the chart's scripts.
    words: &'w [Option<Symbol>],
    /// The values of the first conditions; later ones do not hold.
    planned: &'w [bool],
    notes: RefCell<RecorderState>,
}

#[derive(Default)]
struct RecorderState {
    records: Vec<RecordedCall>,
    /// The conditions read since the last action.
    known: Vec<(usize, bool)>,
    condition_count: usize,
}

impl<'w> RecordingHost<'w> {
    pub(crate) fn new(words: &'w [Option<Symbol>], planned: &'w [bool]) -> RecordingHost<'w> {
        RecordingHost { words, planned, notes: RefCell::default() }
    }

    pub(crate) fn records(self) -> Vec<RecordedCall> {
        self.notes.into_inner().records
    }

    fn word(&self, script: ScriptId) -> Result<Symbol, CallError> {
        let word = self.words.get(script.0 as usize).copied().flatten();
        word.ok_or_else(|| CallError::new("no such script"))
    }
}

impl Host for RecordingHost<'_> {
    fn condition(&self, script: ScriptId, _: ScopeId, _: &ActiveStates<'_>) -> Result<bool, CallError> {
        let Symbol::Condition(condition) = self.word(script)? else {
            return Err(CallError::new("no condition"));
        };
        let mut notes = self.notes.borrow_mut();
        if let Some(&(_, value)) = notes.known.iter().find(|(known, _)| *known == condition) {
            return Ok(value);
        }
        let value = self.planned.get(notes.condition_count).copied().unwrap_or(false);
        notes.condition_count += 1;
        notes.known.push((condition, value));
        notes.records.push(RecordedCall::ConditionRead(condition));
        Ok(value)
    }

    /// An action may change conditions.
    fn perform(&mut self, script: ScriptId, _: ScopeId, _: &mut ScriptContext<'_>) -> Result<(), CallError> {
        let Symbol::Action(action) = self.word(script)? else { return Err(CallError::new("no action")) };
        let notes = self.notes.get_mut();
        notes.known.clear();
        notes.records.push(RecordedCall::ActionExecuted(action));
        Ok(())
    }

    fn start(&mut self, _: Activation) {}

    fn cancel(&mut self, _: Activation) {}

    fn stop(&mut self, _: Activation) {}
}
