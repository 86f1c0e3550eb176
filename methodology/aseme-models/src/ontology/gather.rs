//! Collects messages and field types from expressions.

use std::collections::BTreeMap;

use yase::expression::{Action, ActionKind, Expression, ExpressionKind, Path, TransitionExpression, Trigger};
use yase::statechart::ConstantValue;
use yase::{Diagnostic, Span, Statechart};

use super::{Ontology, OntologyField, OntologyFieldKind, OntologyMessage, OntologyTopic, is_kind, parts};
use crate::iac::Variable;

/// Collects the messages of a chart.
pub(crate) struct Gatherer<'a> {
    /// The kind of a field that is compared with a constant, by the name of the constant.
    constants: BTreeMap<&'a str, OntologyFieldKind>,
    ontology: Ontology,
    found: Vec<Diagnostic>,
}

impl<'a> Gatherer<'a> {
    pub(crate) fn new(chart: &'a Statechart) -> Gatherer<'a> {
        let constants = chart.constants.iter().map(|constant| {
            let kind = match constant.value {
                ConstantValue::Bool(_) => OntologyFieldKind::Condition,
                ConstantValue::Number(_) => OntologyFieldKind::Number,
                ConstantValue::Text(_) => OntologyFieldKind::Text,
            };
            (constant.name.as_str(), kind)
        });
        Gatherer { constants: constants.collect(), ontology: Ontology::default(), found: Vec::new() }
    }

    pub(crate) fn finish(self) -> (Ontology, Vec<Diagnostic>) {
        (self.ontology, self.found)
    }

    pub(crate) fn variable(&mut self, variable: &Variable) {
        match parts(&variable.kind) {
            Some((topic, kind, message)) => self.message(message, Some((topic, kind)), variable.position.0),
            None => {
                let (name, kind) = (&variable.name, &variable.kind);
                let text = format!("the variable `{name}` has the type `{kind}`, which is not a message");
                let hint =
                    "message types are topic.State.Message, topic.Signal.Message or topic.Data.Message";
                self.found.push(Diagnostic::warning("E0880", variable.position.0, text).with_hint(hint));
            }
        }
    }

    pub(crate) fn transition(&mut self, expression: &TransitionExpression) {
        match &expression.trigger {
            Some(Trigger::OneOf(events)) => events.iter().for_each(|event| self.arrival(event)),
            Some(Trigger::Not(event)) => self.arrival(event),
            Some(Trigger::Any) | None => {}
        }
        if let Some(guard) = &expression.guard {
            self.visit(guard, &OntologyFieldKind::Condition);
        }
        expression.actions.iter().for_each(|action| self.action(action));
    }

    pub(crate) fn action(&mut self, action: &Action) {
        match &action.kind {
            ActionKind::Assign { target, value } => {
                self.path(target, &self.kind_of(value));
                self.visit(value, &OntologyFieldKind::Unknown);
            }
            ActionKind::Publish(message) => self.path(message, &OntologyFieldKind::Unknown),
            ActionKind::ProcessMessages
            | ActionKind::PublishAll
            | ActionKind::StartTimeout { .. }
            | ActionKind::Raise(_)
            | ActionKind::Script(_) => {}
        }
    }

    /// A trigger that names a retention (`State`, `Signal`, `Data`) refers to a message; other
    /// triggers are events.
    fn arrival(&mut self, event: &Path) {
        if event.segments.iter().any(|segment| is_kind(&segment.text)) {
            self.path(event, &OntologyFieldKind::Unknown);
        }
    }

    /// Visits an expression that is used as a certain kind.
    fn visit(&mut self, expression: &Expression, used_as: &OntologyFieldKind) {
        match &expression.kind {
            ExpressionKind::Or(operands) | ExpressionKind::And(operands) => {
                operands.iter().for_each(|operand| self.visit(operand, &OntologyFieldKind::Condition));
            }
            ExpressionKind::Not(operand) => self.visit(operand, &OntologyFieldKind::Condition),
            ExpressionKind::Compare(left, _, right) => {
                let kinds = (self.kind_of(left), self.kind_of(right));
                self.visit(left, &kinds.1);
                self.visit(right, &kinds.0);
            }
            ExpressionKind::Sum(first, rest) => {
                self.visit(first, &OntologyFieldKind::Number);
                rest.iter().for_each(|(_, operand)| self.visit(operand, &OntologyFieldKind::Number));
            }
            ExpressionKind::Product(first, rest) => {
                self.visit(first, &OntologyFieldKind::Number);
                rest.iter().for_each(|(_, operand)| self.visit(operand, &OntologyFieldKind::Number));
            }
            ExpressionKind::Negative(operand) => self.visit(operand, &OntologyFieldKind::Number),
            ExpressionKind::Call(_, arguments) => {
                arguments.iter().for_each(|argument| self.visit(argument, &OntologyFieldKind::Unknown));
            }
            ExpressionKind::Absent(path) | ExpressionKind::Present(path) => {
                self.path(path, &OntologyFieldKind::Unknown);
            }
            ExpressionKind::Variable(path) => self.path(path, used_as),
            ExpressionKind::Bool(_)
            | ExpressionKind::Integer(_)
            | ExpressionKind::Decimal(_)
            | ExpressionKind::Text(_)
            | ExpressionKind::TimeoutCheck(_)
            | ExpressionKind::In(_)
            | ExpressionKind::Script(_) => {}
        }
    }

    /// The kind of a field that is compared with this expression or assigned from it.
    fn kind_of(&self, expression: &Expression) -> OntologyFieldKind {
        match &expression.kind {
            ExpressionKind::Integer(_)
            | ExpressionKind::Decimal(_)
            | ExpressionKind::Sum(..)
            | ExpressionKind::Product(..)
            | ExpressionKind::Negative(_) => OntologyFieldKind::Number,
            ExpressionKind::Text(_) => OntologyFieldKind::Text,
            ExpressionKind::Variable(path) => match path.bare() {
                Some(name) => match self.constants.get(name) {
                    Some(kind) => kind.clone(),
                    None => OntologyFieldKind::OneOf(vec![name.to_owned()]),
                },
                None => OntologyFieldKind::Unknown,
            },
            ExpressionKind::Call(..) | ExpressionKind::Absent(_) | ExpressionKind::Present(_) => {
                OntologyFieldKind::Unknown
            }
            ExpressionKind::Bool(_)
            | ExpressionKind::Or(_)
            | ExpressionKind::And(_)
            | ExpressionKind::Not(_)
            | ExpressionKind::Compare(..)
            | ExpressionKind::TimeoutCheck(_)
            | ExpressionKind::In(_)
            | ExpressionKind::Script(_) => OntologyFieldKind::Condition,
        }
    }

    /// Records a path to a message or one of its fields. A bare name is neither.
    fn path(&mut self, path: &Path, kind: &OntologyFieldKind) {
        let names: Vec<&str> = path.segments.iter().map(|segment| segment.text.as_str()).collect();
        let kept =
            names.iter().position(|name| is_kind(name)).filter(|&index| 0 < index && index + 1 < names.len());
        let capital = |name: &&str| name.starts_with(|letter: char| letter.is_ascii_uppercase());
        let at = match kept {
            Some(index) => index + 1,
            None if names.len() > 1 => names.iter().position(capital).unwrap_or(names.len()),
            None => return,
        };
        let Some(message) = names.get(at) else { return };
        let topic = kept.map(|index| (names[index - 1], names[index]));
        self.message(message, topic, path.position.0);
        let Some(known) = self.ontology.messages.iter_mut().find(|known| known.name == *message) else {
            return;
        };
        note(&mut known.fields, &names[at + 1..], kind);
    }

    /// Records a message, perhaps with its topic.
    fn message(&mut self, name: &str, topic: Option<(&str, &str)>, span: Span) {
        let messages = &mut self.ontology.messages;
        let index = messages.iter().position(|known| known.name == name).unwrap_or_else(|| {
            messages.push(OntologyMessage { name: name.to_owned(), topics: Vec::new(), fields: Vec::new() });
            messages.len() - 1
        });
        let Some((topic, kind)) = topic else { return };
        let topics = &mut messages[index].topics;
        if topics.iter().any(|known| known.name == topic && known.kind == kind) {
            return;
        }
        if let Some(known) = topics.iter().find(|known| known.name == topic) {
            let text = format!(
                "`{name}` has the retention `{kind}` on `{topic}` here, and `{}` elsewhere",
                known.kind
            );
            self.found.push(Diagnostic::warning("E0884", span, text));
        }
        topics.push(OntologyTopic { name: topic.to_owned(), kind: kind.to_owned() });
    }
}

/// Records a field and its nested fields.
fn note(fields: &mut Vec<OntologyField>, names: &[&str], kind: &OntologyFieldKind) {
    let [name, rest @ ..] = names else { return };
    let index = fields.iter().position(|field| field.name == *name).unwrap_or_else(|| {
        fields.push(OntologyField { name: (*name).to_owned(), kind: OntologyFieldKind::Unknown });
        fields.len() - 1
    });
    let known = &mut fields[index].kind;
    if !rest.is_empty() {
        if !matches!(known, OntologyFieldKind::Fields(_)) {
            *known = OntologyFieldKind::Fields(Vec::new());
        }
        if let OntologyFieldKind::Fields(inner) = known {
            note(inner, rest, kind);
        }
        return;
    }
    match (known, kind) {
        (OntologyFieldKind::OneOf(values), OntologyFieldKind::OneOf(more)) => {
            let new = more.iter().filter(|value| !values.contains(value)).cloned().collect::<Vec<_>>();
            values.extend(new);
        }
        // the first specific kind counts; a field used alone is a condition only if nothing else is
        // known
        (known @ (OntologyFieldKind::Unknown | OntologyFieldKind::Condition), kind)
            if *kind != OntologyFieldKind::Unknown =>
        {
            *known = kind.clone();
        }
        _ => {}
    }
}
