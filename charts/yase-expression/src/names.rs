//! The names that an expression may use.

use std::collections::BTreeMap;

use crate::constant::Constant;
use crate::diagnostic::Suggestions;
use crate::node_id::NodeId;
use crate::vocabulary::{TopicId, TypeEnvironment};

/// The names in scope when an expression is compiled.
pub struct NameScope<'a> {
    /// Topics, messages, enumerations and functions.
    pub vocabulary: &'a TypeEnvironment,
    /// The constants of the model.
    pub constants: &'a [Constant],
    /// The timers that actions start on the blackboard of the expression's scope, in alphabetical
    /// order; the index of a name is its [`TimerId`](super::TimerId).
    pub timers: &'a [String],
    /// The events of the chart; new names are added.
    pub events: &'a mut EventInterner,
    /// The scripts of the chart; new scripts are added.
    pub scripts: &'a mut ScriptInterner,
    /// Finds the state with a path (without blanks, `~` for ω).
    pub states: &'a dyn Fn(&str) -> Option<NodeId>,
    /// Limits the effort for names that do not exist.
    pub suggestions: &'a Suggestions,
}

/// A script, an index into a [`ScriptInterner`].
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Debug)]
pub struct ScriptId(pub u32);

/// The scripts of a chart in the language of the host, without duplicates.
#[derive(Clone, Debug, Default)]
pub struct ScriptInterner {
    texts: Vec<String>,
    by_text: BTreeMap<String, ScriptId>,
}

impl ScriptInterner {
    /// A table without scripts.
    pub fn new() -> ScriptInterner {
        ScriptInterner::default()
    }

    /// The script of a text, added if it is new.
    pub fn intern(&mut self, text: &str) -> ScriptId {
        if let Some(&id) = self.by_text.get(text) {
            return id;
        }
        let id = ScriptId(self.texts.len() as u32);
        self.texts.push(text.to_owned());
        self.by_text.insert(text.to_owned(), id);
        id
    }

    /// The script of a text.
    pub fn find(&self, text: &str) -> Option<ScriptId> {
        self.by_text.get(text).copied()
    }

    /// The text of a script; empty for one of another table.
    pub fn text(&self, script: ScriptId) -> &str {
        self.texts.get(script.0 as usize).map_or("", String::as_str)
    }

    /// The number of scripts; their numbers run from 0.
    pub fn len(&self) -> usize {
        self.texts.len()
    }

    /// Whether there is no script.
    pub fn is_empty(&self) -> bool {
        self.texts.is_empty()
    }
}

/// An event, an index into an [`EventInterner`].
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Debug)]
pub struct EventId(pub u32);

/// The events of a chart. Each has a name; arrivals of messages have their topic too.
#[derive(Clone, Debug, Default)]
pub struct EventInterner {
    entries: Vec<EventEntry>,
    by_name: BTreeMap<String, EventId>,
    by_topic: BTreeMap<TopicId, EventId>,
    /// Arrivals of messages of other hosts.
    of_hosts: Vec<EventId>,
}

#[derive(Clone, Debug)]
struct EventEntry {
    name: String,
    topic: Option<TopicId>,
    /// The other host, for messages of another host.
    host: Option<Box<str>>,
}

impl EventInterner {
    /// A table without events.
    pub fn new() -> EventInterner {
        EventInterner::default()
    }

    /// The event of a name, added if it is new.
    pub fn intern(&mut self, name: &str) -> EventId {
        if let Some(&id) = self.by_name.get(name) {
            return id;
        }
        let id = self.push(name, None, None);
        self.by_name.insert(name.to_owned(), id);
        id
    }

    /// The event for arrivals of messages of the own host on a topic, added if it is new; `name` is
    /// its name in traces.
    pub fn intern_message(&mut self, topic: TopicId, name: &str) -> EventId {
        if let Some(&id) = self.by_topic.get(&topic) {
            return id;
        }
        let id = self.push(name, Some(topic), None);
        self.by_topic.insert(topic, id);
        id
    }

    /// The same for messages of another host.
    pub fn intern_message_of(&mut self, host: &str, topic: TopicId, name: &str) -> EventId {
        if let Some(id) = self.message_of(host, topic) {
            return id;
        }
        let id = self.push(name, Some(topic), Some(host.into()));
        self.of_hosts.push(id);
        id
    }

    fn push(&mut self, name: &str, topic: Option<TopicId>, host: Option<Box<str>>) -> EventId {
        let id = EventId(self.entries.len() as u32);
        self.entries.push(EventEntry { name: name.to_owned(), topic, host });
        id
    }

    /// The event of a name; arrivals of messages are not found by name.
    pub fn find(&self, name: &str) -> Option<EventId> {
        self.by_name.get(name).copied()
    }

    /// The event with the longest token prefix of a name (`a.b` of `a.b.c`).
    pub fn find_prefix(&self, name: &str) -> Option<EventId> {
        let mut prefix = name;
        while let Some((shorter, _)) = prefix.rsplit_once('.') {
            prefix = shorter;
            if let Some(event) = self.find(prefix) {
                return Some(event);
            }
        }
        None
    }

    /// Every event, in the order of their numbers.
    pub fn ids(&self) -> impl ExactSizeIterator<Item = EventId> + use<> {
        (0..self.entries.len() as u32).map(EventId)
    }

    /// The events whose names begin with the tokens of a name: `a` and `a.b` for `a`.
    pub fn beginning_with(&self, name: &str) -> impl Iterator<Item = EventId> {
        let longer = format!("{name}.");
        let first = longer.clone();
        let others = self.by_name.range(first..).take_while(move |(other, _)| other.starts_with(&longer));
        self.find(name).into_iter().chain(others.map(|(_, &event)| event))
    }

    /// The event for arrivals of messages of the own host on a topic, if a trigger names it.
    pub fn message(&self, topic: TopicId) -> Option<EventId> {
        self.by_topic.get(&topic).copied()
    }

    /// The same for messages of another host.
    pub fn message_of(&self, host: &str, topic: TopicId) -> Option<EventId> {
        let is_it = |id: &EventId| self.topic(*id) == Some(topic) && self.host(*id) == Some(host);
        self.of_hosts.iter().copied().find(is_it)
    }

    /// The other host whose messages the event represents; `None` for the own host.
    pub fn host(&self, event: EventId) -> Option<&str> {
        self.entries.get(event.0 as usize).and_then(|entry| entry.host.as_deref())
    }

    /// The name of an event; empty for an event of another table.
    pub fn name(&self, event: EventId) -> &str {
        self.entries.get(event.0 as usize).map_or("", |entry| &entry.name)
    }

    /// The topic whose arrivals the event represents.
    pub fn topic(&self, event: EventId) -> Option<TopicId> {
        self.entries.get(event.0 as usize).and_then(|entry| entry.topic)
    }

    /// The number of events; their numbers run from 0.
    pub fn len(&self) -> usize {
        self.entries.len()
    }

    /// Whether there is no event.
    pub fn is_empty(&self) -> bool {
        self.entries.is_empty()
    }
}
