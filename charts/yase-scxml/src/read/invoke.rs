//! `<invoke>`.

use roxmltree::Node;

use super::DocumentReader;
use crate::content::{InlineDocument, Invoke};
use crate::xml::{elements, is_scxml, markup, tag, text_of};
use yase::diagnostic::Diagnostic;

impl DocumentReader<'_> {
    pub(crate) fn invoke(&mut self, node: Node<'_, '_>) -> Invoke {
        self.check(node);
        self.exclude_attributes(node, ["id", "idlocation"]);
        let mut invoke = Invoke {
            kind: self.given(node, "type", "typeexpr"),
            source: self.given(node, "src", "srcexpr"),
            id: node.attribute("id").map(str::to_owned),
            id_location: self.location(node, "idlocation"),
            names: self.names(node),
            autoforward: self.autoforward(node),
            ..Invoke::default()
        };
        for child in self.scxml_children(node) {
            match child.tag_name().name() {
                "param" => invoke.parameters.extend(self.parameter(child)),
                "content" => {
                    if invoke.content.is_some() {
                        self.error("E0615", tag(child), "`invoke` has several contents");
                    }
                    invoke.content = self.inner(child);
                }
                "finalize" => {
                    self.silent(child);
                    if invoke.finalize.is_some() {
                        self.error("E0615", tag(child), "`invoke` has several `finalize`");
                    }
                    invoke.finalize = Some(self.block(child));
                }
                _ => {}
            }
        }
        let from_outside = invoke.source.is_some();
        self.exclude(node, &[("a source", from_outside), ("a content", invoke.content.is_some())]);
        let named = (!invoke.names.is_empty(), !invoke.parameters.is_empty());
        self.exclude(node, &[("`namelist`", named.0), ("`param`", named.1)]);
        invoke
    }

    fn autoforward(&mut self, node: Node<'_, '_>) -> bool {
        match node.attribute("autoforward") {
            None | Some("false" | "0") => false,
            Some("true" | "1") => true,
            Some(other) => {
                let span = self.value_span(node, "autoforward");
                self.error("E0609", span, format!("`{other}` is neither `true` nor `false`"));
                false
            }
        }
    }

    /// The document inside `<content>`, read immediately so that diagnostics have the right
    /// position.
    fn inner(&mut self, node: Node<'_, '_>) -> Option<InlineDocument> {
        self.check(node);
        let document = elements(node).find(|&child| is_scxml(child) && child.tag_name().name() == "scxml");
        let expression = self.expression(node, "expr");
        let inside = elements(node).next().is_some() || !text_of(node).trim().is_empty();
        self.exclude(node, &[("`expr`", expression.is_some()), ("content", inside)]);
        if let Some(expression) = expression {
            return Some(InlineDocument::Expression(expression));
        }
        let Some(document) = document else {
            self.error("E0615", tag(node), "the content of an invocation is an `scxml` document");
            return None;
        };
        let mut reader = DocumentReader::new(self.text);
        let _ = reader.document(document);
        self.found.extend(reader.found.into_iter().filter(Diagnostic::is_error));
        Some(InlineDocument::Document(markup(document)))
    }
}
