//! What a compiled expression reads.

use std::collections::BTreeSet;

use super::facts::{MessageSource, TimerId};
use super::program::{Term, Test};
use crate::vocabulary::TopicId;

/// The topics and timers found so far.
#[derive(Default)]
pub(super) struct Reads {
    sources: BTreeSet<MessageSource>,
    timers: BTreeSet<TimerId>,
}

impl Reads {
    pub(super) fn topics(&self) -> Box<[TopicId]> {
        let topics: BTreeSet<TopicId> = self.sources.iter().map(|source| source.topic).collect();
        topics.into_iter().collect()
    }

    pub(super) fn sources(&self) -> Box<[MessageSource]> {
        self.sources.iter().cloned().collect()
    }

    pub(super) fn timers(&self) -> Box<[TimerId]> {
        self.timers.iter().copied().collect()
    }

    pub(super) fn of_test(&mut self, test: &Test) {
        match test {
            Test::Literal(_) | Test::NeverStarted(_) | Test::Active(_) | Test::Script(_) | Test::Typed(_) => {
            }
            Test::All(tests) | Test::Any(tests) => tests.iter().for_each(|test| self.of_test(test)),
            Test::Not(test) => self.of_test(test),
            Test::Compare(left, _, right) => {
                self.of_term(left);
                self.of_term(right);
            }
            Test::FieldIs { source, .. } | Test::Absent(source) => drop(self.sources.insert(source.clone())),
            Test::Over { timer, .. } => drop(self.timers.insert(*timer)),
            Test::Holds(term) => self.of_term(term),
        }
    }

    pub(super) fn of_term(&mut self, term: &Term) {
        match term {
            Term::Literal(_) | Term::Typed(_) => {}
            Term::Field(source, _) | Term::Message(source) => drop(self.sources.insert(source.clone())),
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
