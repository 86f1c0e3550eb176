//! The tree that expressions and scripts are compiled to.

use std::sync::Arc;

use super::value::Value;

/// An expression.
#[derive(Clone, PartialEq, Debug)]
pub(crate) enum Expression {
    /// `1`, `'text'`, `true`, `null`.
    Literal(Value),
    /// A variable.
    Variable(Arc<str>),
    /// `[a, b]`.
    Array(Vec<Expression>),
    /// `{a: 1, 'b': 2}`.
    Object(Vec<(Arc<str>, Expression)>),
    /// `function(a) { … }`.
    Function(Arc<Function>),
    /// `!a`, `-a`, `+a`, `typeof a`.
    Unary(Unary, Box<Expression>),
    /// Operators of one precedence, from left to right.
    Chain(Box<Expression>, Vec<(Binary, Expression)>),
    /// `a && b && c`.
    And(Vec<Expression>),
    /// `a || b || c`.
    Or(Vec<Expression>),
    /// `a ? b : c`.
    Choose(Box<[Expression; 3]>),
    /// `a.b[c](d)`, from left to right.
    Access(Box<Expression>, Vec<Access>),
    /// `In(state)` or `String(value)`.
    Builtin(Builtin, Box<Expression>),
}

/// An operator before its operand.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub(crate) enum Unary {
    Not,
    Minus,
    Plus,
    TypeOf,
}

/// An operator between two operands.
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

/// A function of the language itself.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub(crate) enum Builtin {
    /// Whether a state is active.
    In,
    /// The text of a value.
    String,
}

/// A step from a value to one that belongs to it.
#[derive(Clone, PartialEq, Debug)]
pub(crate) enum Access {
    /// `.name`
    Member(Arc<str>),
    /// `[index]`
    Index(Expression),
    /// `(arguments)`
    Call(Vec<Expression>),
    /// `.method(arguments)`
    Method(Method, Vec<Expression>),
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
    /// The method of a name.
    pub(super) fn find(name: &str) -> Option<Method> {
        Some(match name {
            "concat" => Method::Concat,
            "join" => Method::Join,
            "push" => Method::Push,
            "slice" => Method::Slice,
            _ => return None,
        })
    }
}

/// Where a value can be put: a variable, or a member of what a variable holds.
#[derive(Clone, PartialEq, Debug)]
pub(crate) struct Location {
    /// The variable.
    pub(crate) variable: Arc<str>,
    /// Members and indices.
    pub(crate) path: Vec<Access>,
}

/// A function that a document defines.
#[derive(Clone, PartialEq, Debug)]
pub(crate) struct Function {
    pub(crate) parameters: Vec<Arc<str>>,
    pub(crate) body: Vec<Statement>,
}

/// A script.
#[derive(Clone, PartialEq, Debug, Default)]
pub(crate) struct Program {
    pub(crate) statements: Vec<Statement>,
}

/// A statement of a script.
#[derive(Clone, PartialEq, Debug)]
pub(crate) enum Statement {
    /// `var a = 1, b`
    Declare(Vec<(Arc<str>, Option<Expression>)>),
    /// `a = 1`, `a.b += 2`
    Assign(Location, Option<Binary>, Expression),
    /// A call, for what it does.
    Evaluate(Expression),
    /// `if (a) … else …`
    If(Expression, Vec<Statement>, Vec<Statement>),
    /// `return a`, in functions only.
    Return(Option<Expression>),
}
