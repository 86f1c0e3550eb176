//! What a name means where the expression stands.

use std::cell::RefCell;

use super::Checked;
use super::message::{describe, unknown};
use crate::diagnostic::{Diagnostic, Span};
use crate::expression::facts::TimerId;
use crate::expression::names::{Names, ScriptId, ScriptTable};
use crate::expression::program::{Literal, Term, Test};
use crate::expression::syntax::{Name, Path};
use crate::statechart::{Constant, ConstantValue, NodeId};
use crate::vocabulary::{Enumeration, FunctionEntry, ValueType, Vocabulary};

/// Everything names are looked up in, but for events, which are added while compiling.
pub(super) struct Scope<'a> {
    pub(super) vocabulary: &'a Vocabulary,
    constants: &'a [Constant],
    timers: &'a [String],
    states: &'a dyn Fn(&str) -> Option<NodeId>,
    /// Lent by the names for as long as one expression is compiled.
    scripts: RefCell<ScriptTable>,
}

/// A compiled operand and its type.
pub(super) struct Typed {
    pub(super) term: Term,
    pub(super) kind: ValueType,
}

/// One meaning of a name, and how a message calls it.
struct Meaning {
    what: String,
    typed: Typed,
}

impl<'a> Scope<'a> {
    pub(super) fn new(names: &mut Names<'a>) -> Scope<'a> {
        Scope {
            vocabulary: names.vocabulary,
            constants: names.constants,
            timers: names.timers,
            states: names.states,
            scripts: RefCell::new(std::mem::take(names.scripts)),
        }
    }

    /// Gives the scripts back.
    pub(super) fn close(self, names: &mut Names<'_>) {
        *names.scripts = self.scripts.into_inner();
    }

    /// A script of the host's own language, where the vocabulary says that there is one.
    pub(super) fn script(&self, text: &str, span: Span) -> Checked<ScriptId> {
        if self.vocabulary.scripts {
            return Ok(self.scripts.borrow_mut().intern(text));
        }
        let diagnostic = Diagnostic::error("E0147", span, "what runs this chart has no scripts");
        Err(vec![diagnostic.with_hint("write it as a condition or an action, or as a registered function")])
    }

    /// The timer of a name, if some action starts it on this blackboard.
    pub(super) fn timer(&self, path: &Path) -> Option<TimerId> {
        if self.timers.is_empty() {
            return None;
        }
        let text = path.text();
        let index = self.timers.iter().position(|timer| *timer == text)?;
        Some(TimerId(index as u32))
    }

    pub(super) fn state(&self, name: &Name) -> Checked<NodeId> {
        (self.states)(&name.text).ok_or_else(|| {
            let message = format!("there is no state `{}`", name.text);
            let hint = "a state is named by its path, as in `outer/inner`, or the last names of it if they are unique";
            vec![Diagnostic::error("E0140", name.place.0, message).with_hint(hint)]
        })
    }

    pub(super) fn function(&self, name: &Name) -> Checked<&'a FunctionEntry> {
        self.vocabulary.functions.iter().find(|function| function.name == name.text).ok_or_else(|| {
            let message = format!("there is no function `{}`", name.text);
            let known = self.vocabulary.functions.iter().map(|function| function.name.as_str());
            let diagnostic = Diagnostic::error("E0139", name.place.0, message);
            vec![unknown(
                diagnostic,
                &name.text,
                known,
                "functions are registered by the program that runs the chart",
            )]
        })
    }

    /// What a path means; `expected` is the type of the operand beside it, whose enumeration gives its values
    /// to bare names.
    pub(super) fn variable(&self, path: &Path, expected: Option<&ValueType>) -> Checked<Typed> {
        let mut meanings = self.meanings(path, expected);
        let as_message = self.variable_of_message(path, expected);
        if meanings.len() + usize::from(as_message.is_ok()) > 1 {
            let mut all: Vec<_> = meanings.iter().map(|meaning| meaning.what.as_str()).collect();
            all.extend(as_message.is_ok().then_some("a message"));
            let message = format!("`{path}` has several meanings: {}", all.join(", "));
            return Err(vec![
                Diagnostic::error("E0131", path.place.0, message).with_hint("rename all but one"),
            ]);
        }
        match (meanings.pop(), path.bare()) {
            (Some(meaning), _) => Ok(meaning.typed),
            (None, Some(name)) if !self.names_message(name) => {
                Err(vec![self.unknown_name(path, name, expected)])
            }
            _ => as_message,
        }
    }

    fn names_message(&self, name: &str) -> bool {
        self.vocabulary.messages.iter().any(|entry| entry.name == name) || !self.topics_named(name).is_empty()
    }

    /// A field, or a whole message: a bare name only where a message is expected.
    fn variable_of_message(&self, path: &Path, expected: Option<&ValueType>) -> Checked<Typed> {
        let (source, names) = self.message(path)?;
        let (fields, kind) = self.fields(source.entry, names)?;
        let term = if fields.is_empty() {
            if path.bare().is_some() && !matches!(expected, Some(ValueType::Message(_))) {
                let message = format!("`{path}` is a message, not a value");
                let diagnostic = Diagnostic::error("E0130", path.place.0, message);
                return Err(vec![diagnostic.with_hint(self.fields_hint(path, source.entry))]);
            }
            Term::Message(source.message_source())
        } else {
            Term::Field(source.message_source(), fields)
        };
        Ok(Typed { term, kind })
    }

