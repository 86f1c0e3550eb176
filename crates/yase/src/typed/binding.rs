//! The functions of a typed chart, put in the places of its expressions.

use std::collections::BTreeMap;
use std::sync::Arc;

use super::draft::Reads;
use super::world::{Change, Slots, Test, TypedTest, TypedValue, Valuation};
use crate::chart::{Chart, RegionId};
use crate::diagnostic::{Diagnostic, Span};
use crate::expression::{Effect, Guard, MessageSource, Operand, TimerId};
use crate::host::ActionPlace;
use crate::semantics::Semantics;
use crate::statechart::{Statechart, TransitionId};
use crate::vocabulary::{FunctionId, TopicId, Vocabulary};

/// A statechart whose guards and assigned values are functions. [`Draft`](super::Draft) makes it.
#[derive(Clone, Debug)]
pub struct TypedChart {
    statechart: Statechart,
    program: Arc<Program>,
}

/// The functions of a chart, and what they speak of.
#[derive(Clone, Debug, Default)]
pub(crate) struct Program {
    pub(super) sources: Vec<Reads>,
    pub(super) timers: Vec<&'static str>,
    pub(super) functions: Vec<&'static str>,
    pub(super) enumerations: Vec<(&'static str, &'static str, i32)>,
    pub(super) guards: BTreeMap<TransitionId, Test>,
    pub(super) values: BTreeMap<(ActionPlace, usize), Assigned>,
}

/// An assignment.
#[derive(Clone, Debug)]
pub(super) struct Assigned {
    /// The number of the source that is written.
    pub(super) target: usize,
    pub(super) value: Valuation,
    pub(super) change: Change,
}

impl TypedChart {
    pub(super) fn new(statechart: Statechart, program: Program) -> TypedChart {
        TypedChart { statechart, program: Arc::new(program) }
    }

    /// The chart as data, as if it had been read from its model.
    pub fn statechart(&self) -> &Statechart {
        &self.statechart
    }

    /// Checks the chart and makes it ready to run with the words of a vocabulary. It reads the same messages, wakes for the same reasons
    /// and leaves the same trace as the [statechart](TypedChart::statechart) does that is compiled alone.
    ///
    /// # Errors
    /// Everything that is wrong with its structure or its texts, and where its functions were made for another vocabulary.
    pub fn compile(&self, vocabulary: &Vocabulary, semantics: Semantics) -> Result<Chart, Vec<Diagnostic>> {
        Chart::build(&self.statechart, vocabulary, semantics, Some(&self.program))
    }
}

/// The functions of a chart while it is compiled.
pub(crate) struct Wiring<'a> {
    program: &'a Program,
    sources: Arc<[MessageSource]>,
    functions: Arc<[FunctionId]>,
    slots: BTreeMap<RegionId, Arc<Slots>>,
    pub(crate) found: Vec<Diagnostic>,
}

impl<'a> Wiring<'a> {
    /// Looks up everything the functions speak of.
    pub(crate) fn new(program: &'a Program, vocabulary: &Vocabulary) -> Wiring<'a> {
        let mut found = Vec::new();
        let sources = program.sources.iter().map(|reads| source(reads, vocabulary, &mut found)).collect();
        let functions = program.functions.iter().map(|name| function(name, vocabulary, &mut found)).collect();
        for (enumeration, value, number) in &program.enumerations {
            let known = vocabulary.enumerations.iter().filter(|known| known.name == *enumeration);
            let is_so = |(name, means): &(String, i32)| name == value && means == number;
            if !known.clone().any(|known| known.values.iter().any(is_so)) {
                found.push(stale(format!("`{value}` of the enumeration `{enumeration}` is not {number}")));
            }
        }
        Wiring { program, sources, functions, slots: BTreeMap::new(), found }
    }

    /// What the numbers of the functions mean on a blackboard with these timers.
    fn slots(&mut self, region: RegionId, timers: &[String]) -> Arc<Slots> {
        let (sources, functions) = (&self.sources, &self.functions);
        let place = |name: &&str| timers.iter().position(|timer| timer == name);
        let timers = self.program.timers.iter().map(|name| place(name).map(|place| TimerId(place as u32)));
        let slots =
            || Slots { sources: sources.clone(), functions: functions.clone(), timers: timers.collect() };
        self.slots.entry(region).or_insert_with(|| Arc::new(slots())).clone()
    }

    /// Puts its function in the place of a guard. The word `false` needs none: the machine does not even ask.
    pub(crate) fn guard(&mut self, guard: &mut Guard, id: TransitionId, region: RegionId, timers: &[String]) {
        if guard.is_literally_false() {
            return;
        }
        match self.program.guards.get(&id) {
            Some(&test) => guard.ask(TypedTest { test, slots: self.slots(region, timers) }),
            None => self.found.push(stale(format!("no function is the guard of transition {}", id.0))),
        }
    }

    /// Puts their functions in the places of the values that actions assign.
    pub(crate) fn effects(
        &mut self,
        effects: &mut [Effect],
        place: ActionPlace,
        region: RegionId,
        timers: &[String],
    ) {
        for (index, effect) in effects.iter_mut().enumerate() {
            if let Effect::Assign { topic, value, .. } = effect {
                self.value(value, *topic, (place, index), (region, timers));
            }
        }
    }

    fn value(
        &mut self,
        operand: &mut Operand,
        topic: TopicId,
        place: (ActionPlace, usize),
        (region, timers): (RegionId, &[String]),
    ) {
        let assigned = self.program.values.get(&place);
        let written = assigned.and_then(|assigned| self.sources.get(assigned.target));
        match assigned {
            Some(assigned) if written.is_some_and(|source| source.topic == topic) => {
                let value = TypedValue { value: assigned.value, slots: self.slots(region, timers) };
                operand.ask(value, assigned.change.clone());
            }
            _ => self.found.push(stale(format!("no function gives the value of an action at {:?}", place.0))),
        }
    }
}

fn source(reads: &Reads, vocabulary: &Vocabulary, found: &mut Vec<Diagnostic>) -> MessageSource {
    let is_it =
        |topic: &&crate::vocabulary::TopicEntry| topic.path == reads.topic && topic.message == reads.message;
    let topic = vocabulary.topics.iter().find(is_it).map(|topic| topic.id);
    if topic.is_none() {
        found.push(stale(format!("there is no topic `{}` of messages `{}`", reads.topic, reads.message)));
    }
    MessageSource { topic: topic.unwrap_or(TopicId(u32::MAX)), origin: reads.origin() }
}

fn function(name: &str, vocabulary: &Vocabulary, found: &mut Vec<Diagnostic>) -> FunctionId {
    let known = vocabulary.functions.iter().find(|function| function.name == name);
    if known.is_none() {
        found.push(stale(format!("there is no function `{name}`")));
    }
    known.map_or(FunctionId(u32::MAX), |function| function.id)
}

/// The functions do not belong to what they meet.
fn stale(message: String) -> Diagnostic {
    Diagnostic::error("E0151", Span::default(), message)
        .with_hint("the chart's code was generated for other messages or another model: generate it again")
}
