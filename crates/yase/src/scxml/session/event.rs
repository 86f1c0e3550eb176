//! Events as sessions see them.

use crate::scxml::language::{Data, Fault, Memory, Record, Value};

/// An event: what `_event` shows.
#[derive(Clone, PartialEq, Debug, Default)]
pub struct Event {
    /// Its name.
    pub name: String,
    /// Who made it.
    pub kind: EventKind,
    /// The id of the `<send>` that sent it, if it was given one; of an error, that of the `<send>` that failed.
    pub send_id: Option<String>,
    /// Where an answer would go.
    pub origin: Option<String>,
    /// The kind of target that the origin is.
    pub origin_type: Option<String>,
    /// The invocation that it comes from.
    pub invoke_id: Option<String>,
    /// What it carries.
    pub data: Data,
}

/// Who made an event.
#[derive(Clone, Copy, PartialEq, Eq, Debug, Default)]
pub enum EventKind {
    /// The platform: errors, and the ends of states.
    Platform,
    /// The session itself: `<raise>`, and `<send>` to `#_internal`.
    Internal,
    /// Whoever sends something, be it to itself.
    #[default]
    External,
}

impl Event {
    /// An event without data from outside.
    pub fn new(name: impl Into<String>) -> Event {
        Event { name: name.into(), ..Event::default() }
    }

    /// The event with data.
    pub fn with_data(self, data: Data) -> Event {
        Event { data, ..self }
    }

    pub(super) fn internal(name: &str) -> Event {
        Event { kind: EventKind::Internal, ..Event::new(name) }
    }

    pub(super) fn platform(name: &str) -> Event {
        Event { kind: EventKind::Platform, ..Event::new(name) }
    }

    /// An error, with the reason as its data.
    pub(super) fn error(name: &str, reason: impl Into<String>) -> Event {
        Event::platform(name).with_data(Data::Text(reason.into()))
    }

    /// Shows the event as `_event`.
    pub(super) fn show(&self, memory: &mut Memory) -> Result<(), Fault> {
        let kind = match self.kind {
            EventKind::Platform => "platform",
            EventKind::Internal => "internal",
            EventKind::External => "external",
        };
        let mut record = Record::default();
        record.set("name", memory.heap.text(self.name.as_str())?);
        record.set("type", Value::Text(kind.into()));
        let optional = [
            ("sendid", &self.send_id),
            ("origin", &self.origin),
            ("origintype", &self.origin_type),
            ("invokeid", &self.invoke_id),
        ];
        for (name, text) in optional {
            let value = match text {
                Some(text) => memory.heap.text(text.as_str())?,
                None => Value::Undefined,
            };
            record.set(name, value);
        }
        record.set("data", memory.heap.import(&self.data)?);
        let event = memory.heap.record(record, true)?;
        memory.set_system("_event", event);
        memory.tidy()
    }
}
