//! Writer of XMI in the layout of the Eclipse tools.

/// Writes a document.
pub(crate) struct XmiWriter {
    text: String,
    open: Vec<String>,
    /// Whether the start tag of the innermost element is still open.
    in_tag: bool,
}

impl XmiWriter {
    /// An empty document.
    pub(crate) fn new() -> XmiWriter {
        let text = String::from("<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n");
        XmiWriter { text, open: Vec::new(), in_tag: false }
    }

    /// Starts an element.
    pub(crate) fn open(&mut self, name: &str) {
        self.end_tag();
        self.text.push_str(&"  ".repeat(self.open.len()));
        self.text.extend(["<", name]);
        self.open.push(name.into());
        self.in_tag = true;
    }

    /// Starts the root element, with the attributes of every document.
    pub(crate) fn root(&mut self, prefix: &str, name: &str, namespace: &str) {
        self.open(&format!("{prefix}:{name}"));
        self.attribute("xmi:version", "2.0");
        self.attribute("xmlns:xmi", super::XMI);
        self.attribute(&format!("xmlns:{prefix}"), namespace);
    }

    /// Adds an attribute to the element that was started last.
    pub(crate) fn attribute(&mut self, name: &str, value: &str) {
        self.text.extend([" ", name, "=\""]);
        for letter in value.chars() {
            match letter {
                '&' => self.text.push_str("&amp;"),
                '<' => self.text.push_str("&lt;"),
                '"' => self.text.push_str("&quot;"),
                '\n' => self.text.push_str("&#xA;"),
                '\r' => self.text.push_str("&#xD;"),
                '\t' => self.text.push_str("&#x9;"),
                other => self.text.push(other),
            }
        }
        self.text.push('"');
    }

    /// Adds an attribute unless it is empty.
    pub(crate) fn attribute_if_any(&mut self, name: &str, value: &str) {
        if !value.is_empty() {
            self.attribute(name, value);
        }
    }

    /// Ends the innermost element.
    pub(crate) fn close(&mut self) {
        let Some(name) = self.open.pop() else { return };
        if std::mem::take(&mut self.in_tag) {
            self.text.push_str("/>\n");
        } else {
            self.text.push_str(&"  ".repeat(self.open.len()));
            self.text.extend(["</", &name, ">\n"]);
        }
    }

    /// The text, every element ended.
    pub(crate) fn into_text(mut self) -> String {
        while !self.open.is_empty() {
            self.close();
        }
        self.text
    }

    fn end_tag(&mut self) {
        if std::mem::take(&mut self.in_tag) {
            self.text.push_str(">\n");
        }
    }
}

/// Whether XML can represent all characters of a text.
pub(crate) fn fits_xml(text: &str) -> bool {
    let control = |letter: char| u32::from(letter) < 0x20 && !"\t\n\r".contains(letter);
    !text.contains(|letter| control(letter) || matches!(letter, '\u{fffe}' | '\u{ffff}'))
}
