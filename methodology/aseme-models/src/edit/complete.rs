//! Completions at a position of a model's text.

use std::collections::{BTreeMap, BTreeSet};

use aseme::path::shortest_path;
use aseme::{SrmFile, text};
use yase::vocabulary::{MessageEntry, ValueType};
use yase::{NodeKind, Source, Span, Statechart, TypeEnvironment};
use yase_export::notation::kind_word;

use super::item_edit::FormText;
use super::{FieldKind, ModelOutline, TextForm, form, line_end, line_start, outline};
use crate::document::reference;
use crate::iac::{KINDS, NODE_KEYS};

/// The names of the program that runs a model.
#[derive(Clone, Copy, Debug)]
pub struct ProgramNames<'a> {
    /// Topics, messages, enumerations and functions.
    pub environment: &'a TypeEnvironment,
    /// Activities.
    pub activities: &'a [String],
}

/// Something that can be written.
#[derive(Clone, PartialEq, Eq, PartialOrd, Ord, Debug)]
pub struct Completion {
    /// The text.
    pub text: String,
    /// Its kind: `message`, `field`, `function`, `activity`, `state` and others.
    pub kind: &'static str,
    /// More about it, such as a type.
    pub detail: String,
}

/// The completions at a position.
#[derive(Clone, PartialEq, Eq, Debug, Default)]
pub struct Completions {
    /// The word before the position, which is replaced.
    pub word: Span,
    /// The completions, in order; not filtered by the word.
    pub entries: Vec<Completion>,
}

/// The completions at a position of a model's text.
pub fn completions(source: &str, at: usize, names: ProgramNames<'_>) -> Completions {
    let at = floor_boundary(source, at);
    let blanked = text::without_comments(source);
    let is_comment = source[line_start(source, at)..at] != blanked[line_start(source, at)..at];
    let mut words = CompletionCollector { names, entries: BTreeSet::new() };
    if !is_comment {
        match form(source) {
            TextForm::Role => words.role(source, &blanked, at),
            TextForm::Chart => words.chart(source, &blanked, at),
            TextForm::Items => words.items(source, &blanked, at),
            TextForm::Foreign => {}
        }
    }
    words.at(&blanked, at)
}

/// The completions at a position of an expression of a model.
pub fn expression_completions(
    source: &str,
    expression: &str,
    at: usize,
    names: ProgramNames<'_>,
) -> Completions {
    let at = floor_boundary(expression, at);
    let chart = crate::statechart_of(&Source::new("", source)).0;
    let mut words = CompletionCollector { names, entries: BTreeSet::new() };
    words.expression(&expression[..at], &chart);
    words.at(expression, at)
}

fn floor_boundary(text: &str, at: usize) -> usize {
    let mut at = at.min(text.len());
    while !text.is_char_boundary(at) {
        at -= 1;
    }
    at
}

struct CompletionCollector<'a> {
    names: ProgramNames<'a>,
    entries: BTreeSet<Completion>,
}

