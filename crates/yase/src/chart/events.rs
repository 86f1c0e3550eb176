//! Which events a trigger waits for, once all names are known.

use crate::expression::{CompiledTrigger, EventId, EventTable};
use crate::semantics::EventMatching;

/// The events that a trigger waits for.
#[derive(Clone, PartialEq, Eq, Debug)]
pub(crate) enum Trigger {
    Any,
    OneOf(Box<[EventId]>),
    NoneOf(Box<[EventId]>),
}

impl Trigger {
    /// What a compiled trigger means among all events of a chart.
    pub(super) fn new(compiled: &CompiledTrigger, events: &EventTable, matching: EventMatching) -> Trigger {
        match compiled {
            CompiledTrigger::Any => Trigger::Any,
            CompiledTrigger::Not(event) => match named(&[*event], events, matching) {
                Some(named) => Trigger::NoneOf(named),
                None => Trigger::OneOf(Box::default()),
            },
            CompiledTrigger::OneOf(list) => {
                named(list, events, matching).map_or(Trigger::Any, Trigger::OneOf)
            }
        }
    }

    pub(crate) fn matches(&self, event: EventId) -> bool {
        match self {
            Trigger::Any => true,
            Trigger::OneOf(events) => events.contains(&event),
            Trigger::NoneOf(events) => !events.contains(&event),
        }
    }

    /// The events that it names.
    pub(super) fn events(&self) -> &[EventId] {
        match self {
            Trigger::Any => &[],
            Trigger::OneOf(events) | Trigger::NoneOf(events) => events,
        }
    }
}

/// The events that names stand for; none if that is all of them.
pub(super) fn named(
    list: &[EventId],
    events: &EventTable,
    matching: EventMatching,
) -> Option<Box<[EventId]>> {
    if matching == EventMatching::Exact {
        return Some(list.into());
    }
    let mut all = Vec::new();
    for &event in list {
        if events.topic(event).is_some() {
            all.push(event);
            continue;
        }
        let name = events.name(event);
        if name == "*" {
            return None;
        }
        all.extend(events.beginning_with(name.strip_suffix(".*").unwrap_or(name)));
    }
    all.sort_unstable();
    all.dedup();
    Some(all.into())
}
