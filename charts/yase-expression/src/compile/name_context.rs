//! Resolves names in the context of an expression.

use std::cell::RefCell;

use super::CompileResult;
use super::message::describe;
use crate::constant::{Constant, ConstantValue};
use crate::diagnostic::{Diagnostic, Span, Suggestions};
use crate::eval_context::TimerId;
use crate::ir::{BooleanTerm, Literal, ValueTerm};
use crate::names::{NameScope, ScriptId, ScriptInterner};
use crate::node_id::NodeId;
use crate::syntax::{Name, Path};
use crate::vocabulary::{Enumeration, FunctionEntry, TypeEnvironment, ValueType};

/// The names in scope except events, which are added during compilation.
pub(crate) struct NameContext<'a> {
    pub(crate) vocabulary: &'a TypeEnvironment,
    constants: &'a [Constant],
    timers: &'a [String],
    states: &'a dyn Fn(&str) -> Option<NodeId>,
    pub(crate) suggestions: &'a Suggestions,
    /// Borrowed from the names while one expression is compiled.
    scripts: RefCell<ScriptInterner>,
}

/// A compiled operand and its type.
pub(crate) struct TypedTerm {
    pub(crate) term: ValueTerm,
    pub(crate) kind: ValueType,
}

/// One meaning of a name, and its description in diagnostics.
struct Resolution {
    description: String,
    typed: TypedTerm,
}

impl<'a> NameContext<'a> {
    pub(crate) fn new(names: &mut NameScope<'a>) -> NameContext<'a> {
        NameContext {
            vocabulary: names.vocabulary,
            constants: names.constants,
            timers: names.timers,
            states: names.states,
            suggestions: names.suggestions,
            scripts: RefCell::new(std::mem::take(names.scripts)),
        }
    }

    /// Returns the scripts to the names.
    pub(crate) fn close(self, names: &mut NameScope<'_>) {
        *names.scripts = self.scripts.into_inner();
    }

    /// A script in the language of the host, if the type environment allows scripts.
    pub(crate) fn script(&self, text: &str, span: Span) -> CompileResult<ScriptId> {
        if self.vocabulary.scripts {
            return Ok(self.scripts.borrow_mut().intern(text));
        }
        let diagnostic = Diagnostic::error("E0147", span, "the host of this chart has no scripts");
        Err(vec![diagnostic.with_hint("write it as a condition or an action, or as a registered function")])
    }

    /// The timer with this name, if an action starts it on this blackboard.
    pub(crate) fn timer(&self, path: &Path) -> Option<TimerId> {
        if self.timers.is_empty() {
            return None;
        }
        let index = self.timers.binary_search(&path.text()).ok()?;
        Some(TimerId(index as u32))
    }

    pub(crate) fn state(&self, name: &Name) -> CompileResult<NodeId> {
        (self.states)(&name.text).ok_or_else(|| {
            let message = format!("there is no state `{}`", name.text);
            let hint = "a state is named by its path, as in `outer/inner`, or the last names of it if they are unique";
            vec![Diagnostic::error("E0140", name.position.0, message).with_hint(hint)]
        })
    }

    pub(crate) fn function(&self, name: &Name) -> CompileResult<&'a FunctionEntry> {
        self.vocabulary.functions.iter().find(|function| function.name == name.text).ok_or_else(|| {
            let message = format!("there is no function `{}`", name.text);
            let known = self.vocabulary.functions.iter().map(|function| function.name.as_str());
            let diagnostic = Diagnostic::error("E0139", name.position.0, message);
            vec![self.unknown(
                diagnostic,
                &name.text,
                known,
                "functions are registered by the program that runs the chart",
            )]
        })
    }

    /// Resolves a path. `expected` is the type of the other operand; if it is an enumeration, bare
    /// names can be its values.
    pub(crate) fn variable(&self, path: &Path, expected: Option<&ValueType>) -> CompileResult<TypedTerm> {
        let mut meanings = self.meanings(path, expected);
        // The name of a constant, for example, is not looked up among the messages: the error would
        // suggest the most similar message.
        let as_message = match path.bare().filter(|name| !self.names_message(name)) {
            Some(name) => Err(name),
            None => Ok(self.variable_of_message(path, expected)),
        };
        let is_message = matches!(as_message, Ok(Ok(_)));
        if meanings.len() + usize::from(is_message) > 1 {
            let mut all: Vec<_> = meanings.iter().map(|meaning| meaning.description.as_str()).collect();
            all.extend(is_message.then_some("a message"));
            let message = format!("`{path}` has several meanings: {}", all.join(", "));
            return Err(vec![
                Diagnostic::error("E0131", path.position.0, message).with_hint("rename all but one"),
            ]);
        }
        match (meanings.pop(), as_message) {
            (Some(meaning), _) => Ok(meaning.typed),
            (None, Err(name)) => Err(vec![self.unknown_name(path, name, expected)]),
            (None, Ok(as_message)) => as_message,
        }
    }

