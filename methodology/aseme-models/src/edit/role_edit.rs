//! Edits of the text of a role.

use std::collections::BTreeMap;

use aseme::path::{shortest_path, shortest_transition};
use aseme::refine::refine_placed;
use aseme::srm::{Section, SrmEntry, StateEntry, TransitionEntry};
use aseme::{SrmFile, liveness_to_statechart, text};
use yase::{NodeId, NodeKind, Span, Statechart, TransitionId};

use super::state_reference::{within_expressions, words};
use super::{
    EditRefusal, ModelEdit, TextEdit, insertion, line_below, line_break, line_end, line_start, on_one_line,
    replacement, without_lines,
};

type Edits = Result<Vec<TextEdit>, EditRefusal>;

pub(crate) fn edits(file: &SrmFile, edit: &ModelEdit) -> Edits {
    let role = RoleText::new(file);
    match edit {
        ModelEdit::SetTransition { transition, expression, modifiers } => {
            role.set_transition(*transition, expression.as_deref(), modifiers.as_deref())
        }
        ModelEdit::AddTransition { source, target, expression } => {
            role.add_transition(*source, *target, expression)
        }
        ModelEdit::RemoveTransition { transition } => role.remove_transition(*transition),
        ModelEdit::RenameState { state, name } => role.rename(*state, name),
        ModelEdit::SetState { state, key, value } => role.set_state(*state, key, value.as_deref()),
        ModelEdit::SetEntry { entry, text } => role.set_entry(*entry, text.as_deref()),
        ModelEdit::AddEntry { section, text } => role.add_entry(section, text),
        ModelEdit::AddState { .. } | ModelEdit::RemoveState { .. } => Err(EditRefusal::new(
            "the states of a role are those of its formulas",
        )
        .with_hint("edit the formula, or make a chart of the role: `monas model convert FILE --to text`")),
        ModelEdit::SetField { .. } | ModelEdit::AddItem { .. } | ModelEdit::RemoveItem { .. } => {
            Err(EditRefusal::new("the text of a role has entries, not items"))
        }
    }
}

/// A role with the chart of its formulas.
pub(crate) struct RoleText<'a> {
    file: &'a SrmFile,
    text: &'a str,
    blanked: String,
    /// The chart of the formulas alone; its transitions come first in that of the role.
    plain: Statechart,
    /// The number of transitions of the role.
    transitions: usize,
    /// The entry that applies to each transition.
    placed: BTreeMap<TransitionId, usize>,
}

