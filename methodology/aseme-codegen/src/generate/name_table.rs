//! The names that a chart's functions use: messages, timers, functions, constants and enumeration
//! values, each a constant in Rust.

use std::collections::{BTreeMap, BTreeSet};

use yase::expression::{MessageSource, Origin};
use yase::statechart::ConstantValue;
use yase::vocabulary::{MessageEntry, TopicEntry, ValueType};
use yase::{Diagnostic, FieldId, FunctionId, Statechart};

use super::code::{RustCode, literal, quoted};
use super::names::identifier;
use super::{RustBindings, refusal};

/// Collects the names that functions use.
pub(crate) struct NameTable<'a> {
    pub(crate) words: &'a RustBindings,
    chart: &'a Statechart,
    sources: Vec<SourceWord>,
    timers: Vec<String>,
    functions: Vec<String>,
    constants: BTreeSet<String>,
    /// Enumeration, name and number of each value, by its Rust name.
    values: BTreeMap<String, (String, String, i32)>,
}

struct SourceWord {
    source: MessageSource,
    constant: String,
    rust: String,
}

impl<'a> NameTable<'a> {
    pub(crate) fn new(chart: &'a Statechart, words: &'a RustBindings) -> NameTable<'a> {
        NameTable {
            words,
            chart,
            sources: Vec::new(),
            timers: Vec::new(),
            functions: Vec::new(),
            constants: BTreeSet::new(),
            values: BTreeMap::new(),
        }
    }

    pub(crate) fn topic(&self, source: &MessageSource) -> Option<&'a TopicEntry> {
        self.words.vocabulary.topics.iter().find(|topic| topic.id == source.topic)
    }

    pub(crate) fn message(&self, name: &str) -> Option<&'a MessageEntry> {
        self.words.vocabulary.messages.iter().find(|message| message.name == name)
    }

    /// The field names along a path in the messages of a source, and the type of the last.
    pub(crate) fn fields(
        &self,
        source: &MessageSource,
        path: &[FieldId],
    ) -> Option<(Vec<&'a str>, &'a ValueType)> {
        let mut message = self.message(&self.topic(source)?.message)?;
        let (mut names, mut kind) = (Vec::new(), None::<&ValueType>);
        for step in path {
            if let Some(ValueType::Message(inner)) = kind {
                message = self.message(inner)?;
            }
            let field = message.fields.iter().find(|field| field.id == *step)?;
            names.push(field.name.as_str());
            kind = Some(&field.kind);
        }
        Some((names, kind?))
    }

    /// The constant of a source, and the Rust type of its messages.
    pub(crate) fn source(&mut self, source: &MessageSource) -> Result<(String, String), Diagnostic> {
        if let Some(known) = self.sources.iter().find(|known| known.source == *source) {
            return Ok((format!("messages::{}", known.constant), known.rust.clone()));
        }
        let unknown = |message: &str| {
            let text = format!("the Rust type of the message `{message}` is unknown");
            refusal("E0921", text, "link the crate that declares the message")
        };
        let topic = self.topic(source).ok_or_else(|| unknown("?"))?;
        let rust = self.words.messages.get(&topic.message).ok_or_else(|| unknown(&topic.message))?.clone();
        let last = topic.path.rsplit('/').next().unwrap_or_default();
        let wanted = match &source.origin {
            Origin::Own => last.to_owned(),
            Origin::Host(from) | Origin::Publisher(from) => format!("{from}_{last}"),
            Origin::HostPublisher { host, publisher } => format!("{host}_{publisher}_{last}"),
            _ => return Err(unknown(&topic.message)),
        };
        let wanted = shouted(&wanted);
        let is_taken = |name: &String| self.sources.iter().any(|known| known.constant == *name);
        let numbered = (2..).map(|count| format!("{wanted}_{count}"));
        let constant = std::iter::once(wanted.clone()).chain(numbered).find(|name| !is_taken(name));
        let constant = constant.unwrap_or(wanted);
        self.sources.push(SourceWord {
            source: source.clone(),
            constant: constant.clone(),
            rust: rust.clone(),
        });
        Ok((format!("messages::{constant}"), rust))
    }

    /// The constant of a timer.
    pub(crate) fn timer(&mut self, name: &str) -> String {
        if !self.timers.iter().any(|known| known == name) {
            self.timers.push(name.to_owned());
        }
        format!("timers::{}", identifier(&[name]))
    }

    /// The constant of a function.
    pub(crate) fn function(&mut self, id: FunctionId) -> Option<String> {
        let function = self.words.vocabulary.functions.iter().find(|function| function.id == id)?;
        if !self.functions.contains(&function.name) {
            self.functions.push(function.name.clone());
        }
        Some(format!("functions::{}", identifier(&[&function.name])))
    }

    /// The constant of the model that has this value, among the names in an expression.
    pub(crate) fn constant(&mut self, named: &BTreeSet<String>, value: &ConstantValue) -> Option<String> {
        let mut constants = self.chart.constants.iter().filter(|constant| named.contains(&constant.name));
        let constant = constants.find(|constant| constant.value == *value)?;
        self.constants.insert(constant.name.clone());
        Some(format!("constants::{}", identifier(&[&constant.name])))
    }

    /// The constant of an enumeration value; none for a number without a name.
    pub(crate) fn value(&mut self, enumeration: &str, number: i32) -> Option<String> {
        let known = self.words.vocabulary.enumerations.iter().find(|known| known.name == enumeration)?;
        let (name, _) = known.values.iter().find(|(_, value)| *value == number)?;
        let word = (enumeration.to_owned(), name.clone(), number);
        let plain = identifier(&[name]);
        let called = match self.values.get(&plain) {
            Some(other) if *other != word => identifier(&[name, enumeration]),
            _ => plain,
        };
        self.values.insert(called.clone(), word);
        Some(format!("values::{called}"))
    }

    /// The modules of constants that are not empty.
    pub(crate) fn modules(&self) -> Vec<&'static str> {
        let all = [
            ("constants", self.constants.is_empty()),
            ("functions", self.functions.is_empty()),
            ("messages", self.sources.is_empty()),
            ("timers", self.timers.is_empty()),
            ("values", self.values.is_empty()),
        ];
        all.into_iter().filter(|(_, is_empty)| !is_empty).map(|(name, _)| name).collect()
    }

    /// The code that declares the environment of the chart.
    pub(crate) fn declarations(&self) -> Vec<RustCode> {
        let mut code = Vec::new();
        for word in &self.sources {
            let Some(topic) = self.topic(&word.source) else { continue };
            let (host, publisher) = match &word.source.origin {
                Origin::Host(host) => (Some(host), None),
                Origin::Publisher(publisher) => (None, Some(publisher)),
                Origin::HostPublisher { host, publisher } => (Some(host), Some(publisher)),
                _ => (None, None),
            };
            let arguments = [literal(&topic.path), literal(&topic.message)];
            let mut reads = format!("SourceDeclaration::own({})", arguments.join(", "));
            for (method, name) in [("by", publisher), ("on", host)] {
                reads.extend(name.map(|name| format!(".{method}({})", literal(name))));
            }
            let arguments =
                vec![RustCode::plain(format!("messages::{}", word.constant)), RustCode::plain(reads)];
            code.push(RustCode::call("chart.reads", arguments));
        }
        let named = |method: &str, module: &str, name: &String| {
            let constant = RustCode::plain(format!("{module}::{}", identifier(&[name])));
            RustCode::call(format!("chart.{method}"), vec![constant, RustCode::plain(literal(name))])
        };
        code.extend(self.timers.iter().map(|name| named("starts", "timers", name)));
        code.extend(self.functions.iter().map(|name| named("calls", "functions", name)));
        for (called, (enumeration, name, _)) in &self.values {
            let arguments = [literal(enumeration), literal(name), format!("values::{called}")];
            code.push(RustCode::call("chart.means", arguments.map(RustCode::Plain).into()));
        }
        code.extend(self.chart.constants.iter().map(|constant| {
            let value = match self.constants.contains(&constant.name) {
                true => format!("constants::{}", identifier(&[&constant.name])),
                false => constant_text(&constant.value),
            };
            RustCode::call(
                "chart.constant",
                vec![RustCode::plain(literal(&constant.name)), RustCode::Plain(value)],
            )
        }));
        code
    }

    pub(crate) fn file(&self) -> String {
        let mut text = String::from(
            "//! The names that guards and actions use: each a constant named as in the model.\n",
        );
        let runtime = &self.words.runtime;
        let mut module = |name: &str, about: &str, uses: &str, lines: Vec<String>| {
            if lines.is_empty() {
                return;
            }
            let uses =
                if uses.is_empty() { String::new() } else { format!("    use {runtime}::{uses};\n\n") };
            text += &format!(
                "\n/// {about}\n#[allow(non_upper_case_globals, clippy::approx_constant)] // names and numbers as in the model\n\
                 pub(crate) mod {name} {{\n{uses}{}}}\n",
                lines.concat()
            );
        };
        let lines = self.chart.constants.iter().filter(|constant| self.constants.contains(&constant.name));
        let line = |constant: &yase::statechart::Constant| {
            let kind = match constant.value {
                ConstantValue::Bool(_) => "bool",
                ConstantValue::Number(_) => "f64",
                ConstantValue::Text(_) => "&str",
            };
            constant_line(
                &constant.name,
                &identifier(&[&constant.name]),
                kind,
                &constant_text(&constant.value),
            )
        };
        module("constants", "The constants of the model.", "", lines.map(line).collect());
        let numbered = |names: &[String], kind: &str| -> Vec<String> {
            let line = |(number, name): (usize, &String)| {
                constant_line(name, &identifier(&[name]), kind, &format!("{kind}({number})"))
            };
            names.iter().enumerate().map(line).collect()
        };
        module(
            "functions",
            "The functions that expressions call.",
            "Function",
            numbered(&self.functions, "Function"),
        );
        let lines = self.sources.iter().enumerate().map(|(number, word)| {
            let topic = self.topic(&word.source).map_or("", |topic| &topic.path);
            let kind = format!("Source<{}>", word.rust);
            constant_line(topic, &word.constant, &kind, &format!("Source::new({number})"))
        });
        module("messages", "The messages that are read and written.", "Source", lines.collect());
        module("timers", "The timers.", "Timer", numbered(&self.timers, "Timer"));
        let lines = self.values.iter().map(|(called, (enumeration, name, number))| {
            constant_line(&format!("{enumeration}.{name}"), called, "i32", &number.to_string())
        });
        module("values", "The values of enumerations.", "", lines.collect());
        text
    }
}

fn constant_line(about: &str, name: &str, kind: &str, value: &str) -> String {
    format!("    /// {}\n    pub(crate) const {name}: {kind} = {value};\n", quoted(about))
}

fn constant_text(value: &ConstantValue) -> String {
    match value {
        ConstantValue::Bool(truth) => truth.to_string(),
        ConstantValue::Number(number) => format!("{number:?}"),
        ConstantValue::Text(text) => literal(text),
    }
}

/// `UPPER_SNAKE_CASE`, reduced to letters, digits and underscores.
fn shouted(name: &str) -> String {
    let plain = |c: char| if c.is_ascii_alphanumeric() { c.to_ascii_uppercase() } else { '_' };
    let text: String = name.chars().map(plain).collect();
    let text = text.split('_').filter(|part| !part.is_empty()).collect::<Vec<_>>().join("_");
    if text.starts_with(|first: char| first.is_ascii_digit()) || text.is_empty() {
        format!("TOPIC_{text}")
    } else {
        text
    }
}
