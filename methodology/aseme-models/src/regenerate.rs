//! Preservation of refinements when formulas are edited.
//!
//! Entries of a role refer to states by paths. [`comment_out_refinements`] processes a role whose
//! formulas were edited: entries that still match stay unchanged; entries about a composite whose
//! text was edited follow it; each other entry becomes a comment in its place, with the reason and
//! likely candidates. [`apply_refinements`] applies the
//! entries of another model (an older role, a chart that was refined in an editor) to a role;
//! [`transfer_refinements`] copies what only a model file can represent (functionalities,
//! variables, metadata) from an older chart to a newer one.

mod charts;
mod entries;
mod renamed;

use yase::statechart::Layout;
use yase::{Diagnostic, NodeId, NodeKind, Statechart, Transition, TransitionId};

use aseme::path;
use aseme::refine::{self, UnmatchedEntry};
use aseme::srm::{LayoutEntry, Section, SrmEntry, SrmFile, StateEntry, TransitionEntry};
use aseme::{liveness_to_statechart, role_to_statechart};

pub use charts::transfer_refinements;
pub use entries::{entries_of_chart, entries_of_role};

/// A regenerated role: its text, and the entries that were lost.
#[derive(Clone, PartialEq, Debug)]
#[non_exhaustive]
pub struct RegeneratedRole {
    /// The text. Lost entries are comments in it.
    pub text: String,
    /// The number of entries that were kept or applied.
    pub kept: usize,
    /// The entries that no longer match, in order.
    pub lost: Vec<UnmatchedEntry>,
    /// The entries that are about a composite with another name now (E0256).
    pub renamed: Vec<Diagnostic>,
}

/// Turns every entry that no longer matches into a comment in its place.
///
/// # Errors
/// The formulas themselves cannot be expanded, or the file is XMI, which has no comments.
pub fn comment_out_refinements(file: &SrmFile) -> Result<RegeneratedRole, Vec<Diagnostic>> {
    let (chart, found) = liveness_to_statechart(&file.srm().liveness);
    if found.iter().any(Diagnostic::is_error) {
        return Err(found);
    }
    let original: Vec<SrmEntry> = file.entries().iter().copied().filter(is_refinement).collect();
    let given = file.text();
    let (file, renamed) = with_new_names(file, &original, &chart);
    let entries: Vec<SrmEntry> = file.entries().iter().copied().filter(is_refinement).collect();
    let mut lost = unmatched(&file, chart);
    let mut text = file.text().to_owned();
    let mut count = 0;
    // from the end, so that earlier positions stay valid
    for entry in entries.iter().rev() {
        if let Some(unmatched) = lost.iter().find(|it| it.diagnostic.span == entry.span) {
            comment_out(&mut text, entry, unmatched);
            count += 1;
        }
    }
    // positions are those of the file as it was given
    for unmatched in &mut lost {
        let number = entries.iter().position(|entry| entry.span == unmatched.diagnostic.span);
        if let Some(entry) = number.and_then(|number| original.get(number)) {
            unmatched.diagnostic.span = entry.span;
        }
    }
    let text = with_line_ends_of(given, text);
    Ok(RegeneratedRole { text, kept: entries.len() - count, lost, renamed })
}

/// A text with the line ends of the file that it was made from: lines that were added end in CR LF
/// if all lines of the file do.
fn with_line_ends_of(file: &str, text: String) -> String {
    let (lines, ends) = (file.matches('\n').count(), file.matches("\r\n").count());
    match ends > 0 && lines == ends {
        true => text.replace("\r\n", "\n").replace('\n', "\r\n"),
        false => text,
    }
}

/// The entries of a role that do not fit the chart of its formulas.
fn unmatched(file: &SrmFile, mut chart: Statechart) -> Vec<UnmatchedEntry> {
    let srm = file.srm();
    let mut lost = refine::refine(&mut chart, &srm.transitions);
    lost.extend(refine::refine_layout(&mut chart, &srm.layout));
    lost.extend(refine::refine_states(&mut chart, &srm.states));
    lost
}

/// The role with the present names of composites in entries that fit nothing by the names they had,
/// and what was changed.
fn with_new_names(file: &SrmFile, entries: &[SrmEntry], chart: &Statechart) -> (SrmFile, Vec<Diagnostic>) {
    let lost = unmatched(file, chart.clone());
    let is_lost = |entry: &&SrmEntry| {
        lost.iter().any(|it| it.diagnostic.code == "E0250" && it.diagnostic.span == entry.span)
    };
    let mut text = file.text().to_owned();
    let mut found = Vec::new();
    // from the end, so that places before stay true
    for entry in entries.iter().rev().filter(is_lost) {
        if let Some(new) = renamed::with_new_names(file, entry, chart) {
            let span = entry.span.start..entry.span.end;
            found.push(renamed::renamed(entry, &text[span.clone()], &new));
            text.replace_range(span, &new);
        }
    }
    found.reverse();
    (SrmFile::parse(text).0, found)
}

fn is_refinement(entry: &SrmEntry) -> bool {
    matches!(entry.section, Section::Transitions | Section::States | Section::Layout)
}

