//! Errors of the evaluation of expressions.

use crate::eval_context::CallError;

/// Why an expression has no value. A guard that fails counts as false.
#[derive(Clone, PartialEq, Eq, Debug, thiserror::Error)]
#[non_exhaustive]
pub enum GuardError {
    /// A number was divided by zero.
    #[error("division by zero")]
    DivisionByZero,
    /// An integer exceeded the range of 64 bits.
    #[error("a whole number is out of range")]
    OutOfRange,
    /// NaN was compared.
    #[error("NaN was compared")]
    NotANumber,
    /// A value does not have the declared type of its field or function.
    #[error("a value does not have the declared type")]
    WrongType,
    /// A function failed.
    #[error("the function failed: {0}")]
    Call(#[from] CallError),
}
