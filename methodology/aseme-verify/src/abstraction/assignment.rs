//! An assignment of a chart, as its abstraction follows it.

use yase::expression::{Comparison, Expression, ExpressionKind, Path};
use yase::statechart::{Constant, ConstantValue};

/// `Ball.found = true`: an action that writes a field of a message.
#[derive(Clone, Debug)]
pub(crate) struct Assignment {
    pub(crate) target: Path,
    pub(crate) value: Expression,
}

impl Assignment {
    /// The fact that holds after its execution, if its value does not depend on anything.
    pub(crate) fn fact(&self, constants: &[Constant]) -> Option<Expression> {
        let is_constant = |part: &Expression| match &part.kind {
            ExpressionKind::Variable(path) => path.bare().is_none().then_some(()),
            ExpressionKind::Call(..) | ExpressionKind::In(_) | ExpressionKind::TimeoutCheck(_) => Some(()),
            ExpressionKind::Absent(_) | ExpressionKind::Present(_) | ExpressionKind::Script(_) => Some(()),
            _ => None,
        };
        self.value.find_map(&mut |part| is_constant(part)).is_none().then(|| {
            let target = ExpressionKind::Variable(self.target.clone());
            equation(Expression { kind: target, position: self.target.position }, &self.value, constants)
        })
    }

    /// Whether it may change the value of a condition. A message that had not arrived exists from
    /// the first assignment on, with all its fields.
    pub(crate) fn may_change(&self, condition: &Expression) -> bool {
        condition.find_map(&mut |part| reads(part, &self.target).then_some(())).is_some()
    }

    /// Whether it may overwrite another assignment.
    pub(crate) fn may_overwrite(&self, other: &Assignment) -> bool {
        match same_message(&self.target, &other.target) {
            true => self.target.segments.last() == other.target.segments.last(),
            false => may_be_one_message(&self.target, &other.target),
        }
    }

    /// Whether it writes a signal, as far as its text says so.
    pub(crate) fn is_of_signal(&self) -> bool {
        self.target.segments.iter().any(|name| name.text == "Signal")
    }
}

/// That an operand has a value.
fn equation(target: Expression, value: &Expression, constants: &[Constant]) -> Expression {
    let position = target.position;
    let kind = match truth(value, constants) {
        Some(true) => target.kind,
        Some(false) => ExpressionKind::Not(Box::new(target)),
        None => ExpressionKind::Compare(Box::new(target), Comparison::Equal, Box::new(value.clone())),
    };
    Expression { kind, position }
}

/// The value of a constant condition.
fn truth(value: &Expression, constants: &[Constant]) -> Option<bool> {
    match &value.kind {
        ExpressionKind::Bool(value) => Some(*value),
        ExpressionKind::Not(inner) => truth(inner, constants).map(|value| !value),
        ExpressionKind::Variable(path) => {
            let name = path.bare()?;
            let constant = constants.iter().find(|constant| constant.name == name)?;
            match constant.value {
                ConstantValue::Bool(value) => Some(value),
                _ => None,
            }
        }
        _ => None,
    }
}

/// Whether a part of a condition itself may read the message of a field.
fn reads(part: &Expression, target: &Path) -> bool {
    match &part.kind {
        ExpressionKind::Variable(path) => path.segments.len() > 1 && may_be_one_message(path, target),
        ExpressionKind::Absent(path) | ExpressionKind::Present(path) => may_be_one_message(path, target),
        // a function may be given a whole message
        ExpressionKind::Call(_, arguments) => arguments.iter().any(|argument| {
            matches!(&argument.kind, ExpressionKind::Variable(path) if may_be_one_message(path, target))
        }),
        _ => false,
    }
}

/// Whether two fields are written as fields of the same message.
pub(crate) fn same_message(one: &Path, other: &Path) -> bool {
    one.segments.len() == other.segments.len()
        && one.segments.iter().zip(&other.segments).rev().skip(1).all(|(one, other)| one == other)
}

/// Whether two paths may mean one message, or fields of one: they name it alike, or one by its
/// topic and the other by its type.
pub(crate) fn may_be_one_message(one: &Path, other: &Path) -> bool {
    let names = |path: &Path| -> Vec<String> {
        let texts = path.segments.iter().map(|name| name.text.rsplit('/').next().unwrap_or("").to_owned());
        texts.filter(|text| !matches!(text.as_str(), "State" | "Signal" | "Data" | "Message")).collect()
    };
    let (one, other) = (names(one), names(other));
    let has_type = |names: &[String]| names.iter().any(|name| name.starts_with(char::is_uppercase));
    let is_shared = one.iter().any(|name| other.contains(name));
    is_shared || has_type(&one) != has_type(&other)
}
