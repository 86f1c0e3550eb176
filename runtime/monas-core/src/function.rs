//! Functions that transition expressions may call.
//!
//! The result of a function depends on its arguments only: a chart is evaluated again when a topic
//! that its guards read has a new message, and a change of any other input would be missed.

use narukom::Message;
use yase::Value;
use yase::vocabulary::ValueType;

/// A function as [`function!`](crate::function!) registers it.
#[derive(Clone, Copy)]
pub struct FunctionDeclaration {
    /// Its name in expressions.
    pub name: &'static str,
    /// The module it was registered in.
    pub module: &'static str,
    /// The types of its arguments.
    pub parameters: fn() -> Vec<ValueType>,
    /// The type of its result.
    pub result: fn() -> ValueType,
    /// Calls it; none if an argument is missing or of another type.
    pub call: fn(&[Value<'_>]) -> Option<Value<'static>>,
}

impl std::fmt::Debug for FunctionDeclaration {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "{}::{}", self.module, self.name)
    }
}

/// Every function registered in the crates of this program.
#[doc(hidden)]
#[linkme::distributed_slice]
pub static FUNCTIONS: [FunctionDeclaration];

/// Puts a function into the registry, so that transition expressions can call it.
///
/// Arguments are numbers (`f64`, `i64`), booleans (`bool`), texts (`&str`) and whole messages
/// (`&Ball`); results are numbers and booleans.
///
/// ```
/// fn midway(a: f64, b: f64) -> f64 {
///     (a + b) / 2.0
/// }
/// monas_core::function!(midway(f64, f64) -> f64);
///
/// let registry = monas_core::Registry::linked();
/// assert!(registry.function_names().any(|name| name == "midway"));
/// ```
#[macro_export]
macro_rules! function {
    ($name:ident ( $($argument:ty),* $(,)? ) -> $result:ty) => {
        $crate::function!($name($($argument),*) -> $result as ::core::stringify!($name));
    };
    ($name:ident ( $($argument:ty),* $(,)? ) -> $result:ty as $registered:expr) => {
        const _: () = {
            #[allow(unsafe_code)] // the section of the executable that the linker collects
            #[$crate::linked::linkme::distributed_slice($crate::linked::FUNCTIONS)]
            #[linkme(crate = $crate::linked::linkme)]
            static DECLARATION: $crate::linked::FunctionDeclaration = $crate::linked::FunctionDeclaration {
                name: $registered,
                module: ::core::module_path!(),
                parameters: || ::std::vec![$(<$argument as $crate::linked::Argument<'_>>::value_type()),*],
                result: <$result as $crate::linked::ReturnValue>::value_type,
                call: |values| {
                    #[allow(unused_mut, unused_variables)]
                    let mut values = values.iter().copied();
                    let answer: $result =
                        $name($(<$argument as $crate::linked::Argument<'_>>::from_value(values.next()?)?),*);
                    ::core::option::Option::Some($crate::linked::ReturnValue::into_value(answer))
                },
            };
        };
    };
}

/// Argument types of functions.
#[diagnostic::on_unimplemented(
    message = "a function of expressions cannot take `{Self}`",
    note = "it takes `f64`, `i64`, `bool`, `&str` and references to messages such as `&Ball`"
)]
pub trait Argument<'a>: Sized {
    /// Its type in expressions.
    fn value_type() -> ValueType;
    /// Converts a value; none if it is of another type or missing.
    fn from_value(value: Value<'a>) -> Option<Self>;
}

impl Argument<'_> for f64 {
    fn value_type() -> ValueType {
        ValueType::Number
    }
    fn from_value(value: Value<'_>) -> Option<f64> {
        match value {
            Value::Float(number) => Some(number),
            Value::Int(number) => Some(number as f64),
            Value::Uint(number) => Some(number as f64),
            _ => None,
        }
    }
}

impl Argument<'_> for i64 {
    fn value_type() -> ValueType {
        ValueType::Number
    }
    fn from_value(value: Value<'_>) -> Option<i64> {
        match value {
            Value::Int(number) => Some(number),
            Value::Uint(number) => i64::try_from(number).ok(),
            // A number with a fraction is not an integer; above 2^53 several integers have the same
            // float.
            Value::Float(number) if libm::trunc(number) == number && libm::fabs(number) < 9e15 => {
                Some(number as i64)
            }
            _ => None,
        }
    }
}

