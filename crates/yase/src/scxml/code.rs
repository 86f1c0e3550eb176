//! Pieces of ECMAScript inside a document: their text, and what it was compiled to.

use super::language::{
    Expression, Fault, Location, Program, Refusal, Refused, parse_expression, parse_location, parse_program,
};

/// A text in the language of the document, compiled once.
///
/// A text that is no ECMAScript is kept: it is an error when its turn comes.
#[derive(Clone, Debug)]
pub(crate) struct Code<T> {
    pub(crate) text: String,
    compiled: Result<T, Refused>,
}

impl<T> PartialEq for Code<T> {
    fn eq(&self, other: &Code<T>) -> bool {
        self.text == other.text
    }
}

impl Code<Expression> {
    pub(crate) fn expression(text: &str) -> Code<Expression> {
        Code { text: text.into(), compiled: parse_expression(text) }
    }
}

impl Code<Location> {
    pub(crate) fn location(text: &str) -> Code<Location> {
        Code { text: text.into(), compiled: parse_location(text) }
    }
}

impl Code<Program> {
    pub(crate) fn program(text: &str) -> Code<Program> {
        Code { text: text.into(), compiled: parse_program(text) }
    }
}

impl<T> Code<T> {
    /// What it was compiled to.
    pub(crate) fn get(&self) -> Result<&T, Fault> {
        self.compiled.as_ref().map_err(|refused| Fault::new(format!("`{}`: {}", self.text, refused.message)))
    }

    pub(crate) fn compiled(&self) -> Option<&T> {
        self.compiled.as_ref().ok()
    }

    pub(crate) fn refused(&self) -> Option<&Refused> {
        self.compiled.as_ref().err()
    }

    /// Whether it is ECMAScript that is not understood.
    pub(crate) fn is_unsupported(&self) -> bool {
        self.refused().is_some_and(|refused| refused.refusal == Refusal::Unsupported)
    }
}

/// What a document gives as it is, or as an expression: `target` and `targetexpr`.
#[derive(Clone, PartialEq, Debug)]
pub(crate) enum Given {
    Fixed(String),
    Computed(Code<Expression>),
}
