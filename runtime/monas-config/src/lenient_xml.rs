//! Repairs XML, with a mapping from each byte to the original text.
//!
//! The thesis writes `<agent Priority=1>` without quotes and several roots in a file, and closing
//! tags may be missing. [`repair`] reads such a text tag by tag, reports errors, and writes a text
//! that an XML parser accepts: values quoted, ampersands escaped, tags closed, comments,
//! declarations and references to schemas dropped, one root around everything.

use std::collections::BTreeSet;

use yase::{Diagnostic, Span};

/// Maximum nesting depth, which bounds the stack of recursive readers.
const MAX_DEPTH: usize = 64;

/// The root element added around everything.
pub(crate) const ROOT: &str = "monas";

/// Prefixes of attributes that name the schema and language of a file for editors: dropped.
const EDITOR_PREFIXES: [&str; 3] = ["xml", "xmlns", "xsi"];

/// A well-formed text, and diagnostics of the original.
pub(crate) struct RepairedXml {
    pub(crate) text: String,
    pub(crate) diagnostics: Vec<Diagnostic>,
    pieces: Vec<TextRun>,
}

/// A run of bytes of the repaired text: copied from the original, or inserted at a position of it.
struct TextRun {
    start: usize,
    original: usize,
    copied: bool,
}

impl RepairedXml {
    /// A text that needs no repair.
    pub(crate) fn unchanged(text: &str) -> RepairedXml {
        let whole = TextRun { start: 0, original: 0, copied: true };
        RepairedXml { text: text.to_owned(), diagnostics: Vec::new(), pieces: vec![whole] }
    }

    /// The byte of the original that corresponds to a byte of the repaired text.
    pub(crate) fn original(&self, byte: usize) -> usize {
        let index = self.pieces.partition_point(|piece| piece.start <= byte);
        match index.checked_sub(1).map(|index| &self.pieces[index]) {
            Some(piece) if piece.copied => piece.original + (byte - piece.start),
            Some(piece) => piece.original,
            None => 0,
        }
    }

    /// The span of the original that corresponds to a span of the repaired text.
    pub(crate) fn original_span(&self, start: usize, end: usize) -> Span {
        let first = self.original(start);
        let end = if end > start { self.original_end(end - 1) } else { first };
        Span::new(first, end.max(first))
    }

    /// The end in the original of a byte of the repaired text. Inserted text corresponds to the
    /// text it replaces, if any.
    fn original_end(&self, byte: usize) -> usize {
        let index = self.pieces.partition_point(|piece| piece.start <= byte);
        match (index.checked_sub(1).map(|index| &self.pieces[index]), self.pieces.get(index)) {
            (Some(piece), _) if piece.copied => piece.original + (byte - piece.start) + 1,
            (Some(_), Some(next)) => next.original,
            _ => self.original(byte),
        }
    }
}

/// The span clamped to the text and widened to whole characters.
pub(crate) fn within(text: &str, span: Span) -> Span {
    let mut start = span.start.min(text.len());
    while !text.is_char_boundary(start) {
        start -= 1;
    }
    let mut end = span.end.clamp(start, text.len());
    while !text.is_char_boundary(end) {
        end += 1;
    }
    Span::new(start, end)
}

/// Repairs a text.
pub(crate) fn repair(source: &str) -> RepairedXml {
    let mut writer = RepairWriter {
        source,
        at: 0,
        open: Vec::new(),
        too_deep: 0,
        out: RepairedXml {
            text: String::with_capacity(source.len() + 64),
            diagnostics: vec![],
            pieces: vec![],
        },
    };
    writer.insert(&format!("<{ROOT}>"));
    // Some editors write a byte order mark.
    writer.at = source.len() - source.trim_start_matches('\u{feff}').len();
    match is_without_elements(writer.rest()) {
        true => writer.refuse(),
        false => {
            while writer.at < source.len() {
                writer.item();
            }
        }
    }
    writer.close_down_to(0);
    writer.insert(&format!("</{ROOT}>"));
    writer.out
}

/// Whether it is the text of another language: each line of it would be a mistake of XML.
fn is_without_elements(text: &str) -> bool {
    let begins = text.trim_start();
    !begins.is_empty() && !begins.starts_with('<') && !text.contains("</") && !text.contains("/>")
}

struct RepairWriter<'a> {
    source: &'a str,
    at: usize,
    /// Name of each open element, and the location of the name in its tag.
    open: Vec<(&'a str, Span)>,
    /// Number of open elements that are left out because of the nesting depth.
    too_deep: usize,
    out: RepairedXml,
}

