//! The newest messages of a hub, for values and conditions of scenarios.

use std::collections::BTreeMap;

use narukom::{AnySample, Narukom, TopicSlot};
use yase::expression::{CallError, Facts, MessageSource, TimerId, TimerState};
use yase::{FieldId, FunctionId, NodeId, TopicId, Value};

use crate::chart::values;
use crate::function::FunctionDeclaration;

/// What some topics show at a moment.
pub(super) struct Newest<'a> {
    samples: BTreeMap<TopicId, AnySample>,
    functions: &'a [FunctionDeclaration],
}

impl<'a> Newest<'a> {
    pub(super) fn of(hub: &Narukom, topics: &[TopicId], functions: &'a [FunctionDeclaration]) -> Newest<'a> {
        let sample = |topic: &TopicId| Some((*topic, hub.latest(TopicSlot::new(topic.0))?));
        Newest { samples: topics.iter().filter_map(sample).collect(), functions }
    }
}

impl Facts for Newest<'_> {
    fn field(&self, source: &MessageSource, path: &[FieldId]) -> Value<'_> {
        let sample = self.samples.get(&source.topic);
        sample.map_or(Value::Missing, |sample| values::field(&*sample.message, path))
    }

    fn message(&self, source: &MessageSource) -> Value<'_> {
        let sample = self.samples.get(&source.topic);
        sample.map_or(Value::Missing, |sample| Value::Message(sample.message.as_any()))
    }

    fn call(&self, function: FunctionId, arguments: &[Value<'_>]) -> Result<Value<'_>, CallError> {
        let declaration = self.functions.get(function.0 as usize);
        let declaration = declaration.ok_or_else(|| CallError::new("there is no such function"))?;
        (declaration.call)(arguments)
            .ok_or_else(|| CallError::new("the function does not take these arguments"))
    }

    /// Timers are asked for by name, not by conditions.
    fn timer(&self, _: TimerId) -> TimerState {
        TimerState::Unset
    }

    /// States are asked for by name, not by conditions.
    fn is_active(&self, _: NodeId) -> bool {
        false
    }
}
