//! Nested, indented elements as text.

use crate::xml::{attribute, escape};

/// Writes elements. Elements that contain text are not indented, since blanks would become part of
/// the text.
pub(crate) struct ElementWriter {
    text: String,
    open: Vec<OpenElement>,
    indented: bool,
}

struct OpenElement {
    tag: &'static str,
    /// Whether its start tag is closed.
    inside: bool,
    has_text: bool,
}

impl ElementWriter {
    /// A writer with each element on a separate line.
    pub(crate) fn new() -> ElementWriter {
        ElementWriter { text: String::new(), open: Vec::new(), indented: true }
    }

    /// Elements without blanks between them.
    pub(crate) fn compact() -> ElementWriter {
        ElementWriter { indented: false, ..ElementWriter::new() }
    }

    pub(crate) fn into_text(self) -> String {
        self.text
    }

    pub(crate) fn open(&mut self, tag: &'static str) {
        self.enter();
        self.new_line();
        self.text.push('<');
        self.text.push_str(tag);
        self.open.push(OpenElement { tag, inside: false, has_text: false });
    }

    /// Adds an attribute to the element opened last.
    pub(crate) fn attribute(&mut self, name: &str, value: &str) {
        attribute(&mut self.text, name, value);
    }

    pub(crate) fn optional(&mut self, name: &str, value: Option<&str>) {
        if let Some(value) = value {
            self.attribute(name, value);
        }
    }

    pub(crate) fn text(&mut self, text: &str) {
        self.enter();
        escape(text, false, &mut self.text);
        if let Some(open) = self.open.last_mut() {
            open.has_text = true;
        }
    }

    /// Inserts existing markup.
    pub(crate) fn raw(&mut self, markup: &str) {
        self.enter();
        self.new_line();
        self.text.push_str(markup);
    }

    pub(crate) fn close(&mut self) {
        let Some(open) = self.open.pop() else { return };
        if !open.inside {
            self.text.push_str("/>");
        } else {
            if !open.has_text {
                self.new_line();
            }
            self.text.push_str("</");
            self.text.push_str(open.tag);
            self.text.push('>');
        }
        if self.open.is_empty() && self.indented {
            self.text.push('\n');
        }
    }

    /// Closes the start tag of the surrounding element.
    fn enter(&mut self) {
        if let Some(open) = self.open.last_mut().filter(|open| !open.inside) {
            open.inside = true;
            self.text.push('>');
        }
    }

    fn new_line(&mut self) {
        if self.indented && !self.text.is_empty() {
            self.text.push('\n');
            self.text.push_str(&"  ".repeat(self.open.len()));
        }
    }
}
