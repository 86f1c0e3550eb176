//! Values of expressions, from and into the fields of messages.

use narukom::{AnyMessage, FieldValue};
use yase::expression::CallError;
use yase::{FieldId, Value};

/// A field of a message; the path leads through messages inside it. Missing if one of these is not set.
pub(crate) fn field<'a>(message: &'a dyn AnyMessage, path: &[FieldId]) -> Value<'a> {
    let Some((last, outer)) = path.split_last() else { return Value::Message(message.as_any()) };
    let mut message = message;
    for step in outer {
        match message.field(step.0 as usize) {
            FieldValue::Message(inner) => message = inner,
            _ => return Value::Missing,
        }
    }
    value(message.field(last.0 as usize))
}

fn value(field: FieldValue<'_>) -> Value<'_> {
    match field {
        FieldValue::Bool(truth) => Value::Bool(truth),
        FieldValue::Int(number) => Value::Int(number),
        FieldValue::Uint(number) => Value::Uint(number),
        FieldValue::Float(number) => Value::Float(number),
        FieldValue::Text(text) => Value::Text(text),
        FieldValue::Enum(number) => Value::Enum(number),
        FieldValue::Message(message) => Value::Message(message.as_any()),
        // Lists, maps and bytes have no place in the vocabulary, so no expression reaches them.
        _ => Value::Missing,
    }
}

/// Sets a field of a message; messages on the way to it are made if they are missing.
pub(crate) fn set_field(
    message: &mut dyn AnyMessage,
    path: &[FieldId],
    value: Value<'_>,
) -> Result<(), CallError> {
    let Some((last, outer)) = path.split_last() else {
        return Err(CallError::new("a whole message cannot be assigned"));
    };
    let mut message = message;
    for step in outer {
        let inner = message.message_mut(step.0 as usize);
        message = inner.ok_or_else(|| CallError::new("there is no message inside the message"))?;
    }
    let value = field_value(value).ok_or_else(|| CallError::new("a whole message cannot be assigned"))?;
    message.set_field(last.0 as usize, value).map_err(|error| CallError::new(error.to_string()))
}

fn field_value(value: Value<'_>) -> Option<FieldValue<'_>> {
    Some(match value {
        Value::Missing => FieldValue::Missing,
        Value::Bool(truth) => FieldValue::Bool(truth),
        Value::Int(number) => FieldValue::Int(number),
        Value::Uint(number) => FieldValue::Uint(number),
        Value::Float(number) => FieldValue::Float(number),
        Value::Text(text) => FieldValue::Text(text),
        Value::Enum(number) => FieldValue::Enum(number),
        Value::Message(_) => return None,
    })
}
