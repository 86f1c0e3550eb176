//! Events of sessions.

use crate::language::{DataValue, EvalError, PropertyMap, ScriptMemory, ScriptValue};

/// An event, the content of `_event`.
#[derive(Clone, PartialEq, Debug, Default)]
pub struct ScxmlEvent {
    /// Its name.
    pub name: String,
    /// Its origin.
    pub kind: ScxmlEventKind,
    /// The id of the `<send>` that sent it, if it has one; for an error, that of the `<send>` that
    /// failed.
    pub send_id: Option<String>,
    /// The address for replies.
    pub origin: Option<String>,
    /// The type of event processor of the origin.
    pub origin_type: Option<String>,
    /// The invocation that it comes from.
    pub invoke_id: Option<String>,
    /// Its data.
    pub data: DataValue,
}

/// Origin of an event.
#[derive(Clone, Copy, PartialEq, Eq, Debug, Default)]
pub enum ScxmlEventKind {
    /// The platform: errors, and completion of states.
    Platform,
    /// The session itself: `<raise>`, and `<send>` to `#_internal`.
    Internal,
    /// A sender, possibly the session itself.
    #[default]
    External,
}

impl ScxmlEvent {
    /// An external event without data.
    pub fn new(name: impl Into<String>) -> ScxmlEvent {
        ScxmlEvent { name: name.into(), ..ScxmlEvent::default() }
    }

    /// The event with data.
    pub fn with_data(self, data: DataValue) -> ScxmlEvent {
        ScxmlEvent { data, ..self }
    }

    pub(crate) fn internal(name: &str) -> ScxmlEvent {
        ScxmlEvent { kind: ScxmlEventKind::Internal, ..ScxmlEvent::new(name) }
    }

    pub(crate) fn platform(name: &str) -> ScxmlEvent {
        ScxmlEvent { kind: ScxmlEventKind::Platform, ..ScxmlEvent::new(name) }
    }

    /// An error, with the reason as its data.
    pub(crate) fn error(name: &str, reason: impl Into<String>) -> ScxmlEvent {
        ScxmlEvent::platform(name).with_data(DataValue::Text(reason.into()))
    }

    /// Exposes the event as `_event`.
    pub(crate) fn show(&self, memory: &mut ScriptMemory) -> Result<(), EvalError> {
        let kind = match self.kind {
            ScxmlEventKind::Platform => "platform",
            ScxmlEventKind::Internal => "internal",
            ScxmlEventKind::External => "external",
        };
        let mut record = PropertyMap::default();
        record.set("name", memory.heap.text(self.name.as_str())?);
        record.set("type", ScriptValue::Text(kind.into()));
        let optional = [
            ("sendid", &self.send_id),
            ("origin", &self.origin),
            ("origintype", &self.origin_type),
            ("invokeid", &self.invoke_id),
        ];
        for (name, text) in optional {
            let value = match text {
                Some(text) => memory.heap.text(text.as_str())?,
                None => ScriptValue::Undefined,
            };
            record.set(name, value);
        }
        record.set("data", memory.heap.import(&self.data)?);
        let event = memory.heap.record(record, true)?;
        memory.set_system("_event", event);
        memory.collect_garbage()
    }
}
