//! Type environment of charts' expressions, from the topics and functions of the program.

use std::collections::BTreeMap;

use narukom::{EnumDescriptor, FieldKind, MessageDescriptor, RetentionKind, TopicDeclaration};
use yase::vocabulary::{
    Enumeration, FieldEntry, FunctionEntry, MessageEntry, TopicEntry, TopicKind, TypeEnvironment, ValueType,
};
use yase::{FieldId, FunctionId, TopicId};

use crate::function::FunctionDeclaration;

/// Constructs a type environment. The number of a topic is its index among all paths in order, as
/// in every hub; that of a function its index in `functions`; that of a field its index in the
/// message's descriptor.
pub(crate) fn vocabulary<'a>(
    topics: impl IntoIterator<Item = &'a TopicDeclaration>,
    functions: &[FunctionDeclaration],
) -> TypeEnvironment {
    let topics: BTreeMap<&str, &TopicDeclaration> =
        topics.into_iter().map(|topic| (topic.path(), topic)).collect();
    let mut types = Types::default();
    topics.values().for_each(|topic| types.collect(topic.descriptor()));
    TypeEnvironment {
        scripts: false,
        topics: topics.values().enumerate().map(|(number, topic)| types.topic(number, topic)).collect(),
        messages: types.messages.values().map(|message| types.message(message)).collect(),
        enumerations: types.enumerations.values().map(|enumeration| types.enumeration(enumeration)).collect(),
        functions: functions.iter().enumerate().map(|(number, function)| entry(number, function)).collect(),
    }
}

/// Each topic with the name of its message type in expressions.
pub(crate) fn message_names<'a>(
    topics: impl IntoIterator<Item = &'a TopicDeclaration>,
) -> Vec<(&'a TopicDeclaration, String)> {
    let topics: Vec<&TopicDeclaration> = topics.into_iter().collect();
    let mut types = Types::default();
    topics.iter().for_each(|topic| types.collect(topic.descriptor()));
    topics.into_iter().map(|topic| (topic, types.message_name(topic.descriptor()))).collect()
}

fn entry(number: usize, function: &FunctionDeclaration) -> FunctionEntry {
    FunctionEntry {
        id: FunctionId(number as u32),
        name: function.name.into(),
        parameters: (function.parameters)(),
        result: (function.result)(),
    }
}

/// All types of which the topics' messages consist, by full name.
#[derive(Default)]
struct Types {
    messages: BTreeMap<&'static str, &'static MessageDescriptor>,
    enumerations: BTreeMap<&'static str, &'static EnumDescriptor>,
}

impl Types {
    /// Adds a message type and its nested types; types may be recursive.
    fn collect(&mut self, message: &'static MessageDescriptor) {
        if self.messages.insert(message.full_name, message).is_some() {
            return;
        }
        for field in message.fields {
            match field.kind {
                FieldKind::Message(inner) => self.collect(inner()),
                FieldKind::Enum(enumeration) => {
                    self.enumerations.insert(enumeration.full_name, enumeration);
                }
                _ => {}
            }
        }
    }

    /// A message is named without its package, unless two packages have a message of that name.
    fn message_name(&self, message: &MessageDescriptor) -> String {
        let namesakes = self.messages.values().filter(|other| other.name == message.name).count();
        if namesakes > 1 { message.full_name } else { message.name }.to_owned()
    }

    fn enumeration_name(&self, enumeration: &EnumDescriptor) -> String {
        let namesakes = self.enumerations.values().filter(|other| other.name == enumeration.name).count();
        if namesakes > 1 { enumeration.full_name } else { enumeration.name }.to_owned()
    }

    fn topic(&self, number: usize, topic: &TopicDeclaration) -> TopicEntry {
        TopicEntry {
            id: TopicId(number as u32),
            path: topic.path().into(),
            kind: match topic.kind() {
                RetentionKind::State => TopicKind::State,
                RetentionKind::Signal => TopicKind::Signal,
                RetentionKind::Data => TopicKind::Data,
            },
            message: self.message_name(topic.descriptor()),
        }
    }

    fn message(&self, message: &MessageDescriptor) -> MessageEntry {
        let fields = message.fields.iter().enumerate();
        let fields = fields.filter_map(|(index, field)| {
            let kind = self.value_type(field.kind)?;
            Some(FieldEntry { id: FieldId(index as u32), name: field.name.into(), kind })
        });
        MessageEntry { name: self.message_name(message), fields: fields.collect() }
    }

    fn enumeration(&self, enumeration: &EnumDescriptor) -> Enumeration {
        let values = enumeration.values.iter().map(|(name, number)| ((*name).to_owned(), *number));
        Enumeration { name: self.enumeration_name(enumeration), values: values.collect() }
    }

    /// The type of a field in expressions; none for lists, maps and bytes, which they cannot read.
    fn value_type(&self, kind: FieldKind) -> Option<ValueType> {
        match kind {
            FieldKind::Bool => Some(ValueType::Bool),
            FieldKind::I32
            | FieldKind::I64
            | FieldKind::U32
            | FieldKind::U64
            | FieldKind::F32
            | FieldKind::F64 => Some(ValueType::Number),
            FieldKind::Text => Some(ValueType::Text),
            FieldKind::Enum(enumeration) => Some(ValueType::Enumeration(self.enumeration_name(enumeration))),
            FieldKind::Message(inner) => Some(ValueType::Message(self.message_name(inner()))),
            _ => None,
        }
    }
}

#[cfg(test)]
mod tests {
    use narukom::TOPICS;

    use super::*;

    #[test]
    fn topics_are_numbered_as_in_every_hub() {
        let words = vocabulary(TOPICS, &[]);
        let hub = narukom::Hub::with_linked_topics("a").unwrap();
        let paths: Vec<&str> = words.topics.iter().map(|topic| topic.path.as_str()).collect();
        assert_eq!(paths, hub.topics().iter().map(|topic| topic.path()).collect::<Vec<_>>());
        for topic in &words.topics {
            assert_eq!(hub.topic(&topic.path).map(|slot| slot.number()), Some(topic.id.0));
        }
    }

    #[test]
    fn fields_and_enumerations_are_those_of_the_messages() {
        let words = vocabulary(TOPICS, &[]);
        let sensors = words.messages.iter().find(|message| message.name == "Sensors").unwrap();
        let field = |name: &str| sensors.fields.iter().find(|field| field.name == name).unwrap();
        assert_eq!(field("head_yaw").kind, ValueType::Number);
        assert_eq!(field("chest_button").kind, ValueType::Bool);
        assert_eq!(field("posture").kind, ValueType::Enumeration("Posture".into()));
        let descriptor = <monas_robot::Sensors as narukom::Message>::DESCRIPTOR;
        assert_eq!(descriptor.field_index("posture"), Some(field("posture").id.0 as usize));
        let posture = words.enumerations.iter().find(|enumeration| enumeration.name == "Posture").unwrap();
        assert!(posture.values.contains(&("FALLEN".into(), 4)));
    }

    #[test]
    fn lists_have_no_place_in_expressions() {
        let words = vocabulary(TOPICS, &[]);
        let sightings = words.messages.iter().find(|message| message.name == "Sightings").unwrap();
        assert!(sightings.fields.iter().all(|field| field.name != "objects"));
    }
}
