//! The canonical text of an expression.
//!
//! Each tree has one text, which parses to the same tree. Alternative spellings (`and` and `&&`, a
//! setter and an assignment) have one tree and so one text; only the form of a timeout is kept,
//! since it has a meaning.

use std::fmt::{self, Display, Formatter, Write};
use std::time::Duration;

use super::lexer::is_word_character;
use super::parser::RESERVED;
use super::syntax::{
    Action, ActionKind, Additive, Comparison, Expression, ExpressionKind, Multiplicative, Name, Path,
    TimeoutForm, TransitionExpression, Trigger,
};

impl Display for TransitionExpression {
    fn fmt(&self, f: &mut Formatter<'_>) -> fmt::Result {
        let mut separator = "";
        if let Some(trigger) = &self.trigger {
            write!(f, "{trigger}")?;
            separator = " ";
        }
        if let Some(guard) = &self.guard {
            write!(f, "{separator}[{guard}]")?;
            separator = " ";
        }
        if self.actions.is_empty() {
            return Ok(());
        }
        write!(f, "{separator}/ ")?;
        joined(f, &self.actions, "; ")
    }
}

impl Display for Trigger {
    fn fmt(&self, f: &mut Formatter<'_>) -> fmt::Result {
        match self {
            Trigger::Any => f.write_str("*"),
            Trigger::OneOf(events) => joined(f, events, " | "),
            Trigger::Not(event) => write!(f, "not {event}"),
        }
    }
}

impl Display for Path {
    fn fmt(&self, f: &mut Formatter<'_>) -> fmt::Result {
        joined(f, &self.segments, ".")
    }
}

impl Display for Name {
    /// Uses backquotes unless the name can be read without them.
    fn fmt(&self, f: &mut Formatter<'_>) -> fmt::Result {
        let plain = self.text.split("::").all(is_plain) && !is_special(&self.text);
        if plain { f.write_str(&self.text) } else { write!(f, "`{}`", self.text) }
    }
}

fn is_plain(word: &str) -> bool {
    let digit_first = word.starts_with(|first: char| first.is_ascii_digit());
    !word.is_empty() && !digit_first && word.chars().all(is_word_character)
}

fn is_special(word: &str) -> bool {
    const LEADING: [&str; 7] =
        ["In", "TimeoutCheck", "StartTimeout", "TimeoutAction", "publish", "process_messages", "publish_all"];
    word == "raise" || word == "script" || LEADING.contains(&word) || RESERVED.contains(&word)
}

impl Display for Expression {
    fn fmt(&self, f: &mut Formatter<'_>) -> fmt::Result {
        match &self.kind {
            ExpressionKind::Or(operands) => self.operands(f, operands, " || "),
            ExpressionKind::And(operands) => self.operands(f, operands, " && "),
            ExpressionKind::Not(operand) => {
                f.write_char('!')?;
                operand.at_least(f, Precedence::Sign)
            }
            ExpressionKind::Compare(left, comparison, right) => {
                left.at_least(f, Precedence::Sum)?;
                write!(f, " {comparison} ")?;
                right.at_least(f, Precedence::Sum)
            }
            ExpressionKind::Absent(message) => write!(f, "{message} == NULL"),
            ExpressionKind::Present(message) => write!(f, "{message} != NULL"),
            ExpressionKind::Sum(first, rest) => chain(f, first, rest, Precedence::Product),
            ExpressionKind::Product(first, rest) => chain(f, first, rest, Precedence::Sign),
            ExpressionKind::Negative(operand) => {
                f.write_char('-')?;
                operand.at_least(f, Precedence::Sign)
            }
            ExpressionKind::Bool(value) => write!(f, "{value}"),
            ExpressionKind::Integer(value) => write!(f, "{value}"),
            ExpressionKind::Decimal(value) => write!(f, "{value:?}"),
            ExpressionKind::Text(text) => quoted(f, text),
            ExpressionKind::Variable(path) => write!(f, "{path}"),
            ExpressionKind::Call(function, arguments) => {
                write!(f, "{function}(")?;
                joined(f, arguments, ", ")?;
                f.write_char(')')
            }
            ExpressionKind::TimeoutCheck(timer) => write!(f, "TimeoutCheck({timer})"),
            ExpressionKind::In(state) => write!(f, "In({})", state.text),
            ExpressionKind::Script(text) => script(f, text),
        }
    }
}

/// Precedence of an expression, the lowest first.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
enum Precedence {
    Or,
    And,
    Comparison,
    Sum,
    Product,
    Sign,
    Operand,
}

impl Precedence {
    fn next(self) -> Precedence {
        match self {
            Precedence::Or => Precedence::And,
            Precedence::And => Precedence::Comparison,
            Precedence::Comparison => Precedence::Sum,
            Precedence::Sum => Precedence::Product,
            Precedence::Product => Precedence::Sign,
            Precedence::Sign | Precedence::Operand => Precedence::Operand,
        }
    }
}

