//! Messages of any type as inspectable values, decoded by the schemas in a tape.

use std::collections::BTreeMap;
use std::sync::Arc;

use prost_reflect::{DynamicMessage, FieldDescriptor, Kind, MapKey, MessageDescriptor, ReflectMessage};

use crate::error::Error;
use crate::recording::{Channel, PROTOBUF, Schema};
use crate::schema::descriptor_pool;

/// A message with more values than this, including unset ones, is not decoded. A schema may give
/// each of many small messages many fields.
const MOST_VALUES: usize = 1 << 20;

/// A value of a message.
#[derive(Clone, PartialEq, Debug)]
#[non_exhaustive]
pub enum Value {
    /// An optional field that is not set.
    Missing,
    /// A message field that is not set.
    NoMessage,
    /// True or false.
    Bool(bool),
    /// A signed integer.
    Int(i64),
    /// An unsigned integer.
    Uint(u64),
    /// A floating point number.
    Float(f64),
    /// A string.
    Text(String),
    /// Bytes.
    Bytes(Vec<u8>),
    /// A value of an enumeration by its name, or by its number if it has none.
    Enum(String),
    /// A list.
    List(Vec<Value>),
    /// A map, or the fields of a message, in the order of their numbers.
    Fields(Vec<(String, Value)>),
}

/// Decodes messages.
#[derive(Default)]
pub struct Decoder {
    /// The types used so far, by the address of the schema; the reference is kept, so that the
    /// address remains unique.
    types: BTreeMap<*const Schema, (Arc<Schema>, Option<MessageDescriptor>)>,
}

impl std::fmt::Debug for Decoder {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "Decoder({} types)", self.types.len())
    }
}

impl Decoder {
    /// Creates a decoder.
    pub fn new() -> Decoder {
        Decoder::default()
    }

    /// Decodes a message of a channel.
    ///
    /// # Errors
    /// The channel is not protobuf or has no usable schema, or the bytes do not match it.
    pub fn decode(&mut self, channel: &Channel, bytes: &[u8]) -> Result<Value, Error> {
        if channel.encoding != PROTOBUF {
            return Err(Error::opaque(channel, "its messages are not protobuf"));
        }
        let descriptor = self.descriptor(&channel.schema);
        let descriptor = descriptor.ok_or_else(|| Error::opaque(channel, "its schema cannot be used"))?;
        let message = DynamicMessage::decode(descriptor, bytes).map_err(|error| {
            Error::opaque(channel, &format!("a message does not fit its schema: {error}"))
        })?;
        let mut left = MOST_VALUES;
        fields(&message, &mut left).ok_or_else(|| Error::opaque(channel, "a message has too many values"))
    }

    fn descriptor(&mut self, schema: &Arc<Schema>) -> Option<MessageDescriptor> {
        let known = self.types.entry(Arc::as_ptr(schema)).or_insert_with(|| (schema.clone(), read(schema)));
        known.1.clone()
    }
}

fn read(schema: &Schema) -> Option<MessageDescriptor> {
    let is_protobuf = schema.encoding == PROTOBUF;
    let pool = is_protobuf.then(|| descriptor_pool(&schema.data).ok()).flatten()?;
    pool.get_message_by_name(&schema.name)
}

/// The fields of a message; `None` if there are too many.
fn fields(message: &DynamicMessage, left: &mut usize) -> Option<Value> {
    let descriptor = message.descriptor();
    let mut fields = Vec::new();
    for field in descriptor.fields() {
        // Only the set member of a `oneof` is included.
        if field.containing_oneof().is_some_and(|oneof| !oneof.is_synthetic()) && !message.has_field(&field) {
            continue;
        }
        *left = left.checked_sub(1)?;
        fields.push((field.name().to_owned(), field_value(message, &field, left)?));
    }
    Some(Value::Fields(fields))
}

fn field_value(message: &DynamicMessage, field: &FieldDescriptor, left: &mut usize) -> Option<Value> {
    if field.supports_presence() && !message.has_field(field) {
        let is_message = matches!(field.kind(), Kind::Message(_));
        return Some(if is_message { Value::NoMessage } else { Value::Missing });
    }
    value(&message.get_field(field), &field.kind(), left)
}

