//! Message types that are learned of from a run, and messages as JSON.

use std::collections::BTreeMap;
use std::path::PathBuf;

use monas_link::control::ControlClient;
use prost_reflect::{DynamicMessage, MessageDescriptor, SerializeOptions};
use serde_json::Value;

use super::connect::failure;
use crate::arguments::Format;
use crate::failure::Failure;

/// The message types of a run's topics, asked for when they are first needed.
pub(super) struct Schemas {
    socket: PathBuf,
    format: Format,
    client: Option<ControlClient>,
    by_topic: BTreeMap<String, MessageDescriptor>,
}

impl Schemas {
    pub(super) fn new(socket: PathBuf, format: Format) -> Schemas {
        Schemas { socket, format, client: None, by_topic: BTreeMap::new() }
    }

    /// The message type of a topic.
    pub(super) fn of(&mut self, topic: &str) -> Result<MessageDescriptor, Failure> {
        if let Some(known) = self.by_topic.get(topic) {
            return Ok(known.clone());
        }
        let schema = self.fetch(topic)?;
        let odd = |what: String| {
            Failure::failed(self.format, format!("the schema of `{topic}` cannot be used: {what}"))
        };
        let pool = monas_tape::descriptor_pool(&schema.descriptors).map_err(odd)?;
        let message = pool.get_message_by_name(&schema.r#type);
        let message = message.ok_or_else(|| odd(format!("it does not hold `{}`", schema.r#type)))?;
        self.by_topic.insert(topic.to_owned(), message.clone());
        Ok(message)
    }

    /// A connection that has said nothing for long may have been closed: then there is another.
    fn fetch(&mut self, topic: &str) -> Result<monas_link::control::messages::Schema, Failure> {
        if let Some(Ok(schema)) = self.client.as_mut().map(|client| client.schema(topic)) {
            return Ok(schema);
        }
        let client = ControlClient::connect(&self.socket).map_err(failure(self.format))?;
        self.client.insert(client).schema(topic).map_err(failure(self.format))
    }

    /// The message that bytes encode.
    pub(super) fn decode(&mut self, topic: &str, bytes: &[u8]) -> Result<Value, Failure> {
        let format = self.format;
        let odd =
            |what: String| Failure::failed(format, format!("a message of `{topic}` cannot be read: {what}"));
        let message =
            DynamicMessage::decode(self.of(topic)?, bytes).map_err(|error| odd(error.to_string()))?;
        let options = SerializeOptions::new()
            .use_proto_field_name(true)
            .stringify_64_bit_integers(false)
            .skip_default_fields(false);
        message
            .serialize_with_options(serde_json::value::Serializer, &options)
            .map_err(|error| odd(error.to_string()))
    }
}