impl CompletionCollector<'_> {
    fn at(self, text: &str, at: usize) -> Completions {
        let start = text[..at].trim_end_matches(text::is_name_character).len();
        Completions { word: Span::new(start, at), entries: self.entries.into_iter().collect() }
    }

    fn add(&mut self, kind: &'static str, text: impl Into<String>, detail: impl Into<String>) {
        self.entries.insert(Completion { text: text.into(), kind, detail: detail.into() });
    }

    fn all<'w>(&mut self, kind: &'static str, words: impl IntoIterator<Item = &'w str>) {
        words.into_iter().for_each(|word| self.add(kind, word, ""));
    }

    fn activities(&mut self) {
        self.names.activities.iter().for_each(|name| self.add("activity", name, ""));
    }

    fn role(&mut self, source: &str, blanked: &str, at: usize) {
        let sections = ["Role", "Protocols", "Liveness", "Constants", "Transitions", "States", "Layout"];
        let before = &blanked[..at];
        let header = |line: &str| {
            let word = line.trim_start().split_once(':')?.0;
            sections.into_iter().find(|section| *section == word)
        };
        let current = before.lines().rev().find_map(header);
        let line = &blanked[line_start(blanked, at)..at];
        let is_header = header(line).is_some();
        if line.trim().chars().all(text::is_name_character) && !is_header {
            let known: BTreeSet<&str> = blanked.lines().filter_map(header).collect();
            for section in sections.into_iter().filter(|section| !known.contains(section)) {
                self.add("section", format!("{section}:"), "");
            }
        }
        let chart = || crate::statechart_of(&Source::new("", source)).0;
        match current {
            Some("Transitions") if !is_header => self.transition(blanked, at, &chart()),
            Some("States") if !is_header => self.state(line, &chart()),
            Some("Layout") if !is_header => self.states(&chart()),
            None | Some("Liveness") => {
                let (file, _) = SrmFile::parse(source);
                for formula in file.srm().liveness.formulas() {
                    self.add("formula", formula.name.as_str(), "");
                }
                self.activities();
            }
            _ => {}
        }
    }

    /// In an entry of `Transitions:`, which begins with the line that has its arrow.
    fn transition(&mut self, blanked: &str, at: usize, chart: &Statechart) {
        let begin = blanked[..at].rfind("->");
        let start = match begin {
            Some(arrow) => line_start(blanked, arrow),
            None => line_start(blanked, at),
        };
        // a line with an arrow after the position begins another entry
        let line = line_start(blanked, at);
        let is_new = line > start && blanked[line..line_end(blanked, at)].contains("->");
        let entry = &blanked[if is_new { line } else { start }..at];
        let colon = entry.find("->").and_then(|arrow| Some(arrow + entry[arrow..].find(':')?));
        match colon {
            Some(colon) if !entry[colon..].contains('\n') || entry[colon..].contains(['[', '/']) => {
                self.expression(&entry[colon + 1..], chart);
            }
            _ => {
                self.states(chart);
                if entry.contains("->") {
                    self.all("modifier", ["also", "interrupts", "internal", "!1", "%1"]);
                }
            }
        }
    }

    /// In an entry of `States:`.
    fn state(&mut self, line: &str, chart: &Statechart) {
        let Some((_, settings)) = line.split_once(':') else { return self.states(chart) };
        let setting = settings.rsplit(',').next().unwrap_or_default();
        match setting.split_once('=').map(|(key, value)| (key.trim(), value)) {
            Some(("activity", _)) => self.activities(),
            Some(("history", _)) => self.all("value", ["shallow", "deep"]),
            Some(("entry" | "exit", value)) => self.expression(&format!("/{value}"), chart),
            Some(_) => {}
            None => self.all(
                "key",
                ["activity =", "priority =", "entry =", "exit =", "defer =", "duration =", "history ="],
            ),
        }
    }

    fn states(&mut self, chart: &Statechart) {
        for (id, node) in chart.nodes() {
            let is_named = !node.name.is_empty();
            if is_named || node.kind == NodeKind::End {
                let path = if is_named { node.name.clone() } else { shortest_path(chart, id) };
                self.add("state", path, kind_word(node.kind));
            }
        }
        self.all("state", ["START", "CONDITION", "END"]);
    }

    fn chart(&mut self, source: &str, blanked: &str, at: usize) {
        let line = &blanked[line_start(blanked, at)..at];
        let item = current_header(blanked, at);
        if !line.starts_with(char::is_whitespace) {
            return self.all("section", ["Variable:", "Constants:", "States:", "Transitions:"]);
        }
        match item {
            Some("Transitions") => {
                let chart = crate::statechart_of(&Source::new("", source)).0;
                self.transition(blanked, at, &chart);
            }
            Some("States") => match line.split_once('=').map(|(key, _)| key.trim()) {
                Some("activity") => self.activities(),
                Some(_) => {}
                None => {
                    self.all("kind", KINDS.into_iter().map(kind_word));
                    NODE_KEYS.into_iter().for_each(|key| self.add("key", format!("{key} ="), ""));
                }
            },
            _ => {}
        }
    }

    fn items(&mut self, source: &str, blanked: &str, at: usize) {
        let ModelOutline::Form { classes, .. } = outline(source) else { return };
        let line = &blanked[line_start(blanked, at)..at];
        if !line.starts_with(char::is_whitespace) {
            return classes.iter().for_each(|class| self.add("section", format!("{}:", class.word), ""));
        }
        let header = current_header(blanked, at);
        let Some(class) = classes.iter().find(|class| Some(class.word) == header) else { return };
        let Some((key, _)) = line.split_once('=') else {
            for field in &class.fields {
                let sign = if field.kind == FieldKind::Formulas { ":" } else { " =" };
                self.add("key", format!("{}{sign}", field.key), "");
            }
            return self.activities_of_formulas(line);
        };
        match class.fields.iter().find(|field| field.key == key.trim()).map(|field| &field.kind) {
            Some(FieldKind::Choice(choices)) => self.all("value", choices.iter().copied()),
            Some(FieldKind::Links(word, _)) => {
                let form = FormText::new(source);
                let class = form.metamodel.classes.iter().find(|class| class.header == *word);
                let known = class.map(|class| form.references(class)).unwrap_or_default();
                for one in known.into_values() {
                    self.add("item", reference(&one.name, one.number), *word);
                }
            }
            _ => self.activities_of_formulas(line),
        }
    }

    /// Lines of formulas are further in than settings.
    fn activities_of_formulas(&mut self, line: &str) {
        if line.len() - line.trim_start().len() > 2 {
            self.activities();
        }
    }

    /// In an expression of which this precedes the position.
    fn expression(&mut self, before: &str, chart: &Statechart) {
        let word = before.trim_end_matches(text::is_name_character);
        if let Some(owner) = word.strip_suffix('.') {
            return self.fields(owner);
        }
        if is_within_state_reference(word) {
            return self.states(chart);
        }
        match part_at(word) {
            ExpressionPart::Trigger => {
                self.events(chart);
                self.messages();
                self.all("word", ["not"]);
            }
            ExpressionPart::Guard => self.condition(word, chart),
            ExpressionPart::Action => {
                self.all(
                    "action",
                    ["StartTimeout(", "raise(", "publish.", "process_messages", "publish_all"],
                );
                self.condition(word, chart);
            }
        }
    }

    fn condition(&mut self, before: &str, chart: &Statechart) {
        let compared = before.trim_end();
        if let Some(left) = compared.strip_suffix("==").or(compared.strip_suffix("!=")) {
            let path = left.trim_end();
            let path = &path[path
                .trim_end_matches(|letter: char| text::is_name_character(letter) || letter == '.')
                .len()..];
            if let Some(ValueType::Enumeration(name)) = self.type_of(path) {
                return self.values_of(&name);
            }
        }
        self.messages();
        self.all("word", ["true", "false", "In("]);
        for constant in &chart.constants {
            self.add("constant", constant.name.as_str(), format!("{:?}", constant.value));
        }
        let timers: BTreeSet<String> = chart
            .transitions()
            .flat_map(|(_, it)| {
                it.expression.started_timers().map(|timer| timer.to_string()).collect::<Vec<_>>()
            })
            .collect();
        timers.into_iter().for_each(|timer| self.add("timer", timer, ""));
        for function in &self.names.environment.functions {
            let parameters: Vec<String> = function.parameters.iter().map(type_word).collect();
            let detail = format!("({}) {}", parameters.join(", "), type_word(&function.result));
            self.entries.insert(Completion { text: format!("{}(", function.name), kind: "function", detail });
        }
        let enumerations = &self.names.environment.enumerations;
        for name in enumerations.iter().map(|enumeration| enumeration.name.clone()).collect::<Vec<_>>() {
            self.values_of(&name);
        }
    }

    fn values_of(&mut self, enumeration: &str) {
        let known = self.names.environment.enumerations.iter().find(|it| it.name == enumeration);
        for (value, _) in known.into_iter().flat_map(|it| &it.values) {
            self.add("value", value.as_str(), enumeration);
        }
    }

    fn events(&mut self, chart: &Statechart) {
        use yase::expression::{Path, Trigger};
        let triggers = chart.transitions().filter_map(|(_, it)| it.expression.trigger.clone());
        let names: BTreeSet<String> = triggers
            .flat_map(|trigger| match trigger {
                Trigger::OneOf(paths) => paths.iter().map(Path::text).collect(),
                Trigger::Not(path) => vec![path.text()],
                Trigger::Any => Vec::new(),
            })
            .collect();
        names.into_iter().for_each(|name| self.add("event", name, ""));
    }

    /// Messages, each of which is named by its type if one topic has it, otherwise by its topic.
    fn messages(&mut self) {
        let mut topics: BTreeMap<&str, Vec<&str>> = BTreeMap::new();
        for topic in &self.names.environment.topics {
            topics.entry(topic.message.as_str()).or_default().push(topic.path.as_str());
        }
        for (message, paths) in topics {
            match paths.as_slice() {
                [path] => self.add("message", message, *path),
                several => {
                    for path in several {
                        let last = path.rsplit('/').next().unwrap_or(path);
                        self.add("topic", last, format!("{message} on {path}"));
                    }
                }
            }
        }
    }

    fn fields(&mut self, owner: &str) {
        let path = &owner
            [owner.trim_end_matches(|letter: char| text::is_name_character(letter) || letter == '.').len()..];
        if path == "publish" {
            return self.messages();
        }
        let Some(ValueType::Message(name)) = self.type_of(path) else { return };
        let Some(message) = self.message(&name) else { return };
        for field in message.fields.clone() {
            self.add("field", field.name, type_word(&field.kind));
        }
    }

    /// The type of a path that begins with a message or a topic.
    fn type_of(&self, path: &str) -> Option<ValueType> {
        let mut segments = path.split('.');
        let first = segments.next()?;
        let topic = self
            .names
            .environment
            .topics
            .iter()
            .find(|topic| topic.message == first || topic.path.rsplit('/').next() == Some(first));
        let mut kind = ValueType::Message(topic?.message.clone());
        for segment in segments {
            let ValueType::Message(name) = &kind else { return None };
            kind = self.message(name)?.fields.iter().find(|field| field.name == segment)?.kind.clone();
        }
        Some(kind)
    }

    fn message(&self, name: &str) -> Option<&MessageEntry> {
        self.names.environment.messages.iter().find(|message| message.name == name)
    }
}

