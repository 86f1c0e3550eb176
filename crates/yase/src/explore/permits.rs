//! What conditions may be, asked for once.

use super::Allows;
use super::numbers::Numbers;
use crate::expression::ScriptId;

/// Remembers what [`Surroundings::allows`](super::Surroundings::allows) has said of a condition beside others: the same is asked for in nearly every step.
pub(super) struct Permits<'s, 'a> {
    allows: &'s mut Allows<'a>,
    /// Conditions with their values, and at the end one without.
    asked: Numbers,
    /// Whether it may be false and whether it may be true.
    answers: Vec<(bool, bool)>,
    row: Vec<u32>,
}

impl<'s, 'a> Permits<'s, 'a> {
    pub(super) fn new(allows: &'s mut Allows<'a>) -> Permits<'s, 'a> {
        Permits { allows, asked: Numbers::default(), answers: Vec::new(), row: Vec::new() }
    }

    /// Whether a condition may be false and whether it may be true, given others.
    pub(super) fn of(&mut self, script: ScriptId, known: &[(ScriptId, bool)]) -> (bool, bool) {
        self.row.clear();
        self.row.extend(known.iter().map(|&(script, value)| script.0 << 1 | u32::from(value)));
        self.row.push(script.0);
        let number = self.asked.number(&self.row);
        if let Some(&answer) = self.answers.get(number) {
            return answer;
        }
        let answer = ((self.allows)(script, false, known), (self.allows)(script, true, known));
        self.answers.push(answer);
        answer
    }
}
