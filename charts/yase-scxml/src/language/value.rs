//! Values of a running session, and values exchanged between sessions.

use std::fmt::{self, Display, Formatter, Write};
use std::sync::Arc;

use super::heap::ObjectId;
use super::syntax::ScriptFunction;

/// A value of the data model of a running session.
#[derive(Clone, Debug)]
pub(crate) enum ScriptValue {
    Undefined,
    Null,
    Bool(bool),
    Number(f64),
    Text(Arc<str>),
    /// An array or an object, assigned and passed by reference.
    Object(ObjectId),
    Function(Arc<ScriptFunction>),
}

impl PartialEq for ScriptValue {
    /// Whether `===` holds.
    fn eq(&self, other: &ScriptValue) -> bool {
        match (self, other) {
            (ScriptValue::Undefined, ScriptValue::Undefined) | (ScriptValue::Null, ScriptValue::Null) => true,
            (ScriptValue::Bool(a), ScriptValue::Bool(b)) => a == b,
            (ScriptValue::Number(a), ScriptValue::Number(b)) => a == b,
            (ScriptValue::Text(a), ScriptValue::Text(b)) => a == b,
            (ScriptValue::Object(a), ScriptValue::Object(b)) => a == b,
            (ScriptValue::Function(a), ScriptValue::Function(b)) => Arc::ptr_eq(a, b),
            _ => false,
        }
    }
}

/// A self-contained value, as events carry it: a deep copy.
#[derive(Clone, PartialEq, Debug, Default)]
pub enum DataValue {
    /// No value.
    #[default]
    Undefined,
    /// `null`.
    Null,
    /// True or false.
    Bool(bool),
    /// A number.
    Number(f64),
    /// A text.
    Text(String),
    /// An array.
    Array(Vec<DataValue>),
    /// An object: names with values, in the order of their first assignment.
    Object(Vec<(String, DataValue)>),
}

impl Display for DataValue {
    /// As JSON, with `undefined` for values that JSON cannot represent.
    fn fmt(&self, f: &mut Formatter<'_>) -> fmt::Result {
        match self {
            DataValue::Undefined => f.write_str("undefined"),
            DataValue::Null => f.write_str("null"),
            DataValue::Bool(value) => write!(f, "{value}"),
            DataValue::Number(value) => f.write_str(&super::convert::number_text(*value)),
            DataValue::Text(text) => quoted(f, text),
            DataValue::Array(items) => {
                f.write_char('[')?;
                for (index, item) in items.iter().enumerate() {
                    write!(f, "{}{item}", if index == 0 { "" } else { "," })?;
                }
                f.write_char(']')
            }
            DataValue::Object(members) => {
                f.write_char('{')?;
                for (index, (name, value)) in members.iter().enumerate() {
                    f.write_str(if index == 0 { "" } else { "," })?;
                    quoted(f, name)?;
                    write!(f, ":{value}")?;
                }
                f.write_char('}')
            }
        }
    }
}

/// Writes a text as JSON.
pub(crate) fn quoted(f: &mut impl Write, text: &str) -> fmt::Result {
    f.write_char('"')?;
    for character in text.chars() {
        match character {
            '"' => f.write_str("\\\"")?,
            '\\' => f.write_str("\\\\")?,
            '\n' => f.write_str("\\n")?,
            '\r' => f.write_str("\\r")?,
            '\t' => f.write_str("\\t")?,
            '\u{8}' => f.write_str("\\b")?,
            '\u{c}' => f.write_str("\\f")?,
            control if u32::from(control) < 0x20 => write!(f, "\\u{:04x}", u32::from(control))?,
            other => f.write_char(other)?,
        }
    }
    f.write_char('"')
}
