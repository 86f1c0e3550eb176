//! Message types requested from a run, and messages as JSON.

use std::collections::BTreeMap;
use std::path::PathBuf;

use monas_link::control::ControlClient;
use monas_terminal::{CommandFailure, Format};
use prost_reflect::MessageDescriptor;
use serde_json::Value;

use crate::remote::failure;

/// The message types of a run's topics, requested on first use.
pub(crate) struct Schemas {
    socket: PathBuf,
    format: Format,
    client: Option<ControlClient>,
    by_topic: BTreeMap<String, MessageDescriptor>,
}

impl Schemas {
    pub(crate) fn new(socket: PathBuf, format: Format) -> Schemas {
        Schemas { socket, format, client: None, by_topic: BTreeMap::new() }
    }

    /// The message type of a topic.
    pub(crate) fn of(&mut self, topic: &str) -> Result<MessageDescriptor, CommandFailure> {
        if let Some(known) = self.by_topic.get(topic) {
            return Ok(known.clone());
        }
        let schema = self.fetch(topic)?;
        let odd = |what: String| {
            CommandFailure::failed(self.format, format!("the schema of `{topic}` cannot be used: {what}"))
        };
        let pool = monas_tape::descriptor_pool(&schema.descriptors).map_err(odd)?;
        let message = pool.get_message_by_name(&schema.r#type);
        let message = message.ok_or_else(|| odd(format!("it does not contain `{}`", schema.r#type)))?;
        self.by_topic.insert(topic.to_owned(), message.clone());
        Ok(message)
    }

    /// Reconnects if the run has closed an idle connection.
    fn fetch(&mut self, topic: &str) -> Result<monas_link::control::messages::Schema, CommandFailure> {
        if let Some(Ok(schema)) = self.client.as_mut().map(|client| client.schema(topic)) {
            return Ok(schema);
        }
        let client = ControlClient::connect(&self.socket).map_err(failure(self.format))?;
        self.client.insert(client).schema(topic).map_err(failure(self.format))
    }

    /// Decodes a message to JSON.
    pub(crate) fn decode(&mut self, topic: &str, bytes: &[u8]) -> Result<Value, CommandFailure> {
        let format = self.format;
        let odd = |what: String| {
            CommandFailure::failed(format, format!("a message of `{topic}` cannot be read: {what}"))
        };
        monas_studio::message_json(&self.of(topic)?, bytes).map_err(odd)
    }
}
