//! Resolves a path to a topic, the origin of its messages and a field.

use std::collections::BTreeSet;

use super::CompileResult;
use super::name_context::NameContext;
use crate::diagnostic::{Diagnostic, Span};
use crate::eval_context::{MessageSource, Origin};
use crate::syntax::{Name, Path};
use crate::vocabulary::{FieldId, MessageEntry, TopicEntry, TopicKind, ValueType};

/// A topic and the origin of its messages.
pub(crate) struct ResolvedTopic<'a> {
    pub(crate) entry: &'a TopicEntry,
    pub(crate) origin: Origin,
}

impl ResolvedTopic<'_> {
    pub(crate) fn message_source(self) -> MessageSource {
        MessageSource { topic: self.entry.id, origin: self.origin }
    }
}

impl<'a> NameContext<'a> {
    /// Resolves the message at the beginning of a path and returns the field names that follow it.
    /// With `M` a message type and `Kind` one of Signal, State and Data, the forms are:
    /// `topic.Kind.M`, `host.topic.Kind.M`, `M`, `publisher.M`, `host.publisher.M`, `topic`.
    pub(crate) fn message<'p>(&self, path: &'p Path) -> CompileResult<(ResolvedTopic<'a>, &'p [Name])> {
        match path.segments.as_slice() {
            [topic, kind, message, rest @ ..] if kind_of(kind).is_some() => Ok((
                ResolvedTopic { entry: self.topic_of_kind(topic, kind, message)?, origin: Origin::Own },
                rest,
            )),
            [host, topic, kind, message, rest @ ..] if kind_of(kind).is_some() => {
                let origin = Origin::Host(host.text.as_str().into());
                Ok((ResolvedTopic { entry: self.topic_of_kind(topic, kind, message)?, origin }, rest))
            }
            [message, rest @ ..] if self.is_message(message) => {
                Ok((ResolvedTopic { entry: self.topic_of_message(message)?, origin: Origin::Own }, rest))
            }
            [publisher, message, rest @ ..] if self.is_message(message) => {
                let origin = Origin::Publisher(publisher.text.as_str().into());
                Ok((ResolvedTopic { entry: self.topic_of_message(message)?, origin }, rest))
            }
            [host, publisher, message, rest @ ..] if self.is_message(message) => {
                let (host, publisher) = (host.text.as_str().into(), publisher.text.as_str().into());
                let origin = Origin::HostPublisher { host, publisher };
                Ok((ResolvedTopic { entry: self.topic_of_message(message)?, origin }, rest))
            }
            [topic, rest @ ..] => {
                Ok((ResolvedTopic { entry: self.topic_of_name(topic)?, origin: Origin::Own }, rest))
            }
            [] => Err(vec![Diagnostic::error("E0132", path.position.0, "there is no name")]),
        }
    }

    /// Resolves field names inside a message to a field and its type; without names the message
    /// itself.
    pub(crate) fn fields(
        &self,
        topic: &TopicEntry,
        names: &[Name],
    ) -> CompileResult<(Box<[FieldId]>, ValueType)> {
        let mut fields = Vec::with_capacity(names.len());
        let mut kind: Option<&ValueType> = None;
        for name in names {
            let message = match kind {
                None => &topic.message,
                Some(ValueType::Message(message)) => message,
                Some(other) => {
                    let text = format!("{} has no field `{}`", describe(other), name.text);
                    let diagnostic = Diagnostic::error("E0134", name.position.0, text);
                    return Err(vec![diagnostic.with_hint(format!("remove `.{}`", name.text))]);
                }
            };
            let entries = self.entry_of(message).map_or(&[][..], |entry| &entry.fields);
            let Some(entry) = entries.iter().find(|entry| entry.name == name.text) else {
                let text = format!("the message `{message}` has no field `{}`", name.text);
                let known = entries.iter().map(|entry| entry.name.as_str());
                let diagnostic = Diagnostic::error("E0134", name.position.0, text);
                return Err(vec![self.unknown(
                    diagnostic,
                    &name.text,
                    known,
                    "see the definition of the message",
                )]);
            };
            fields.push(entry.id);
            kind = Some(&entry.kind);
        }
        let kind = kind.map_or_else(|| ValueType::Message(topic.message.clone()), ValueType::clone);
        Ok((fields.into(), kind))
    }

    /// Suggests a field that may have been meant.
    pub(crate) fn fields_hint(&self, path: &Path, topic: &TopicEntry) -> String {
        match self.entry_of(&topic.message).and_then(|entry| entry.fields.first()) {
            Some(field) => format!("name one of its fields, as in `{path}.{}`", field.name),
            None => "it has no fields".to_owned(),
        }
    }

    pub(crate) fn is_message(&self, name: &Name) -> bool {
        self.entry_of(&name.text).is_some()
    }

    fn entry_of(&self, message: &str) -> Option<&'a MessageEntry> {
        self.vocabulary.messages.iter().find(|entry| entry.name == message)
    }

    /// The topics whose last segment or complete path is the name.
    pub(crate) fn topics_named(&self, name: &str) -> Vec<&'a TopicEntry> {
        let topics = self.vocabulary.topics.iter();
        topics.filter(|topic| last_segment(topic) == name || is_same_path(&topic.path, name)).collect()
    }

    /// The only topic with messages of a type.
    pub(crate) fn topic_of_message(&self, message: &Name) -> CompileResult<&'a TopicEntry> {
        if !self.is_message(message) {
            return Err(vec![self.unknown_message(message)]);
        }
        let topics: Vec<_> =
            self.vocabulary.topics.iter().filter(|topic| topic.message == message.text).collect();
        only(&topics, message.position.0, || format!("messages of type `{}`", message.text))
    }

    fn topic_of_name(&self, name: &Name) -> CompileResult<&'a TopicEntry> {
        let topics = self.topics_named(&name.text);
        if topics.is_empty() {
            return Err(vec![self.unknown_message(name)]);
        }
        only(&topics, name.position.0, || format!("the name `{}`", name.text))
    }

    fn unknown_message(&self, name: &Name) -> Diagnostic {
        let text = format!("there is neither a message nor a topic `{}`", name.text);
        let messages = self.vocabulary.messages.iter().map(|entry| entry.name.as_str());
        let known = messages.chain(self.vocabulary.topics.iter().map(last_segment));
        let diagnostic = Diagnostic::error("E0132", name.position.0, text);
        self.unknown(
            diagnostic,
            &name.text,
            known,
            "a variable is `Message.field` or `topic.Kind.Message.field`",
        )
    }

    /// The topic with this name, kind and message type.
    fn topic_of_kind(&self, name: &Name, kind: &Name, message: &Name) -> CompileResult<&'a TopicEntry> {
        let topics = self.topics_named(&name.text);
        if topics.is_empty() {
            let text = format!("there is no topic `{}`", name.text);
            let known = self.vocabulary.topics.iter().map(last_segment);
            let diagnostic = Diagnostic::error("E0132", name.position.0, text);
            return Err(vec![self.unknown(
                diagnostic,
                &name.text,
                known,
                "a topic is named by its last segment",
            )]);
        }
        let wanted =
            |topic: &&&TopicEntry| Some(topic.kind) == kind_of(kind) && topic.message == message.text;
        let fitting: Vec<_> = topics.iter().filter(wanted).copied().collect();
        if fitting.is_empty() {
            let text =
                format!("the topic `{}` has no {} messages of type `{}`", name.text, kind.text, message.text);
            let forms: Vec<_> = topics.iter().map(|topic| full_form(topic)).collect();
            let diagnostic = Diagnostic::error("E0135", kind.position.0.to(message.position.0), text);
            return Err(vec![diagnostic.with_hint(format!("write {}", forms.join(" or ")))]);
        }
        only(&fitting, name.position.0, || format!("the name `{}`", name.text))
    }

    /// Diagnostic for an unknown name. It suggests the nearest known name, or lists all names if
    /// they are few, or else describes the expected form.
    pub(crate) fn unknown<'n>(
        &self,
        diagnostic: Diagnostic,
        wrong: &str,
        mut known: impl Iterator<Item = &'n str> + Clone,
        form: &str,
    ) -> Diagnostic {
        const MAX_LISTED_TOPICS: usize = 12;
        let diagnostic = diagnostic.with_suggestion(self.suggestions, wrong, known.clone());
        if diagnostic.hint.is_some() {
            return diagnostic;
        }
        let mut names = BTreeSet::new();
        let are_few = known.all(|name| {
            names.insert(name);
            names.len() <= MAX_LISTED_TOPICS
        });
        if !are_few || names.is_empty() {
            return diagnostic.with_hint(form);
        }
        diagnostic.with_hint(format!("known are {}", Vec::from_iter(names).join(", ")))
    }
}

