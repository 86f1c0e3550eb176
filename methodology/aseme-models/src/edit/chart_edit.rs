//! Edits of the text of a chart (IAC, EAC).

use std::collections::BTreeMap;

use aseme::text;
use yase::Span;
use yase_export::notation::kind_word;

use super::state_reference::within_expressions;
use super::{
    EditRefusal, ModelEdit, TextEdit, insertion, line_below, line_break, line_end, on_one_line, replacement,
    without_lines,
};
use crate::document::{Item, ItemDocument, Line, SpannedText, last_word, value_text};
use crate::iac::{
    Iac, IacNode, KINDS, NODE_KEYS, NodePaths, TransitionLine, from_text, name_of, name_text, node_setting,
    transition_line,
};

type Edits = Result<Vec<TextEdit>, EditRefusal>;

pub(crate) fn edits(source: &str, edit: &ModelEdit) -> Edits {
    let chart = ChartText::new(source);
    match edit {
        ModelEdit::SetTransition { transition, expression, modifiers } => {
            chart.set_transition(*transition, expression.as_deref(), modifiers.as_deref())
        }
        ModelEdit::AddTransition { source, target, expression } => {
            chart.add_transition(*source, *target, expression)
        }
        ModelEdit::RemoveTransition { transition } => {
            let line = chart.line(*transition)?;
            Ok(chart.without_transition(line))
        }
        ModelEdit::RenameState { state, name } => chart.rename(*state, name),
        ModelEdit::SetState { state, key, value } => chart.set_state(*state, key, value.as_deref()),
        ModelEdit::AddState { parent, kind, name } => chart.add_state(*parent, kind, name),
        ModelEdit::RemoveState { state } => chart.remove_state(*state),
        _ => Err(EditRefusal::new("the text of a chart has states and transitions, not items")),
    }
}

/// The text of a chart, with the lines of its nodes and transitions.
pub(crate) struct ChartText<'a> {
    source: &'a str,
    document: ItemDocument,
    chart: Iac,
    nodes: Vec<NodeLines>,
    transitions: Vec<TransitionLines>,
}

/// The lines of a node.
#[derive(Clone, Default)]
struct NodeLines {
    indent: usize,
    /// Name and kind.
    content: SpannedText,
    settings: Vec<(SpannedText, SpannedText)>,
}

/// The lines of a transition.
struct TransitionLines {
    indent: usize,
    content: SpannedText,
    parts: TransitionLine,
    /// The end of its last line.
    end: usize,
}