impl Argument<'_> for bool {
    fn value_type() -> ValueType {
        ValueType::Bool
    }
    fn from_value(value: Value<'_>) -> Option<bool> {
        match value {
            Value::Bool(truth) => Some(truth),
            _ => None,
        }
    }
}

impl<'a> Argument<'a> for &'a str {
    fn value_type() -> ValueType {
        ValueType::Text
    }
    fn from_value(value: Value<'a>) -> Option<&'a str> {
        match value {
            Value::Text(text) => Some(text),
            _ => None,
        }
    }
}

impl<'a, M: Message> Argument<'a> for &'a M {
    fn value_type() -> ValueType {
        ValueType::Message(M::DESCRIPTOR.name.into())
    }
    fn from_value(value: Value<'a>) -> Option<&'a M> {
        match value {
            Value::Message(message) => message.downcast_ref(),
            _ => None,
        }
    }
}

/// Result types of functions.
#[diagnostic::on_unimplemented(
    message = "a function of expressions cannot return `{Self}`",
    note = "it returns `bool`, `f64` or `i64`"
)]
pub trait ReturnValue {
    /// Its type in expressions.
    fn value_type() -> ValueType;
    /// Converts to a value.
    fn into_value(self) -> Value<'static>;
}

impl ReturnValue for bool {
    fn value_type() -> ValueType {
        ValueType::Bool
    }
    fn into_value(self) -> Value<'static> {
        Value::Bool(self)
    }
}

impl ReturnValue for f64 {
    fn value_type() -> ValueType {
        ValueType::Number
    }
    fn into_value(self) -> Value<'static> {
        Value::Float(self)
    }
}

impl ReturnValue for i64 {
    fn value_type() -> ValueType {
        ValueType::Number
    }
    fn into_value(self) -> Value<'static> {
        Value::Int(self)
    }
}

/// Whether a function is built into expressions, independent of the program's registry.
pub(crate) fn is_own(declaration: &FunctionDeclaration) -> bool {
    declaration.module == module_path!()
}

fn abs(number: f64) -> f64 {
    libm::fabs(number)
}
fn min(a: f64, b: f64) -> f64 {
    libm::fmin(a, b)
}
fn max(a: f64, b: f64) -> f64 {
    libm::fmax(a, b)
}

crate::function!(abs(f64) -> f64);
crate::function!(min(f64, f64) -> f64);
crate::function!(max(f64, f64) -> f64);

#[cfg(test)]
mod tests {
    use monas_robot::Sensors;

    use super::*;

    fn mixed(sensors: &Sensors, limit: f64, count: i64, strict: bool, name: &str) -> bool {
        sensors.head_yaw > limit && count > 1 && strict && name == "head"
    }
    crate::function!(mixed(&Sensors, f64, i64, bool, &str) -> bool as "function_test_mixed");

    fn declaration() -> &'static FunctionDeclaration {
        FUNCTIONS.iter().find(|function| function.name == "function_test_mixed").unwrap()
    }

    #[test]
    fn arguments_of_every_type_are_passed() {
        let sensors = Sensors { head_yaw: 0.5, ..Sensors::default() };
        let call = |limit, count| {
            let values = [Value::Message(&sensors), limit, count, Value::Bool(true), Value::Text("head")];
            match (declaration().call)(&values) {
                Some(Value::Bool(truth)) => Some(truth),
                _ => None,
            }
        };
        assert_eq!(call(Value::Float(0.4), Value::Int(2)), Some(true));
        assert_eq!(call(Value::Int(1), Value::Uint(2)), Some(false));
        assert_eq!(call(Value::Float(0.4), Value::Float(2.0)), Some(true));
        assert_eq!(call(Value::Float(0.4), Value::Float(2.5)), None, "no whole number");
        assert_eq!(call(Value::Missing, Value::Int(2)), None);
        assert_eq!(call(Value::Bool(true), Value::Int(2)), None);
    }

    #[test]
    fn too_few_arguments_are_no_call() {
        assert!((declaration().call)(&[]).is_none());
    }

    #[test]
    fn types_are_declared() {
        let expected = [
            ValueType::Message("Sensors".into()),
            ValueType::Number,
            ValueType::Number,
            ValueType::Bool,
            ValueType::Text,
        ];
        assert_eq!((declaration().parameters)(), expected);
        assert_eq!((declaration().result)(), ValueType::Bool);
    }
}