/// The part of an expression.
enum ExpressionPart {
    Trigger,
    Guard,
    Action,
}

fn part_at(before: &str) -> ExpressionPart {
    let (mut depth, mut is_action, mut quotes) = (0_usize, false, text::QuoteScanner::default());
    for letter in before.chars() {
        if quotes.hold(letter) {
            continue;
        }
        match letter {
            '[' => depth += 1,
            ']' => depth = depth.saturating_sub(1),
            '/' if depth == 0 => is_action = true,
            _ => {}
        }
    }
    match (depth, is_action) {
        (0, false) => ExpressionPart::Trigger,
        (0, true) => ExpressionPart::Action,
        _ => ExpressionPart::Guard,
    }
}

/// Whether an `In(` is open.
fn is_within_state_reference(before: &str) -> bool {
    before.rfind("In(").is_some_and(|at| {
        let inside = &before[at + 3..];
        inside.matches('(').count() >= inside.matches(')').count() && !inside.contains(')')
    })
}

/// The header of the item at a position.
fn current_header(blanked: &str, at: usize) -> Option<&str> {
    let is_header = |line: &&str| line.starts_with(|letter: char| letter.is_ascii_uppercase());
    let line = blanked[..at].lines().rev().filter(is_header).find_map(|line| line.split_once(':'))?;
    Some(line.0)
}

