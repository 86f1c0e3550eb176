//! Assignment of expression values to message fields.

use crate::CallError;
use crate::vocabulary::Value;

/// A type of field that an expression may assign.
///
/// Integers fit if their value is in range, and into floating-point fields; a number with a
/// fraction does not fit into an integer field.
pub trait Field: Sized {
    /// Converts a value to the type of the field.
    ///
    /// # Errors
    /// The field cannot hold the value; `field` is its name.
    fn read(value: Value<'_>, field: &str) -> Result<Self, CallError>;
}

/// Sets a field of a message.
///
/// # Errors
/// The field cannot hold the value; it is left unchanged.
pub fn set<T: Field>(target: &mut T, value: Value<'_>, field: &str) -> Result<(), CallError> {
    *target = T::read(value, field)?;
    Ok(())
}

/// The nested message, created if it is not set.
pub fn inside_mut<T: Default>(message: &mut Option<T>) -> &mut T {
    message.get_or_insert_default()
}

fn wrong_kind(field: &str) -> CallError {
    CallError::new(format!("the field `{field}` does not hold such a value"))
}

fn out_of_range(field: &str) -> CallError {
    CallError::new(format!("the number does not fit into the field `{field}`"))
}

/// An integer, also from a float without fraction, since constants are floats.
fn whole<T: TryFrom<i128>>(value: Value<'_>, field: &str) -> Result<T, CallError> {
    let number = match value {
        Value::Missing => 0,
        Value::Int(value) => i128::from(value),
        Value::Uint(value) => i128::from(value),
        Value::Enum(value) => i128::from(value),
        Value::Float(value) if value.trunc() == value => value as i128,
        Value::Float(_) => return Err(out_of_range(field)),
        _ => return Err(wrong_kind(field)),
    };
    T::try_from(number).map_err(|_| out_of_range(field))
}

impl Field for bool {
    fn read(value: Value<'_>, field: &str) -> Result<bool, CallError> {
        match value {
            Value::Missing => Ok(false),
            Value::Bool(truth) => Ok(truth),
            _ => Err(wrong_kind(field)),
        }
    }
}

impl Field for i32 {
    fn read(value: Value<'_>, field: &str) -> Result<i32, CallError> {
        whole(value, field)
    }
}

impl Field for i64 {
    fn read(value: Value<'_>, field: &str) -> Result<i64, CallError> {
        whole(value, field)
    }
}

impl Field for u32 {
    fn read(value: Value<'_>, field: &str) -> Result<u32, CallError> {
        whole(value, field)
    }
}

impl Field for u64 {
    fn read(value: Value<'_>, field: &str) -> Result<u64, CallError> {
        whole(value, field)
    }
}

impl Field for f64 {
    fn read(value: Value<'_>, field: &str) -> Result<f64, CallError> {
        match value {
            Value::Missing => Ok(0.0),
            Value::Int(value) => Ok(value as f64),
            Value::Uint(value) => Ok(value as f64),
            Value::Float(value) => Ok(value),
            _ => Err(wrong_kind(field)),
        }
    }
}

impl Field for f32 {
    fn read(value: Value<'_>, field: &str) -> Result<f32, CallError> {
        f64::read(value, field).map(|value| value as f32)
    }
}

impl Field for String {
    fn read(value: Value<'_>, field: &str) -> Result<String, CallError> {
        match value {
            Value::Missing => Ok(String::new()),
            Value::Text(text) => Ok(text.to_owned()),
            _ => Err(wrong_kind(field)),
        }
    }
}

impl<T: Field> Field for Option<T> {
    fn read(value: Value<'_>, field: &str) -> Result<Option<T>, CallError> {
        match value {
            Value::Missing => Ok(None),
            value => T::read(value, field).map(Some),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn read<T: Field>(value: Value<'_>) -> Result<T, String> {
        T::read(value, "n").map_err(|error| error.to_string())
    }

    #[test]
    fn valid_settings_are_applied_and_others_are_named() {
        let out_of_range = Err("the number does not fit into the field `n`".to_owned());
        assert_eq!(read::<i32>(Value::Float(3.0)), Ok(3));
        assert_eq!(read::<i32>(Value::Float(3.5)), out_of_range);
        assert_eq!(read::<u32>(Value::Int(-1)).map(i64::from), out_of_range.clone().map(i64::from));
        assert_eq!(read::<f32>(Value::Uint(7)), Ok(7.0));
        assert_eq!(read::<bool>(Value::Uint(1)), Err("the field `n` does not hold such a value".into()));
        assert_eq!(read::<Option<String>>(Value::Text("a")), Ok(Some("a".into())));
    }

    #[test]
    fn a_value_that_does_not_fit_changes_nothing() {
        let mut number = 5_u32;
        assert!(set(&mut number, Value::Int(-1), "n").is_err());
        assert_eq!(number, 5);
    }
}
