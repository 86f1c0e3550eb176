//! The syntax tree of expressions and scripts.

use std::sync::Arc;

use super::library::LibraryFunction;
use super::value::ScriptValue;

/// An expression.
#[derive(Clone, PartialEq, Debug)]
pub(crate) enum ScriptExpression {
    /// `1`, `'text'`, `true`, `null`.
    Literal(ScriptValue),
    /// A variable.
    Variable(Arc<str>),
    /// `[a, b]`.
    Array(Vec<ScriptExpression>),
    /// `{a: 1, 'b': 2}`.
    Object(Vec<(Arc<str>, ScriptExpression)>),
    /// `function(a) { … }`.
    Function(Arc<ScriptFunction>),
    /// `!a`, `-a`, `+a`, `typeof a`.
    Unary(Unary, Box<ScriptExpression>),
    /// Operators of one precedence, from left to right.
    Chain(Box<ScriptExpression>, Vec<(Binary, ScriptExpression)>),
    /// `a && b && c`.
    And(Vec<ScriptExpression>),
    /// `a || b || c`.
    Or(Vec<ScriptExpression>),
    /// `a ? b : c`.
    Choose(Box<[ScriptExpression; 3]>),
    /// `a.b[c](d)`, from left to right.
    Access(Box<ScriptExpression>, Vec<Access>),
    /// `In(state)` or `String(value)`.
    Builtin(Builtin, Box<ScriptExpression>),
    /// `Math.max(a, b)` or `JSON.stringify(a)`.
    Library(LibraryFunction, Vec<ScriptExpression>),
}

/// A unary operator.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub(crate) enum Unary {
    Not,
    Minus,
    Plus,
    TypeOf,
}

/// A binary operator.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub(crate) enum Binary {
    Equal,
    NotEqual,
    Same,
    NotSame,
    Less,
    LessOrEqual,
    Greater,
    GreaterOrEqual,
    /// `'name' in object`.
    Within,
    Plus,
    Minus,
    Times,
    Over,
    Modulo,
}

/// A built-in function.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub(crate) enum Builtin {
    /// Whether a state is active.
    In,
    /// The text of a value.
    String,
}

/// An access to a part of a value.
#[derive(Clone, PartialEq, Debug)]
pub(crate) enum Access {
    /// `.name`
    Member(Arc<str>),
    /// `[index]`
    Index(ScriptExpression),
    /// `(arguments)`
    Call(Vec<ScriptExpression>),
    /// `.method(arguments)`
    Method(Method, Vec<ScriptExpression>),
}

/// A method of arrays or texts.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub(crate) enum Method {
    Concat,
    Join,
    Push,
    Slice,
}

impl Method {
    /// The method with this name.
    pub(crate) fn find(name: &str) -> Option<Method> {
        Some(match name {
            "concat" => Method::Concat,
            "join" => Method::Join,
            "push" => Method::Push,
            "slice" => Method::Slice,
            _ => return None,
        })
    }
}

/// A location: a variable, or a member of its value.
#[derive(Clone, PartialEq, Debug)]
pub(crate) struct Location {
    /// The variable.
    pub(crate) variable: Arc<str>,
    /// Members and indices.
    pub(crate) path: Vec<Access>,
}

/// A function that a document defines.
#[derive(Clone, PartialEq, Debug)]
pub(crate) struct ScriptFunction {
    pub(crate) parameters: Vec<Arc<str>>,
    pub(crate) body: Vec<Statement>,
}

/// A script.
#[derive(Clone, PartialEq, Debug, Default)]
pub(crate) struct ScriptProgram {
    pub(crate) statements: Vec<Statement>,
}

/// A statement of a script.
#[derive(Clone, PartialEq, Debug)]
pub(crate) enum Statement {
    /// `var a = 1, b`
    Declare(Vec<(Arc<str>, Option<ScriptExpression>)>),
    /// `a = 1`, `a.b += 2`
    Assign(Location, Option<Binary>, ScriptExpression),
    /// A call for its side effects.
    Evaluate(ScriptExpression),
    /// `if (a) … else …`
    If(ScriptExpression, Vec<Statement>, Vec<Statement>),
    /// `return a`, in functions only.
    Return(Option<ScriptExpression>),
}
