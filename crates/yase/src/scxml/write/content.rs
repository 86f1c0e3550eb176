//! Executable content as text: the same for the same content, so that charts that hold it can be compared.

use super::element::Writer;
use crate::scxml::code::{Code, Given};
use crate::scxml::content::{Block, Content, Parameter, ParameterValue, Payload, Script, Send, Source};
use crate::scxml::language::{Expression, Location};

/// Contents as text, without blanks between them.
pub(crate) fn block_text(block: &Block) -> String {
    let mut writer = Writer::compact();
    block_into(&mut writer, block);
    writer.into_text()
}

pub(super) fn block_into(writer: &mut Writer, block: &Block) {
    block.iter().for_each(|content| content_into(writer, content));
}

fn content_into(writer: &mut Writer, content: &Content) {
    match content {
        Content::Raise(event) => {
            writer.open("raise");
            writer.attribute("event", event);
        }
        Content::If(branches) => branches_into(writer, branches),
        Content::Foreach { array, item, index, block } => {
            writer.open("foreach");
            writer.attribute("array", &array.text);
            writer.attribute("item", item);
            writer.optional("index", index.as_deref());
            block_into(writer, block);
        }
        Content::Log { label, value } => {
            writer.open("log");
            writer.optional("label", label.as_deref());
            writer.optional("expr", value.as_ref().map(|code| code.text.as_str()));
        }
        Content::Assign { location, value } => {
            writer.open("assign");
            writer.attribute("location", &location.text);
            source_into(writer, value);
        }
        Content::Script(Script::Inline(code)) => {
            writer.open("script");
            writer.text(&code.text);
        }
        Content::Script(Script::Uri(uri)) => {
            writer.open("script");
            writer.attribute("src", uri);
        }
        Content::Send(send) => send_into(writer, send),
        Content::Cancel(id) => {
            writer.open("cancel");
            given_into(writer, Some(id), "sendid", "sendidexpr");
        }
    }
    writer.close();
}

/// Leaves the `<if>` open, to be closed like every other element.
fn branches_into(writer: &mut Writer, branches: &[(Option<Code<Expression>>, Block)]) {
    for (index, (condition, block)) in branches.iter().enumerate() {
        writer.open(match (index, condition) {
            (0, _) => "if",
            (_, Some(_)) => "elseif",
            (_, None) => "else",
        });
        writer.optional("cond", condition.as_ref().map(|code| code.text.as_str()));
        if index > 0 {
            writer.close();
        }
        block_into(writer, block);
    }
}

fn send_into(writer: &mut Writer, send: &Send) {
    writer.open("send");
    given_into(writer, send.event.as_ref(), "event", "eventexpr");
    given_into(writer, send.target.as_ref(), "target", "targetexpr");
    given_into(writer, send.kind.as_ref(), "type", "typeexpr");
    writer.optional("id", send.id.as_deref());
    writer.optional("idlocation", send.id_location.as_ref().map(|code| code.text.as_str()));
    given_into(writer, send.delay.as_ref(), "delay", "delayexpr");
    names_into(writer, &send.payload.names);
    payload_elements(writer, &send.payload);
}

pub(super) fn given_into(writer: &mut Writer, given: Option<&Given>, fixed: &str, computed: &str) {
    match given {
        Some(Given::Fixed(text)) => writer.attribute(fixed, text),
        Some(Given::Computed(code)) => writer.attribute(computed, &code.text),
        None => {}
    }
}

pub(super) fn names_into(writer: &mut Writer, names: &[Code<Location>]) {
    if !names.is_empty() {
        let names: Vec<&str> = names.iter().map(|code| code.text.as_str()).collect();
        writer.attribute("namelist", &names.join(" "));
    }
}

/// `<param>` and `<content>`.
pub(super) fn payload_elements(writer: &mut Writer, payload: &Payload) {
    payload.parameters.iter().for_each(|parameter| parameter_into(writer, parameter));
    if let Some(content) = &payload.content {
        writer.open("content");
        source_into(writer, content);
        writer.close();
    }
}

pub(super) fn parameter_into(writer: &mut Writer, parameter: &Parameter) {
    writer.open("param");
    writer.attribute("name", &parameter.name);
    match &parameter.value {
        ParameterValue::Expression(code) => writer.attribute("expr", &code.text),
        ParameterValue::Location(code) => writer.attribute("location", &code.text),
    }
    writer.close();
}

/// The attribute or the text that gives a value.
pub(super) fn source_into(writer: &mut Writer, source: &Source) {
    match source {
        Source::Nothing => {}
        Source::Expression(code) => writer.attribute("expr", &code.text),
        Source::Uri(uri) => writer.attribute("src", uri),
        Source::Text(text) => writer.text(text),
        Source::Document(text) => writer.raw(text),
    }
}
