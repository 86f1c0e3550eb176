//! The XMI form of a System Roles Model: `<SRM:SRMmodel>` with `<roles name liveness/>` and `<activities name/>`.

use std::collections::BTreeSet;
use std::ops::Range;

use roxmltree::{Document, Node};
use yase::{Diagnostic, Span};

use super::Reader;

impl Reader {
    /// Reads the name and the formulas of the model's role.
    pub(super) fn xmi(&mut self, text: &str) {
        match Document::parse(text) {
            Ok(document) => self.model(text, &document),
            Err(error) => {
                let place = place(text, error.pos());
                self.report(Diagnostic::error(
                    "E0246",
                    place,
                    format!("this is not well-formed XML: {error}"),
                ));
            }
        }
    }

    fn model(&mut self, text: &str, document: &Document<'_>) {
        let root = document.root_element();
        let name = root.tag_name().name();
        if name != "SRMmodel" {
            let message = format!("this is a `{name}`, not a System Roles Model");
            let hint = "a role is an `SRM:SRMmodel`, or text";
            return self.report(Diagnostic::error("E0230", tag(text, root), message).with_hint(hint));
        }
        let mut roles = children(root, "roles");
        let Some(role) = roles.next() else {
            let hint = "add `<roles name=.. liveness=../>`";
            return self.report(
                Diagnostic::error("E0247", tag(text, root), "the model has no role").with_hint(hint),
            );
        };
        if let Some(second) = roles.next() {
            let message = "the model has more than one role, of which the first is read";
            self.report(
                Diagnostic::error("E0248", tag(text, second), message)
                    .with_hint("keep each role in a file of its own"),
            );
        }
        self.xmi_role(text, role);
        self.unknown_activities(root);
    }

    fn xmi_role(&mut self, text: &str, role: Node<'_, '_>) {
        self.srm.role = role.attribute("name").unwrap_or_default().trim().into();
        let liveness = role.attributes().find(|attribute| attribute.name() == "liveness");
        match liveness.map(|attribute| attribute.range_value()) {
            Some(range) => self.liveness(&decoded(text, range.clone()), range.into()),
            None => {
                let hint = "add `liveness=\"role=activity\"`";
                self.report(
                    Diagnostic::error("E0233", tag(text, role), "the role has no formulas").with_hint(hint),
                );
            }
        }
        self.entries.clear();
    }

    /// A name that is neither a formula's nor one of the model's activities is probably misspelt.
    fn unknown_activities(&mut self, root: Node<'_, '_>) {
        let liveness = &self.srm.liveness;
        let activities: BTreeSet<&str> =
            children(root, "activities").filter_map(|node| node.attribute("name")).collect();
        let formulas: BTreeSet<&str> =
            liveness.formulas().iter().map(|formula| formula.name.as_str()).collect();
        let known: BTreeSet<&str> = activities.union(&formulas).copied().collect();
        let names = liveness.formulas().iter().flat_map(|formula| liveness.names(formula));
        let unknown = names.filter(|(name, _)| !activities.is_empty() && !known.contains(name));
        let warnings = unknown.map(|(name, span)| {
            let message = format!("the model has no activity `{name}`");
            Diagnostic::warning("E0249", span, message).with_nearest(name, known.iter().copied())
        });
        self.diagnostics.extend(warnings);
    }
}

fn children<'a, 'input>(
    node: Node<'a, 'input>,
    name: &'static str,
) -> impl Iterator<Item = Node<'a, 'input>> {
    node.children().filter(move |child| child.has_tag_name(name))
}

/// From the `<` of an element to the end of its name.
fn tag(text: &str, node: Node<'_, '_>) -> Span {
    let start = node.range().start;
    let name = text[start..].find([' ', '>', '/', '\n', '\t', '\r']);
    Span::new(start, start + name.unwrap_or(text.len() - start))
}

/// The character at a line and column, both from 1; the end of the text if there is none.
fn place(text: &str, position: roxmltree::TextPos) -> Span {
    let (row, column) = (position.row.saturating_sub(1) as usize, position.col.saturating_sub(1) as usize);
    let lines = text.split_inclusive('\n');
    let start: usize = lines.take(row).map(str::len).sum();
    match text[start..].char_indices().nth(column) {
        Some((at, letter)) => Span::new(start + at, start + at + letter.len_utf8()),
        None => Span::new(text.len(), text.len()),
    }
}

/// The text with the value of an attribute decoded, each reference padded with blanks, which mean nothing in a formula: so every
/// byte keeps its place. Line breaks are blanks unless written as references, as XML has it.
fn decoded(text: &str, value: Range<usize>) -> String {
    let mut decoded = String::from(&text[..value.start]);
    let mut rest = &text[value.clone()];
    while let Some(character) = rest.chars().next() {
        let reference = reference(rest);
        let (meant, length) = match reference {
            Some(reference) => reference,
            None if character.is_whitespace() => (' ', character.len_utf8()),
            None => (character, character.len_utf8()),
        };
        decoded.push(meant);
        decoded.extend(std::iter::repeat_n(' ', length - meant.len_utf8()));
        rest = &rest[length..];
    }
    decoded.push_str(&text[value.end..]);
    decoded
}

/// The character that a reference at the beginning of a text stands for, and the length of the reference.
fn reference(text: &str) -> Option<(char, usize)> {
    let (name, _) = text.strip_prefix('&')?.split_once(';')?;
    let character = match name {
        "amp" => '&',
        "lt" => '<',
        "gt" => '>',
        "quot" => '"',
        "apos" => '\'',
        _ => char::from_u32(match name.strip_prefix("#x") {
            Some(digits) => u32::from_str_radix(digits, 16).ok()?,
            None => name.strip_prefix('#')?.parse().ok()?,
        })?,
    };
    Some((character, name.len() + 2))
}
