//! What a compiled expression reads.

use smallvec::SmallVec;

use super::facts::{MessageSource, TimerId};
use super::program::{Term, Test};
use crate::vocabulary::TopicId;

/// The topics and timers found so far.
#[derive(Default)]
pub(super) struct Reads {
    sources: Few<MessageSource>,
    timers: Few<TimerId>,
    /// The timers that are asked for in a form that tells one that was never set from one that is over.
    told_apart: Few<TimerId>,
    /// Whether it is code in part: what that asks is not known.
    is_opaque: bool,
}

/// What most expressions read is so little that it needs no memory of its own.
type Few<T> = SmallVec<[T; 2]>;

impl Reads {
    pub(super) fn topics(&self) -> Box<[TopicId]> {
        in_order(self.sources.iter().map(|source| source.topic).collect())
    }

    pub(super) fn sources(&self) -> Box<[MessageSource]> {
        in_order(self.sources.clone())
    }

    pub(super) fn timers(&self) -> Box<[TimerId]> {
        in_order(self.timers.clone())
    }

    /// Of timers that are read, those of which it matters whether they are over or were never set.
    pub(super) fn timers_told_apart(self, read: &[TimerId]) -> Vec<TimerId> {
        if self.is_opaque { read.to_vec() } else { self.told_apart.into_iter().collect() }
    }

    pub(super) fn of_test(&mut self, test: &Test) {
        match test {
            Test::Literal(_) | Test::NeverStarted(_) | Test::Active(_) | Test::Script(_) => {}
            Test::Typed(_) => self.is_opaque = true,
            Test::All(tests) | Test::Any(tests) => tests.iter().for_each(|test| self.of_test(test)),
            Test::Not(test) => self.of_test(test),
            Test::Compare(left, _, right) => {
                self.of_term(left);
                self.of_term(right);
            }
            Test::FieldIs { source, .. } | Test::Absent(source) => self.sources.push(source.clone()),
            Test::Over { timer, when_unset } => {
                self.timers.push(*timer);
                if !when_unset {
                    self.told_apart.push(*timer);
                }
            }
            Test::Holds(term) => self.of_term(term),
        }
    }

    pub(super) fn of_term(&mut self, term: &Term) {
        match term {
            Term::Literal(_) => {}
            Term::Typed(_) => self.is_opaque = true,
            Term::Field(source, _) | Term::Message(source) => self.sources.push(source.clone()),
            Term::Call(_, arguments) => arguments.iter().for_each(|term| self.of_term(term)),
            Term::Negative(term) => self.of_term(term),
            Term::Sum(first, rest) => {
                self.of_term(first);
                rest.iter().for_each(|(_, term)| self.of_term(term));
            }
            Term::Product(first, rest) => {
                self.of_term(first);
                rest.iter().for_each(|(_, term)| self.of_term(term));
            }
            Term::Truth(test) => self.of_test(test),
        }
    }
}

/// Each once, in order.
fn in_order<T: Ord>(mut items: Few<T>) -> Box<[T]> {
    items.sort_unstable();
    items.dedup();
    items.into_iter().collect()
}
