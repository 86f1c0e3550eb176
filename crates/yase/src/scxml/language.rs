//! The expressions and scripts of SCXML documents: the subset of ECMAScript that statecharts need.
//!
//! Values are those of ECMAScript (undefined, null, booleans, numbers, texts, arrays, objects, functions), with its conversions and with
//! objects that are passed by reference. Left out is what would need an engine of its own: loops, classes, prototypes, exceptions,
//! regular expressions, the library. What is left out is [refused](Refusal::Unsupported) when a document is read. What is not ECMAScript at
//! all is not refused: by the recommendation it is an `error.execution` when its turn comes.
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
//! ```
//!
//! Arrays have `length`, `concat`, `join`, `push` and `slice`; texts have `length`, `slice` and `concat`. Functions see their parameters, their own
//! variables and those of the document.

mod convert;
mod evaluate;
mod execute;
mod heap;
mod lexer;
mod memory;
mod methods;
mod parser;
mod query;
mod syntax;
#[cfg(test)]
mod tests;
mod value;
mod words;

pub(crate) use evaluate::{ActiveStates, Evaluation};
pub(crate) use heap::{Heap, Record};
pub(crate) use memory::Memory;
pub(crate) use parser::{is_json, parse_expression, parse_location, parse_program};
pub(crate) use query::ActiveQuery;
pub(crate) use syntax::{Expression, Location, Program};
pub use value::Data;
pub(crate) use value::Value;
pub(crate) use words::is_variable;

use crate::diagnostic::Span;

/// The longest text there may be, in bytes.
const MAX_TEXT: usize = 1 << 20;
/// How much the data of one session may take.
const MAX_BYTES: usize = 1 << 26;

/// Why a text is not an expression or a script.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub(crate) enum Refusal {
    /// It is not ECMAScript.
    Malformed,
    /// It is, but not of the subset.
    Unsupported,
}

/// A text that is not an expression or a script.
#[derive(Clone, PartialEq, Eq, Debug)]
pub(crate) struct Refused {
    pub(crate) refusal: Refusal,
    /// The place in the text.
    pub(crate) span: Span,
    pub(crate) message: String,
}

/// Why something could not be evaluated.
#[derive(Clone, PartialEq, Eq, Debug)]
pub(crate) struct Fault {
    pub(crate) message: String,
}

impl Fault {
    pub(crate) fn new(message: impl Into<String>) -> Fault {
        Fault { message: message.into() }
    }
}
