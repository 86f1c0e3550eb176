//! Executable content.

use crate::lexical::quoted;
use roxmltree::Node;

use super::DocumentReader;
use crate::compiled_text::CompiledText;
use crate::content::{
    Block, ExecutableContent, Parameter, ParameterValue, Payload, ScriptSource, Send, ValueSource,
};
use crate::document::DataModel;
use crate::language::{ScriptExpression, is_json, parse_expression};
use crate::xml::{elements, is_scxml, markup, tag, text_of};
use yase::diagnostic::{Diagnostic, Span};

impl DocumentReader<'_> {
    /// The contents of an element, in order.
    pub(crate) fn block(&mut self, node: Node<'_, '_>) -> Block {
        self.check(node);
        self.scxml_children(node).into_iter().filter_map(|child| self.content(child)).collect()
    }

    fn content(&mut self, node: Node<'_, '_>) -> Option<ExecutableContent> {
        let name = node.tag_name().name();
        if !matches!(name, "if" | "foreach") {
            self.check(node);
        }
        if self.data_model == DataModel::Null && matches!(name, "assign" | "script" | "foreach") {
            self.not_in_null(tag(node), &format!("a `{name}`"));
        }
        match name {
            "raise" => self.raise(node),
            "if" => Some(self.branches(node)),
            "foreach" => self.foreach(node),
            "log" => {
                let label = node.attribute("label").map(str::to_owned);
                Some(ExecutableContent::Log { label, value: self.expression(node, "expr") })
            }
            "assign" => self.assign(node),
            "script" => Some(ExecutableContent::Script(self.script(node))),
            "send" => Some(ExecutableContent::Send(Box::new(self.send(node)))),
            "cancel" => {
                let id = self.given(node, "sendid", "sendidexpr");
                if id.is_none() {
                    self.error("E0604", tag(node), "`cancel` lacks the attribute `sendid`");
                }
                id.map(ExecutableContent::Cancel)
            }
            _ => None,
        }
    }

    fn raise(&mut self, node: Node<'_, '_>) -> Option<ExecutableContent> {
        let event = node.attribute("event")?.trim();
        let span = self.value_span(node, "event");
        self.event_name(event, span).then(|| ExecutableContent::Raise(event.to_owned()))
    }

    /// Whether a text is the name of an event: words separated by dots.
    pub(crate) fn event_name(&mut self, name: &str, span: Span) -> bool {
        let fits = !name.is_empty()
            && name.split('.').all(|token| !token.is_empty())
            && !name.contains(|character: char| character.is_whitespace() || "`*".contains(character));
        if !fits {
            let message = format!("`{name}` is not the name of an event");
            self.error("E0609", span, message).hint =
                Some("a name is words with dots between them, such as `door.open`".into());
        }
        fits
    }

    fn branches(&mut self, node: Node<'_, '_>) -> ExecutableContent {
        self.check(node);
        let mut branches = vec![(Some(self.condition(node)), Block::new())];
        for child in self.scxml_children(node) {
            match child.tag_name().name() {
                "elseif" | "else" => {
                    self.check(child);
                    if branches.last().is_some_and(|(condition, _)| condition.is_none()) {
                        self.error("E0615", tag(child), "nothing comes after `else`");
                    }
                    let last = child.tag_name().name() == "else";
                    let condition = if last { None } else { Some(self.condition(child)) };
                    branches.push((condition, Block::new()));
                }
                _ => {
                    let content = self.content(child);
                    if let Some((_, block)) = branches.last_mut() {
                        block.extend(content);
                    }
                }
            }
        }
        ExecutableContent::If(branches)
    }

    /// The condition of an element that requires one.
    fn condition(&mut self, node: Node<'_, '_>) -> CompiledText<ScriptExpression> {
        self.expression(node, "cond").unwrap_or_else(|| CompiledText::expression("false"))
    }

    fn foreach(&mut self, node: Node<'_, '_>) -> Option<ExecutableContent> {
        let block = self.block(node);
        let array = self.expression(node, "array")?;
        let item = node.attribute("item")?.to_owned();
        let index = node.attribute("index").map(str::to_owned);
        Some(ExecutableContent::Foreach { array, item, index, block })
    }

    fn assign(&mut self, node: Node<'_, '_>) -> Option<ExecutableContent> {
        let location = self.location(node, "location")?;
        let value = self.source(node);
        Some(ExecutableContent::Assign { location, value })
    }

    pub(crate) fn script(&mut self, node: Node<'_, '_>) -> ScriptSource {
        let text = text_of(node);
        match node.attribute("src") {
            Some(uri) => {
                self.exclude(node, &[("`src`", true), ("text", !text.trim().is_empty())]);
                ScriptSource::Uri(uri.to_owned())
            }
            None => ScriptSource::Inline(self.program(node, &text)),
        }
    }

    /// The value given by `expr`, `src` or the text of an element.
    pub(crate) fn source(&mut self, node: Node<'_, '_>) -> ValueSource {
        let text = text_of(node);
        let has_text = !text.trim().is_empty();
        let given = [
            ("`expr`", node.has_attribute("expr")),
            ("`src`", node.has_attribute("src")),
            ("content", has_text || elements(node).next().is_some()),
        ];
        self.exclude(node, &given);
        if let Some(inside) = elements(node).next() {
            return self.element_as_value(inside);
        }
        match (self.expression(node, "expr"), node.attribute("src")) {
            (Some(code), _) => ValueSource::Expression(code),
            (None, Some(uri)) => ValueSource::Uri(uri.to_owned()),
            (None, None) if has_text => self.literal(node, text),
            (None, None) => ValueSource::Nothing,
        }
    }

    /// Only a document to invoke can be a value; the subset cannot access other elements.
    fn element_as_value(&mut self, inside: Node<'_, '_>) -> ValueSource {
        if inside.tag_name().name() == "scxml" && is_scxml(inside) {
            return ValueSource::Document(markup(inside));
        }
        self.error("E0610", tag(inside), "XML as a value needs a DOM, which is outside the subset");
        ValueSource::Nothing
    }

    fn literal(&mut self, node: Node<'_, '_>, text: String) -> ValueSource {
        if let (true, Some(first)) = (is_function(&text), node.children().find(|child| child.is_text())) {
            self.judge(&CompiledText::expression(&text), first.range().into());
        }
        ValueSource::Text(text)
    }

    pub(crate) fn send(&mut self, node: Node<'_, '_>) -> Send {
        self.exclude_attributes(node, ["id", "idlocation"]);
        let event = self.given(node, "event", "eventexpr");
        let delay = self.given(node, "delay", "delayexpr");
        if let Some(text) = node.attribute("delay")
            && super::super::time::delay(text).is_none()
        {
            let span = self.value_span(node, "delay");
            self.error("E0609", span, format!("`{text}` is not a delay")).hint =
                Some("a delay is a number with its unit, such as `500ms` or `1.5s`".into());
        }
        let send = Send {
            event,
            target: self.given(node, "target", "targetexpr"),
            kind: self.given(node, "type", "typeexpr"),
            id: node.attribute("id").map(str::to_owned),
            id_location: self.location(node, "idlocation"),
            delay,
            payload: self.payload(node),
        };
        if node.attribute("target") == Some("#_internal") && send.delay.is_some() {
            let message = "an event that goes to `#_internal` cannot be delayed";
            self.error("E0608", tag(node), message);
        }
        if send.event.is_none() && send.payload.content.is_none() {
            self.error("E0604", tag(node), "`send` lacks the attribute `event`");
        }
        send
    }

    /// `namelist`, `<param>` and `<content>`.
    pub(crate) fn payload(&mut self, node: Node<'_, '_>) -> Payload {
        let names = self.names(node);
        let mut payload = Payload { names, ..Payload::default() };
        let mut contents = 0;
        for child in self.scxml_children(node) {
            match child.tag_name().name() {
                "param" => payload.parameters.extend(self.parameter(child)),
                "content" => {
                    self.check(child);
                    contents += 1;
                    payload.content = Some(self.source(child));
                }
                _ => {}
            }
        }
        if contents > 1 {
            self.error("E0615", tag(node), format!("`{}` has several contents", node.tag_name().name()));
        }
        let named = !payload.names.is_empty() || !payload.parameters.is_empty();
        self.exclude(node, &[("named values", named), ("a content", contents > 0)]);
        payload
    }

    pub(crate) fn parameter(&mut self, node: Node<'_, '_>) -> Option<Parameter> {
        self.check(node);
        self.exclude_attributes(node, ["expr", "location"]);
        let name = node.attribute("name")?.to_owned();
        let value = match self.expression(node, "expr") {
            Some(code) => ParameterValue::Expression(code),
            None => ParameterValue::Location(self.location(node, "location").or_else(|| {
                self.error("E0604", tag(node), "`param` has neither `expr` nor `location`");
                None
            })?),
        };
        Some(Parameter { name, value })
    }

    /// Contents that must not send or raise events.
    pub(crate) fn silent(&mut self, node: Node<'_, '_>) {
        for inner in node.descendants() {
            if inner.is_element() && matches!(inner.tag_name().name(), "send" | "raise") {
                let message = format!("`{}` cannot stand in `finalize`", inner.tag_name().name());
                self.report(Diagnostic::error("E0615", tag(inner), message));
            }
        }
    }
}

/// Whether the text of a value is a function.
pub(crate) fn is_function(text: &str) -> bool {
    text.trim_start().starts_with("function")
}

/// The expression for the text between tags: JSON, a function, or a text with normalised blanks.
pub(crate) fn literal(text: &str) -> CompiledText<ScriptExpression> {
    let text = text.trim();
    if is_json(text) || (is_function(text) && parse_expression(text).is_ok()) {
        return CompiledText::expression(text);
    }
    let words: Vec<&str> = text.split_whitespace().collect();
    CompiledText::expression(&quoted(&words.join(" ")))
}
