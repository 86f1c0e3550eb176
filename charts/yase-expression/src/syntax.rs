//! The syntax tree of a transition expression, with the position of each part.

use std::time::Duration;

use crate::diagnostic::Span;

/// The text of a transition: `trigger [guard] / actions`, each part optional.
///
/// The default is the empty expression: no trigger, always enabled, no actions.
#[derive(Clone, PartialEq, Debug, Default)]
pub struct TransitionExpression {
    /// The events that trigger it; `None` for a transition without trigger.
    pub trigger: Option<Trigger>,
    /// The condition that enables it.
    pub guard: Option<Expression>,
    /// The actions, in order.
    pub actions: Vec<Action>,
}

impl TransitionExpression {
    /// Whether there is neither trigger nor guard nor action.
    pub fn is_empty(&self) -> bool {
        self.trigger.is_none() && self.guard.is_none() && self.actions.is_empty()
    }

    /// Whether the guard is the word `false`: the transition is intentionally never taken.
    pub fn is_never(&self) -> bool {
        matches!(&self.guard, Some(guard) if guard.kind == ExpressionKind::Bool(false))
    }

    /// The names of the timers that its actions start, in order, with duplicates.
    pub fn started_timers(&self) -> impl Iterator<Item = String> {
        started_timers(&self.actions)
    }
}

/// The names of the timers that actions start, in order, with duplicates.
pub fn started_timers(actions: &[Action]) -> impl Iterator<Item = String> {
    actions.iter().filter_map(|action| match &action.kind {
        ActionKind::StartTimeout { timer, .. } => Some(timer.text()),
        _ => None,
    })
}

/// Position of a part in its text.
///
/// All positions are equal: trees compare by meaning, which does not depend on the position.
#[derive(Clone, Copy, Debug, Default)]
pub struct TextPosition(pub Span);

impl PartialEq for TextPosition {
    fn eq(&self, _: &TextPosition) -> bool {
        true
    }
}

impl Eq for TextPosition {}

/// One segment of a path.
#[derive(Clone, PartialEq, Eq, Debug)]
pub struct Name {
    /// The name, without the backquotes it may have been written in.
    pub text: String,
    /// Its position.
    pub position: TextPosition,
}

/// Names separated by dots, one at least: `Ball.distance`,
/// `worldstate.State.GameState.player_state`, `near`.
///
/// The getter form `Ball.distance()` is the same path.
#[derive(Clone, PartialEq, Eq, Debug)]
pub struct Path {
    /// The names, one at least.
    pub segments: Vec<Name>,
    /// Its position.
    pub position: TextPosition,
}

impl Path {
    /// The names joined by dots, without backquotes: the name of a timer or an event.
    pub fn text(&self) -> String {
        let mut text = String::new();
        for name in &self.segments {
            if !text.is_empty() {
                text.push('.');
            }
            text.push_str(&name.text);
        }
        text
    }

    /// The name, if it is a single one.
    pub fn bare(&self) -> Option<&str> {
        match self.segments.as_slice() {
            [name] => Some(&name.text),
            _ => None,
        }
    }
}

/// The events that trigger a transition. A path names an event, or a message whose arrivals are
/// events.
#[derive(Clone, PartialEq, Eq, Debug)]
pub enum Trigger {
    /// `*`: any event.
    Any,
    /// `e` or `e1 | e2`: one of these, at least one.
    OneOf(Vec<Path>),
    /// `not e`: any event except this one.
    Not(Path),
}

/// A condition or an operand: a Boolean is an operand like any other.
#[derive(Clone, PartialEq, Debug)]
pub struct Expression {
    /// Kind and operands.
    pub kind: ExpressionKind,
    /// Its position.
    pub position: TextPosition,
}

impl Expression {
    /// Its span.
    pub fn span(&self) -> Span {
        self.position.0
    }

