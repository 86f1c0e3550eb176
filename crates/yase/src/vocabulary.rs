//! The words that transition expressions may use: topics, message fields, enumerations and functions.
//!
//! A chart names things by text (`Ball.distance`, `robotInPosition(...)`); a [`Vocabulary`] says which of these exist,
//! and gives each a number. Expressions are checked and compiled against it once; afterwards only numbers are used.
//! The embedding (in Monas: the blackboards of Narukom) chooses the numbers and answers to them while the machine runs.

use std::any::Any;
use std::fmt;

/// A topic, as numbered by whoever made the vocabulary.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Debug)]
pub struct TopicId(pub u32);

/// A field of a message, as numbered by whoever made the vocabulary.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Debug)]
pub struct FieldId(pub u32);

/// A function, as numbered by whoever made the vocabulary.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Debug)]
pub struct FunctionId(pub u32);

/// The topics, message types, enumerations and functions that the expressions of a chart may name.
#[derive(Clone, Debug, Default)]
pub struct Vocabulary {
    /// Every topic, with the type of its messages.
    pub topics: Vec<TopicEntry>,
    /// Every message type.
    pub messages: Vec<MessageEntry>,
    /// Every enumeration.
    pub enumerations: Vec<Enumeration>,
    /// Every function.
    pub functions: Vec<FunctionEntry>,
    /// Whether the host has a language of its own for conditions and actions: `script("text")`.
    pub scripts: bool,
}

/// A topic that expressions may read and assign.
#[derive(Clone, Debug)]
pub struct TopicEntry {
    /// Its number.
    pub id: TopicId,
    /// Its path, segments separated by `/`.
    pub path: String,
    /// How its messages are kept.
    pub kind: TopicKind,
    /// The name of its message type, as in [`MessageEntry::name`].
    pub message: String,
}

/// How a topic keeps its messages.
#[derive(Clone, Copy, PartialEq, Eq, Hash, Debug)]
pub enum TopicKind {
    /// The latest message stays.
    State,
    /// Each reader sees a message in one cycle.
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
    /// What it holds.
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
    /// A number, of whatever width and kind; numbers compare with each other by value.
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
    /// What a message that has not arrived says of its fields.
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
