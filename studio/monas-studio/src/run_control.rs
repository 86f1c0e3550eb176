//! Executes control requests of viewers that are allowed to change the run.

use monas::records::{Change, Changed, Inquiry, Reply};
use monas_link::control::ControlClient;
use prost::Message;
use prost_reflect::{DynamicMessage, EnumDescriptor, FieldDescriptor, Kind, MessageDescriptor};
use serde_json::{Value, json};

use crate::control_request::ControlRequest;
use crate::live_state::LiveState;
use crate::message_decoder::message_json;

/// The longest chain of messages within messages that a form shows.
const MAX_DEPTH: usize = 4;

/// Executes a request of a viewer. Returns the reply without its number: success or the reason of
/// failure, and the results.
pub(crate) fn execute(state: &LiveState, request: ControlRequest) -> Value {
    let result = match request {
        ControlRequest::Change { host, change } => change_agents(state, host, *change),
        ControlRequest::Publish { host, topic, message } => publish(state, &host, &topic, message),
        ControlRequest::Form { topic } => form(state, &topic),
    };
    result.unwrap_or_else(|reason| json!({"done": false, "reason": reason}))
}

fn client(state: &LiveState) -> Result<ControlClient, String> {
    ControlClient::connect(&state.socket).map_err(|error| error.to_string())
}

fn change_agents(state: &LiveState, host: String, change: Change) -> Result<Value, String> {
    let change = Change { number: std::process::id().into(), ..change };
    let inquiry = Inquiry { host, change: Some(change), ..Inquiry::default() };
    let reply = client(state)?.manage(inquiry.encode_to_vec()).map_err(|error| error.to_string())?;
    let reply = Reply::decode(reply.as_slice()).map_err(|error| error.to_string())?;
    let Changed { done, cycle, findings, .. } = reply.changed.ok_or("unexpected reply of the run")?;
    let findings: Vec<Value> = findings
        .iter()
        .map(|finding| {
            json!({"code": finding.code, "error": finding.is_error, "text": finding.message, "hint": finding.hint,
                "file": finding.file, "line": finding.line, "column": finding.column})
        })
        .collect();
    let reason = (!done).then_some("the run refuses the change");
    Ok(json!({"done": done, "reason": reason, "cycle": cycle, "findings": findings}))
}

fn publish(state: &LiveState, host: &str, topic: &str, message: Value) -> Result<Value, String> {
    let mut client = client(state)?;
    let descriptor = descriptor(state, &mut client, topic)?;
    let name = descriptor.full_name().to_owned();
    let message = DynamicMessage::deserialize(descriptor, message)
        .map_err(|error| format!("this is not a `{name}`: {error}"))?;
    client.publish(host, topic, message.encode_to_vec()).map_err(|error| error.to_string())?;
    Ok(json!({"done": true}))
}

fn descriptor(
    state: &LiveState,
    client: &mut ControlClient,
    topic: &str,
) -> Result<MessageDescriptor, String> {
    if !state.view().decoder.knows(topic) {
        let schema = client.schema(topic).map_err(|error| error.to_string())?;
        state.view().decoder.learn(topic, &schema.r#type, &schema.descriptors);
    }
    state.view().decoder.descriptor(topic)
}

/// The fields of the messages of a topic, with their kinds and defaults.
fn form(state: &LiveState, topic: &str) -> Result<Value, String> {
    let descriptor = descriptor(state, &mut client(state)?, topic)?;
    let fields: Vec<Value> = descriptor.fields().map(|field| field_object(&field)).collect();
    Ok(json!({"done": true, "message_type": descriptor.full_name(), "fields": fields}))
}

fn field_object(field: &FieldDescriptor) -> Value {
    let (kind, values, default) = match field.kind() {
        _ if field.is_list() => ("json", None, json!([])),
        _ if field.is_map() => ("json", None, json!({})),
        Kind::Message(message) => ("json", None, default_message(&message, MAX_DEPTH)),
        Kind::Enum(kind) => ("enum", Some(value_names(&kind)), json!(kind.default_value().name())),
        Kind::Bool => ("boolean", None, json!(false)),
        Kind::String | Kind::Bytes => ("text", None, json!("")),
        Kind::Float | Kind::Double => ("number", None, json!(0)),
        _ => ("integer", None, json!(0)),
    };
    let type_name = match field.kind() {
        Kind::Message(message) => message.full_name().to_owned(),
        Kind::Enum(kind) => kind.full_name().to_owned(),
        scalar => format!("{scalar:?}").to_lowercase(),
    };
    let type_name = if field.is_list() { format!("repeated {type_name}") } else { type_name };
    json!({"name": field.name(), "kind": kind, "type": type_name, "values": values, "default": default})
}

fn value_names(kind: &EnumDescriptor) -> Vec<String> {
    kind.values().map(|value| value.name().to_owned()).collect()
}

/// A message of a type with the defaults of all its fields, down to a depth.
fn default_message(descriptor: &MessageDescriptor, depth: usize) -> Value {
    let mut object = message_json(descriptor, &[]).unwrap_or_else(|_| json!({}));
    for field in descriptor.fields().filter(|field| !field.is_list() && !field.is_map()) {
        if let (Kind::Message(inner), Value::Object(object), true) = (field.kind(), &mut object, depth > 0)
            && !inner.full_name().starts_with("google.protobuf.")
        {
            object.insert(field.name().to_owned(), default_message(&inner, depth - 1));
        }
    }
    object
}
