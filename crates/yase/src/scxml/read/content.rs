//! Executable content.

use roxmltree::Node;

use super::Reader;
use crate::diagnostic::{Diagnostic, Span};
use crate::scxml::code::Code;
use crate::scxml::content::{Block, Content, Parameter, ParameterValue, Payload, Script, Send, Source};
use crate::scxml::document::DataModel;
use crate::scxml::language::{Expression, is_json, parse_expression};
use crate::scxml::xml::{elements, is_scxml, markup, tag, text_of};

impl Reader<'_> {
    /// The contents of an element, in order.
    pub(super) fn block(&mut self, node: Node<'_, '_>) -> Block {
        self.check(node);
        self.scxml_children(node).into_iter().filter_map(|child| self.content(child)).collect()
    }

    fn content(&mut self, node: Node<'_, '_>) -> Option<Content> {
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
                Some(Content::Log { label, value: self.expression(node, "expr") })
            }
            "assign" => self.assign(node),
            "script" => Some(Content::Script(self.script(node))),
            "send" => Some(Content::Send(Box::new(self.send(node)))),
            "cancel" => {
                let id = self.given(node, "sendid", "sendidexpr");
                if id.is_none() {
                    self.error("E0604", tag(node), "`cancel` has no attribute `sendid`");
                }
                id.map(Content::Cancel)
            }
            _ => None,
        }
    }

    fn raise(&mut self, node: Node<'_, '_>) -> Option<Content> {
        let event = node.attribute("event")?.trim();
        let span = self.value_span(node, "event");
        self.event_name(event, span).then(|| Content::Raise(event.to_owned()))
    }

    /// Whether a text is the name of an event: words separated by dots.
    pub(super) fn event_name(&mut self, name: &str, span: Span) -> bool {
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

    fn branches(&mut self, node: Node<'_, '_>) -> Content {
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
        Content::If(branches)
    }

    /// The condition of an element that must have one.
    fn condition(&mut self, node: Node<'_, '_>) -> Code<Expression> {
        self.expression(node, "cond").unwrap_or_else(|| Code::expression("false"))
    }

    fn foreach(&mut self, node: Node<'_, '_>) -> Option<Content> {
        let block = self.block(node);
        let array = self.expression(node, "array")?;
        let item = node.attribute("item")?.to_owned();
        let index = node.attribute("index").map(str::to_owned);
        Some(Content::Foreach { array, item, index, block })
    }

    fn assign(&mut self, node: Node<'_, '_>) -> Option<Content> {
        let location = self.location(node, "location")?;
        let value = self.source(node);
        Some(Content::Assign { location, value })
    }

    pub(super) fn script(&mut self, node: Node<'_, '_>) -> Script {
        let text = text_of(node);
        match node.attribute("src") {
            Some(uri) => {
                self.exclude(node, &[("`src`", true), ("text", !text.trim().is_empty())]);
                Script::Uri(uri.to_owned())
            }
            None => Script::Inline(self.program(node, &text)),
        }
    }

    /// The value that `expr`, `src` or the text of an element gives.
    pub(super) fn source(&mut self, node: Node<'_, '_>) -> Source {
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
            (Some(code), _) => Source::Expression(code),
            (None, Some(uri)) => Source::Uri(uri.to_owned()),
            (None, None) if has_text => self.literal(node, text),
            (None, None) => Source::Nothing,
        }
    }

    /// A document to invoke can be a value; no other element can, since nothing of the subset could look into it.
    fn element_as_value(&mut self, inside: Node<'_, '_>) -> Source {
        if inside.tag_name().name() == "scxml" && is_scxml(inside) {
            return Source::Document(markup(inside));
        }
        self.error("E0610", tag(inside), "XML as a value needs a DOM, which is outside the subset");
        Source::Nothing
    }

    fn literal(&mut self, node: Node<'_, '_>, text: String) -> Source {
        if let (true, Some(first)) = (is_function(&text), node.children().find(|child| child.is_text())) {
            self.judge(&Code::expression(&text), first.range().into());
        }
        Source::Text(text)
    }

    pub(super) fn send(&mut self, node: Node<'_, '_>) -> Send {
        self.exclude_attributes(node, ["id", "idlocation"]);
        let event = self.given(node, "event", "eventexpr");
        let delay = self.given(node, "delay", "delayexpr");
        if let Some(text) = node.attribute("delay")
            && super::super::time::delay(text).is_none()
        {
            let span = self.value_span(node, "delay");
            self.error("E0609", span, format!("`{text}` is no delay")).hint =
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
            self.error("E0604", tag(node), "`send` has no attribute `event`");
        }
        send
    }

    /// `namelist`, `<param>` and `<content>`.
    pub(super) fn payload(&mut self, node: Node<'_, '_>) -> Payload {
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

    pub(super) fn parameter(&mut self, node: Node<'_, '_>) -> Option<Parameter> {
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

    /// Contents that must not send or raise anything.
    pub(super) fn silent(&mut self, node: Node<'_, '_>) {
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

/// The expression that the text between tags is: JSON, a function, or a text with its blanks normalised.
pub(crate) fn literal(text: &str) -> Code<Expression> {
    let text = text.trim();
    if is_json(text) || (is_function(text) && parse_expression(text).is_ok()) {
        return Code::expression(text);
    }
    let words: Vec<&str> = text.split_whitespace().collect();
    Code::expression(&quoted(&words.join(" ")))
}

/// A text as the language writes it.
pub(crate) fn quoted(text: &str) -> String {
    let mut quoted = String::from("'");
    for character in text.chars() {
        match character {
            '\'' => quoted.push_str("\\'"),
            '\\' => quoted.push_str("\\\\"),
            '\n' => quoted.push_str("\\n"),
            '\r' => quoted.push_str("\\r"),
            other => quoted.push(other),
        }
    }
    quoted.push('\'');
    quoted
}
