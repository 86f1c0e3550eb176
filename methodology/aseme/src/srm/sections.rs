//! Sections of a role's text.

use yase::diagnostic::nearest;
use yase::{Diagnostic, Span};

use crate::text;

/// A section of a role's text.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Debug)]
pub enum Section {
    /// The role's name.
    Role,
    /// The protocols it takes part in.
    Protocols,
    /// Its formulas.
    Liveness,
    /// Named constants.
    Constants,
    /// Refinements of transitions.
    Transitions,
    /// Refinements of states.
    States,
    /// The layout of states and transitions.
    Layout,
}

impl Section {
    const ALL: [(&'static str, Section); 7] = [
        ("Role", Section::Role),
        ("Protocols", Section::Protocols),
        ("Liveness", Section::Liveness),
        ("Constants", Section::Constants),
        ("Transitions", Section::Transitions),
        ("States", Section::States),
        ("Layout", Section::Layout),
    ];

    /// The word of its header.
    pub fn word(self) -> &'static str {
        Section::ALL.iter().find(|(_, section)| *section == self).map_or("", |(word, _)| word)
    }

    fn named(name: &str) -> Option<Section> {
        Section::ALL.iter().find(|(word, _)| *word == name).map(|(_, section)| *section)
    }

    /// Whether its lines may start with `word:` without being a header.
    fn has_colons(self) -> bool {
        matches!(self, Section::Transitions | Section::States | Section::Layout)
    }
}

/// The sections in order with their bodies; `None` without a header, since the text is then bare
/// formulas.
pub(crate) fn sections(blanked: &str, diagnostics: &mut Vec<Diagnostic>) -> Option<Vec<(Section, Span)>> {
    let mut sections: Vec<(Section, Span)> = Vec::new();
    let mut preamble = Span::new(0, blanked.len());
    let mut found = Vec::new();
    for line in text::lines_of(blanked, Span::new(0, blanked.len())) {
        let current = sections.last().map(|(section, _)| *section);
        let Some((section, name)) = header(blanked, line, current, &mut found) else { continue };
        match sections.last_mut() {
            Some((_, body)) => body.end = line.start,
            None => preamble.end = line.start,
        }
        if sections.iter().any(|(earlier, _)| *earlier == section) {
            found
                .push(Diagnostic::error("E0232", name, "this section is repeated").with_hint("join the two"));
        }
        sections.push((section, Span::new(name.end + 1, blanked.len())));
    }
    if sections.is_empty() {
        return None;
    }
    let before = text::trimmed(blanked, preamble);
    if before.start < before.end {
        found.push(Diagnostic::error("E0236", before, "this precedes the first section"));
    }
    diagnostics.append(&mut found);
    Some(first_of_each(sections))
}

/// The header at the start of a line: the section and the span of its name. A misspelt header is
/// reported and corrected.
fn header(
    blanked: &str,
    line: Span,
    current: Option<Section>,
    found: &mut Vec<Diagnostic>,
) -> Option<(Section, Span)> {
    let (word, rest) = blanked[line.start..line.end].split_once(':')?;
    let name = Span::new(line.start + word.len() - word.trim_start().len(), line.start + word.len());
    let word = word.trim_start();
    if word.is_empty() || !word.bytes().all(|byte| byte.is_ascii_alphabetic()) {
        return None;
    }
    if let Some(section) = Section::named(word) {
        return Some((section, name));
    }
    if current.is_some_and(Section::has_colons) && !rest.trim().is_empty() {
        return None;
    }
    let meant = nearest(word, Section::ALL.iter().map(|(name, _)| *name))?;
    let message = format!("there is no section `{word}`");
    found.push(Diagnostic::error("E0231", name, message).with_hint(format!("did you mean `{meant}:`?")));
    Section::named(meant).map(|section| (section, name))
}

/// Removes repeated sections, which were reported.
fn first_of_each(sections: Vec<(Section, Span)>) -> Vec<(Section, Span)> {
    let mut kept: Vec<(Section, Span)> = Vec::new();
    for (section, body) in sections {
        if !kept.iter().any(|(earlier, _)| *earlier == section) {
            kept.push((section, body));
        }
    }
    kept
}
