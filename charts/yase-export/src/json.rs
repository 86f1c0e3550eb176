//! JSON writer.

use std::fmt::Write;

use super::outline::IndentedText;

/// Maximum length of a value on one line.
const MAX_LINE_LENGTH: usize = 110;

/// A small value.
#[derive(Clone, PartialEq, Debug)]
pub(crate) enum JsonValue {
    Null,
    Bool(bool),
    /// A number; JSON has no infinities.
    Number(f64),
    Text(String),
    List(Vec<JsonValue>),
    Object(Vec<(String, JsonValue)>),
}

impl From<&str> for JsonValue {
    fn from(text: &str) -> JsonValue {
        JsonValue::Text(text.into())
    }
}

impl From<String> for JsonValue {
    fn from(text: String) -> JsonValue {
        JsonValue::Text(text)
    }
}

impl JsonValue {
    /// The value on one line.
    pub(crate) fn to_line(&self) -> String {
        let mut out = String::new();
        self.in_one_line(&mut out);
        out
    }

    fn in_one_line(&self, out: &mut String) {
        match self {
            JsonValue::Null => out.push_str("null"),
            JsonValue::Bool(value) => write!(out, "{value}").unwrap_or_default(),
            JsonValue::Number(value) if value.is_finite() => write!(out, "{value}").unwrap_or_default(),
            JsonValue::Number(value) => quote(&value.to_string(), out),
            JsonValue::Text(text) => quote(text, out),
            JsonValue::List(items) => {
                out.push('[');
                for (index, item) in items.iter().enumerate() {
                    out.push_str(if index == 0 { "" } else { ", " });
                    item.in_one_line(out);
                }
                out.push(']');
            }
            JsonValue::Object(entries) => {
                out.push('{');
                for (index, (key, value)) in entries.iter().enumerate() {
                    out.push_str(if index == 0 { "" } else { ", " });
                    quote(key, out);
                    out.push_str(": ");
                    value.in_one_line(out);
                }
                out.push('}');
            }
        }
    }
}

/// A writer of nested objects, without recursion, since they may be deeper than the stack.
#[derive(Default)]
pub(crate) struct JsonWriter {
    lines: IndentedText,
    /// Whether the innermost open object has an entry.
    begun: bool,
}

impl JsonWriter {
    /// Opens an object, under a key if it is inside an object.
    pub(crate) fn open(&mut self, key: Option<&str>) {
        self.begin(key);
        self.lines.text.push('{');
        self.lines.depth += 1;
        self.begun = false;
    }

    /// Closes the innermost object.
    pub(crate) fn close(&mut self) {
        self.lines.depth -= 1;
        if self.begun {
            self.next_line();
        }
        self.lines.text.push('}');
        self.begun = true;
    }

    /// Writes a value under a key.
    pub(crate) fn value(&mut self, key: &str, value: &JsonValue) {
        self.begin(Some(key));
        self.broken(value);
        self.begun = true;
    }

    /// The whole text.
    pub(crate) fn text(mut self) -> String {
        self.lines.text.push('\n');
        self.lines.text
    }

    fn begin(&mut self, key: Option<&str>) {
        if self.begun {
            self.lines.text.push(',');
        }
        if let Some(key) = key {
            self.next_line();
            quote(key, &mut self.lines.text);
            self.lines.text.push_str(": ");
        }
    }

    fn next_line(&mut self) {
        self.lines.text.push('\n');
        self.lines.indent();
    }

    /// A value on one line or, if that is too long, each part on a separate line.
    fn broken(&mut self, value: &JsonValue) {
        let mut line = String::new();
        value.in_one_line(&mut line);
        match value {
            JsonValue::List(items) if line.len() > MAX_LINE_LENGTH => {
                self.lines.text.push('[');
                self.parts(items, |_, _| {}, |item| item);
                self.lines.text.push(']');
            }
            JsonValue::Object(entries) if line.len() > MAX_LINE_LENGTH => {
                self.lines.text.push('{');
                let key = |(key, _): &(String, JsonValue), out: &mut String| {
                    quote(key, out);
                    out.push_str(": ");
                };
                self.parts(entries, key, |(_, value)| value);
                self.lines.text.push('}');
            }
            _ => self.lines.text.push_str(&line),
        }
    }

    fn parts<T>(&mut self, parts: &[T], key: impl Fn(&T, &mut String), value: impl Fn(&T) -> &JsonValue) {
        self.lines.depth += 1;
        for (index, part) in parts.iter().enumerate() {
            self.lines.text.push_str(if index == 0 { "" } else { "," });
            self.next_line();
            key(part, &mut self.lines.text);
            self.broken(value(part));
        }
        self.lines.depth -= 1;
        self.next_line();
    }
}

fn quote(text: &str, out: &mut String) {
    out.push('"');
    for character in text.chars() {
        match character {
            '"' => out.push_str("\\\""),
            '\\' => out.push_str("\\\\"),
            '\n' => out.push_str("\\n"),
            _ if (character as u32) < 0x20 => {
                // writing to a String cannot fail
                let _ = write!(out, "\\u{:04x}", character as u32);
            }
            _ => out.push(character),
        }
    }
    out.push('"');
}
