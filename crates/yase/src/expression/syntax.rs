//! The syntax tree: what a transition expression says, with the place of each part.

use std::time::Duration;

use crate::diagnostic::Span;

/// What is written on a transition: `trigger [guard] / actions`, each of them optional.
///
/// The default is the empty expression: no trigger, always allowed, nothing to do.
#[derive(Clone, PartialEq, Debug, Default)]
pub struct TransitionExpression {
    /// The events it waits for; without one it needs no event.
    pub trigger: Option<Trigger>,
    /// What must hold.
    pub guard: Option<Expression>,
    /// What it does, in this order.
    pub actions: Vec<Action>,
}

impl TransitionExpression {
    /// Whether there is neither trigger nor guard nor action.
    pub fn is_empty(&self) -> bool {
        self.trigger.is_none() && self.guard.is_none() && self.actions.is_empty()
    }

    /// Whether the guard is the word `false`: the transition is never taken, and is meant so.
    pub fn is_never(&self) -> bool {
        matches!(&self.guard, Some(guard) if guard.kind == ExpressionKind::Bool(false))
    }

    /// The names of the timers that its actions start, in order, repeated if started twice.
    pub fn started_timers(&self) -> impl Iterator<Item = String> {
        started_timers(&self.actions)
    }
}

/// The names of the timers that actions start, in order, repeated if started twice.
pub fn started_timers(actions: &[Action]) -> impl Iterator<Item = String> {
    actions.iter().filter_map(|action| match &action.kind {
        ActionKind::StartTimeout { timer, .. } => Some(timer.text()),
        _ => None,
    })
}

/// Where a part stands in its text.
///
/// Any two places are equal: what an expression says does not depend on where it stands, so trees compare by
/// meaning.
#[derive(Clone, Copy, Debug, Default)]
pub struct Place(pub Span);

impl PartialEq for Place {
    fn eq(&self, _: &Place) -> bool {
        true
    }
}

impl Eq for Place {}

/// One segment of a path.
#[derive(Clone, PartialEq, Eq, Debug)]
pub struct Name {
    /// The name, without the backquotes it may have been written in.
    pub text: String,
    /// Where it stands.
    pub place: Place,
}

/// Names separated by dots, one at least: `Ball.distance`, `worldstate.State.GameState.player_state`, `near`.
///
/// The getter form `Ball.distance()` is the same path.
#[derive(Clone, PartialEq, Eq, Debug)]
pub struct Path {
    /// The names, one at least.
    pub segments: Vec<Name>,
    /// Where it stands.
    pub place: Place,
}

impl Path {
    /// The names joined by dots, without backquotes: what a timer or an event is known by.
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

/// The events a transition waits for. An event is named by a path; so is a message, each arrival of which is
/// an event.
#[derive(Clone, PartialEq, Eq, Debug)]
pub enum Trigger {
    /// `*`: whatever event.
    Any,
    /// `e` or `e1 | e2`: one of these, one at least.
    OneOf(Vec<Path>),
    /// `not e`: any event but this.
    Not(Path),
}

/// A condition or an operand: a boolean is an operand like any other.
#[derive(Clone, PartialEq, Debug)]
pub struct Expression {
    /// What it says.
    pub kind: ExpressionKind,
    /// Where it stands.
    pub place: Place,
}

impl Expression {
    /// The bytes it stands in.
    pub fn span(&self) -> Span {
        self.place.0
    }

    /// What it is made of, as it is written: none of a name, a value or a question that has no expressions in it.
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

    /// The first expression in it, itself and outer ones before inner ones, of which something can be told.
    pub fn find_map<'a, T>(&'a self, told: &mut dyn FnMut(&'a Expression) -> Option<T>) -> Option<T> {
        if let Some(found) = told(self) {
            return Some(found);
        }
        self.parts().into_iter().find_map(|operand| operand.find_map(told))
    }
}

/// What an [`Expression`] says.
#[derive(Clone, PartialEq, Debug)]
pub enum ExpressionKind {
    /// `a || b || c`, two operands at least.
    Or(Vec<Expression>),
    /// `a && b && c`, two operands at least.
    And(Vec<Expression>),
    /// `!a`.
    Not(Box<Expression>),
    /// `a < b` and its like.
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
    /// A field, a message, a timer, a constant, a value of an enumeration or a function without arguments.
    Variable(Path),
    /// `function(a, b)`.
    Call(Name, Vec<Expression>),
    /// `TimeoutCheck(v)`: timer `v` has been started and is over.
    TimeoutCheck(Path),
    /// `In(state)`: the state of that path is active. Blanks are removed, `ω` is `~`.
    In(Name),
    /// `script("text")`: a condition in a language of the host's own.
    Script(String),
}

/// How two values are compared.
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
    /// All there are.
    #[cfg(test)]
    pub(super) const ALL: [Comparison; 6] = [
        Comparison::Equal,
        Comparison::NotEqual,
        Comparison::Less,
        Comparison::LessOrEqual,
        Comparison::Greater,
        Comparison::GreaterOrEqual,
    ];

    /// The comparison that says the contrary of two values that can be compared.
    pub const fn contrary(self) -> Comparison {
        match self {
            Comparison::Equal => Comparison::NotEqual,
            Comparison::NotEqual => Comparison::Equal,
            Comparison::Less => Comparison::GreaterOrEqual,
            Comparison::LessOrEqual => Comparison::Greater,
            Comparison::Greater => Comparison::LessOrEqual,
            Comparison::GreaterOrEqual => Comparison::Less,
        }
    }

    /// The comparison that says the same with its sides exchanged.
    pub(super) fn mirrored(self) -> Comparison {
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
    /// What it does.
    pub kind: ActionKind,
    /// Where it stands.
    pub place: Place,
}

/// What an [`Action`] does.
#[derive(Clone, PartialEq, Debug)]
pub enum ActionKind {
    /// `Message.field = value`, also written `topic.Kind.Message.set_field(value)`.
    Assign {
        /// The field.
        target: Path,
        /// Its new value.
        value: Expression,
    },
    /// `publish.Message` or `publish.topic.Kind.Message`.
    Publish(Path),
    /// `process_messages`: deliver what has arrived.
    ProcessMessages,
    /// `publish_all`: publish what has been written, now.
    PublishAll,
    /// `StartTimeout(v, 100ms)` or `TimeoutAction.v.100`.
    StartTimeout {
        /// The timer's name.
        timer: Path,
        /// When it is over, from now.
        delay: Duration,
        /// How it is written.
        form: TimeoutForm,
    },
    /// `raise(event)`.
    Raise(Path),
    /// `script("text")`: in a language of the host's own.
    Script(String),
}

/// The two ways to write the start of a timer; they mean the same.
#[derive(Clone, Copy, PartialEq, Eq, Hash, Debug)]
pub enum TimeoutForm {
    /// `StartTimeout(v, 100ms)`
    StartTimeout,
    /// `TimeoutAction.v.100`
    TimeoutAction,
}