    /// Every meaning but a message: a timer of the chart, a value of the expected enumeration, a constant of
    /// the model, a function without arguments.
    fn meanings(&self, path: &Path, expected: Option<&ValueType>) -> Vec<Meaning> {
        let mut meanings = Vec::new();
        meanings.extend(self.timer(path).map(|timer| Meaning {
            what: "a timer of the chart".to_owned(),
            typed: Typed { term: timer_over(timer), kind: ValueType::Bool },
        }));
        let Some(name) = path.bare() else {
            return meanings;
        };
        meanings.extend(self.expected_values(expected).and_then(|enumeration| value_of(enumeration, name)));
        meanings.extend(self.constants.iter().find(|constant| constant.name == name).map(|constant| {
            Meaning { what: "a constant of the model".to_owned(), typed: constant_value(&constant.value) }
        }));
        let functions = self.vocabulary.functions.iter();
        let function = functions
            .filter(|function| function.parameters.is_empty())
            .find(|function| function.name == name);
        meanings.extend(function.map(|function| Meaning {
            what: "a function without arguments".to_owned(),
            typed: Typed { term: Term::Call(function.id, Box::default()), kind: function.result.clone() },
        }));
        meanings
    }

    fn expected_values(&self, expected: Option<&ValueType>) -> Option<&'a Enumeration> {
        match expected {
            Some(ValueType::Enumeration(name)) => {
                self.vocabulary.enumerations.iter().find(|enumeration| enumeration.name == *name)
            }
            _ => None,
        }
    }

    fn unknown_name(&self, path: &Path, name: &str, expected: Option<&ValueType>) -> Diagnostic {
        let span = path.place.0;
        if let Some(enumeration) = self.expected_values(expected) {
            let message = format!("the enumeration `{}` has no value `{name}`", enumeration.name);
            let known = enumeration.values.iter().map(|(value, _)| value.as_str());
            let form = "see the definition of the enumeration";
            return unknown(Diagnostic::error("E0130", span, message), name, known, form);
        }
        let message = format!("there is nothing called `{name}` here");
        if let Some(hint) = self.hint_for_unknown(name, expected) {
            return Diagnostic::error("E0130", span, message).with_hint(hint);
        }
        let timers = self.timers.iter().map(String::as_str);
        let constants = self.constants.iter().map(|constant| constant.name.as_str());
        let functions = self.vocabulary.functions.iter().map(|function| function.name.as_str());
        let diagnostic = Diagnostic::error("E0130", span, message);
        let diagnostic = diagnostic.with_nearest(name, timers.chain(constants).chain(functions));
        if diagnostic.hint.is_some() {
            return diagnostic;
        }
        diagnostic.with_hint(
            "a bare name is a timer started on this blackboard, a constant or a function without arguments",
        )
    }

    /// What is known elsewhere, but not as a bare name here.
    fn hint_for_unknown(&self, name: &str, expected: Option<&ValueType>) -> Option<String> {
        if name.starts_with(|first: char| first.is_ascii_digit()) {
            return Some("numbers carry no unit".to_owned());
        }
        if let Some(message @ ValueType::Message(_)) = expected {
            return Some(format!("{} is expected", describe(message)));
        }
        if self.vocabulary.functions.iter().any(|function| function.name == name) {
            return Some(format!("`{name}` is a function: write its arguments in parentheses"));
        }
        let has_value = |entry: &&Enumeration| entry.values.iter().any(|(value, _)| value == name);
        let enumeration = self.vocabulary.enumerations.iter().find(has_value)?;
        Some(format!("`{name}` is a value of `{}`: compare a field of that type with it", enumeration.name))
    }
}

/// A timer that was never started counts as over in the bare form.
fn timer_over(timer: TimerId) -> Term {
    Term::Truth(Box::new(Test::Over { timer, when_unset: true }))
}

fn value_of(enumeration: &Enumeration, name: &str) -> Option<Meaning> {
    let (_, number) = enumeration.values.iter().find(|(value, _)| value == name)?;
    let kind = ValueType::Enumeration(enumeration.name.clone());
    let what = format!("a value of the enumeration `{}`", enumeration.name);
    Some(Meaning { what, typed: Typed { term: Term::Literal(Literal::Enum(*number)), kind } })
}

fn constant_value(value: &ConstantValue) -> Typed {
    match value {
        ConstantValue::Bool(value) => {
            Typed { term: Term::Literal(Literal::Bool(*value)), kind: ValueType::Bool }
        }
        ConstantValue::Number(value) => {
            Typed { term: Term::Literal(Literal::Float(*value)), kind: ValueType::Number }
        }
        ConstantValue::Text(value) => {
            Typed { term: Term::Literal(Literal::Text(value.as_str().into())), kind: ValueType::Text }
        }
    }
}
