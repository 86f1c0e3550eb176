//! Parser of the text form.

use std::collections::{BTreeMap, BTreeSet};
use std::time::Duration;

use yase::diagnostic::Suggestions;
use yase::expression::TextPosition;
use yase::statechart::Constant;
use yase::{Diagnostic, Span};

use super::from_xmi::too_deep;
use super::path::{NodePaths, name_of};
use super::to_text::label_name;
use super::{ChartKind, Iac, IacNode, IacTransition, MAX_LEVELS, Variable, lint, without_null};
use crate::document::{
    Item, ItemDocument, KeyValue, Line, Reference, SpannedText, last_word, list, settings, unquoted,
};
use aseme::layout::{self, BENDS_KEY};
use aseme::srm::constant_value;
use aseme::text::outside_quotes;

/// Parses a chart from text; the findings are E0260 to E0279 and the structural faults.
pub(crate) fn from_text(document: &ItemDocument) -> (Iac, Vec<Diagnostic>) {
    let mut reader = Reader {
        chart: Iac::default(),
        variables: BTreeMap::new(),
        by_label: false,
        named_by_label: Vec::new(),
        labelled: BTreeSet::new(),
        suggestions: Suggestions::default(),
        diagnostics: Vec::new(),
    };
    for (index, item) in document.items.iter().enumerate() {
        reader.item(index, item);
    }
    for item in document.items.iter().filter(|item| item.word.text == "States") {
        reader.states(&item.lines);
    }
    for item in document.items.iter().filter(|item| item.word.text == "Transitions") {
        reader.transitions(&item.lines);
    }
    let file = document.items.first().map_or(Span::default(), Item::span);
    reader.diagnostics.extend(lint::faults(&reader.chart, file));
    (reader.chart, reader.diagnostics)
}

const WORDS: [&str; 5] = ["IAC", "Variable", "Constants", "States", "Transitions"];
/// The keys of a state's settings.
pub(crate) const NODE_KEYS: [&str; 14] = [
    "type",
    "label",
    "activity",
    "priority",
    "entry",
    "exit",
    "defer",
    "duration",
    "at",
    "size",
    "variables",
    "functionality",
    "actions",
    "metadata",
];

struct Reader {
    chart: Iac,
    variables: BTreeMap<Reference, usize>,
    by_label: bool,
    /// Nodes without a name.
    named_by_label: Vec<usize>,
    /// Nodes with an explicit label.
    labelled: BTreeSet<usize>,
    suggestions: Suggestions,
    diagnostics: Vec<Diagnostic>,
}

impl Reader {
    fn report(&mut self, diagnostic: Diagnostic) {
        self.diagnostics.push(diagnostic);
    }

    fn item(&mut self, index: usize, item: &Item) {
        match item.word.text.as_str() {
            word @ ("IAC" | "EAC") if index == 0 => {
                self.chart.kind = if word == "IAC" { ChartKind::Intra } else { ChartKind::Inter };
                self.chart.name = self.plain(&item.name);
                self.about(item);
            }
            "Variable" => self.variable(item),
            "Constants" => self.constants(item),
            "States" | "Transitions" => {}
            word => {
                let message = format!("a chart has no `{word}`");
                let hint = format!("headers are {}", WORDS.join(", "));
                let found = Diagnostic::error("E0261", item.word.span, message).with_hint(hint);
                self.report(found.with_nearest(word, WORDS));
            }
        }
    }

    fn plain(&mut self, value: &SpannedText) -> String {
        unquoted(&value.text).unwrap_or_else(|| {
            let message = format!("`{}` cannot be read", value.text);
            let hint =
                "a quoted text ends with a quote and may contain the escapes `\\n`, `\\t`, `\\\"` and `\\\\`";
            self.report(Diagnostic::error("E0264", value.span, message).with_hint(hint));
            value.text.clone()
        })
    }

    fn unknown_key(&mut self, key: &SpannedText, what: &str, keys: &[&str]) {
        let message = format!("a {what} has no `{}`", key.text);
        let hint = format!("keys are {}", keys.join(", "));
        let found = Diagnostic::error("E0266", key.span, message).with_hint(hint);
        self.report(found.with_nearest(&key.text, keys.iter().copied()));
    }

    fn about(&mut self, item: &Item) {
        for setting in self.settings(&item.lines) {
            match setting.key.text.as_str() {
                "description" => self.chart.description = self.plain(&setting.value),
                "metadata" => self.chart.metadata = self.plain(&setting.value),
                "transition_names" if setting.value.text == "labels" => self.by_label = true,
                _ => self.unknown_key(
                    &setting.key,
                    "chart",
                    &["description", "metadata", "transition_names = labels"],
                ),
            }
        }
    }

