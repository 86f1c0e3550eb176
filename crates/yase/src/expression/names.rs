//! The names an expression may use, as the chart that holds it knows them.

use std::collections::BTreeMap;

use crate::statechart::{Constant, NodeId};
use crate::vocabulary::{TopicId, Vocabulary};

/// Everything that names are looked up in when an expression is compiled.
pub struct Names<'a> {
    /// Topics, messages, enumerations and functions.
    pub vocabulary: &'a Vocabulary,
    /// The constants of the model.
    pub constants: &'a [Constant],
    /// The timers that some action starts on the blackboard of the expression's scope; the place of a name is
    /// its [`TimerId`](super::TimerId).
    pub timers: &'a [String],
    /// The events of the chart; names that are new are added.
    pub events: &'a mut EventTable,
    /// Finds the state that a path (blanks removed, `~` for forever) names.
    pub states: &'a dyn Fn(&str) -> Option<NodeId>,
}

/// An event, by its place in an [`EventTable`].
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Debug)]
pub struct EventId(pub u32);

/// The events of a chart. Each has a name; those that are arrivals of messages have their topic too.
#[derive(Clone, Debug, Default)]
pub struct EventTable {
    entries: Vec<EventEntry>,
    by_name: BTreeMap<String, EventId>,
    by_topic: BTreeMap<TopicId, EventId>,
}

#[derive(Clone, Debug)]
struct EventEntry {
    name: String,
    topic: Option<TopicId>,
}

impl EventTable {
    /// A table without events.
    pub fn new() -> EventTable {
        EventTable::default()
    }

    /// The event of a name, added if it is new.
    pub fn intern(&mut self, name: &str) -> EventId {
        if let Some(&id) = self.by_name.get(name) {
            return id;
        }
        let id = self.push(name, None);
        self.by_name.insert(name.to_owned(), id);
        id
    }

    /// The event that is each arrival of a message on a topic, added if it is new; `name` is what traces call
    /// it.
    pub fn intern_message(&mut self, topic: TopicId, name: &str) -> EventId {
        if let Some(&id) = self.by_topic.get(&topic) {
            return id;
        }
        let id = self.push(name, Some(topic));
        self.by_topic.insert(topic, id);
        id
    }

    fn push(&mut self, name: &str, topic: Option<TopicId>) -> EventId {
        let id = EventId(self.entries.len() as u32);
        self.entries.push(EventEntry { name: name.to_owned(), topic });
        id
    }

    /// The event of a name; arrivals of messages are not found by name.
    pub fn find(&self, name: &str) -> Option<EventId> {
        self.by_name.get(name).copied()
    }

    /// The event that is each arrival on a topic, if some trigger names it.
    pub fn message(&self, topic: TopicId) -> Option<EventId> {
        self.by_topic.get(&topic).copied()
    }

    /// What an event is called; empty for one of another table.
    pub fn name(&self, event: EventId) -> &str {
        self.entries.get(event.0 as usize).map_or("", |entry| &entry.name)
    }

    /// The topic whose arrivals an event stands for.
    pub fn topic(&self, event: EventId) -> Option<TopicId> {
        self.entries.get(event.0 as usize).and_then(|entry| entry.topic)
    }

    /// How many events there are; their numbers run from 0.
    pub fn len(&self) -> usize {
        self.entries.len()
    }

    /// Whether there is no event.
    pub fn is_empty(&self) -> bool {
        self.entries.is_empty()
    }
}
