//! Binds the functions of a generated chart to its expressions.

use std::collections::BTreeMap;
use std::sync::Arc;

use crate::diagnostic::{Diagnostic, Span};
use crate::expression::{Effect, Guard, MessageSource, Operand, TimerId};
use crate::ids::{ActionLocation, ScopeId};
use crate::native::{NativeProgram, Slots, SourceDeclaration, TypedTest, TypedValue};
use crate::statechart::TransitionId;
use crate::vocabulary::{FunctionId, TopicId, TypeEnvironment};

/// The functions of a chart during compilation.
pub(crate) struct FunctionBindings<'a> {
    program: &'a NativeProgram,
    sources: Arc<[MessageSource]>,
    functions: Arc<[FunctionId]>,
    slots: BTreeMap<ScopeId, Arc<Slots>>,
    pub(crate) found: Vec<Diagnostic>,
}

impl<'a> FunctionBindings<'a> {
    /// Resolves the declarations of the functions.
    pub(crate) fn new(program: &'a NativeProgram, vocabulary: &TypeEnvironment) -> FunctionBindings<'a> {
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
        FunctionBindings { program, sources, functions, slots: BTreeMap::new(), found }
    }

    /// Resolves the numbers in the functions for a scope with these timers.
    fn slots(&mut self, region: ScopeId, timers: &[String]) -> Arc<Slots> {
        let (sources, functions) = (&self.sources, &self.functions);
        let position = |name: &&str| timers.iter().position(|timer| timer == name);
        let timers = self.program.timers.iter().map(|name| position(name).map(|index| TimerId(index as u32)));
        let slots =
            || Slots { sources: sources.clone(), functions: functions.clone(), timers: timers.collect() };
        self.slots.entry(region).or_insert_with(|| Arc::new(slots())).clone()
    }

    /// Replaces a guard by its function. The literal `false` needs none: the machine does not
    /// evaluate it.
    pub(crate) fn guard(&mut self, guard: &mut Guard, id: TransitionId, region: ScopeId, timers: &[String]) {
        if guard.is_literally_false() {
            return;
        }
        match self.program.guards.get(&id) {
            Some(&test) => guard.set_native_test(TypedTest { test, slots: self.slots(region, timers) }),
            None => self.found.push(stale(format!("no function is the guard of transition {}", id.0))),
        }
    }

    /// Replaces the values that actions assign by their functions.
    pub(crate) fn effects(
        &mut self,
        effects: &mut [Effect],
        location: ActionLocation,
        region: ScopeId,
        timers: &[String],
    ) {
        for (index, effect) in effects.iter_mut().enumerate() {
            if let Effect::Assign { topic, value, .. } = effect {
                self.value(value, *topic, (location, index), (region, timers));
            }
        }
    }

    fn value(
        &mut self,
        operand: &mut Operand,
        topic: TopicId,
        location: (ActionLocation, usize),
        (region, timers): (ScopeId, &[String]),
    ) {
        let assigned = self.program.values.get(&location);
        let written = assigned.and_then(|assigned| self.sources.get(assigned.target));
        match assigned {
            Some(assigned) if written.is_some_and(|source| source.topic == topic) => {
                let value = TypedValue { value: assigned.value, slots: self.slots(region, timers) };
                operand.set_native_value(value, assigned.change.clone());
            }
            _ => self
                .found
                .push(stale(format!("no function gives the value of an action at {:?}", location.0))),
        }
    }
}

fn source(
    reads: &SourceDeclaration,
    vocabulary: &TypeEnvironment,
    found: &mut Vec<Diagnostic>,
) -> MessageSource {
    let is_it =
        |topic: &&crate::vocabulary::TopicEntry| topic.path == reads.topic && topic.message == reads.message;
    let topic = vocabulary.topics.iter().find(is_it).map(|topic| topic.id);
    if topic.is_none() {
        found.push(stale(format!("there is no topic `{}` of messages `{}`", reads.topic, reads.message)));
    }
    MessageSource { topic: topic.unwrap_or(TopicId(u32::MAX)), origin: reads.origin() }
}

fn function(name: &str, vocabulary: &TypeEnvironment, found: &mut Vec<Diagnostic>) -> FunctionId {
    let known = vocabulary.functions.iter().find(|function| function.name == name);
    if known.is_none() {
        found.push(stale(format!("there is no function `{name}`")));
    }
    known.map_or(FunctionId(u32::MAX), |function| function.id)
}

/// The functions do not match the chart or the type environment.
fn stale(message: String) -> Diagnostic {
    Diagnostic::error("E0151", Span::default(), message)
        .with_hint("the chart's code was generated for other messages or another model: generate it again")
}