fn type_word(kind: &ValueType) -> String {
    match kind {
        ValueType::Bool => "boolean".into(),
        ValueType::Number => "number".into(),
        ValueType::Text => "text".into(),
        ValueType::Enumeration(name) | ValueType::Message(name) => name.clone(),
    }
}

#[cfg(test)]
mod tests {
    use yase::vocabulary::{
        Enumeration, FieldEntry, FieldId, FunctionEntry, FunctionId, TopicEntry, TopicId, TopicKind,
    };

    use super::*;

    fn environment() -> TypeEnvironment {
        let field = |id, name: &str, kind| FieldEntry { id: FieldId(id), name: name.into(), kind };
        let ball =
            vec![field(0, "found", ValueType::Bool), field(1, "side", ValueType::Enumeration("Side".into()))];
        TypeEnvironment {
            topics: vec![TopicEntry {
                id: TopicId(0),
                path: "soccer/ball".into(),
                kind: TopicKind::State,
                message: "Ball".into(),
            }],
            messages: vec![MessageEntry { name: "Ball".into(), fields: ball }],
            enumerations: vec![Enumeration { name: "Side".into(), values: vec![("LEFT".into(), 0)] }],
            functions: vec![FunctionEntry {
                id: FunctionId(0),
                name: "abs".into(),
                parameters: vec![ValueType::Number],
                result: ValueType::Number,
            }],
            ..TypeEnvironment::default()
        }
    }