    /// Its direct subexpressions in textual order; none for names, values and predicates on paths.
    pub fn parts(&self) -> Vec<&Expression> {
        match &self.kind {
            ExpressionKind::Or(parts) | ExpressionKind::And(parts) | ExpressionKind::Call(_, parts) => {
                parts.iter().collect()
            }
            ExpressionKind::Not(operand) | ExpressionKind::Negative(operand) => vec![operand],
            ExpressionKind::Compare(left, _, right) => vec![left, right],
            ExpressionKind::Sum(first, rest) => {
                std::iter::once(&**first).chain(rest.iter().map(|(_, operand)| operand)).collect()
            }
            ExpressionKind::Product(first, rest) => {
                std::iter::once(&**first).chain(rest.iter().map(|(_, operand)| operand)).collect()
            }
            ExpressionKind::Absent(_)
            | ExpressionKind::Present(_)
            | ExpressionKind::Bool(_)
            | ExpressionKind::Integer(_)
            | ExpressionKind::Decimal(_)
            | ExpressionKind::Text(_)
            | ExpressionKind::Variable(_)
            | ExpressionKind::TimeoutCheck(_)
            | ExpressionKind::In(_)
            | ExpressionKind::Script(_) => Vec::new(),
        }
    }

    /// The expression with parts replaced: those for which the closure has another one, outermost
    /// first. The replacement itself is not searched again.
    pub fn replaced(&self, other: &mut dyn FnMut(&Expression) -> Option<Expression>) -> Expression {
        if let Some(other) = other(self) {
            return other;
        }
        let mut one = |operand: &Expression| operand.replaced(other);
        let kind = match &self.kind {
            ExpressionKind::Or(parts) => ExpressionKind::Or(parts.iter().map(one).collect()),
            ExpressionKind::And(parts) => ExpressionKind::And(parts.iter().map(one).collect()),
            ExpressionKind::Call(name, parts) => {
                ExpressionKind::Call(name.clone(), parts.iter().map(one).collect())
            }
            ExpressionKind::Not(operand) => ExpressionKind::Not(Box::new(one(operand))),
            ExpressionKind::Negative(operand) => ExpressionKind::Negative(Box::new(one(operand))),
            ExpressionKind::Compare(left, comparison, right) => {
                ExpressionKind::Compare(Box::new(one(left)), *comparison, Box::new(one(right)))
            }
            ExpressionKind::Sum(first, rest) => {
                let first = Box::new(one(first));
                ExpressionKind::Sum(first, rest.iter().map(|(sign, operand)| (*sign, one(operand))).collect())
            }
            ExpressionKind::Product(first, rest) => {
                let first = Box::new(one(first));
                let rest = rest.iter().map(|(operator, operand)| (*operator, one(operand)));
                ExpressionKind::Product(first, rest.collect())
            }
            leaf => leaf.clone(),
        };
        Expression { kind, position: self.position }
    }

    /// The first result of the closure in a pre-order walk of the expression.
    pub fn find_map<'a, T>(&'a self, visit: &mut dyn FnMut(&'a Expression) -> Option<T>) -> Option<T> {
        if let Some(found) = visit(self) {
            return Some(found);
        }
        self.parts().into_iter().find_map(|operand| operand.find_map(visit))
    }
}

/// Kind and operands of an [`Expression`].
#[derive(Clone, PartialEq, Debug)]
pub enum ExpressionKind {
    /// `a || b || c`, two operands at least.
    Or(Vec<Expression>),
    /// `a && b && c`, two operands at least.
    And(Vec<Expression>),
    /// `!a`.
    Not(Box<Expression>),
    /// `a < b` and the other comparisons.
    Compare(Box<Expression>, Comparison, Box<Expression>),
    /// `message == NULL`: none has arrived.
    Absent(Path),
    /// `message != NULL`: one has arrived.
    Present(Path),
    /// `a + b - c`, one operator at least.
    Sum(Box<Expression>, Vec<(Additive, Expression)>),
    /// `a * b / c`, one operator at least.
    Product(Box<Expression>, Vec<(Multiplicative, Expression)>),
    /// `-a`.
    Negative(Box<Expression>),
    /// `true`, `false`.
    Bool(bool),
    /// A number without a fraction.
    Integer(u64),
    /// A finite number with a fraction or an exponent, not negative.
    Decimal(f64),
    /// `"text"`.
    Text(String),
    /// A field, a message, a timer, a constant, a value of an enumeration or a function without
    /// arguments.
    Variable(Path),
    /// `function(a, b)`.
    Call(Name, Vec<Expression>),
    /// `TimeoutCheck(v)`: timer `v` was started and has expired.
    TimeoutCheck(Path),
    /// `In(state)`: the state with that path is active. Blanks are removed, `ω` is `~`.
    In(Name),
    /// `script("text")`: a condition in the language of the host.
    Script(String),
}