impl<'a> ChartText<'a> {
    pub(crate) fn new(source: &'a str) -> ChartText<'a> {
        let (document, _) = ItemDocument::parse(source);
        let (chart, _) = from_text(&document);
        let nodes = node_lines(&document, &chart);
        let transitions = transition_lines(&document, &chart);
        ChartText { source, document, chart, nodes, transitions }
    }

    /// The position of a node in the text.
    pub(crate) fn state_span(&self, node: usize) -> Span {
        self.nodes.get(node).map(|lines| lines.content.span).unwrap_or_default()
    }

    pub(crate) fn state_count(&self) -> usize {
        self.nodes.len()
    }

    /// The settings of a node as they are written, without quotes.
    pub(crate) fn state_settings(&self, node: usize) -> Vec<(String, String)> {
        let plain = |value: &SpannedText| {
            crate::document::unquoted(&value.text).unwrap_or_else(|| value.text.clone())
        };
        let settings = self.nodes.get(node).map(|lines| lines.settings.as_slice()).unwrap_or_default();
        settings.iter().map(|(key, value)| (key.text.clone(), plain(value))).collect()
    }

    /// The position of each transition in the text, with its expression and modifiers.
    pub(crate) fn transition_texts(&self) -> impl Iterator<Item = (Span, String, String)> {
        self.transitions.iter().map(|line| {
            let TransitionLine { modifiers, expression, .. } = &line.parts;
            let expression =
                crate::document::unquoted(&expression.text).unwrap_or_else(|| expression.text.clone());
            (line.content.span, expression, modifiers.text.clone())
        })
    }

    fn line(&self, number: u32) -> Result<&TransitionLines, EditRefusal> {
        let line = self.transitions.get(number as usize);
        line.ok_or_else(|| EditRefusal::new(format!("the chart has no transition {number}")))
    }

    fn node(&self, number: u32) -> Result<usize, EditRefusal> {
        let is_known = (number as usize) < self.nodes.len();
        is_known
            .then_some(number as usize)
            .ok_or_else(|| EditRefusal::new(format!("the chart has no state {number}")))
    }

    fn set_transition(&self, number: u32, expression: Option<&str>, modifiers: Option<&str>) -> Edits {
        let TransitionLines { parts, content, .. } = self.line(number)?;
        let target = parts.target.span.end;
        let mut edits = Vec::new();
        if let Some(modifiers) = modifiers {
            let modifiers = format!(" {}", on_one_line(modifiers, "modifiers")?);
            edits.push(replacement(
                Span::new(target, parts.modifiers.span.end.max(target)),
                modifiers.trim_end(),
            ));
        }
        if let Some(expression) = expression.map(|text| text.split_whitespace().collect::<Vec<_>>().join(" "))
        {
            let head = parts.modifiers.span.end.max(target);
            edits.push(match (expression.is_empty(), parts.expression.text.is_empty()) {
                (true, _) => replacement(Span::new(head, content.span.end), ""),
                (false, true) => {
                    replacement(Span::new(head, content.span.end), format!(" : {}", value_text(&expression)))
                }
                (false, false) => replacement(parts.expression.span, value_text(&expression)),
            });
        }
        Ok(edits)
    }

    fn add_transition(&self, source: u32, target: u32, expression: &str) -> Edits {
        let paths = NodePaths::new(&self.chart);
        let (source, target) = (paths.shortest(self.node(source)?), paths.shortest(self.node(target)?));
        let expression = match expression.split_whitespace().collect::<Vec<_>>().join(" ") {
            text if text.is_empty() => text,
            text => format!(" : {}", value_text(&text)),
        };
        let line = format!("{source} -> {target}{expression}");
        if let Some(last) = self.transitions.last() {
            return Ok(vec![line_below(self.source, last.end, &format!("{:1$}{line}", "", last.indent))]);
        }
        let ending = line_break(self.source);
        Ok(vec![match self.items("Transitions").last() {
            Some(item) => line_below(self.source, item.span().end, &format!("  {line}")),
            None => {
                let begin = if self.source.ends_with('\n') { "" } else { ending };
                insertion(self.source.len(), format!("{begin}{ending}Transitions:{ending}  {line}{ending}"))
            }
        }])
    }

    fn without_transition(&self, line: &TransitionLines) -> Vec<TextEdit> {
        vec![without_lines(self.source, Span::new(line.content.span.start, line.end))]
    }

    fn rename(&self, number: u32, name: &str) -> Edits {
        let node = self.node(number)?;
        let name = on_one_line(name, "a name")?;
        let (content, old) = (&self.nodes[node].content, &self.chart.nodes[node]);
        let split = last_word(&content.text);
        let written = content.part(0..split);
        let mut edits = vec![match (name.is_empty(), written.text.is_empty()) {
            (true, _) if matches!(old.kind.as_str(), "OR" | "AND" | "BASIC") => {
                return Err(EditRefusal::new("a state needs a name"));
            }
            (true, _) => replacement(Span::new(content.span.start, content.span.start + split), ""),
            (false, true) => insertion(content.span.start, format!("{} ", name_as_text(&name, &old.kind))),
            (false, false) => replacement(written.span, name_as_text(&name, &old.kind)),
        }];
        if text::is_name(&old.name) && text::is_name(&name) {
            let blanked = text::without_comments(self.source);
            let expressions = self.transitions.iter().map(|line| line.parts.expression.span);
            let named = expressions.flat_map(|span| within_expressions(&blanked, span, &old.name));
            edits.extend(named.map(|span| replacement(span, name.as_str())));
        }
        Ok(self.with_paths_kept(edits))
    }

    fn set_state(&self, number: u32, key: &str, value: Option<&str>) -> Edits {
        let node = self.node(number)?;
        let lines = &self.nodes[node];
        let value = value.map(|value| value.split_whitespace().collect::<Vec<_>>().join(" "));
        if key == "kind" {
            let kind = known_kind(value.as_deref().unwrap_or_default())?;
            let split = last_word(&lines.content.text);
            let edits = vec![replacement(lines.content.part(split..lines.content.text.len()).span, kind)];
            return Ok(self.with_paths_kept(edits));
        }
        if !NODE_KEYS.contains(&key) {
            let message = format!("a state has no setting `{key}`");
            return Err(EditRefusal::new(message).with_hint(format!("settings are {}", NODE_KEYS.join(", "))));
        }
        let known = lines.settings.iter().find(|(known, _)| known.text == key);
        Ok(match (known, value.filter(|value| !value.is_empty())) {
            (Some((_, content)), Some(value)) => {
                let blank = if content.text.is_empty() { " " } else { "" };
                vec![replacement(content.span, format!("{blank}{}", value_text(&value)))]
            }
            (Some((key, _)), None) => vec![without_lines(self.source, key.span)],
            (None, Some(value)) => {
                let last = lines.settings.last().map_or(lines.content.span.end, |(key, _)| key.span.end);
                let line = format!("{:1$}{key} = {2}", "", lines.indent + 2, value_text(&value));
                vec![line_below(self.source, last, &line)]
            }
            (None, None) => Vec::new(),
        })
    }

    fn add_state(&self, parent: u32, kind: &str, name: &str) -> Edits {
        let (parent, kind) = (self.node(parent)?, known_kind(kind)?);
        let name = on_one_line(name, "a name")?;
        if !matches!(self.chart.nodes[parent].kind.as_str(), "OR" | "AND") {
            return Err(EditRefusal::new("only a composite has states in it")
                .with_hint("make it an OR or an AND, or choose the state around it"));
        }
        if name.is_empty() && matches!(kind, "OR" | "BASIC") && self.chart.nodes[parent].kind != "AND" {
            return Err(EditRefusal::new("a state needs a name"));
        }
        let child = (0..self.nodes.len()).find(|&node| self.chart.nodes[node].parent == Some(parent));
        let indent = child.map_or(self.nodes[parent].indent + 2, |child| self.nodes[child].indent);
        let line = match name.as_str() {
            "" => format!("{:indent$}{kind}", ""),
            name => format!("{:indent$}{} {kind}", "", name_as_text(name, kind)),
        };
        Ok(self.with_paths_kept(vec![line_below(self.source, self.subtree_end(parent), &line)]))
    }

    fn remove_state(&self, number: u32) -> Edits {
        let node = self.node(number)?;
        if self.chart.nodes[node].parent.is_none() {
            return Err(EditRefusal::new("the chart consists of this state"));
        }
        let span = Span::new(self.nodes[node].content.span.start, self.subtree_end(node));
        let mut edits = vec![without_lines(self.source, span)];
        let ends = |line: &TransitionLines| {
            let number = self.chart.transitions.iter().position(|it| it.position.0 == line.content.span);
            number
                .map(|number| (self.chart.transitions[number].source, self.chart.transitions[number].target))
        };
        for line in &self.transitions {
            if ends(line)
                .is_some_and(|(source, target)| self.is_within(source, node) || self.is_within(target, node))
            {
                edits.extend(self.without_transition(line));
            }
        }
        edits.sort_by_key(|edit| edit.span);
        Ok(self.with_paths_kept(edits))
    }

    fn is_within(&self, node: usize, composite: usize) -> bool {
        std::iter::successors(Some(node), |&node| self.chart.nodes[node].parent).any(|node| node == composite)
    }

    /// The end of the last line of a node and of what is in it.
    fn subtree_end(&self, composite: usize) -> usize {
        let within = (0..self.nodes.len()).filter(|&node| self.is_within(node, composite));
        let ends = within.flat_map(|node| {
            let NodeLines { content, settings, .. } = &self.nodes[node];
            settings.iter().map(|(key, _)| key.span.end).chain([content.span.end])
        });
        line_end(self.source, ends.max().unwrap_or_default())
    }

    fn items(&self, word: &str) -> impl Iterator<Item = &Item> {
        self.document.items.iter().filter(move |item| item.word.text == word)
    }

    /// Adds edits of the paths of transitions that would otherwise name another node, or none.
    fn with_paths_kept(&self, mut edits: Vec<TextEdit>) -> Vec<TextEdit> {
        edits.sort_by_key(|edit| edit.span);
        let text = super::applied(self.source, &edits);
        let changed = ChartText::new(&text);
        let indices: BTreeMap<usize, usize> = changed
            .nodes
            .iter()
            .enumerate()
            .map(|(index, lines)| (lines.content.span.start, index))
            .collect();
        let moved =
            |node: usize| indices.get(&shifted(&edits, self.nodes[node].content.span.start)?).copied();
        let paths = NodePaths::new(&changed.chart);
        let mut more = Vec::new();
        for (line, transition) in self.transitions.iter().zip(&self.chart.transitions) {
            let ends = [(&line.parts.source, transition.source), (&line.parts.target, transition.target)];
            let known = ends.map(|(_, node)| moved(node));
            if shifted(&edits, line.content.span.start).is_none() || known.contains(&None) {
                continue;
            }
            for ((written, _), node) in ends.into_iter().zip(known.into_iter().flatten()) {
                if paths.find(&written.text) != [node] {
                    more.push(replacement(written.span, paths.shortest(node)));
                }
            }
        }
        edits.extend(more);
        edits
    }
}

/// The position of the start of a line's content after edits; `None` if it is removed.
fn shifted(edits: &[TextEdit], at: usize) -> Option<usize> {
    let mut moved = at;
    for edit in edits {
        if edit.span.start < at && at < edit.span.end {
            return None;
        }
        if edit.span.start < at {
            moved = moved + edit.text.len() - (edit.span.end - edit.span.start);
        }
    }
    Some(moved)
}

fn node_lines(document: &ItemDocument, chart: &Iac) -> Vec<NodeLines> {
    let indices: BTreeMap<usize, usize> =
        chart.nodes.iter().enumerate().map(|(index, node)| (node.position.0.start, index)).collect();
    let mut nodes = vec![NodeLines::default(); chart.nodes.len()];
    let mut open: Vec<(usize, usize)> = Vec::new();
    for line in lines(document, "States") {
        open.retain(|(indent, _)| *indent < line.indent);
        match (node_setting(line), indices.get(&line.content.span.start)) {
            (Some(setting), _) => {
                if let Some((_, node)) = open.last() {
                    nodes[*node].settings.push(setting);
                }
            }
            (None, Some(&node)) => {
                nodes[node] =
                    NodeLines { indent: line.indent, content: line.content.clone(), settings: Vec::new() };
                open.push((line.indent, node));
            }
            (None, None) => {}
        }
    }
    nodes
}

fn transition_lines(document: &ItemDocument, chart: &Iac) -> Vec<TransitionLines> {
    let mut found: Vec<TransitionLines> = Vec::new();
    let mut known = chart.transitions.iter().peekable();
    for line in lines(document, "Transitions") {
        let is_next = known.peek().is_some_and(|next| next.position.0 == line.content.span);
        match (transition_line(&line.content).filter(|_| is_next), found.last_mut()) {
            (Some(parts), _) => {
                known.next();
                let (content, end) = (line.content.clone(), line.content.span.end);
                found.push(TransitionLines { indent: line.indent, content, parts, end });
            }
            (None, Some(last)) if line.indent > last.indent => last.end = line.content.span.end,
            _ => {}
        }
    }
    found
}

fn lines<'a>(document: &'a ItemDocument, word: &'a str) -> impl Iterator<Item = &'a Line> {
    document.items.iter().filter(move |item| item.word.text == word).flat_map(|item| &item.lines)
}

fn known_kind(kind: &str) -> Result<&'static str, EditRefusal> {
    KINDS.into_iter().map(kind_word).find(|known| *known == kind).ok_or_else(|| {
        let kinds: Vec<&str> = KINDS.into_iter().map(kind_word).collect();
        EditRefusal::new(format!("`{kind}` is not a kind of node"))
            .with_hint(format!("kinds are {}", kinds.join(", ")))
    })
}

/// A name as it is written before a kind.
fn name_as_text(name: &str, kind: &str) -> String {
    let name = name_of(name, kind).unwrap_or_else(|| name.to_owned());
    name_text(&IacNode { name, kind: kind.to_owned(), ..IacNode::default() })
}
