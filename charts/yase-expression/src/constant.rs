//! Constants of a model.

/// A value with a name, usable in expressions.
#[derive(Clone, PartialEq, Debug)]
pub struct Constant {
    /// Its name.
    pub name: String,
    /// Its value.
    pub value: ConstantValue,
}

/// The value of a constant.
#[derive(Clone, PartialEq, Debug)]
pub enum ConstantValue {
    /// True or false.
    Bool(bool),
    /// A number.
    Number(f64),
    /// A text.
    Text(String),
}

impl From<bool> for ConstantValue {
    fn from(value: bool) -> ConstantValue {
        ConstantValue::Bool(value)
    }
}

impl From<f64> for ConstantValue {
    fn from(value: f64) -> ConstantValue {
        ConstantValue::Number(value)
    }
}

impl From<&str> for ConstantValue {
    fn from(value: &str) -> ConstantValue {
        ConstantValue::Text(value.to_owned())
    }
}
