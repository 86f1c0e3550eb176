//! `monas topic pub`: a message from outside.

use prost_reflect::DynamicMessage;
use prost_reflect::prost::Message as _;
use serde_json::json;

use super::arguments::RunChoice;
use super::connect::{self, failure};
use super::schemas::Schemas;
use crate::arguments::Format;
use crate::console::Console;
use crate::exit::Exit;
use crate::failure::Failure;

pub(super) fn execute(
    topic: &str,
    message: &str,
    choice: &RunChoice,
    console: &mut Console<'_>,
) -> Result<Exit, Failure> {
    let format = choice.format.value;
    let mut client = connect::client(choice)?;
    let host = match &choice.host {
        Some(host) => host.clone(),
        None => only_host(client.describe().map_err(failure(format))?.hosts)?,
    };
    let descriptor = Schemas::new(connect::socket(choice)?, format).of(topic)?;
    let name = descriptor.full_name().to_owned();
    let mut text = serde_json::Deserializer::from_str(message);
    let read = DynamicMessage::deserialize(descriptor, &mut text).and_then(|read| text.end().map(|()| read));
    let read = read.map_err(|error| Failure::Usage(format!("`{message}` is no `{name}`: {error}")))?;
    client.publish(&host, topic, read.encode_to_vec()).map_err(failure(format))?;
    match format {
        Format::Json => writeln!(console.out, "{}", json!({"host": host, "topic": topic, "type": name}))?,
        Format::Text => writeln!(console.out, "published on {topic} of {host}")?,
    }
    Ok(Exit::Success)
}

fn only_host(hosts: Vec<String>) -> Result<String, Failure> {
    match <[String; 1]>::try_from(hosts) {
        Ok([host]) => Ok(host),
        Err(hosts) => {
            let hosts: Vec<String> = hosts.iter().map(|host| format!("`{host}`")).collect();
            Err(Failure::Usage(format!(
                "there are several hosts, {}: say which with --host NAME",
                hosts.join(", ")
            )))
        }
    }
}