    /// Lines that are settings; other lines are reported.
    fn settings<'a>(&mut self, lines: &'a [Line]) -> Vec<KeyValue<'a>> {
        let mut understood = Vec::new();
        for setting in settings(lines) {
            match setting {
                Ok(setting) if setting.block.is_none() => understood.push(setting),
                Ok(KeyValue { key, .. }) => self.no_setting(&key),
                Err(line) => self.no_setting(&line.content),
            }
        }
        understood
    }

    fn no_setting(&mut self, word: &SpannedText) {
        let message = format!("`{}` is not a setting", word.text);
        self.report(Diagnostic::error("E0265", word.span, message).with_hint("write `key = value`"));
    }

    fn variable(&mut self, item: &Item) {
        let name = self.plain(&item.name);
        let mut variable =
            Variable { name: name.clone(), kind: String::new(), position: TextPosition(item.span()) };
        for setting in self.settings(&item.lines) {
            match setting.key.text.as_str() {
                "type" => variable.kind = self.plain(&setting.value),
                _ => self.unknown_key(&setting.key, "variable", &["type"]),
            }
        }
        let same = self.chart.variables.iter().filter(|variable| variable.name == name).count();
        self.variables.insert(Reference { name, number: same + 1 }, self.chart.variables.len());
        self.chart.variables.push(variable);
    }

    fn constants(&mut self, item: &Item) {
        for setting in self.settings(&item.lines) {
            let name = setting.key.text.clone();
            if self.chart.constants.iter().any(|constant| constant.name == name) {
                let message = format!("`{name}` has a value already");
                self.report(
                    Diagnostic::error("E0238", setting.key.span, message).with_hint("keep one of the two"),
                );
                continue;
            }
            match constant_value(&setting.value.text) {
                Some(value) => self.chart.constants.push(Constant { name, value }),
                None => {
                    let message = format!("`{}` is not a value", setting.value.text);
                    let hint = "a value is a number, which a unit may follow (m cm mm s ms rad deg), true, false or \"text\"";
                    self.report(Diagnostic::error("E0239", setting.value.span, message).with_hint(hint));
                }
            }
        }
    }

    /// Parses the tree: a deeper indented line is a child or a setting of the line above.
    fn states(&mut self, lines: &[Line]) {
        let mut open: Vec<(usize, usize)> = Vec::new();
        for line in lines {
            open.retain(|(indent, _)| *indent < line.indent);
            let parent = open.last().map(|(_, node)| *node);
            match (node_setting(line), parent) {
                (Some((key, value)), Some(node)) => self.node_setting(node, &key, &value),
                (Some((key, _)), None) => self.no_setting(&key),
                (None, _) if open.len() >= MAX_LEVELS => self.report(too_deep(line.content.span)),
                (None, parent) => {
                    if let Some(node) = self.node(line, parent) {
                        open.push((line.indent, node));
                    }
                }
            }
        }
        self.labels();
    }

    /// `name TYPE`, or a type alone.
    fn node(&mut self, line: &Line, parent: Option<usize>) -> Option<usize> {
        let content = &line.content;
        let split = last_word(&content.text);
        let kind = content.text[split..].to_owned();
        let is_kind = !kind.is_empty() && kind.bytes().all(|byte| byte.is_ascii_uppercase() || byte == b'_');
        if !is_kind {
            let message = format!("`{}` is not a state", content.text);
            let hint =
                "write a name and a type, such as `Scan BASIC`, or the type alone for a node without a name";
            self.report(Diagnostic::error("E0270", content.span, message).with_hint(hint));
            return None;
        }
        let name = content.part(0..split);
        let meant = name_of(&name.text, &kind).unwrap_or_else(|| self.plain(&name));
        if name.text.is_empty() {
            self.named_by_label.push(self.chart.nodes.len());
        }
        let kind = if kind == "NODE" { String::new() } else { kind };
        let position = TextPosition(content.span);
        self.chart.nodes.push(IacNode { name: meant, kind, parent, position, ..IacNode::default() });
        Some(self.chart.nodes.len() - 1)
    }

    /// Fills in default labels, and names of nodes without a name.
    fn labels(&mut self) {
        let usual = self.chart.labels();
        for &node in &self.named_by_label {
            self.chart.nodes[node].name.clone_from(&usual[node]);
        }
        for (index, node) in self.chart.nodes.iter_mut().enumerate() {
            if !self.labelled.contains(&index) {
                node.label.clone_from(&usual[index]);
            }
        }
    }

    fn node_setting(&mut self, index: usize, key: &SpannedText, value: &SpannedText) {
        if key.text == "variables" {
            let variables = list(value).iter().filter_map(|word| self.variable_named(word)).collect();
            self.chart.nodes[index].variables = variables;
            return;
        }
        let text = self.plain(value);
        let node = &mut self.chart.nodes[index];
        let refinement = &mut node.refinement;
        let understood = match key.text.as_str() {
            "type" => set(&mut node.kind, text),
            "label" => set(&mut node.label, text) && self.labelled.insert(index),
            "entry" => set(&mut refinement.entry, text),
            "exit" => set(&mut refinement.exit, text),
            "defer" => set(&mut refinement.defer, text),
            "functionality" => set(&mut node.functionality, without_null(&text)),
            "actions" => set(&mut node.actions, text),
            "metadata" => set(&mut node.metadata, text),
            "activity" => set(&mut refinement.activity, Some(text)),
            "at" => set(&mut node.frame.at, layout::parse_position(&text)) && node.frame.at.is_some(),
            "size" => set(&mut node.frame.size, layout::size(&text)) && node.frame.size.is_some(),
            "priority" => text.parse().map(|priority| refinement.priority = priority).is_ok(),
            "duration" => set(&mut refinement.duration, duration(&text)) && refinement.duration.is_some(),
            _ => return self.unknown_key(key, "state", &NODE_KEYS),
        };
        if !understood {
            self.no_value(key, value);
        }
    }

    fn no_value(&mut self, key: &SpannedText, value: &SpannedText) {
        let message = format!("`{}` is not a value for `{}`", value.text, key.text);
        let hint = match key.text.as_str() {
            "at" => layout::POSITION_FORM,
            "size" => layout::SIZE_FORM,
            "priority" => "a whole number; higher runs first",
            "duration" => "a time such as `250ms` or `2s`",
            _ => layout::CORNERS_FORM,
        };
        self.report(Diagnostic::error("E0245", value.span, message).with_hint(hint));
    }

    fn variable_named(&mut self, word: &SpannedText) -> Option<usize> {
        let found =
            Reference::parse(&word.text).and_then(|reference| self.variables.get(&reference).copied());
        if found.is_none() {
            let message = format!("there is no Variable `{}`", word.text);
            let names: Vec<&str> = self.variables.keys().map(|reference| reference.name.as_str()).collect();
            let finding = Diagnostic::error("E0269", word.span, message).with_suggestion(
                &self.suggestions,
                &word.text,
                names,
            );
            self.report(finding);
        }
        found
    }

    /// Lines with an arrow, each with its settings below.
    fn transitions(&mut self, lines: &[Line]) {
        let (paths, labels) = (NodePaths::new(&self.chart), self.chart.labels());
        let mut last: Option<(usize, usize)> = None;
        for line in lines {
            let setting = node_setting(line);
            match (setting, last) {
                (Some((key, value)), Some((indent, index))) if line.indent > indent => {
                    self.transition_setting(index, &key, &value);
                }
                (Some((key, _)), _) => self.no_setting(&key),
                (None, _) => {
                    last = self.transition(line, &paths, &labels).map(|index| (line.indent, index)).or(last);
                }
            }
        }
    }

    fn transition(&mut self, line: &Line, paths: &NodePaths, labels: &[String]) -> Option<usize> {
        let content = &line.content;
        let Some(TransitionLine { source, target, modifiers, expression: te }) = transition_line(content)
        else {
            let message = format!("`{}` has no `->`", content.text);
            self.report(
                Diagnostic::error("E0240", content.span, message)
                    .with_hint("write `source -> target : expression`"),
            );
            return None;
        };
        let (source, target) = (self.end(paths, &source), self.end(paths, &target));
        let mut transition = IacTransition {
            te: without_null(&self.plain(&te)),
            position: TextPosition(content.span),
            te_position: TextPosition(if te.text.is_empty() { content.span } else { te.span }),
            ..IacTransition::default()
        };
        self.modifiers(&modifiers, &mut transition);
        (transition.source, transition.target) = (source?, target?);
        transition.name = match self.by_label {
            true => label_name(labels, &transition),
            false => self.chart.usual_name(transition.source, transition.target),
        };
        self.chart.transitions.push(transition);
        Some(self.chart.transitions.len() - 1)
    }

    fn end(&mut self, paths: &NodePaths, path: &SpannedText) -> Option<usize> {
        let found = paths.find(&path.text);
        match found.as_slice() {
            [one] => return Some(*one),
            [] => {
                let message = format!("`{}` is not a state", path.text);
                let finding = Diagnostic::error("E0271", path.span, message).with_suggestion(
                    &self.suggestions,
                    &path.text,
                    paths.names(),
                );
                self.report(finding);
            }
            several => {
                let message = format!("`{}` names more than one state", path.text);
                let names: Vec<String> =
                    several.iter().take(5).map(|&node| format!("`{}`", paths.shortest(node))).collect();
                let hint = format!("did you mean one of {}?", names.join(", "));
                self.report(Diagnostic::error("E0271", path.span, message).with_hint(hint));
            }
        }
        None
    }

    fn modifiers(&mut self, modifiers: &SpannedText, transition: &mut IacTransition) {
        let refinement = &mut transition.refinement;
        let mut wrong = Vec::new();
        for word in modifiers.text.split_whitespace() {
            let understood = match (word, word.strip_prefix('!'), word.strip_prefix('%')) {
                ("interrupts", ..) => set(&mut refinement.interrupts, true),
                ("internal", ..) => set(&mut refinement.internal, true),
                (_, Some(number), _) => number.parse().map(|priority| refinement.priority = priority).is_ok(),
                (_, _, Some(number)) => {
                    set(&mut refinement.weight, weight(number)) && refinement.weight.is_some()
                }
                _ => false,
            };
            if !understood {
                wrong.push(word);
            }
        }
        for word in wrong {
            let message = format!("`{word}` is not a modifier of a transition");
            let hint = "a target may be followed by `!priority`, `%weight`, `interrupts` and `internal`";
            self.report(Diagnostic::error("E0242", modifiers.span, message).with_hint(hint));
        }
    }

    fn transition_setting(&mut self, index: usize, key: &SpannedText, value: &SpannedText) {
        let text = self.plain(value);
        match key.text.as_str() {
            "name" => self.chart.transitions[index].name = text,
            "metadata" => self.chart.transitions[index].metadata = text,
            BENDS_KEY => match layout::bends(&text) {
                Some(bends) => self.chart.transitions[index].bends = bends,
                None => self.no_value(key, value),
            },
            _ => self.unknown_key(key, "transition", &["name", "metadata", BENDS_KEY]),
        }
    }
}