    /// The texts of a kind at the `@` of a text, and the word that they replace.
    fn at(text: &str) -> (String, impl Fn(&str) -> Vec<String> + use<>) {
        let index = text.find('@').expect("a position");
        let source = text.replacen('@', "", 1);
        let (environment, activities) = (environment(), ["Kick".to_owned(), "Wait".to_owned()]);
        let names = ProgramNames { environment: &environment, activities: &activities };
        let found = completions(&source, index, names);
        let word = source[found.word.start..found.word.end].to_owned();
        let of = move |kind: &str| {
            found.entries.iter().filter(|it| it.kind == kind).map(|it| it.text.clone()).collect()
        };
        (word, of)
    }

    const ROLE: &str = "Role: r\nLiveness:\nr = Wait . go\ngo = Kick | Wait\nConstants:\nnear = 1\n";

    #[test]
    fn formulas_name_activities_and_formulas() {
        let (word, of) = at("Liveness:\nr = Wa@it . go\ngo = Kick\n");
        assert_eq!(
            (word.as_str(), of("activity"), of("formula")),
            ("Wa", vec!["Kick".into(), "Wait".into()], vec!["go".into(), "r".into()],)
        );
        assert!(at("Liveness:\nr = Wait # no @\n").1("activity").is_empty(), "a comment");
    }

    #[test]
    fn guards_know_messages_fields_values_constants_and_functions() {
        let guard = |text: &str| at(&format!("{ROLE}Transitions:\nCONDITION -> Kick : {text}\n"));
        let (word, of) = guard("[Ba@");
        assert_eq!(
            (word.as_str(), of("message"), of("constant")),
            ("Ba", vec!["Ball".into()], vec!["near".into()])
        );
        assert_eq!(of("function"), ["abs("]);
        let (word, of) = guard("[near < 1 && Ball.fo@]");
        assert_eq!((word.as_str(), of("field")), ("fo", vec!["found".to_owned(), "side".to_owned()]));
        let (_, of) = guard("[Ball.side == @]");
        assert_eq!((of("value"), of("message")), (vec!["LEFT".to_owned()], vec![]));
        assert!(guard("[In(@)]").1("state").contains(&"Kick".to_owned()));
        assert!(guard("[x] / St@").1("action").contains(&"StartTimeout(".to_owned()));
        assert!(guard("[Ball.found\n   && ne@]").1("constant").contains(&"near".to_owned()));
    }

    #[test]
    fn the_ends_of_entries_name_states() {
        let (_, of) = at(&format!("{ROLE}Transitions:\nCONDITION -> Kick : [x]\nCONDITION -> @\n"));
        assert!(of("state").contains(&"Kick".to_owned()) && of("modifier").contains(&"also".to_owned()));
        let (_, of) = at(&format!("{ROLE}States:\nKick : activity = @\n"));
        assert_eq!(of("activity"), ["Kick", "Wait"]);
        assert!(at(&format!("{ROLE}States:\nKick : @\n")).1("key").contains(&"duration =".to_owned()));
        assert!(at(&format!("{ROLE}Tr@\n")).1("section").contains(&"Transitions:".to_owned()));
    }

    #[test]
    fn forms_know_keys_and_items() {
        let goals = "SAG:\n\nGoal: Win\n  depender = @\n\nActor: Team\n";
        assert_eq!(at(goals).1("item"), ["Team"]);
        assert!(at("SAG:\n\nGoal: Win\n  de@\n").1("key").contains(&"depender =".to_owned()));
        assert_eq!(at("SAG:\n\nG@\n").1("section"), ["Actor:", "Goal:"]);
        assert!(at("IAC: a\n\nStates:\n  a OR\n    b @\n").1("kind").contains(&"JUNCTION".to_owned()));
    }
}