/// Puts `# ` before each line of an entry, and the reason above it.
fn comment_out(text: &mut String, entry: &SrmEntry, unmatched: &UnmatchedEntry) {
    let (start, end) = (entry.span.start, entry.span.end);
    let comment = comment(&text[start..end], &unmatched.diagnostic);
    text.replace_range(start..end, &comment);
}

/// A text as comments, with the reason above.
fn comment(old: &str, reason: &Diagnostic) -> String {
    let hint = reason.hint.as_ref().map_or(String::new(), |hint| format!("; {hint}"));
    let what = reason.message.rsplit("` ").next().unwrap_or_default();
    let what = if reason.code == "E0250" || reason.code == "E0251" { what } else { reason.message.as_str() };
    let lines: Vec<String> = old.lines().map(|line| format!("# {}", line.trim_end())).collect();
    format!("# lost: this {what}{hint}\n{}", lines.join("\n"))
}

/// Adds the entries of another model to a role. The role's own entries take precedence: an entry
/// that contradicts them, or matches nothing, is lost and becomes a comment at the end.
///
/// # Errors
/// The formulas of the role cannot be expanded, or its own entries do not match and have to be
/// commented out first.
pub fn apply_refinements(
    file: &SrmFile,
    entries: &[(Section, String)],
) -> Result<RegeneratedRole, Vec<Diagnostic>> {
    let (chart, found) = role_to_statechart(file.srm());
    if found.iter().any(Diagnostic::is_error) {
        return Err(found);
    }
    let (plain, _) = liveness_to_statechart(&file.srm().liveness);
    let mut placed = plain.clone();
    refine::refine(&mut placed, &file.srm().transitions);
    refine::refine_layout(&mut placed, &file.srm().layout);
    let mut carrying =
        RefinementTransfer { plain, placed, chart, added: Vec::new(), kept: 0, lost: Vec::new() };
    for (section, text) in entries {
        carrying.entry(*section, text);
    }
    let RefinementTransfer { added, kept, lost, .. } = carrying;
    let mut text = file.text().to_owned();
    for section in entries::TRANSFERRED_SECTIONS {
        let lines: Vec<&str> =
            added.iter().filter(|(of, _)| *of == section).map(|(_, line)| line.as_str()).collect();
        text = entries::inserted(&text, section, &lines);
    }
    for unmatched in &lost {
        let gap = if text.ends_with('\n') { "" } else { "\n" };
        text = format!("{text}{gap}{}\n", comment(&unmatched.text, &unmatched.diagnostic));
    }
    let text = with_line_ends_of(file.text(), text);
    Ok(RegeneratedRole { text, kept, lost, renamed: Vec::new() })
}

struct RefinementTransfer {
    /// The chart of the formulas alone, in which paths are resolved.
    plain: Statechart,
    /// The same with parallel transitions and all positions, to which layout entries refer.
    placed: Statechart,
    /// The chart with the refinements applied so far.
    chart: Statechart,
    added: Vec<(Section, String)>,
    kept: usize,
    lost: Vec<UnmatchedEntry>,
}

impl RefinementTransfer {
    fn entry(&mut self, section: Section, text: &str) {
        let (file, found) =
            SrmFile::parse(format!("Role: r\nLiveness:\nr = a\n{}:\n{text}\n", section.word()));
        let srm = file.srm();
        let errors = found.into_iter().find(Diagnostic::is_error);
        let outcome = match (errors, srm.transitions.first(), srm.states.first(), srm.layout.first()) {
            (Some(error), ..) => {
                Err(Box::new(UnmatchedEntry { text: text.into(), candidates: Vec::new(), diagnostic: error }))
            }
            (None, Some(entry), ..) => self.transition(entry),
            (None, _, Some(entry), _) => self.state(entry),
            (None, _, _, Some(entry)) => self.layout(entry),
            (None, None, None, None) => self.constants(&srm.constants, text),
        };
        match outcome {
            Ok(is_new) => {
                self.kept += 1;
                self.added.extend(is_new.then(|| (section, text.to_owned())));
            }
            Err(unmatched) => self.lost.push(*unmatched),
        }
    }

    /// Whether the entry has to be added; `false` if the role has it already.
    fn transition(&mut self, entry: &TransitionEntry) -> Result<bool, Box<UnmatchedEntry>> {
        let mut scratch = self.plain.clone();
        if let Some(unmatched) = refine::refine(&mut scratch, std::slice::from_ref(entry)).pop() {
            return Err(Box::new(unmatched));
        }
        if entry.also {
            return Ok(self.beside(entry, &scratch));
        }
        let named: Vec<TransitionId> = path::transitions(&self.plain, &entry.source, &entry.target).collect();
        let (mut is_new, mut taken) = (false, None);
        for id in named {
            let (own, wished) = (self.chart.transition(id), scratch.transition(id));
            if transition_content(own) == transition_content(self.plain.transition(id)) {
                is_new = is_new || transition_content(wished) != transition_content(own);
            } else if transition_content(own) != transition_content(wished) && !entry.has_wildcard() {
                taken = Some(path::shortest_transition(&self.plain, id));
            }
        }
        if let Some(taken) = taken {
            return Err(conflict(&entry.text, &taken));
        }
        if is_new {
            refine::refine(&mut self.chart, std::slice::from_ref(entry));
        }
        Ok(is_new)
    }