    fn names_message(&self, name: &str) -> bool {
        self.vocabulary.messages.iter().any(|entry| entry.name == name) || !self.topics_named(name).is_empty()
    }

    /// A field or a complete message. A bare name is a message only where a message is expected.
    fn variable_of_message(&self, path: &Path, expected: Option<&ValueType>) -> CompileResult<TypedTerm> {
        let (source, names) = self.message(path)?;
        let (fields, kind) = self.fields(source.entry, names)?;
        let term = if fields.is_empty() {
            if path.bare().is_some() && !matches!(expected, Some(ValueType::Message(_))) {
                let message = format!("`{path}` is a message, not a value");
                let diagnostic = Diagnostic::error("E0130", path.position.0, message);
                return Err(vec![diagnostic.with_hint(self.fields_hint(path, source.entry))]);
            }
            ValueTerm::Message(source.message_source())
        } else {
            ValueTerm::Field(source.message_source(), fields)
        };
        Ok(TypedTerm { term, kind })
    }

    /// All meanings except messages: a timer of the chart, a value of the expected enumeration, a
    /// constant of the model, a function without arguments.
    fn meanings(&self, path: &Path, expected: Option<&ValueType>) -> Vec<Resolution> {
        let mut meanings = Vec::new();
        meanings.extend(self.timer(path).map(|timer| Resolution {
            description: "a timer of the chart".to_owned(),
            typed: TypedTerm { term: timer_over(timer), kind: ValueType::Bool },
        }));
        let Some(name) = path.bare() else {
            return meanings;
        };
        meanings.extend(self.expected_values(expected).and_then(|enumeration| value_of(enumeration, name)));
        meanings.extend(self.constants.iter().find(|constant| constant.name == name).map(|constant| {
            Resolution {
                description: "a constant of the model".to_owned(),
                typed: constant_value(&constant.value),
            }
        }));
        let functions = self.vocabulary.functions.iter();
        let function = functions
            .filter(|function| function.parameters.is_empty())
            .find(|function| function.name == name);
        meanings.extend(function.map(|function| Resolution {
            description: "a function without arguments".to_owned(),
            typed: TypedTerm {
                term: ValueTerm::Call(function.id, Box::default()),
                kind: function.result.clone(),
            },
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
        let span = path.position.0;
        if let Some(enumeration) = self.expected_values(expected) {
            let message = format!("the enumeration `{}` has no value `{name}`", enumeration.name);
            let known = enumeration.values.iter().map(|(value, _)| value.as_str());
            let form = "see the definition of the enumeration";
            return self.unknown(Diagnostic::error("E0130", span, message), name, known, form);
        }
        let message = format!("there is no `{name}` here");
        if let Some(hint) = self.hint_for_unknown(name, expected) {
            return Diagnostic::error("E0130", span, message).with_hint(hint);
        }
        let timers = self.timers.iter().map(String::as_str);
        let constants = self.constants.iter().map(|constant| constant.name.as_str());
        let functions = self.vocabulary.functions.iter().map(|function| function.name.as_str());
        let diagnostic = Diagnostic::error("E0130", span, message);
        let known = timers.chain(constants).chain(functions);
        let diagnostic = diagnostic.with_suggestion(self.suggestions, name, known);
        if diagnostic.hint.is_some() {
            return diagnostic;
        }
        diagnostic.with_hint(
            "a bare name is a timer started on this blackboard, a constant or a function without arguments",
        )
    }

    /// Suggests names that exist but cannot be used as a bare name here.
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

/// In the bare form, a timer that was never started counts as expired.
fn timer_over(timer: TimerId) -> ValueTerm {
    ValueTerm::Truth(Box::new(BooleanTerm::Over { timer, when_unset: true }))
}

fn value_of(enumeration: &Enumeration, name: &str) -> Option<Resolution> {
    let (_, number) = enumeration.values.iter().find(|(value, _)| value == name)?;
    let kind = ValueType::Enumeration(enumeration.name.clone());
    let what = format!("a value of the enumeration `{}`", enumeration.name);
    Some(Resolution {
        description: what,
        typed: TypedTerm { term: ValueTerm::Literal(Literal::Enum(*number)), kind },
    })
}

fn constant_value(value: &ConstantValue) -> TypedTerm {
    match value {
        ConstantValue::Bool(value) => {
            TypedTerm { term: ValueTerm::Literal(Literal::Bool(*value)), kind: ValueType::Bool }
        }
        ConstantValue::Number(value) => {
            TypedTerm { term: ValueTerm::Literal(Literal::Float(*value)), kind: ValueType::Number }
        }
        ConstantValue::Text(value) => TypedTerm {
            term: ValueTerm::Literal(Literal::Text(value.as_str().into())),
            kind: ValueType::Text,
        },
    }
}
