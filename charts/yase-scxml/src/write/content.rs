//! Executable content as text: equal contents have equal texts, so that charts with contents can be
//! compared.

use super::element::ElementWriter;
use crate::compiled_text::{CompiledText, LiteralOrExpression};
use crate::content::{
    Block, ExecutableContent, Parameter, ParameterValue, Payload, ScriptSource, Send, ValueSource,
};
use crate::language::{Location, ScriptExpression};

/// Contents as text, without blanks between them.
pub(crate) fn block_text(block: &Block) -> String {
    let mut writer = ElementWriter::compact();
    block_into(&mut writer, block);
    writer.into_text()
}

pub(crate) fn block_into(writer: &mut ElementWriter, block: &Block) {
    block.iter().for_each(|content| content_into(writer, content));
}

fn content_into(writer: &mut ElementWriter, content: &ExecutableContent) {
    match content {
        ExecutableContent::Raise(event) => {
            writer.open("raise");
            writer.attribute("event", event);
        }
        ExecutableContent::If(branches) => branches_into(writer, branches),
        ExecutableContent::Foreach { array, item, index, block } => {
            writer.open("foreach");
            writer.attribute("array", &array.text);
            writer.attribute("item", item);
            writer.optional("index", index.as_deref());
            block_into(writer, block);
        }
        ExecutableContent::Log { label, value } => {
            writer.open("log");
            writer.optional("label", label.as_deref());
            writer.optional("expr", value.as_ref().map(|code| code.text.as_str()));
        }
        ExecutableContent::Assign { location, value } => {
            writer.open("assign");
            writer.attribute("location", &location.text);
            source_into(writer, value);
        }
        ExecutableContent::Script(ScriptSource::Inline(code)) => {
            writer.open("script");
            writer.text(&code.text);
        }
        ExecutableContent::Script(ScriptSource::Uri(uri)) => {
            writer.open("script");
            writer.attribute("src", uri);
        }
        ExecutableContent::Send(send) => send_into(writer, send),
        ExecutableContent::Cancel(id) => {
            writer.open("cancel");
            given_into(writer, Some(id), "sendid", "sendidexpr");
        }
    }
    writer.close();
}

/// Leaves the `<if>` open, to be closed like every other element.
fn branches_into(writer: &mut ElementWriter, branches: &[(Option<CompiledText<ScriptExpression>>, Block)]) {
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

fn send_into(writer: &mut ElementWriter, send: &Send) {
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

pub(crate) fn given_into(
    writer: &mut ElementWriter,
    given: Option<&LiteralOrExpression>,
    fixed: &str,
    computed: &str,
) {
    match given {
        Some(LiteralOrExpression::Fixed(text)) => writer.attribute(fixed, text),
        Some(LiteralOrExpression::Computed(code)) => writer.attribute(computed, &code.text),
        None => {}
    }
}

pub(crate) fn names_into(writer: &mut ElementWriter, names: &[CompiledText<Location>]) {
    if !names.is_empty() {
        let names: Vec<&str> = names.iter().map(|code| code.text.as_str()).collect();
        writer.attribute("namelist", &names.join(" "));
    }
}

/// `<param>` and `<content>`.
pub(crate) fn payload_elements(writer: &mut ElementWriter, payload: &Payload) {
    payload.parameters.iter().for_each(|parameter| parameter_into(writer, parameter));
    if let Some(content) = &payload.content {
        writer.open("content");
        source_into(writer, content);
        writer.close();
    }
}

pub(crate) fn parameter_into(writer: &mut ElementWriter, parameter: &Parameter) {
    writer.open("param");
    writer.attribute("name", &parameter.name);
    match &parameter.value {
        ParameterValue::Expression(code) => writer.attribute("expr", &code.text),
        ParameterValue::Location(code) => writer.attribute("location", &code.text),
    }
    writer.close();
}

/// The attribute or text of a value source.
pub(crate) fn source_into(writer: &mut ElementWriter, source: &ValueSource) {
    match source {
        ValueSource::Nothing => {}
        ValueSource::Expression(code) => writer.attribute("expr", &code.text),
        ValueSource::Uri(uri) => writer.attribute("src", uri),
        ValueSource::Text(text) => writer.text(text),
        ValueSource::Document(text) => writer.raw(text),
    }
}