    /// Whether a parallel transition has to be added; `scratch` already has it.
    fn beside(&mut self, entry: &TransitionEntry, scratch: &Statechart) -> bool {
        let is_there = |wished: &Transition| {
            let same = |own: &Transition| (own.source, own.target) == (wished.source, wished.target);
            // in the refined chart a transition into a composite may lead to its HISTORY
            self.placed
                .transitions()
                .any(|(_, own)| same(own) && transition_content(own) == transition_content(wished))
        };
        let added = scratch.transitions().skip(self.plain.transitions().len());
        let is_new = !added.map(|(_, wished)| wished).all(is_there);
        if is_new {
            refine::refine(&mut self.chart, std::slice::from_ref(entry));
            refine::refine(&mut self.placed, std::slice::from_ref(entry));
        }
        is_new
    }

    /// Whether the layout has to be added; `false` if the role has it already.
    fn layout(&mut self, entry: &LayoutEntry) -> Result<bool, Box<UnmatchedEntry>> {
        let mut scratch = self.placed.clone();
        scratch.layout = Layout::default();
        if let Some(unmatched) = refine::refine_layout(&mut scratch, std::slice::from_ref(entry)).pop() {
            return Err(Box::new(unmatched));
        }
        let own = &mut self.placed.layout;
        let nodes = scratch.layout.frames.iter();
        let taken = nodes.clone().find(|(id, frame)| own.frames.get(id).is_some_and(|own| own != *frame));
        let transitions = scratch.layout.bends.iter();
        let bent = transitions.clone().find(|(id, bends)| own.bends.get(id).is_some_and(|own| own != *bends));
        let taken = taken.map(|(&id, _)| path::shortest_path(&self.plain, id));
        let taken = taken.or(bent.map(|(&id, _)| path::shortest_transition(&scratch, id)));
        if let Some(taken) = taken {
            return Err(conflict(&entry.text, &taken));
        }
        let is_new = nodes.clone().any(|(id, _)| !own.frames.contains_key(id))
            || transitions.clone().any(|(id, _)| !own.bends.contains_key(id));
        own.frames.extend(scratch.layout.frames);
        own.bends.extend(scratch.layout.bends);
        Ok(is_new)
    }

    fn state(&mut self, entry: &StateEntry) -> Result<bool, Box<UnmatchedEntry>> {
        let mut scratch = self.plain.clone();
        if let Some(unmatched) = refine::refine_states(&mut scratch, std::slice::from_ref(entry)).pop() {
            return Err(Box::new(unmatched));
        }
        let ids: Vec<_> =
            self.plain.nodes().map(|(id, _)| id).filter(|&id| entry.path.matches(&self.plain, id)).collect();
        let mut is_new = false;
        for id in ids {
            let (plain, own, wished) = (self.plain.node(id), self.chart.node(id), scratch.node(id));
            if own != wished && own != plain {
                return Err(conflict(&entry.text, &path::shortest_path(&self.plain, id)));
            }
            let (own_history, wished_history) = (history(&self.chart, id), history(&scratch, id));
            if wished_history.is_some() && own_history.is_some() && own_history != wished_history {
                return Err(conflict(&entry.text, &path::shortest_path(&self.plain, id)));
            }
            is_new = is_new || own != wished || own_history != wished_history;
        }
        if is_new {
            refine::refine_states(&mut self.chart, std::slice::from_ref(entry));
        }
        Ok(is_new)
    }

    fn constants(
        &mut self,
        constants: &[yase::statechart::Constant],
        text: &str,
    ) -> Result<bool, Box<UnmatchedEntry>> {
        let Some(constant) = constants.first() else { return Ok(false) };
        match self.chart.constants.iter().find(|own| own.name == constant.name) {
            Some(own) if own.value == constant.value => Ok(false),
            Some(_) => Err(conflict(text, &constant.name)),
            None => {
                self.chart.constants.push(constant.clone());
                Ok(true)
            }
        }
    }
}

/// The content of a transition.
fn transition_content(it: &Transition) -> (String, i32, Option<u64>, [bool; 2]) {
    (it.expression.to_string(), it.priority, it.weight.map(f64::to_bits), [it.interrupts, it.internal])
}

/// The kind of HISTORY of a composite.
fn history(chart: &Statechart, id: NodeId) -> Option<NodeKind> {
    let kinds = chart.children(id).iter().map(|&child| chart.node(child).kind);
    kinds.into_iter().find(|kind| matches!(kind, NodeKind::ShallowHistory | NodeKind::DeepHistory))
}

fn conflict(text: &str, named: &str) -> Box<UnmatchedEntry> {
    let message = format!("`{text}`: the role has another entry for `{named}`");
    let diagnostic =
        Diagnostic::error("E0255", yase::Span::default(), message).with_hint("keep one of the two");
    Box::new(UnmatchedEntry { text: text.into(), candidates: vec![named.into()], diagnostic })
}