fn value(value: &prost_reflect::Value, kind: &Kind, left: &mut usize) -> Option<Value> {
    use prost_reflect::Value as Wire;
    *left = left.checked_sub(1)?;
    Some(match value {
        Wire::Bool(value) => Value::Bool(*value),
        Wire::I32(value) => Value::Int((*value).into()),
        Wire::I64(value) => Value::Int(*value),
        Wire::U32(value) => Value::Uint((*value).into()),
        Wire::U64(value) => Value::Uint(*value),
        Wire::F32(value) => Value::Float((*value).into()),
        Wire::F64(value) => Value::Float(*value),
        Wire::String(text) => Value::Text(text.clone()),
        Wire::Bytes(bytes) => Value::Bytes(bytes.to_vec()),
        Wire::EnumNumber(number) => Value::Enum(enum_name(kind, *number)),
        Wire::Message(message) => fields(message, left)?,
        Wire::List(list) => {
            Value::List(list.iter().map(|one| self::value(one, kind, left)).collect::<Option<_>>()?)
        }
        Wire::Map(map) => Value::Fields(map_entries(map, kind, left)?),
    })
}

fn enum_name(kind: &Kind, number: i32) -> String {
    let Kind::Enum(descriptor) = kind else { return number.to_string() };
    descriptor.get_value(number).map_or_else(|| number.to_string(), |value| value.name().to_owned())
}

/// The entries of a map in the order of their keys.
fn map_entries<'a>(
    map: impl IntoIterator<Item = (&'a MapKey, &'a prost_reflect::Value)>,
    kind: &Kind,
    left: &mut usize,
) -> Option<Vec<(String, Value)>> {
    let Kind::Message(entry) = kind else { return None };
    let kind = entry.map_entry_value_field().kind();
    let mut entries: Vec<_> = map.into_iter().collect();
    entries.sort_by_key(|(key, _)| *key);
    let named = entries.into_iter().map(|(key, one)| Some((key_name(key), value(one, &kind, left)?)));
    named.collect()
}

fn key_name(key: &MapKey) -> String {
    match key {
        MapKey::Bool(key) => key.to_string(),
        MapKey::I32(key) => key.to_string(),
        MapKey::I64(key) => key.to_string(),
        MapKey::U32(key) => key.to_string(),
        MapKey::U64(key) => key.to_string(),
        MapKey::String(key) => key.clone(),
    }
}

/// A field that differs between two messages.
#[derive(Clone, PartialEq, Debug)]
pub struct FieldDifference<'a> {
    /// The field: `robots[2].x`.
    pub path: String,
    /// The value in the first message; `None` if it has none.
    pub first: Option<&'a Value>,
    /// The value in the second message; `None` if it has none.
    pub second: Option<&'a Value>,
}

impl Value {
    /// The differences to another message, in order.
    pub fn differences<'a>(&'a self, other: &'a Value) -> Vec<FieldDifference<'a>> {
        let mut found = Vec::new();
        compare(String::new(), Some(self), Some(other), &mut found);
        found
    }
}

fn compare<'a>(
    path: String,
    first: Option<&'a Value>,
    second: Option<&'a Value>,
    found: &mut Vec<FieldDifference<'a>>,
) {
    match (first, second) {
        (Some(Value::Fields(a)), Some(Value::Fields(b))) => {
            let inner = |name: &str| if path.is_empty() { name.to_owned() } else { format!("{path}.{name}") };
            let of = |fields: &'a [(String, Value)], name: &str| {
                fields.iter().find(|(other, _)| other == name).map(|(_, value)| value)
            };
            a.iter().for_each(|(name, value)| compare(inner(name), Some(value), of(b, name), found));
            let only_second = b.iter().filter(|(name, _)| of(a, name).is_none());
            only_second.for_each(|(name, value)| compare(inner(name), None, Some(value), found));
        }
        (Some(Value::List(a)), Some(Value::List(b))) => {
            let pairs = (0..a.len().max(b.len())).map(|index| (index, a.get(index), b.get(index)));
            pairs.for_each(|(position, a, b)| compare(format!("{path}[{position}]"), a, b, found));
        }
        (Some(Value::Float(a)), Some(Value::Float(b))) if a.to_bits() == b.to_bits() => {}
        (Some(Value::Float(_)), Some(Value::Float(_))) => {
            found.push(FieldDifference { path, first, second });
        }
        _ if first == second => {}
        _ => found.push(FieldDifference { path, first, second }),
    }
}
