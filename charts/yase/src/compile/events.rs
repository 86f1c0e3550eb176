//! Resolves the events that triggers await, once all names are known.

use crate::expression::{CompiledTrigger, EventId, EventInterner};
use crate::semantics::EventMatching;

/// The events that a trigger awaits.
#[derive(Clone, PartialEq, Eq, Debug)]
pub(crate) enum EventFilter {
    Any,
    OneOf(Box<[EventId]>),
    NoneOf(Box<[EventId]>),
}

impl EventFilter {
    /// Resolves a compiled trigger among all events of a chart.
    pub(crate) fn new(
        compiled: &CompiledTrigger,
        events: &EventInterner,
        matching: EventMatching,
    ) -> EventFilter {
        match compiled {
            CompiledTrigger::Any => EventFilter::Any,
            CompiledTrigger::Not(event) => match named(&[*event], events, matching) {
                Some(named) => EventFilter::NoneOf(named),
                None => EventFilter::OneOf(Box::default()),
            },
            CompiledTrigger::OneOf(list) => {
                named(list, events, matching).map_or(EventFilter::Any, EventFilter::OneOf)
            }
        }
    }

    pub(crate) fn matches(&self, event: EventId) -> bool {
        match self {
            EventFilter::Any => true,
            EventFilter::OneOf(events) => events.contains(&event),
            EventFilter::NoneOf(events) => !events.contains(&event),
        }
    }

    /// The events that it names.
    pub(crate) fn events(&self) -> &[EventId] {
        match self {
            EventFilter::Any => &[],
            EventFilter::OneOf(events) | EventFilter::NoneOf(events) => events,
        }
    }
}

/// The events that match names; `None` if all events do.
pub(crate) fn named(
    list: &[EventId],
    events: &EventInterner,
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
