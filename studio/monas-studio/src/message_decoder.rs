//! Messages as JSON, by the schemas of a run.

use std::collections::BTreeMap;

use prost_reflect::{DynamicMessage, MessageDescriptor, SerializeOptions};
use serde_json::Value;

/// The message types of topics.
#[derive(Clone, Default, Debug)]
pub(crate) struct MessageDecoder {
    by_topic: BTreeMap<String, Result<MessageDescriptor, String>>,
}

impl MessageDecoder {
    pub(crate) fn knows(&self, topic: &str) -> bool {
        self.by_topic.contains_key(topic)
    }

    /// Adds the type of a topic: its full name, and a serialised `FileDescriptorSet`.
    pub(crate) fn learn(&mut self, topic: &str, name: &str, descriptors: &[u8]) {
        let found = monas_tape::descriptor_pool(descriptors).and_then(|pool| {
            pool.get_message_by_name(name).ok_or_else(|| format!("the schema does not contain `{name}`"))
        });
        self.by_topic.insert(topic.to_owned(), found);
    }

    /// The message type of a topic.
    ///
    /// # Errors
    /// It is not known, or its schema cannot be used.
    pub(crate) fn descriptor(&self, topic: &str) -> Result<MessageDescriptor, String> {
        self.by_topic
            .get(topic)
            .cloned()
            .unwrap_or_else(|| Err(format!("the type of `{topic}` is not known")))
    }

    /// A message as JSON; for a message that cannot be decoded, a text with the reason.
    pub(crate) fn decode(&self, topic: &str, bytes: &[u8]) -> Value {
        let unread = |reason: &str| Value::String(format!("({} bytes: {reason})", bytes.len()));
        match self.by_topic.get(topic) {
            None => unread("the type is not known yet"),
            Some(Err(reason)) => unread(reason),
            Some(Ok(descriptor)) => message_json(descriptor, bytes).unwrap_or_else(|reason| unread(&reason)),
        }
    }
}

/// A message of a type as JSON, with the fields' own names, and numbers of 64 bits as numbers.
///
/// # Errors
/// The reason why the bytes are no such message.
pub fn message_json(descriptor: &MessageDescriptor, bytes: &[u8]) -> Result<Value, String> {
    let message = DynamicMessage::decode(descriptor.clone(), bytes).map_err(|error| error.to_string())?;
    let options = SerializeOptions::new()
        .use_proto_field_name(true)
        .stringify_64_bit_integers(false)
        .skip_default_fields(false);
    message.serialize_with_options(serde_json::value::Serializer, &options).map_err(|error| error.to_string())
}