impl<'a> RoleText<'a> {
    pub(crate) fn new(file: &'a SrmFile) -> RoleText<'a> {
        let (plain, _) = liveness_to_statechart(&file.srm().liveness);
        let mut chart = plain.clone();
        let (placed, _) = refine_placed(&mut chart, &file.srm().transitions);
        let transitions = chart.transitions().count();
        let blanked = text::without_comments(file.text());
        RoleText { file, text: file.text(), blanked, plain, transitions, placed }
    }

    /// The entry that applies to a transition, and whether it is for this one alone.
    pub(crate) fn entry_of(&self, id: TransitionId) -> Option<(&'a TransitionEntry, bool)> {
        let index = *self.placed.get(&id)?;
        let entry = &self.file.srm().transitions[index];
        let is_own =
            self.placed.values().filter(|&&other| other == index).count() == 1 && !entry.has_wildcard();
        Some((entry, is_own))
    }

    pub(crate) fn transition_count(&self) -> u32 {
        self.transitions as u32
    }

    fn transition(&self, number: u32) -> Result<TransitionId, EditRefusal> {
        match (number as usize) < self.transitions {
            true => Ok(TransitionId(number)),
            false => Err(EditRefusal::new(format!("the chart has no transition {number}"))),
        }
    }

    fn node(&self, number: u32) -> Result<NodeId, EditRefusal> {
        match (number as usize) < self.plain.nodes().len() {
            true => Ok(NodeId(number)),
            false => Err(EditRefusal::new("the formulas have no such state")),
        }
    }

    fn set_transition(&self, number: u32, expression: Option<&str>, modifiers: Option<&str>) -> Edits {
        let id = self.transition(number)?;
        let expression = expression.map(|text| on_one_line(text, "an expression")).transpose()?;
        let modifiers = modifiers.map(|text| on_one_line(text, "modifiers")).transpose()?;
        let Some((entry, _)) = self.entry_of(id).filter(|(_, is_own)| *is_own) else {
            // what a wildcard says stays for the parts that are not given
            let known = self.entry_of(id).map(|(entry, _)| (entry, self.file.transition_parts(entry)));
            let part = |span: fn(&aseme::srm::TransitionParts) -> Span| {
                let part = known.as_ref().map(|(_, parts)| span(parts));
                part.map(|part| text::one_line(&self.blanked[part.start..part.end])).unwrap_or_default()
            };
            let expression = expression.unwrap_or_else(|| part(|parts| parts.expression));
            let modifiers = modifiers.unwrap_or_else(|| part(|parts| parts.modifiers));
            if known.is_none() && expression.is_empty() && modifiers.is_empty() {
                return Ok(Vec::new());
            }
            let line = entry_line(&shortest_transition(&self.plain, id), &modifiers, &expression);
            return Ok(self.new_entry(Section::Transitions, &line));
        };
        let parts = self.file.transition_parts(entry);
        let mut edits = Vec::new();
        if let Some(modifiers) = modifiers {
            let also = if entry.also { "also " } else { "" };
            let text = format!(" {also}{modifiers}");
            edits.push(replacement(Span::new(parts.ends.end, parts.modifiers.end), text.trim_end()));
        }
        match (expression, parts.colon) {
            (Some(expression), Some(_)) if !expression.is_empty() => {
                let comments = text::comments_within(self.text, parts.expression);
                if !comments.is_empty() {
                    let ending = line_break(self.text);
                    let lines: String = comments.iter().flat_map(|comment| [*comment, ending]).collect();
                    edits.push(insertion(line_start(self.text, entry.span.start), lines));
                }
                let blank = if parts.expression.start < parts.expression.end { "" } else { " " };
                edits.push(replacement(parts.expression, format!("{blank}{expression}")));
            }
            (Some(_), Some(_)) => {
                edits.push(replacement(
                    Span::new(parts.modifiers.end.max(parts.ends.end), entry.span.end),
                    "",
                ));
            }
            (Some(expression), None) if !expression.is_empty() => {
                edits.push(insertion(entry.span.end, format!(" : {expression}")));
            }
            _ => {}
        }
        Ok(edits)
    }

    fn add_transition(&self, source: u32, target: u32, expression: &str) -> Edits {
        let (source, target) = (self.node(source)?, self.node(target)?);
        let expression = on_one_line(expression, "an expression")?;
        let beside = self.plain.transitions().find(|(_, it)| (it.source, it.target) == (source, target));
        let Some((id, _)) = beside else {
            let (from, to) = (shortest_path(&self.plain, source), shortest_path(&self.plain, target));
            let message = format!("the formulas have no transition from `{from}` to `{to}`");
            let hint = "a role gets further transitions beside those of its formulas; edit the formula, or make a chart \
                        of the role: `monas model convert FILE --to text`";
            return Err(EditRefusal::new(message).with_hint(hint));
        };
        let line = entry_line(&shortest_transition(&self.plain, id), "also", &expression);
        Ok(self.new_entry(Section::Transitions, &line))
    }

    fn remove_transition(&self, number: u32) -> Edits {
        let id = self.transition(number)?;
        match self.entry_of(id) {
            Some((entry, true)) => Ok(vec![without_lines(self.text, entry.span)]),
            Some((entry, false)) => {
                Err(EditRefusal::new(format!("`{}` is for several transitions", entry.text))
                    .with_hint("edit it in the text, or give this transition an expression of its own"))
            }
            None => Err(EditRefusal::new("this transition is made by the formulas")
                .with_hint("edit the formula; the guard `[false]` closes a transition")),
        }
    }

    /// Renames a word of the formulas, there and in the paths of entries.
    fn rename(&self, number: u32, name: &str) -> Edits {
        let node = self.node(number)?;
        let old = self.plain.node(node).name.as_str();
        let name = name.trim();
        if !text::is_name(old) {
            let message =
                format!("`{}` is named by a term of the formulas", shortest_path(&self.plain, node));
            return Err(EditRefusal::new(message).with_hint("edit the formula, or rename the states in it"));
        }
        if !text::is_name(name) || ["START", "END", "CONDITION"].contains(&name) {
            let message = format!("`{name}` is not a name of a state");
            return Err(
                EditRefusal::new(message).with_hint("a name has ASCII letters, digits and underscores")
            );
        }
        let formulas = self.entries(Section::Liveness);
        if formulas.iter().any(|entry| !words(&self.blanked, entry.span, name).is_empty()) {
            return Err(EditRefusal::new(format!("the formulas use the name `{name}` already")));
        }
        let mut spans: Vec<Span> =
            formulas.iter().flat_map(|entry| words(&self.blanked, entry.span, old)).collect();
        for entry in &self.file.srm().transitions {
            let parts = self.file.transition_parts(entry);
            spans.extend(words(&self.blanked, parts.ends, old));
            spans.extend(within_expressions(&self.blanked, parts.expression, old));
        }
        for entry in self.entries(Section::States) {
            spans.extend(words(&self.blanked, self.before_colon(entry.span, false), old));
            spans.extend(within_expressions(&self.blanked, entry.span, old));
        }
        for entry in self.entries(Section::Layout) {
            spans.extend(words(&self.blanked, self.before_colon(entry.span, true), old));
        }
        Ok(spans.into_iter().map(|span| replacement(span, name)).collect())
    }

    fn before_colon(&self, entry: Span, is_last: bool) -> Span {
        let part = &self.blanked[entry.start..entry.end];
        let colon = if is_last { part.rfind(':') } else { part.find(':') };
        Span::new(entry.start, colon.map_or(entry.end, |colon| entry.start + colon))
    }

    fn set_state(&self, number: u32, key: &str, value: Option<&str>) -> Edits {
        let node = self.node(number)?;
        let kind = self.plain.node(node).kind;
        let has_settings = matches!(kind, NodeKind::Basic | NodeKind::Or | NodeKind::And | NodeKind::End);
        if !has_settings || !text::is_name(key) {
            return Err(EditRefusal::new(format!("this node has no setting `{key}`")));
        }
        let value =
            value.map(|value| on_one_line(value, "a value")).transpose()?.filter(|value| !value.is_empty());
        let is_of_node = |entry: &&StateEntry| {
            let mut nodes = self.plain.nodes().filter(|(id, _)| entry.path.matches(&self.plain, *id));
            !entry.path.has_wildcard()
                && nodes.next().is_some_and(|(id, _)| id == node)
                && nodes.next().is_none()
        };
        let Some(entry) = self.file.srm().states.iter().find(is_of_node) else {
            let Some(value) = value else { return Ok(Vec::new()) };
            let line = format!("{} : {key} = {value}", shortest_path(&self.plain, node));
            return Ok(self.new_entry(Section::States, &line));
        };
        let settings = self.file.state_settings(entry.span);
        let index = settings.iter().position(|(known, _)| self.text[known.start..known.end] == *key);
        Ok(match (index, value) {
            (Some(position), Some(value)) => vec![replacement(settings[position].1, value)],
            (None, Some(value)) => vec![insertion(entry.span.end, format!(", {key} = {value}"))],
            (Some(0), None) if settings.len() == 1 => vec![without_lines(self.text, entry.span)],
            (Some(0), None) => vec![replacement(Span::new(settings[0].0.start, settings[1].0.start), "")],
            (Some(index), None) => {
                vec![replacement(Span::new(settings[index - 1].1.end, settings[index].1.end), "")]
            }
            (None, None) => Vec::new(),
        })
    }

    fn set_entry(&self, index: usize, new: Option<&str>) -> Edits {
        let entry = self.file.entries().get(index);
        let entry = entry.ok_or_else(|| EditRefusal::new(format!("the text has no entry {index}")))?;
        let Some(new) = new.map(str::trim).filter(|new| !new.is_empty()) else {
            return Ok(vec![without_lines(self.text, entry.span)]);
        };
        // comments between the lines of an entry are kept above it
        let comments = text::comments_within(self.text, entry.span);
        let mut edits = vec![replacement(entry.span, new)];
        if !comments.is_empty() {
            let ending = line_break(self.text);
            let lines: String = comments.iter().flat_map(|comment| [*comment, ending]).collect();
            edits.push(insertion(line_start(self.text, entry.span.start), lines));
        }
        Ok(edits)
    }

    fn add_entry(&self, section: &str, new: &str) -> Edits {
        let known =
            [Section::Liveness, Section::Constants, Section::Transitions, Section::States, Section::Layout];
        let found = known.into_iter().find(|known| known.word() == section);
        let found =
            found.ok_or_else(|| EditRefusal::new(format!("no section `{section}` has further entries")))?;
        match new.trim() {
            "" => Err(EditRefusal::new("the entry is empty")),
            new => Ok(self.new_entry(found, new)),
        }
    }

    fn entries(&self, section: Section) -> Vec<SrmEntry> {
        self.file.entries().iter().filter(|entry| entry.section == section).copied().collect()
    }

    /// Adds a line at the end of a section, which is made if it is missing.
    fn new_entry(&self, section: Section, line: &str) -> Vec<TextEdit> {
        if let Some(last) = self.entries(section).last() {
            return vec![line_below(self.text, last.span.end, line)];
        }
        if let Some(header) = self.header(section) {
            return vec![line_below(self.text, header, line)];
        }
        let ending = line_break(self.text);
        let mut edits = Vec::new();
        if let Some(first) = self.entries(Section::Liveness).first().filter(|_| !self.has_sections()) {
            edits.push(insertion(line_start(self.text, first.span.start), format!("Liveness:{ending}")));
        }
        let later = [Section::Constants, Section::Transitions, Section::States, Section::Layout];
        let later = later.into_iter().skip_while(|other| *other != section).skip(1);
        let next = later.filter_map(|other| self.header(other)).min();
        edits.push(match next {
            Some(next) => insertion(
                line_start(self.text, next),
                format!("{}:{ending}{line}{ending}{ending}", section.word()),
            ),
            None => {
                let begin = if self.text.is_empty() || self.text.ends_with('\n') { "" } else { ending };
                insertion(
                    self.text.len(),
                    format!("{begin}{ending}{}:{ending}{line}{ending}", section.word()),
                )
            }
        });
        edits
    }

    fn has_sections(&self) -> bool {
        self.header(Section::Liveness).is_some() || self.header(Section::Role).is_some()
    }

    /// A position on the line of a section's header.
    fn header(&self, section: Section) -> Option<usize> {
        let lines = text::lines_of(&self.blanked, Span::new(0, self.blanked.len()));
        let word = format!("{}:", section.word());
        let mut starts = lines.map(|line| text::trimmed(&self.blanked, line).start);
        starts.find(|&start| self.blanked[start..line_end(&self.blanked, start)].starts_with(&word))
    }
}

fn entry_line(ends: &str, modifiers: &str, expression: &str) -> String {
    let modifiers = if modifiers.is_empty() { String::new() } else { format!(" {modifiers}") };
    let expression = if expression.is_empty() { String::new() } else { format!(" : {expression}") };
    format!("{ends}{modifiers}{expression}")
}
