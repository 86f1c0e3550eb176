//! Pieces of ECMAScript in a document: their text and the compiled form.

use super::language::{
    EvalError, Location, ScriptErrorKind, ScriptExpression, ScriptProgram, Unsupported, parse_expression,
    parse_location, parse_program,
};

/// A text in the language of the document, compiled once.
///
/// An invalid text is kept: executing it raises an error.
#[derive(Clone, Debug)]
pub(crate) struct CompiledText<T> {
    pub(crate) text: String,
    compiled: Result<T, Unsupported>,
}

impl<T> PartialEq for CompiledText<T> {
    fn eq(&self, other: &CompiledText<T>) -> bool {
        self.text == other.text
    }
}

impl CompiledText<ScriptExpression> {
    pub(crate) fn expression(text: &str) -> CompiledText<ScriptExpression> {
        CompiledText { text: text.into(), compiled: parse_expression(text) }
    }
}

impl CompiledText<Location> {
    pub(crate) fn location(text: &str) -> CompiledText<Location> {
        CompiledText { text: text.into(), compiled: parse_location(text) }
    }
}

impl CompiledText<ScriptProgram> {
    pub(crate) fn program(text: &str) -> CompiledText<ScriptProgram> {
        CompiledText { text: text.into(), compiled: parse_program(text) }
    }
}

impl<T> CompiledText<T> {
    /// The compiled form.
    pub(crate) fn get(&self) -> Result<&T, EvalError> {
        self.compiled
            .as_ref()
            .map_err(|refused| EvalError::new(format!("`{}`: {}", self.text, refused.message)))
    }

    pub(crate) fn compiled(&self) -> Option<&T> {
        self.compiled.as_ref().ok()
    }

    pub(crate) fn refused(&self) -> Option<&Unsupported> {
        self.compiled.as_ref().err()
    }

    /// Whether it is ECMAScript outside of the supported subset.
    pub(crate) fn is_unsupported(&self) -> bool {
        self.refused().is_some_and(|refused| refused.refusal == ScriptErrorKind::Unsupported)
    }
}

/// A value given literally or as an expression: `target` and `targetexpr`.
#[derive(Clone, PartialEq, Debug)]
pub(crate) enum LiteralOrExpression {
    Fixed(String),
    Computed(CompiledText<ScriptExpression>),
}
