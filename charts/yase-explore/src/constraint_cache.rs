//! Cache of the answers of [`Environment::allows`](super::Environment::allows).

use super::ConditionConstraint;
use super::row_interner::RowInterner;
use yase::expression::ScriptId;

/// Caches the answers of [`Environment::allows`](super::Environment::allows), since nearly every
/// step asks the same question.
pub(crate) struct ConstraintCache<'s, 'a> {
    allows: &'s mut ConditionConstraint<'a>,
    /// Rows of conditions with their values; the last condition has none.
    conditions: RowInterner,
    /// Whether it may be false and whether it may be true.
    answers: Vec<(bool, bool)>,
    row: Vec<u32>,
}

impl<'s, 'a> ConstraintCache<'s, 'a> {
    pub(crate) fn new(allows: &'s mut ConditionConstraint<'a>) -> ConstraintCache<'s, 'a> {
        ConstraintCache { allows, conditions: RowInterner::default(), answers: Vec::new(), row: Vec::new() }
    }

    /// Whether a condition may be false and whether it may be true, given the values of others.
    pub(crate) fn of(&mut self, script: ScriptId, known: &[(ScriptId, bool)]) -> (bool, bool) {
        self.row.clear();
        self.row.extend(known.iter().map(|&(script, value)| script.0 << 1 | u32::from(value)));
        self.row.push(script.0);
        let number = self.conditions.number(&self.row);
        if let Some(&answer) = self.answers.get(number) {
            return answer;
        }
        let answer = ((self.allows)(script, false, known), (self.allows)(script, true, known));
        self.answers.push(answer);
        answer
    }
}
