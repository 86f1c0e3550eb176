//! Composites that have another name because their formula was edited.
//!
//! A composite without a formula of its own is called by its text: `(B | C)`. If that becomes
//! `(B | C | E)`, entries about it follow if it can be no other.

use std::collections::BTreeSet;

use aseme::path::Path;
use aseme::srm::{LayoutTarget, SrmEntry, SrmFile};
use aseme::text::{canonical_name, is_name_character};
use yase::{Diagnostic, Statechart};

/// An entry of a role that names composites as they were called before, with their new names; none
/// if it names none, or one of which the new name is not certain.
pub(crate) fn with_new_names(file: &SrmFile, entry: &SrmEntry, chart: &Statechart) -> Option<String> {
    let mut text = file.text()[entry.span.start..entry.span.end].to_owned();
    let old: BTreeSet<&str> =
        paths(file, entry).into_iter().flat_map(|path| path.unknown_names(chart)).collect();
    if old.is_empty() {
        return None;
    }
    for old in old {
        text = with_name(&text, old, new_name(old, chart)?)?;
    }
    Some(text)
}

/// Says that an entry is about a composite with another name.
pub(crate) fn renamed(entry: &SrmEntry, old: &str, new: &str) -> Diagnostic {
    let one_line = |text: &str| text.split_whitespace().collect::<Vec<_>>().join(" ");
    let message = format!("`{}` is now `{}`: the formula was edited", one_line(old), one_line(new));
    Diagnostic::warning("E0256", entry.span, message)
}

fn paths<'f>(file: &'f SrmFile, entry: &SrmEntry) -> Vec<&'f Path> {
    let srm = file.srm();
    let transitions = srm.transitions.iter().filter(|it| it.span == entry.span);
    let states = srm.states.iter().filter(|it| it.span == entry.span);
    let layout = srm.layout.iter().filter(|it| it.span == entry.span);
    let mut paths: Vec<&Path> = transitions.flat_map(|it| [&it.source, &it.target]).collect();
    paths.extend(states.map(|it| &it.path));
    for entry in layout {
        match &entry.of {
            LayoutTarget::State(path) => paths.push(path),
            LayoutTarget::Transition { source, target, .. } => paths.extend([source, target]),
        }
    }
    paths
}

/// The new name of a composite, if exactly one fits: of the same operators, with more names in
/// common than not.
fn new_name<'c>(old: &str, chart: &'c Statechart) -> Option<&'c str> {
    let (outline, names) = (outline(old), leaves(old));
    if outline.is_empty() {
        return None;
    }
    let candidates: BTreeSet<&str> = chart.nodes().map(|(_, node)| node.name.as_str()).collect();
    let mut fitting = candidates.into_iter().filter(|new| {
        let others = leaves(new);
        let (shared, all) = (names.intersection(&others).count(), names.union(&others).count());
        self::outline(new) == outline && 2 * shared > all
    });
    let only = fitting.next()?;
    fitting.next().is_none().then_some(only)
}

/// The operators of a term, each once: what it is around its operands.
fn outline(term: &str) -> BTreeSet<&str> {
    let operators = ["||", "|", ".", "~", "*", "+", "(", "["];
    let single = |operator: &&str| match *operator {
        "|" => term.replace("||", "").contains('|'),
        operator => term.contains(operator),
    };
    operators.into_iter().filter(single).collect()
}

fn leaves(term: &str) -> BTreeSet<&str> {
    term.split(|letter| !is_name_character(letter)).filter(|name| !name.is_empty()).collect()
}

/// A text with another name in all paths that have the old one, however that is spaced.
fn with_name(text: &str, old: &str, new: &str) -> Option<String> {
    let mut replaced = String::with_capacity(text.len());
    let mut at = 0;
    let mut is_found = false;
    while let Some(letter) = text[at..].chars().next() {
        let before = replaced.trim_end();
        let is_asked = before.ends_with("In(");
        let begins = is_asked || before.chars().next_back().is_none_or(|c| "/:>".contains(c));
        match length_of(&text[at..], old).filter(|_| begins) {
            Some(length) if ends_a_name(&text[at + length..], is_asked) => {
                replaced.push_str(new);
                at += length;
                is_found = true;
            }
            _ => {
                replaced.push(letter);
                at += letter.len_utf8();
            }
        }
    }
    is_found.then_some(replaced)
}

/// The length of the name at the beginning of a text.
fn length_of(text: &str, name: &str) -> Option<usize> {
    if text.starts_with(char::is_whitespace) {
        return None;
    }
    let ends = text.char_indices().map(|(at, letter)| at + letter.len_utf8());
    let mut prefixes = ends.map(|end| (end, canonical_name(&text[..end])));
    prefixes
        .find(|(_, prefix)| *prefix == name || !name.starts_with(prefix.as_str()))
        .and_then(|(end, prefix)| (prefix == name).then_some(end))
}

/// Whether a name in a path ends where the text begins: not in the middle of another term.
/// `In(name)` asks for it.
fn ends_a_name(rest: &str, is_asked: bool) -> bool {
    let is_blank = rest.starts_with(char::is_whitespace);
    match rest.trim_start().chars().next() {
        None => true,
        Some(letter) if is_asked => letter == ')',
        Some('/' | '-' | ':' | '!' | '%' | '#') => true,
        Some(letter) => is_blank && is_name_character(letter),
    }
}