impl<'a> RepairWriter<'a> {
    /// Reports a text of another language at its first line.
    fn refuse(&mut self) {
        let rest = self.rest();
        let start = self.at + (rest.len() - rest.trim_start().len());
        let line = self.source[start..].lines().next().unwrap_or_default().trim_end();
        let hint = "XML begins with an element; the name of a configuration in TOML ends with `.toml`";
        self.report(start..start + line.len(), "this is not XML", hint);
        self.at = self.source.len();
    }

    /// Reads one comment, declaration, tag or run of text.
    fn item(&mut self) {
        let rest = self.rest();
        if rest.starts_with("<!--") {
            self.skip_to("-->", "this comment is not closed");
        } else if rest.starts_with("<![CDATA[") {
            self.character_data();
        } else if rest.starts_with("<?") {
            self.skip_to("?>", "this declaration is not closed");
        } else if rest.starts_with("<!") {
            self.report(self.at..self.at + 2, "document types are not supported", "leave it out");
            self.skip_to(">", "this document type is not closed");
        } else if rest.starts_with("</") {
            self.closing_tag();
        } else if rest.strip_prefix('<').is_some_and(starts_name) {
            self.opening_tag();
        } else {
            self.text();
        }
    }

    fn rest(&self) -> &'a str {
        &self.source[self.at..]
    }

    fn report(&mut self, span: impl Into<Span>, message: impl Into<String>, hint: impl Into<String>) {
        let span = within(self.source, span.into());
        self.out.diagnostics.push(Diagnostic::error("E0301", span, message).with_hint(hint));
    }

    fn insert(&mut self, text: &str) {
        self.out.pieces.push(TextRun { start: self.out.text.len(), original: self.at, copied: false });
        self.out.text.push_str(text);
    }

    /// Copies the bytes up to `end`, where reading continues.
    fn copy_to(&mut self, end: usize) {
        self.out.pieces.push(TextRun { start: self.out.text.len(), original: self.at, copied: true });
        self.out.text.push_str(&self.source[self.at..end]);
        self.at = end;
    }

    fn skip_to(&mut self, terminator: &str, otherwise: &str) {
        match self.rest().find(terminator) {
            Some(found) => self.at += found + terminator.len(),
            None => {
                self.report(self.at..self.at + 2, otherwise, format!("it ends with `{terminator}`"));
                self.at = self.source.len();
            }
        }
    }

    fn character_data(&mut self) {
        match self.rest().find("]]>") {
            Some(found) => self.copy_to(self.at + found + 3),
            None => self.skip_to("]]>", "this character data is not closed"),
        }
    }

    /// Text up to the next tag; a `<` that begins no tag is escaped and reported.
    fn text(&mut self) {
        if self.rest().starts_with('<') {
            self.report(self.at..self.at + 1, "`<` starts no tag here", "write `&lt;`");
            self.insert("&lt;");
            self.at += 1;
        }
        let end = self.rest().find('<').map_or(self.source.len(), |found| self.at + found);
        let text = &self.source[self.at..end];
        if self.open.is_empty() && !text.trim().is_empty() {
            let start = self.at + (text.len() - text.trim_start().len());
            let hint = "text must be inside an element: `<name>text</name>`";
            self.report(start..start + text.trim().len(), "text outside an element", hint);
        }
        self.escaped_to(end);
    }

    /// Copies up to `end`, escaping `&` outside of entities and `<` in values.
    fn escaped_to(&mut self, end: usize) {
        while let Some(found) = self.source[self.at..end].find(['&', '<']) {
            self.copy_to(self.at + found);
            if begins_entity(&self.source[self.at..end]) {
                self.copy_to(self.at + 1);
            } else {
                self.insert(if self.rest().starts_with('&') { "&amp;" } else { "&lt;" });
                self.at += 1;
            }
        }
        self.copy_to(end);
    }

    fn closing_tag(&mut self) {
        let start = self.at + 2;
        let name = name_at(&self.source[start..]);
        let span = Span::new(start, start + name.len());
        if self.too_deep > 0 {
            self.too_deep -= 1;
            return self.skip_to(">", "this tag is not closed");
        }
        match self.open.iter().rposition(|(open, _)| *open == name) {
            Some(depth) => {
                self.close_down_to(depth + 1);
                self.open.pop();
                self.copy_to(span.end);
                self.end_of_closing_tag(name, span);
            }
            None => {
                self.stray_closing_tag(name, span);
                self.at = span.end;
                self.skip_to(">", "this tag is not closed");
            }
        }
    }

    fn end_of_closing_tag(&mut self, name: &str, span: Span) {
        let rest = self.rest().trim_start();
        if rest.starts_with('>') {
            self.at = self.source.len() - rest.len();
            self.copy_to(self.at + 1);
        } else {
            self.report(span, format!("the tag `</{name}` has no `>`"), format!("write `</{name}>`"));
            self.insert(">");
        }
    }

    /// A closing tag that matches no open element counts for the innermost one if its name is a
    /// typo of that.
    fn stray_closing_tag(&mut self, name: &str, span: Span) {
        let message = format!("`</{name}>` closes nothing");
        let open = self.open.last().copied();
        let names = open.iter().map(|(open, _)| *open);
        let diagnostic = Diagnostic::error("E0301", span, message).with_nearest(name, names);
        let slip = diagnostic.hint.is_some();
        self.out.diagnostics.push(if slip { diagnostic } else { diagnostic.with_hint("leave it out") });
        if let (true, Some((open, _))) = (slip, open) {
            self.open.pop();
            self.insert(&format!("</{open}>"));
        }
    }

    /// Closes open elements down to this depth.
    fn close_down_to(&mut self, depth: usize) {
        while self.open.len() > depth {
            if let Some((name, span)) = self.open.pop() {
                self.report(
                    span,
                    format!("`<{name}>` is not closed"),
                    format!("write `</{name}>` behind it"),
                );
                self.insert(&format!("</{name}>"));
            }
        }
    }

    fn opening_tag(&mut self) {
        let tag = self.at;
        let name = name_at(&self.source[tag + 1..]);
        let span = Span::new(tag + 1, tag + 1 + name.len());
        if self.open.len() >= MAX_DEPTH {
            return self.leave_out(name, span);
        }
        self.copy_to(span.end);
        self.attributes(name, span);
    }

    /// Leaves out an element that is nested too deep, with its contents; reported once.
    fn leave_out(&mut self, name: &str, span: Span) {
        if self.too_deep == 0 {
            let message = format!("`<{name}>` is nested more than {MAX_DEPTH} levels deep");
            let diagnostic = Diagnostic::error("E0302", span, message);
            self.out.diagnostics.push(diagnostic.with_hint("no configuration nests this deep"));
        }
        self.skip_to(">", "this tag is not closed");
        if !self.source[..self.at].ends_with("/>") {
            self.too_deep += 1;
        }
    }

    /// Attributes, up to and including the end of the tag.
    fn attributes(&mut self, element: &'a str, span: Span) {
        let mut seen = BTreeSet::new();
        loop {
            self.copy_to(self.source.len() - self.rest().trim_start().len());
            let rest = self.rest();
            if rest.starts_with("/>") {
                return self.copy_to(self.at + 2);
            } else if rest.starts_with('>') {
                self.open.push((element, span));
                return self.copy_to(self.at + 1);
            } else if rest.is_empty() || rest.starts_with('<') {
                self.report(span, format!("the tag `<{element}` has no `>`"), "a tag ends with `>` or `/>`");
                self.open.push((element, span));
                return self.insert(">");
            } else if starts_name(rest) {
                self.attribute(&mut seen);
            } else {
                let wrong = rest.chars().next().map_or(0, char::len_utf8);
                let message = format!("`{}` has no meaning here", &rest[..wrong]);
                self.report(self.at..self.at + wrong, message, "a tag contains `name=\"value\"` pairs");
                self.at += wrong;
            }
        }
    }

    fn attribute(&mut self, seen: &mut BTreeSet<&'a str>) {
        let (name, prefix) = qualified_name_at(self.rest());
        let span = Span::new(self.at, self.at + name.len());
        let after = self.source[span.end..].trim_start();
        let Some(value) = after.strip_prefix('=') else {
            let diagnostic = Diagnostic::error("E0301", span, format!("attribute `{name}` has no value"));
            self.out.diagnostics.push(diagnostic.with_hint(format!("write `{name}=\"1\"`")));
            self.at = span.end;
            return;
        };
        let value_start = self.source.len() - value.trim_start().len();
        let repeated = seen.contains(name);
        let length = self.out.text.len();
        if let Some(prefix) = prefix {
            if !EDITOR_PREFIXES.contains(&prefix) {
                let message = format!("attribute `{name}` belongs to another namespace");
                self.report(
                    span,
                    message,
                    format!("a configuration has no namespaces: leave out `{prefix}:`"),
                );
            }
        } else if repeated {
            let diagnostic = Diagnostic::error("E0307", span, format!("attribute `{name}` is repeated"));
            self.out.diagnostics.push(diagnostic.with_hint("remove one of them"));
        } else {
            seen.insert(name);
            self.insert(" ");
            self.copy_to(span.end);
            self.insert("=");
        }
        self.at = value_start;
        self.value(name);
        if repeated || prefix.is_some() {
            self.take_back(length);
        }
    }

    /// Removes the output after this length.
    fn take_back(&mut self, length: usize) {
        self.out.text.truncate(length);
        let left = self.out.pieces.partition_point(|piece| piece.start < length);
        self.out.pieces.truncate(left);
    }

    fn value(&mut self, name: &str) {
        match self.rest().chars().next() {
            Some(quote @ ('"' | '\'')) => self.quoted_value(name, quote),
            _ => {
                let rest = self.rest();
                let end =
                    rest.find(|c: char| c.is_whitespace() || c == '>' || c == '<').unwrap_or(rest.len());
                let value = rest[..end].strip_suffix('/').filter(|_| rest[end..].starts_with('>'));
                self.enclosed(self.at + value.map_or(end, str::len));
            }
        }
    }

    fn quoted_value(&mut self, name: &str, quote: char) {
        let start = self.at;
        let inner = &self.source[start + 1..];
        self.at = start + 1;
        match inner.find(quote) {
            // A quote closed only on another line, after the start of a tag, belongs to that tag.
            Some(end) if !inner[..end].contains('\n') || !inner[..end].contains('<') => {
                self.enclosed(start + 1 + end);
                self.at += 1;
            }
            _ => {
                let line = inner.find(['\n', '>']).unwrap_or(inner.len());
                let message = format!("the value of `{name}` is not closed");
                self.report(start..start + 1 + line, message, "it ends with the quote that it begins with");
                self.enclosed(start + 1 + line);
            }
        }
    }

    /// Copies up to `end` in double quotes.
    fn enclosed(&mut self, end: usize) {
        self.insert("\"");
        while let Some(found) = self.source[self.at..end].find('"') {
            self.escaped_to(self.at + found);
            self.insert("&quot;");
            self.at += 1;
        }
        self.escaped_to(end);
        self.insert("\"");
    }
}

