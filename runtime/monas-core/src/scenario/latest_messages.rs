//! The newest messages of a hub, for values and conditions of scenarios.

use std::collections::BTreeMap;

use narukom::{AnySample, Hub, TopicSlot};
use yase::expression::{CallError, EvalContext, MessageSource, TimerId, TimerState};
use yase::{FieldId, FunctionId, NodeId, TopicId, Value};

use crate::chart_runner::message_field;
use crate::function::FunctionDeclaration;

/// The newest messages of some topics at one time.
pub(crate) struct LatestMessages<'a> {
    samples: BTreeMap<TopicId, AnySample>,
    functions: &'a [FunctionDeclaration],
}

impl<'a> LatestMessages<'a> {
    pub(crate) fn of(
        hub: &Hub,
        topics: &[TopicId],
        functions: &'a [FunctionDeclaration],
    ) -> LatestMessages<'a> {
        let sample = |topic: &TopicId| Some((*topic, hub.latest(TopicSlot::new(topic.0))?));
        LatestMessages { samples: topics.iter().filter_map(sample).collect(), functions }
    }
}

impl EvalContext for LatestMessages<'_> {
    fn field(&self, source: &MessageSource, path: &[FieldId]) -> Value<'_> {
        let sample = self.samples.get(&source.topic);
        sample.map_or(Value::Missing, |sample| message_field(&*sample.message, path))
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

    /// Scenarios refer to timers by name, not in conditions.
    fn timer(&self, _: TimerId) -> TimerState {
        TimerState::Unset
    }

    /// Scenarios refer to states by name, not in conditions.
    fn is_active(&self, _: NodeId) -> bool {
        false
    }
}