impl Expression {
    fn tightness(&self) -> Precedence {
        match self.kind {
            ExpressionKind::Or(_) => Precedence::Or,
            ExpressionKind::And(_) => Precedence::And,
            ExpressionKind::Compare(..) | ExpressionKind::Absent(_) | ExpressionKind::Present(_) => {
                Precedence::Comparison
            }
            ExpressionKind::Sum(..) => Precedence::Sum,
            ExpressionKind::Product(..) => Precedence::Product,
            ExpressionKind::Not(_) | ExpressionKind::Negative(_) => Precedence::Sign,
            _ => Precedence::Operand,
        }
    }

    /// Adds parentheses if the precedence is lower than the context requires.
    fn at_least(&self, f: &mut Formatter<'_>, tightness: Precedence) -> fmt::Result {
        if self.tightness() < tightness { write!(f, "({self})") } else { write!(f, "{self}") }
    }

    fn operands(&self, f: &mut Formatter<'_>, operands: &[Expression], separator: &str) -> fmt::Result {
        for (index, operand) in operands.iter().enumerate() {
            f.write_str(if index == 0 { "" } else { separator })?;
            operand.at_least(f, self.tightness().next())?;
        }
        Ok(())
    }
}

fn chain<O: Display>(
    f: &mut Formatter<'_>,
    first: &Expression,
    rest: &[(O, Expression)],
    tightness: Precedence,
) -> fmt::Result {
    first.at_least(f, tightness)?;
    for (operator, operand) in rest {
        write!(f, " {operator} ")?;
        operand.at_least(f, tightness)?;
    }
    Ok(())
}

impl Display for Comparison {
    fn fmt(&self, f: &mut Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Comparison::Equal => "==",
            Comparison::NotEqual => "!=",
            Comparison::Less => "<",
            Comparison::LessOrEqual => "<=",
            Comparison::Greater => ">",
            Comparison::GreaterOrEqual => ">=",
        })
    }
}

impl Display for Additive {
    fn fmt(&self, f: &mut Formatter<'_>) -> fmt::Result {
        f.write_char(if *self == Additive::Plus { '+' } else { '-' })
    }
}

impl Display for Multiplicative {
    fn fmt(&self, f: &mut Formatter<'_>) -> fmt::Result {
        f.write_char(if *self == Multiplicative::Times { '*' } else { '/' })
    }
}

impl Display for Action {
    fn fmt(&self, f: &mut Formatter<'_>) -> fmt::Result {
        match &self.kind {
            ActionKind::Assign { target, value } => write!(f, "{target} = {value}"),
            ActionKind::Publish(message) => write!(f, "publish.{message}"),
            ActionKind::ProcessMessages => f.write_str("process_messages"),
            ActionKind::PublishAll => f.write_str("publish_all"),
            ActionKind::StartTimeout { timer, delay, form: TimeoutForm::StartTimeout } => {
                write!(f, "StartTimeout({timer}, {}ms)", Milliseconds(*delay))
            }
            ActionKind::StartTimeout { timer, delay, form: TimeoutForm::TimeoutAction } => {
                write!(f, "TimeoutAction.{timer}.{}", Milliseconds(*delay))
            }
            ActionKind::Raise(event) => write!(f, "raise({event})"),
            ActionKind::Script(text) => script(f, text),
        }
    }
}

struct Milliseconds(Duration);

impl Display for Milliseconds {
    fn fmt(&self, f: &mut Formatter<'_>) -> fmt::Result {
        write!(f, "{}", self.0.as_millis())?;
        match self.0.subsec_nanos() % 1_000_000 {
            0 => Ok(()),
            rest => write!(f, ".{}", format!("{rest:06}").trim_end_matches('0')),
        }
    }
}

fn script(f: &mut Formatter<'_>, text: &str) -> fmt::Result {
    f.write_str("script(")?;
    quoted(f, text)?;
    f.write_char(')')
}

fn quoted(f: &mut Formatter<'_>, text: &str) -> fmt::Result {
    f.write_char('"')?;
    for character in text.chars() {
        match character {
            '"' => f.write_str("\\\"")?,
            '\\' => f.write_str("\\\\")?,
            '\n' => f.write_str("\\n")?,
            '\r' => f.write_str("\\r")?,
            '\t' => f.write_str("\\t")?,
            other => f.write_char(other)?,
        }
    }
    f.write_char('"')
}

fn joined<T: Display>(f: &mut Formatter<'_>, parts: &[T], separator: &str) -> fmt::Result {
    for (index, part) in parts.iter().enumerate() {
        f.write_str(if index == 0 { "" } else { separator })?;
        write!(f, "{part}")?;
    }
    Ok(())
}