fn starts_name(text: &str) -> bool {
    text.starts_with(|c: char| c.is_alphabetic() || c == '_')
}

/// The name at the start of a text; empty if there is none.
fn name_at(text: &str) -> &str {
    let end = text.find(|c: char| !(c.is_alphanumeric() || matches!(c, '_' | '-' | '.')));
    &text[..end.unwrap_or(text.len())]
}

/// The name at the start of a text, with the prefix of its namespace, and that prefix.
fn qualified_name_at(text: &str) -> (&str, Option<&str>) {
    let prefix = name_at(text);
    match text[prefix.len()..].strip_prefix(':').map(name_at) {
        Some(local) if !local.is_empty() => (&text[..prefix.len() + 1 + local.len()], Some(prefix)),
        _ => (prefix, None),
    }
}

/// Whether a text is a name.
pub(crate) fn is_name(text: &str) -> bool {
    starts_name(text) && name_at(text).len() == text.len()
}

/// Whether a text begins with a predefined XML entity or a character reference.
fn begins_entity(text: &str) -> bool {
    let Some((name, _)) = text.strip_prefix('&').and_then(|rest| rest.split_once(';')) else {
        return false;
    };
    let digits = |text: &str, radix| !text.is_empty() && text.chars().all(|c| c.is_digit(radix));
    match name.strip_prefix('#') {
        Some(number) => match number.strip_prefix('x') {
            Some(hexadecimal) => digits(hexadecimal, 16),
            None => digits(number, 10),
        },
        None => matches!(name, "lt" | "gt" | "amp" | "quot" | "apos"),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// With an effort that grows quadratically this takes minutes.
    #[test]
    fn a_long_line_of_attributes_is_read() {
        let attributes: Vec<String> = (0..200_000).map(|number| format!("a{number}=\"1\"")).collect();
        assert!(repair(&format!("<a {}/>", attributes.join(" "))).diagnostics.is_empty());
    }
}
