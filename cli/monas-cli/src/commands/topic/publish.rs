//! `monas topic pub`: publishes a message.

use monas_terminal::{CommandFailure, CommandOutput, Exit, Format};
use prost_reflect::DynamicMessage;
use prost_reflect::prost::Message as _;
use serde_json::json;

use super::schemas::Schemas;
use crate::remote::{RunSelector, connection, failure};

pub(crate) fn execute(
    topic: &str,
    message: &str,
    choice: &RunSelector,
    console: &mut CommandOutput<'_>,
) -> Result<Exit, CommandFailure> {
    let format = choice.format.value;
    let mut client = connection::client(choice)?;
    let host = match &choice.host {
        Some(host) => host.clone(),
        None => only_host(client.describe().map_err(failure(format))?.hosts)?,
    };
    let descriptor = Schemas::new(connection::socket(choice)?, format).of(topic)?;
    let name = descriptor.full_name().to_owned();
    let mut text = serde_json::Deserializer::from_str(message);
    let read = DynamicMessage::deserialize(descriptor, &mut text).and_then(|read| text.end().map(|()| read));
    let read =
        read.map_err(|error| CommandFailure::Usage(format!("`{message}` is not a `{name}`: {error}")))?;
    client.publish(&host, topic, read.encode_to_vec()).map_err(failure(format))?;
    match format {
        Format::Json => writeln!(console.out, "{}", json!({"host": host, "topic": topic, "type": name}))?,
        Format::Text => writeln!(console.out, "published on {topic} of {host}")?,
    }
    Ok(Exit::Success)
}

fn only_host(hosts: Vec<String>) -> Result<String, CommandFailure> {
    match <[String; 1]>::try_from(hosts) {
        Ok([host]) => Ok(host),
        Err(hosts) => {
            let hosts: Vec<String> = hosts.iter().map(|host| format!("`{host}`")).collect();
            Err(CommandFailure::Usage(format!(
                "there are several hosts, {}: select one with --host NAME",
                hosts.join(", ")
            )))
        }
    }
}
