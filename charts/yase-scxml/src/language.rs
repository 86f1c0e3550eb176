//! The expressions and scripts of SCXML documents: the subset of ECMAScript that statecharts need.
//!
//! Values are those of ECMAScript (undefined, null, booleans, numbers, texts, arrays, objects,
//! functions), with its conversions; objects are passed by reference. Features that need a complete
//! engine are not supported: loops, classes, prototypes, exceptions, regular expressions, most of
//! the library. They are [refused](ScriptErrorKind::Unsupported) when a document is read. Text that
//! is not ECMAScript is not refused: by the recommendation it raises `error.execution` when it is
//! executed.
//!
//! ```text
//! program    = { statement }
//! statement  = "var" name [ "=" expression ] { "," … } | place ("=" | "+=" | "-=" | "*=" | "/=" | "%=") expression
//!            | place ("++" | "--") | expression | "if" "(" expression ")" statement [ "else" statement ]
//!            | "function" name "(" names ")" block | block | "return" [ expression ]
//! expression = or [ "?" expression ":" expression ]
//! or         = and { "||" and }                     and = equality { "&&" equality }
//! equality   = relation { ("==" | "!=" | "===" | "!==") relation }
//! relation   = sum { ("<" | "<=" | ">" | ">=" | "in") sum }
//! sum        = product { ("+" | "-") product }      product = unary { ("*" | "/" | "%") unary }
//! unary      = ("!" | "-" | "+" | "typeof") unary | operand { "." name | "[" expression "]" | "(" expressions ")" }
//! operand    = number | text | "true" | "false" | "null" | "undefined" | name | "[" expressions "]" | "{" members "}"
//!            | "function" "(" names ")" block | "(" expression ")" | "In(" expression ")" | "String(" expression ")"
//!            | "Math." name [ "(" expressions ")" ] | "JSON.stringify(" expressions ")"
//!            | ("isNaN" | "isFinite") "(" expression ")"
//! ```
//!
//! Arrays have `length`, `concat`, `join`, `push` and `slice`; texts have `length`, `slice` and
//! `concat`. `Math` has all but `random`, `imul` and `clz32`. Functions access their parameters,
//! their own variables and those of the document.

mod convert;
mod evaluate;
mod execute;
mod heap;
mod lexer;
mod library;
mod memory;
mod methods;
mod parser;
mod query;
mod reserved_words;
mod syntax;
#[cfg(test)]
mod tests;
mod value;

pub(crate) use evaluate::{Evaluator, InPredicate};
pub(crate) use heap::{Heap, PropertyMap};
pub(crate) use memory::{ScriptMemory, StepBudget};
pub(crate) use parser::{is_json, parse_expression, parse_location, parse_program};
pub(crate) use query::ActiveQuery;
pub(crate) use reserved_words::is_variable;
pub(crate) use syntax::{Location, ScriptExpression, ScriptProgram};
pub use value::DataValue;
pub(crate) use value::ScriptValue;

use yase::diagnostic::Span;

/// Maximum length of a text in bytes.
const MAX_TEXT: usize = 1 << 20;
/// Maximum size of a session's data in bytes.
const MAX_BYTES: usize = 1 << 26;

/// Why a text is not an expression or a script.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub(crate) enum ScriptErrorKind {
    /// It is not ECMAScript.
    Malformed,
    /// It is ECMAScript outside of the subset.
    Unsupported,
}

/// A text that is not an expression or a script.
#[derive(Clone, PartialEq, Eq, Debug)]
pub(crate) struct Unsupported {
    pub(crate) refusal: ScriptErrorKind,
    /// The position in the text.
    pub(crate) span: Span,
    pub(crate) message: String,
}

/// Why an evaluation failed.
#[derive(Clone, PartialEq, Eq, Debug)]
pub(crate) struct EvalError {
    pub(crate) message: String,
}

impl EvalError {
    pub(crate) fn new(message: impl Into<String>) -> EvalError {
        EvalError { message: message.into() }
    }
}
