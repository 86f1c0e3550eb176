//! The names that transition expressions may use: topics, message fields, enumerations and
//! functions.
//!
//! A chart names them in text (`Ball.distance`, `robotInPosition(...)`); a [`TypeEnvironment`]
//! lists them and numbers them. Expressions are checked and compiled against it once; afterwards
//! only the numbers are used. The embedding (in Monas: the blackboards of Narukom) assigns the
//! numbers and resolves them at run time.

use std::any::Any;
use std::fmt;

/// A topic, numbered by the creator of the type environment.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Debug)]
pub struct TopicId(pub u32);

/// A field of a message, numbered by the creator of the type environment.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Debug)]
pub struct FieldId(pub u32);

/// A function, numbered by the creator of the type environment.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Debug)]
pub struct FunctionId(pub u32);

/// The topics, message types, enumerations and functions available to the expressions of a chart.
#[derive(Clone, Debug, Default)]
pub struct TypeEnvironment {
    /// All topics with their message types.
    pub topics: Vec<TopicEntry>,
    /// All message types.
    pub messages: Vec<MessageEntry>,
    /// All enumerations.
    pub enumerations: Vec<Enumeration>,
    /// All functions.
    pub functions: Vec<FunctionEntry>,
    /// Whether the host has a language for conditions and actions: `script("text")`.
    pub scripts: bool,
}

/// A topic that expressions may read and assign.
#[derive(Clone, Debug)]
pub struct TopicEntry {
    /// Its number.
    pub id: TopicId,
    /// Its path, segments separated by `/`.
    pub path: String,
    /// Its retention.
    pub kind: TopicKind,
    /// The name of its message type, as in [`MessageEntry::name`].
    pub message: String,
}

/// Retention of a topic.
#[derive(Clone, Copy, PartialEq, Eq, Hash, Debug)]
pub enum TopicKind {
    /// The latest message is kept.
    State,
    /// Each reader receives a message in one cycle.
    Signal,
    /// A history.
    Data,
}

/// A message type and its fields.
#[derive(Clone, Debug)]
pub struct MessageEntry {
    /// The type's name without its package: `Ball`.
    pub name: String,
    /// Its fields.
    pub fields: Vec<FieldEntry>,
}

/// A field of a message type.
#[derive(Clone, Debug)]
pub struct FieldEntry {
    /// Its number within the message.
    pub id: FieldId,
    /// Its name: `distance`.
    pub name: String,
    /// Its type.
    pub kind: ValueType,
}

/// A function that expressions may call; its result depends on its arguments only.
#[derive(Clone, Debug)]
pub struct FunctionEntry {
    /// Its number.
    pub id: FunctionId,
    /// Its name.
    pub name: String,
    /// The types of its arguments.
    pub parameters: Vec<ValueType>,
    /// The type of its result.
    pub result: ValueType,
}

/// An enumeration and the names of its values.
#[derive(Clone, Debug)]
pub struct Enumeration {
    /// The type's name without its package: `PlayerState`.
    pub name: String,
    /// Name and number of each value.
    pub values: Vec<(String, i32)>,
}

/// The type of a value in an expression.
#[derive(Clone, PartialEq, Eq, Debug)]
pub enum ValueType {
    /// True or false.
    Bool,
    /// A number of any width and kind; numbers compare by value.
    Number,
    /// A text.
    Text,
    /// A value of the enumeration of that name.
    Enumeration(String),
    /// A whole message of the type of that name.
    Message(String),
}

/// A value while an expression is evaluated. Copying it copies no text.
#[derive(Clone, Copy)]
pub enum Value<'a> {
    /// A field of a message that has not arrived.
    Missing,
    /// True or false.
    Bool(bool),
    /// A signed number.
    Int(i64),
    /// An unsigned number.
    Uint(u64),
    /// A floating point number.
    Float(f64),
    /// A text.
    Text(&'a str),
    /// The number of a value of an enumeration.
    Enum(i32),
    /// A whole message, for functions.
    Message(&'a (dyn Any + Send + Sync)),
}

impl fmt::Debug for Value<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Value::Missing => f.write_str("Missing"),
            Value::Bool(value) => write!(f, "Bool({value})"),
            Value::Int(value) => write!(f, "Int({value})"),
            Value::Uint(value) => write!(f, "Uint({value})"),
            Value::Float(value) => write!(f, "Float({value})"),
            Value::Text(value) => write!(f, "Text({value:?})"),
            Value::Enum(value) => write!(f, "Enum({value})"),
            Value::Message(_) => f.write_str("Message(..)"),
        }
    }
}
