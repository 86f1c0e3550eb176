//! Messages: protobuf structs whose fields are also accessible by index, without serialising.

use std::any::Any;
use std::fmt::Debug;

use thiserror::Error;

use crate::descriptor::{EnumDescriptor, MessageDescriptor};

/// Access to the fields of a message by their index in its [`MessageDescriptor`].
///
/// `narukom-build` implements this for every message. Transition expressions, the studio and the
/// command line read and set fields through it; ordinary code uses the struct's fields.
pub trait Reflect {
    /// The descriptor of the type.
    fn descriptor(&self) -> &'static MessageDescriptor;

    /// The value of the field at `index`: [`FieldValue::Missing`] for an unset optional field and
    /// for an index beyond the last field, [`FieldValue::Unsupported`] for lists, maps and members
    /// of a `oneof`.
    fn field(&self, index: usize) -> FieldValue<'_>;

    /// Sets the field at `index`. Integers are accepted wherever their value fits, also for
    /// floating point fields; [`FieldValue::Missing`] resets the field.
    fn set_field(&mut self, index: usize, value: FieldValue<'_>) -> Result<(), FieldError>;

    /// The message inside the field at `index`, created if it was missing; `None` if the field does
    /// not hold a message.
    fn message_mut(&mut self, index: usize) -> Option<&mut dyn AnyMessage>;

    /// The value of the field with that name: [`FieldValue::Missing`] if there is none. For
    /// repeated access look up the index once in the [descriptor](MessageDescriptor::field_index).
    fn field_by_name(&self, name: &str) -> FieldValue<'_> {
        self.descriptor().field_index(name).map_or(FieldValue::Missing, |index| self.field(index))
    }

    /// Sets the field with that name.
    fn set_field_by_name(&mut self, name: &str, value: FieldValue<'_>) -> Result<(), FieldError> {
        let index = self.descriptor().field_index(name).ok_or(FieldError::NoSuchField)?;
        self.set_field(index, value)
    }
}

/// A message type: a protobuf struct with a descriptor. `narukom-build` implements it.
#[diagnostic::on_unimplemented(
    message = "`{Self}` is not a message of Narukom",
    note = "declare it in a .proto file, compile that with `narukom_build::compile` and include it with \
            `narukom::include_messages!`"
)]
pub trait Message: Reflect + prost::Message + Default + Clone + Debug + 'static {
    /// The descriptor of the type.
    const DESCRIPTOR: &'static MessageDescriptor;
}

/// An enumeration of a schema. `narukom-build` implements it.
pub trait Enumeration {
    /// The descriptor of the enumeration.
    const DESCRIPTOR: &'static EnumDescriptor;
}

/// A message of any type.
///
/// Every [`Message`] implements it; the runtime, the tape and the links handle messages through it.
pub trait AnyMessage: Reflect + Debug + Send + Sync + 'static {
    /// Appends the protobuf encoding to `bytes`.
    fn encode_to(&self, bytes: &mut Vec<u8>);

    /// Replaces the message by the one that `bytes` encode. After an error the content is
    /// unspecified.
    fn decode_from(&mut self, bytes: &[u8]) -> Result<(), prost::DecodeError>;

    /// Resets the message to its default; strings, bytes and lists keep their memory.
    fn reset(&mut self);

    /// Copies `other`; changes nothing and returns `false` if `other` has another type.
    fn copy_from(&mut self, other: &dyn AnyMessage) -> bool;

    /// A copy.
    fn clone_box(&self) -> Box<dyn AnyMessage>;

    /// The message for downcasting.
    fn as_any(&self) -> &(dyn Any + Send + Sync);

    /// The message for downcasting.
    fn as_any_mut(&mut self) -> &mut (dyn Any + Send + Sync);

    /// The message as a trait object.
    fn as_message(&self) -> &dyn AnyMessage;

    /// The message as a trait object.
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

/// The value of a field. Copying it does not copy text.
#[derive(Clone, Copy, Debug)]
#[non_exhaustive]
pub enum FieldValue<'a> {
    /// The field is not set, or there is no such field.
    Missing,
    /// True or false.
    Bool(bool),
    /// A signed integer.
    Int(i64),
    /// An unsigned integer.
    Uint(u64),
    /// A floating point number.
    Float(f64),
    /// A string.
    Text(&'a str),
    /// Bytes.
    Bytes(&'a [u8]),
    /// The number of an enumeration value.
    Enum(i32),
    /// A message inside the message.
    Message(&'a dyn AnyMessage),
    /// A list, a map or a member of a `oneof`.
    Unsupported,
}

/// The reason why a field was not set.
#[derive(Clone, Copy, PartialEq, Eq, Debug, Error)]
#[non_exhaustive]
pub enum FieldError {
    /// The message has no field at that index.
    #[error("the message has no such field")]
    NoSuchField,
    /// The field has another type than the value.
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
