//! The topics and timers that a compiled expression reads.

use smallvec::SmallVec;

use super::eval_context::{MessageSource, TimerId};
use super::ir::{BooleanTerm, ValueTerm};
use crate::vocabulary::TopicId;

/// The topics and timers found so far.
#[derive(Default)]
pub(crate) struct ReadSet {
    sources: ReadVec<MessageSource>,
    timers: ReadVec<TimerId>,
    /// The timers read in a form that distinguishes never started from expired.
    distinguished_timers: ReadVec<TimerId>,
    /// Whether it is a Rust function in part, whose reads are unknown.
    is_opaque: bool,
}

/// Most expressions read so little that no allocation is needed.
type ReadVec<T> = SmallVec<[T; 2]>;

impl ReadSet {
    pub(crate) fn topics(&self) -> Box<[TopicId]> {
        in_order(self.sources.iter().map(|source| source.topic).collect())
    }

    pub(crate) fn sources(&self) -> Box<[MessageSource]> {
        in_order(self.sources.clone())
    }

    pub(crate) fn timers(&self) -> Box<[TimerId]> {
        in_order(self.timers.clone())
    }

    /// The timers among those read for which expired and never started are distinguished.
    pub(crate) fn timers_distinguished(self, read: &[TimerId]) -> Vec<TimerId> {
        if self.is_opaque { read.to_vec() } else { self.distinguished_timers.into_iter().collect() }
    }

    pub(crate) fn of_test(&mut self, test: &BooleanTerm) {
        match test {
            BooleanTerm::Literal(_)
            | BooleanTerm::NeverStarted(_)
            | BooleanTerm::Active(_)
            | BooleanTerm::Script(_) => {}
            BooleanTerm::Typed(_) => self.is_opaque = true,
            BooleanTerm::All(tests) | BooleanTerm::Any(tests) => {
                tests.iter().for_each(|test| self.of_test(test))
            }
            BooleanTerm::Not(test) => self.of_test(test),
            BooleanTerm::Compare(left, _, right) => {
                self.of_term(left);
                self.of_term(right);
            }
            BooleanTerm::FieldIs { source, .. } | BooleanTerm::Absent(source) => {
                self.sources.push(source.clone())
            }
            BooleanTerm::Over { timer, when_unset } => {
                self.timers.push(*timer);
                if !when_unset {
                    self.distinguished_timers.push(*timer);
                }
            }
            BooleanTerm::Holds(term) => self.of_term(term),
        }
    }

    pub(crate) fn of_term(&mut self, term: &ValueTerm) {
        match term {
            ValueTerm::Literal(_) => {}
            ValueTerm::Typed(_) => self.is_opaque = true,
            ValueTerm::Field(source, _) | ValueTerm::Message(source) => self.sources.push(source.clone()),
            ValueTerm::Call(_, arguments) => arguments.iter().for_each(|term| self.of_term(term)),
            ValueTerm::Negative(term) => self.of_term(term),
            ValueTerm::Sum(first, rest) => {
                self.of_term(first);
                rest.iter().for_each(|(_, term)| self.of_term(term));
            }
            ValueTerm::Product(first, rest) => {
                self.of_term(first);
                rest.iter().for_each(|(_, term)| self.of_term(term));
            }
            ValueTerm::Truth(test) => self.of_test(test),
        }
    }
}

/// Sorts and removes duplicates.
fn in_order<T: Ord>(mut items: ReadVec<T>) -> Box<[T]> {
    items.sort_unstable();
    items.dedup();
    items.into_iter().collect()
}
