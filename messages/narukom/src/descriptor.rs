//! Descriptors of message types: names, fields and enumerations, known at compile time.

use std::fmt;

/// Describes a message type. `narukom-build` generates one static per message.
#[derive(Clone, Copy)]
pub struct MessageDescriptor {
    /// Name with package: `monas.soccer.Ball`.
    pub full_name: &'static str,
    /// Name without package: `Ball`; a nested message is prefixed with the outer name:
    /// `Ball.Sighting`.
    pub name: &'static str,
    /// The fields in order of declaration; the position is the index that
    /// [`Reflect::field`](crate::Reflect::field) takes.
    pub fields: &'static [FieldDescriptor],
    /// A serialised `google.protobuf.FileDescriptorSet`: the type's own file and all its imports,
    /// without source positions.
    pub file_descriptor_set: &'static [u8],
}

impl MessageDescriptor {
    /// The index of the field with that name.
    pub fn field_index(&self, name: &str) -> Option<usize> {
        self.fields.iter().position(|field| field.name == name)
    }
}

impl fmt::Debug for MessageDescriptor {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "MessageDescriptor({})", self.full_name)
    }
}

/// Two descriptors are equal when they describe the same type: full name and schema agree.
impl PartialEq for MessageDescriptor {
    fn eq(&self, other: &MessageDescriptor) -> bool {
        self.full_name == other.full_name && self.file_descriptor_set == other.file_descriptor_set
    }
}

impl Eq for MessageDescriptor {}

/// A field of a message type.
#[derive(Clone, Copy, Debug)]
pub struct FieldDescriptor {
    /// Its name in the `.proto` file: `distance`.
    pub name: &'static str,
    /// Its protobuf field number.
    pub tag: u32,
    /// The type of its value.
    pub kind: FieldKind,
}

/// The type of a field's value.
#[derive(Clone, Copy, Debug)]
#[non_exhaustive]
pub enum FieldKind {
    /// `bool`
    Bool,
    /// `int32`, `sint32`, `sfixed32`
    I32,
    /// `int64`, `sint64`, `sfixed64`
    I64,
    /// `uint32`, `fixed32`
    U32,
    /// `uint64`, `fixed64`
    U64,
    /// `float`
    F32,
    /// `double`
    F64,
    /// `string`
    Text,
    /// `bytes`
    Bytes,
    /// A value of an enumeration.
    Enum(&'static EnumDescriptor),
    /// Another message; a function, since message types may be recursive.
    Message(fn() -> &'static MessageDescriptor),
    /// A list, a map, a member of a `oneof`, or a foreign message: not accessible by index.
    Unsupported,
}

/// An enumeration.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub struct EnumDescriptor {
    /// Name with package: `monas.soccer.PlayerState`.
    pub full_name: &'static str,
    /// Name without package: `PlayerState`.
    pub name: &'static str,
    /// Name and number of each value, in order of declaration.
    pub values: &'static [(&'static str, i32)],
}

impl EnumDescriptor {
    /// The number of the value with that name.
    pub fn number(&self, name: &str) -> Option<i32> {
        self.values.iter().find(|(value, _)| *value == name).map(|(_, number)| *number)
    }

    /// The name of the value with that number.
    pub fn name_of(&self, number: i32) -> Option<&'static str> {
        self.values.iter().find(|(_, value)| *value == number).map(|(name, _)| *name)
    }
}
