//! Text of elements, one inside the other, indented.

use crate::scxml::xml::{attribute, escape};

/// Writes elements. Where a text has been written the element is left as it is, since blanks would become part of it.
pub(super) struct Writer {
    text: String,
    open: Vec<Open>,
    indented: bool,
}

struct Open {
    tag: &'static str,
    /// Whether its start tag is closed.
    inside: bool,
    has_text: bool,
}

impl Writer {
    /// Elements on lines of their own.
    pub(super) fn new() -> Writer {
        Writer { text: String::new(), open: Vec::new(), indented: true }
    }

    /// Elements without blanks between them.
    pub(super) fn compact() -> Writer {
        Writer { indented: false, ..Writer::new() }
    }

    pub(super) fn into_text(self) -> String {
        self.text
    }

    pub(super) fn open(&mut self, tag: &'static str) {
        self.enter();
        self.new_line();
        self.text.push('<');
        self.text.push_str(tag);
        self.open.push(Open { tag, inside: false, has_text: false });
    }

    /// An attribute of the element that was opened last.
    pub(super) fn attribute(&mut self, name: &str, value: &str) {
        attribute(&mut self.text, name, value);
    }

    pub(super) fn optional(&mut self, name: &str, value: Option<&str>) {
        if let Some(value) = value {
            self.attribute(name, value);
        }
    }

    pub(super) fn text(&mut self, text: &str) {
        self.enter();
        escape(text, false, &mut self.text);
        if let Some(open) = self.open.last_mut() {
            open.has_text = true;
        }
    }

    /// Markup that is written already.
    pub(super) fn raw(&mut self, markup: &str) {
        self.enter();
        self.new_line();
        self.text.push_str(markup);
    }

    pub(super) fn close(&mut self) {
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

    /// Closes the start tag of the element around.
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