fn set<T>(target: &mut T, value: T) -> bool {
    *target = value;
    true
}

/// The parts of a transition's line.
pub(crate) struct TransitionLine {
    pub(crate) source: SpannedText,
    pub(crate) target: SpannedText,
    pub(crate) modifiers: SpannedText,
    pub(crate) expression: SpannedText,
}

/// `source -> target modifiers : expression`; `None` without an arrow.
pub(crate) fn transition_line(content: &SpannedText) -> Option<TransitionLine> {
    let arrow = outside_quotes(&content.text, "->")?;
    let rest = content.part(arrow + 2..content.text.len());
    let colon = outside_quotes(&rest.text, ":").unwrap_or(rest.text.len());
    let head = rest.part(0..colon);
    let modifiers = modifiers_start(&head.text);
    Some(TransitionLine {
        source: content.part(0..arrow),
        target: head.part(0..modifiers),
        modifiers: head.part(modifiers..head.text.len()),
        expression: rest.part((colon + 1).min(rest.text.len())..rest.text.len()),
    })
}

/// `key = value`. A node cannot look like this, since a name with `=` must be quoted.
pub(crate) fn node_setting(line: &Line) -> Option<(SpannedText, SpannedText)> {
    let text = &line.content.text;
    let equals = text.find('=')?;
    let key = text[..equals].trim_end();
    let is_key = !key.is_empty() && key.bytes().all(|byte| byte.is_ascii_lowercase() || byte == b'_');
    is_key.then(|| (line.content.part(0..equals), line.content.part(equals + 1..text.len())))
}

/// The end of a target's path: the first `!`, `%` or blank outside quotes.
fn modifiers_start(head: &str) -> usize {
    let words = [" !", " %", " interrupts", " internal"];
    words.iter().filter_map(|word| outside_quotes(head, word)).min().unwrap_or(head.len())
}

fn weight(text: &str) -> Option<f64> {
    text.parse().ok().filter(|weight: &f64| weight.is_finite() && *weight >= 0.0)
}

fn duration(text: &str) -> Option<Duration> {
    match text.strip_suffix("ns") {
        Some(number) => number.trim_end().parse().ok().map(Duration::from_nanos),
        None => aseme::srm::duration(text),
    }
}
