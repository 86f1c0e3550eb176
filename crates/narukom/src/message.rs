//! Messages: protobuf structs whose fields can also be reached by index, without serialising.

use std::any::Any;
use std::fmt::Debug;

use thiserror::Error;

use crate::descriptor::{EnumDescriptor, MessageDescriptor};

/// Access to the fields of a message by their place in its [`MessageDescriptor`].
///
/// `narukom-build` writes this for every message. It is what transition expressions, the studio and the command line
/// read and set fields through; ordinary code uses the struct's own fields.
pub trait Reflect {
    /// The type's own description.
    fn descriptor(&self) -> &'static MessageDescriptor;

    /// The value of the field at `index`: [`FieldValue::Missing`] for an unset optional field and for an index beyond
    /// the last field, [`FieldValue::Unsupported`] for lists, maps and members of a `oneof`.
    fn field(&self, index: usize) -> FieldValue<'_>;

    /// Sets the field at `index`. Whole numbers fit wherever their value does, and into floating point fields;
    /// [`FieldValue::Missing`] resets the field.
    fn set_field(&mut self, index: usize, value: FieldValue<'_>) -> Result<(), FieldError>;

    /// The message inside the field at `index`, made if it was missing; none if the field holds no message.
    fn message_mut(&mut self, index: usize) -> Option<&mut dyn AnyMessage>;

    /// The value of the field of that name: [`FieldValue::Missing`] if there is none. Whoever reads often asks the
    /// [descriptor](MessageDescriptor::field_index) for the index once.
    fn field_by_name(&self, name: &str) -> FieldValue<'_> {
        self.descriptor().field_index(name).map_or(FieldValue::Missing, |index| self.field(index))
    }

    /// Sets the field of that name.
    fn set_field_by_name(&mut self, name: &str, value: FieldValue<'_>) -> Result<(), FieldError> {
        let index = self.descriptor().field_index(name).ok_or(FieldError::NoSuchField)?;
        self.set_field(index, value)
    }
}

/// A message type: a protobuf struct that knows its descriptor. `narukom-build` implements it.
#[diagnostic::on_unimplemented(
    message = "`{Self}` is not a message of Narukom",
    note = "declare it in a .proto file, compile that with `narukom_build::compile` and include it with \
            `narukom::include_messages!`"
)]
pub trait Message: Reflect + prost::Message + Default + Clone + Debug + 'static {
    /// The type's description.
    const DESCRIPTOR: &'static MessageDescriptor;
}

/// An enumeration of a schema. `narukom-build` implements it.
pub trait Enumeration {
    /// The enumeration's description.
    const DESCRIPTOR: &'static EnumDescriptor;
}

/// A message of any type.
///
/// Every [`Message`] is one; the runtime, the tape and the links handle messages through it.
pub trait AnyMessage: Reflect + Debug + Send + Sync + 'static {
    /// Appends the protobuf encoding to `bytes`.
    fn encode_to(&self, bytes: &mut Vec<u8>);

    /// Becomes the message that `bytes` encode. If they encode none, what it then is, is not said.
    fn decode_from(&mut self, bytes: &[u8]) -> Result<(), prost::DecodeError>;

    /// Becomes a message with nothing set; texts, bytes and lists keep their memory.
    fn reset(&mut self);

    /// Becomes equal to `other`; changes nothing and answers `false` if `other` is of another type.
    fn copy_from(&mut self, other: &dyn AnyMessage) -> bool;

    /// A copy.
    fn clone_box(&self) -> Box<dyn AnyMessage>;

    /// Itself, for downcasting.
    fn as_any(&self) -> &(dyn Any + Send + Sync);

    /// Itself, for downcasting.
    fn as_any_mut(&mut self) -> &mut (dyn Any + Send + Sync);

    /// Itself, without its type.
    fn as_message(&self) -> &dyn AnyMessage;

    /// Itself, without its type.
    fn as_message_mut(&mut self) -> &mut dyn AnyMessage;
}

impl<M: Message> AnyMessage for M {
    fn encode_to(&self, bytes: &mut Vec<u8>) {
        self.encode_raw(bytes);
    }

    fn decode_from(&mut self, bytes: &[u8]) -> Result<(), prost::DecodeError> {
        self.clear();
        self.merge(bytes)
    }

    fn reset(&mut self) {
        self.clear();
    }

    fn copy_from(&mut self, other: &dyn AnyMessage) -> bool {
        let Some(other) = other.as_any().downcast_ref::<M>() else { return false };
        self.clone_from(other);
        true
    }

    fn clone_box(&self) -> Box<dyn AnyMessage> {
        Box::new(self.clone())
    }

    fn as_any(&self) -> &(dyn Any + Send + Sync) {
        self
    }

    fn as_any_mut(&mut self) -> &mut (dyn Any + Send + Sync) {
        self
    }

    fn as_message(&self) -> &dyn AnyMessage {
        self
    }

    fn as_message_mut(&mut self) -> &mut dyn AnyMessage {
        self
    }
}

/// The value of a field. Copying it copies no text.
#[derive(Clone, Copy, Debug)]
#[non_exhaustive]
pub enum FieldValue<'a> {
    /// The field is not set, or there is no such field.
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
    /// Bytes.
    Bytes(&'a [u8]),
    /// The number of a value of an enumeration.
    Enum(i32),
    /// A message inside the message.
    Message(&'a dyn AnyMessage),
    /// A list, a map or a member of a `oneof`.
    Unsupported,
}

/// Why a field was not set.
#[derive(Clone, Copy, PartialEq, Eq, Debug, Error)]
#[non_exhaustive]
pub enum FieldError {
    /// The message has no field at that index.
    #[error("the message has no such field")]
    NoSuchField,
    /// The value is of a kind that the field does not hold.
    #[error("the field `{field}` does not hold such a value")]
    WrongKind {
        /// The field's name.
        field: &'static str,
    },
    /// The number does not fit.
    #[error("the number does not fit into the field `{field}`")]
    OutOfRange {
        /// The field's name.
        field: &'static str,
    },
    /// The field is a list, a map or a member of a `oneof`.
    #[error("the field `{field}` cannot be set by index")]
    Unsupported {
        /// The field's name.
        field: &'static str,
    },
}
