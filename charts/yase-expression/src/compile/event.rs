//! Resolves names of events: an event has a name or is the arrival of a message on a topic.

use super::CompileResult;
use super::message::{full_form, kind_of};
use super::name_context::NameContext;
use crate::diagnostic::Diagnostic;
use crate::eval_context::Origin;
use crate::names::{EventId, EventInterner};
use crate::syntax::{Name, Path};
use crate::vocabulary::{TopicEntry, TopicKind};

/// The topic of a message, and its host if that is not the own host.
type TopicArrival<'a> = (&'a TopicEntry, Option<Box<str>>);

/// A message of the own host.
fn own(topic: &TopicEntry) -> Option<TopicArrival<'_>> {
    Some((topic, None))
}

impl NameContext<'_> {
    /// The event that a trigger names.
    pub(crate) fn event(&self, path: &Path, events: &mut EventInterner) -> CompileResult<EventId> {
        Ok(match self.arrival(path)? {
            Some((topic, None)) => events.intern_message(topic.id, &topic.path),
            Some((topic, Some(host))) => {
                events.intern_message_of(&host, topic.id, &format!("{} of {host}", topic.path))
            }
            None => match path.bare() {
                Some(name) => events.intern(name),
                None => events.intern(&path.text()),
            },
        })
    }

    /// The event that an action raises. It cannot be a message, since messages are published.
    pub(crate) fn raised_event(&self, path: &Path, events: &mut EventInterner) -> CompileResult<EventId> {
        if self.arrival(path)?.is_none() {
            return Ok(events.intern(&path.text()));
        }
        let message = format!("`{path}` is a message, and messages are not raised");
        let diagnostic = Diagnostic::error("E0144", path.position.0, message);
        Err(vec![diagnostic.with_hint("give the event another name, or use `publish`")])
    }

    /// The topic whose messages the path names and the host if it is another; `None` if the path
    /// names an event of the chart.
    fn arrival(&self, path: &Path) -> CompileResult<Option<TopicArrival<'_>>> {
        if self.timer(path).is_some() {
            return Ok(None);
        }
        match path.segments.as_slice() {
            [_, kind, _, ..] if kind_of(kind).is_some() => self.arrival_of_path(path).map(Some),
            [_, _, kind, _, ..] if kind_of(kind).is_some() => self.arrival_of_path(path).map(Some),
            [prefix, message] if prefix.text == "Message" => self.topic_of_message(message).map(own),
            [message] if self.is_message(message) => self.topic_of_message(message).map(own),
            [name] => self.arrival_of_topic(name).map(|topic| topic.and_then(own)),
            _ => Ok(None),
        }
    }

    fn arrival_of_path(&self, path: &Path) -> CompileResult<TopicArrival<'_>> {
        let (source, fields) = self.message(path)?;
        let fault = match (source.origin, fields.first()) {
            (Origin::Own, None) => return Ok((source.entry, None)),
            (Origin::Host(host), None) => return Ok((source.entry, Some(host))),
            (Origin::Own | Origin::Host(_), Some(field)) => {
                (field.position, format!("`{}` is a field; a trigger names a message", field.text))
            }
            _ => (
                path.position,
                format!("`{path}` is a message of one publisher; events are the messages of all publishers"),
            ),
        };
        Err(vec![
            Diagnostic::error("E0146", fault.0.0, fault.1).with_hint("read it in a condition, in brackets"),
        ])
    }

    /// A bare name denotes the topic of a signal. Other kinds of topics need the complete path, so
    /// that a topic is never confused with an event.
    fn arrival_of_topic(&self, name: &Name) -> CompileResult<Option<&TopicEntry>> {
        let whole_path = name.text.contains(['.', '/']);
        let mut topics = self.topics_named(&name.text);
        topics.retain(|topic| whole_path || topic.kind == TopicKind::Signal);
        match topics.as_slice() {
            [] => Ok(None),
            [topic] => Ok(Some(topic)),
            several => {
                let forms: Vec<_> = several.iter().map(|topic| full_form(topic)).collect();
                let message = format!("several topics have the name `{}`", name.text);
                let diagnostic = Diagnostic::error("E0133", name.position.0, message);
                Err(vec![diagnostic.with_hint(format!("write {}", forms.join(" or ")))])
            }
        }
    }
}