/// Comparison operator.
#[derive(Clone, Copy, PartialEq, Eq, Hash, Debug)]
pub enum Comparison {
    /// `==`
    Equal,
    /// `!=`
    NotEqual,
    /// `<`
    Less,
    /// `<=`
    LessOrEqual,
    /// `>`
    Greater,
    /// `>=`
    GreaterOrEqual,
}

impl Comparison {
    /// All operators.
    #[cfg(test)]
    pub(crate) const ALL: [Comparison; 6] = [
        Comparison::Equal,
        Comparison::NotEqual,
        Comparison::Less,
        Comparison::LessOrEqual,
        Comparison::Greater,
        Comparison::GreaterOrEqual,
    ];

    /// The negated comparison, for two values that can be compared.
    pub const fn negated(self) -> Comparison {
        match self {
            Comparison::Equal => Comparison::NotEqual,
            Comparison::NotEqual => Comparison::Equal,
            Comparison::Less => Comparison::GreaterOrEqual,
            Comparison::LessOrEqual => Comparison::Greater,
            Comparison::Greater => Comparison::LessOrEqual,
            Comparison::GreaterOrEqual => Comparison::Less,
        }
    }

    /// The equivalent comparison with exchanged operands.
    pub(crate) fn mirrored(self) -> Comparison {
        match self {
            Comparison::Less => Comparison::Greater,
            Comparison::LessOrEqual => Comparison::GreaterOrEqual,
            Comparison::Greater => Comparison::Less,
            Comparison::GreaterOrEqual => Comparison::LessOrEqual,
            same => same,
        }
    }
}

/// `+` or `-`.
#[derive(Clone, Copy, PartialEq, Eq, Hash, Debug)]
pub enum Additive {
    /// `+`
    Plus,
    /// `-`
    Minus,
}

/// `*` or `/`.
#[derive(Clone, Copy, PartialEq, Eq, Hash, Debug)]
pub enum Multiplicative {
    /// `*`
    Times,
    /// `/`
    Over,
}

/// One action of a transition, or of the entry or exit of a state.
#[derive(Clone, PartialEq, Debug)]
pub struct Action {
    /// Kind and operands.
    pub kind: ActionKind,
    /// Its position.
    pub position: TextPosition,
}

/// Kind and operands of an [`Action`].
#[derive(Clone, PartialEq, Debug)]
pub enum ActionKind {
    /// `Message.field = value`, also written `topic.Kind.Message.set_field(value)`.
    Assign {
        /// The field.
        target: Path,
        /// The new value.
        value: Expression,
    },
    /// `publish.Message` or `publish.topic.Kind.Message`.
    Publish(Path),
    /// `process_messages`: delivers the messages that have arrived.
    ProcessMessages,
    /// `publish_all`: publishes all written messages immediately.
    PublishAll,
    /// `StartTimeout(v, 100ms)` or `TimeoutAction.v.100`.
    StartTimeout {
        /// The timer's name.
        timer: Path,
        /// The time from now to its expiry.
        delay: Duration,
        /// Its spelling.
        form: TimeoutForm,
    },
    /// `raise(event)`.
    Raise(Path),
    /// `script("text")`: an action in the language of the host.
    Script(String),
}

/// The two spellings of the start of a timer; they are equivalent.
#[derive(Clone, Copy, PartialEq, Eq, Hash, Debug)]
pub enum TimeoutForm {
    /// `StartTimeout(v, 100ms)`
    StartTimeout,
    /// `TimeoutAction.v.100`
    TimeoutAction,
}
