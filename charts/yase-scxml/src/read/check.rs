//! Checks of elements, and access to attributes.

use roxmltree::Node;

use super::DocumentReader;
use crate::compiled_text::{CompiledText, LiteralOrExpression};
use crate::document::DataModel;
use crate::grammar::{ELEMENTS_WITH_ANY_CONTENT, ElementGrammar, element};
use crate::language::{Location, ScriptExpression, ScriptProgram};
use crate::xml::{elements, is_scxml, tag};
use yase::diagnostic::{Diagnostic, Span};

impl DocumentReader<'_> {
    /// Checks the names of the attributes and children of an element.
    pub(crate) fn check(&mut self, node: Node<'_, '_>) {
        let name = node.tag_name().name();
        let Some(known) = element(name) else { return };
        self.check_attributes(node, known);
        if ELEMENTS_WITH_ANY_CONTENT.contains(&name) {
            return;
        }
        for child in elements(node).filter(|&child| is_scxml(child)) {
            self.check_child(child, known);
        }
        if name != "script" {
            self.check_text(node);
        }
    }

    fn check_attributes(&mut self, node: Node<'_, '_>, known: &ElementGrammar) {
        let name = known.name;
        for given in node.attributes().filter(|given| given.namespace().is_none()) {
            if !known.attributes.contains(&given.name()) {
                let message = format!("unknown attribute `{}` of `{name}`", given.name());
                let span: Span = given.range_qname().into();
                self.report(
                    Diagnostic::error("E0603", span, message)
                        .with_nearest(given.name(), known.attributes.iter().copied()),
                );
            }
        }
        for required in known.required.iter().filter(|required| node.attribute(**required).is_none()) {
            self.error("E0604", tag(node), format!("`{name}` lacks the attribute `{required}`"));
        }
    }

    fn check_child(&mut self, child: Node<'_, '_>, outer: &ElementGrammar) {
        let name = child.tag_name().name();
        if outer.children.contains(&name) {
            return;
        }
        let diagnostic = match element(name) {
            Some(_) => {
                let message = format!("`{name}` cannot stand in `{}`", outer.name);
                Diagnostic::error("E0615", tag(child), message)
            }
            None => {
                let message = format!("unknown element `{name}` in `{}`", outer.name);
                Diagnostic::error("E0602", tag(child), message)
                    .with_nearest(name, outer.children.iter().copied())
            }
        };
        self.report(diagnostic);
    }

    fn check_text(&mut self, node: Node<'_, '_>) {
        let texts = node.children().filter(|child| child.is_text());
        for text in texts.filter(|text| text.text().is_some_and(|text| !text.trim().is_empty())) {
            let message = format!("text cannot stand in `{}`", node.tag_name().name());
            self.error("E0615", text.range().into(), message);
        }
    }

    /// The SCXML children of an element; a diagnostic reports that others are left out.
    pub(crate) fn scxml_children<'b, 'input>(&mut self, node: Node<'b, 'input>) -> Vec<Node<'b, 'input>> {
        let (known, foreign): (Vec<_>, Vec<_>) = elements(node).partition(|&child| is_scxml(child));
        for child in foreign {
            let message = format!("`{}` is not an element of SCXML and is left out", child.tag_name().name());
            self.report(Diagnostic::warning("E0618", tag(child), message));
        }
        known
    }

    /// Position of the value of an attribute.
    pub(crate) fn value_span(&self, node: Node<'_, '_>, name: &str) -> Span {
        node.attribute_node(name).map_or(tag(node), |given| given.range_value().into())
    }

    /// Reports attributes or children that exclude each other.
    pub(crate) fn exclude(&mut self, node: Node<'_, '_>, given: &[(&str, bool)]) -> bool {
        let present: Vec<&str> =
            given.iter().filter(|(_, present)| *present).map(|(name, _)| *name).collect();
        if present.len() < 2 {
            return true;
        }
        let message =
            format!("`{}` has {}, of which one is too many", node.tag_name().name(), present.join(" and "));
        self.error("E0608", tag(node), message);
        false
    }

    pub(crate) fn exclude_attributes(&mut self, node: Node<'_, '_>, names: [&str; 2]) {
        let given = names.map(|name| (name, node.has_attribute(name)));
        self.exclude(node, &given);
    }

    /// An expression in an attribute.
    pub(crate) fn expression(
        &mut self,
        node: Node<'_, '_>,
        name: &str,
    ) -> Option<CompiledText<ScriptExpression>> {
        let code = CompiledText::expression(node.attribute(name)?);
        let span = self.value_span(node, name);
        self.judge(&code, span);
        if self.data_model == DataModel::Null && !code.compiled().is_none_or(ScriptExpression::is_null) {
            self.not_in_null(span, "an expression");
        }
        Some(code)
    }

    /// A location in an attribute.
    pub(crate) fn location(&mut self, node: Node<'_, '_>, name: &str) -> Option<CompiledText<Location>> {
        let code = CompiledText::location(node.attribute(name)?);
        let span = self.value_span(node, name);
        self.judge(&code, span);
        if self.data_model == DataModel::Null {
            self.not_in_null(span, "a variable");
        }
        Some(code)
    }

    /// The locations in `namelist`.
    pub(crate) fn names(&mut self, node: Node<'_, '_>) -> Vec<CompiledText<Location>> {
        let names = node.attribute("namelist").unwrap_or_default().split_whitespace();
        let names: Vec<_> = names.map(CompiledText::location).collect();
        let span = self.value_span(node, "namelist");
        if self.data_model == DataModel::Null && !names.is_empty() {
            self.not_in_null(span, "a variable");
        }
        for name in &names {
            self.judge_at(name, span);
        }
        names
    }

    /// An attribute, given literally or as an expression.
    pub(crate) fn given(
        &mut self,
        node: Node<'_, '_>,
        fixed: &str,
        computed: &str,
    ) -> Option<LiteralOrExpression> {
        self.exclude_attributes(node, [fixed, computed]);
        match node.attribute(fixed) {
            Some(text) => Some(LiteralOrExpression::Fixed(text.to_owned())),
            None => self.expression(node, computed).map(LiteralOrExpression::Computed),
        }
    }

    pub(crate) fn program(&mut self, node: Node<'_, '_>, text: &str) -> CompiledText<ScriptProgram> {
        let code = CompiledText::program(text);
        let first = node.children().find(|child| child.is_text());
        self.judge(&code, first.map_or(tag(node), |text| text.range().into()));
        code
    }

    /// Reports an invalid text of the language, at its position in the document if that is known.
    pub(crate) fn judge<T>(&mut self, code: &CompiledText<T>, whole: Span) {
        let Some(refused) = code.refused() else { return };
        let verbatim = self.text.get(whole.start..whole.end) == Some(code.text.as_str());
        self.judge_at(code, if verbatim { refused.span.shifted(whole.start) } else { whole });
    }

    fn judge_at<T>(&mut self, code: &CompiledText<T>, span: Span) {
        let Some(refused) = code.refused() else { return };
        let diagnostic = if code.is_unsupported() {
            Diagnostic::error("E0610", span, &refused.message)
        } else {
            Diagnostic::warning("E0611", span, format!("not ECMAScript: {}", refused.message))
                .with_hint("it will be an error.execution when its turn comes")
        };
        self.report(diagnostic);
    }

    pub(crate) fn not_in_null(&mut self, span: Span, what: &str) {
        self.error("E0613", span, format!("there is {what} in a document of the null data model")).hint =
            Some("say `datamodel=\"ecmascript\"`; the null data model has nothing but `In()`".into());
    }
}