/// The only one of several topics, or a diagnostic that lists them.
fn only<'a>(
    topics: &[&'a TopicEntry],
    span: Span,
    shared: impl Fn() -> String,
) -> CompileResult<&'a TopicEntry> {
    match topics {
        [topic] => Ok(topic),
        [] => {
            let diagnostic = Diagnostic::error("E0133", span, format!("no topic has {}", shared()));
            Err(vec![
                diagnostic.with_hint("read a message that is published, or a field that holds this one"),
            ])
        }
        several => {
            let forms: Vec<_> = several.iter().map(|topic| full_form(topic)).collect();
            let diagnostic = Diagnostic::error("E0133", span, format!("several topics have {}", shared()));
            Err(vec![diagnostic.with_hint(format!("write {}", forms.join(" or ")))])
        }
    }
}

pub(crate) fn kind_of(name: &Name) -> Option<TopicKind> {
    match name.text.as_str() {
        "Signal" => Some(TopicKind::Signal),
        "State" => Some(TopicKind::State),
        "Data" => Some(TopicKind::Data),
        _ => None,
    }
}

/// Name of a type in diagnostics.
pub(crate) fn describe(kind: &ValueType) -> String {
    match kind {
        ValueType::Bool => "true or false".to_owned(),
        ValueType::Number => "a number".to_owned(),
        ValueType::Text => "a text".to_owned(),
        ValueType::Enumeration(name) => format!("a `{name}`"),
        ValueType::Message(name) => format!("a message `{name}`"),
    }
}

fn last_segment(topic: &TopicEntry) -> &str {
    topic.path.rsplit('/').next().unwrap_or_default()
}

/// Whether two paths are equal, separated by slashes or dots.
fn is_same_path(a: &str, b: &str) -> bool {
    let dotted = |byte: u8| if byte == b'/' { b'.' } else { byte };
    a.len() == b.len() && a.bytes().map(dotted).eq(b.bytes().map(dotted))
}

fn dotted(topic: &TopicEntry) -> String {
    topic.path.replace('/', ".")
}

/// The form that denotes only this topic.
pub(crate) fn full_form(topic: &TopicEntry) -> String {
    let kind = match topic.kind {
        TopicKind::Signal => "Signal",
        TopicKind::State => "State",
        TopicKind::Data => "Data",
    };
    format!("`` `{}`.{kind}.{} ``", dotted(topic), topic.message)
}
