//! Conversions that generated code calls to set a field from a value.

use crate::message::{FieldError, FieldValue, Message};

type Read<T> = Result<T, FieldError>;

/// A value for a field that may be missing.
pub fn optional<T>(
    value: FieldValue<'_>,
    field: &'static str,
    read: fn(FieldValue<'_>, &'static str) -> Read<T>,
) -> Read<Option<T>> {
    match value {
        FieldValue::Missing => Ok(None),
        value => read(value, field).map(Some),
    }
}

pub fn boolean(value: FieldValue<'_>, field: &'static str) -> Read<bool> {
    match value {
        FieldValue::Missing => Ok(false),
        FieldValue::Bool(value) => Ok(value),
        _ => Err(FieldError::WrongKind { field }),
    }
}

pub fn int32(value: FieldValue<'_>, field: &'static str) -> Read<i32> {
    whole(value, field)
}

pub fn int64(value: FieldValue<'_>, field: &'static str) -> Read<i64> {
    whole(value, field)
}

pub fn uint32(value: FieldValue<'_>, field: &'static str) -> Read<u32> {
    whole(value, field)
}

pub fn uint64(value: FieldValue<'_>, field: &'static str) -> Read<u64> {
    whole(value, field)
}

/// An integer; also accepts a float without a fraction, as constants of expressions are.
fn whole<T: TryFrom<i128>>(value: FieldValue<'_>, field: &'static str) -> Read<T> {
    let number = match value {
        FieldValue::Missing => 0,
        FieldValue::Int(value) => i128::from(value),
        FieldValue::Uint(value) => i128::from(value),
        FieldValue::Float(value) if value.trunc() == value => value as i128,
        FieldValue::Float(_) => return Err(FieldError::OutOfRange { field }),
        _ => return Err(FieldError::WrongKind { field }),
    };
    T::try_from(number).map_err(|_| FieldError::OutOfRange { field })
}

pub fn float32(value: FieldValue<'_>, field: &'static str) -> Read<f32> {
    float64(value, field).map(|value| value as f32)
}

pub fn float64(value: FieldValue<'_>, field: &'static str) -> Read<f64> {
    match value {
        FieldValue::Missing => Ok(0.0),
        FieldValue::Int(value) => Ok(value as f64),
        FieldValue::Uint(value) => Ok(value as f64),
        FieldValue::Float(value) => Ok(value),
        _ => Err(FieldError::WrongKind { field }),
    }
}

pub fn text(value: FieldValue<'_>, field: &'static str) -> Read<String> {
    match value {
        FieldValue::Missing => Ok(String::new()),
        FieldValue::Text(value) => Ok(value.to_owned()),
        _ => Err(FieldError::WrongKind { field }),
    }
}

pub fn bytes(value: FieldValue<'_>, field: &'static str) -> Read<Vec<u8>> {
    match value {
        FieldValue::Missing => Ok(Vec::new()),
        FieldValue::Bytes(value) => Ok(value.to_owned()),
        _ => Err(FieldError::WrongKind { field }),
    }
}

/// The number of an enumeration value; as in protobuf, numbers without a name are kept.
pub fn enumeration(value: FieldValue<'_>, field: &'static str) -> Read<i32> {
    match value {
        FieldValue::Enum(value) => Ok(value),
        value => whole(value, field),
    }
}

pub fn message<M: Message>(value: FieldValue<'_>, field: &'static str) -> Read<Option<M>> {
    match value {
        FieldValue::Missing => Ok(None),
        FieldValue::Message(value) => match value.as_any().downcast_ref::<M>() {
            Some(value) => Ok(Some(value.clone())),
            None => Err(FieldError::WrongKind { field }),
        },
        _ => Err(FieldError::WrongKind { field }),
    }
}
