//! Identifiers valid in every tool: ASCII letters, digits and underscores.

use std::collections::{BTreeMap, BTreeSet};

use super::notation::kind_word;
use yase::statechart::{NodeId, Statechart};

/// Maximum length; longer names are truncated.
const MAX_LENGTH: usize = 48;

/// A unique identifier for each node of a chart.
///
/// It is derived from the name of the node, or from its parent and its kind; duplicates are
/// numbered. It stays the same when other parts of the chart change.
pub(crate) struct Ids {
    names: Vec<String>,
}

impl Ids {
    pub(crate) fn of(chart: &Statechart) -> Ids {
        let mut names: Vec<String> = Vec::with_capacity(chart.nodes().len());
        let (mut taken, mut counts) = (BTreeSet::new(), BTreeMap::new());
        for (_, node) in chart.nodes() {
            let own = word(&node.name);
            let parent = node.parent.map_or("", |parent| &names[parent.0 as usize]);
            let base = match own.is_empty() {
                true => shortened(&word(&format!("{parent}_{}", kind_word(node.kind)))),
                false => shortened(&own),
            };
            let name = unlike(base, &mut taken, &mut counts);
            names.push(name);
        }
        Ids { names }
    }

    pub(crate) fn of_node(&self, id: NodeId) -> &str {
        &self.names[id.0 as usize]
    }
}

/// The first of `base`, `base_2`, `base_3` and so on that is not taken.
fn unlike(base: String, taken: &mut BTreeSet<String>, counts: &mut BTreeMap<String, usize>) -> String {
    let count = counts.entry(base.clone()).or_insert(0);
    loop {
        *count += 1;
        let name = if *count == 1 { base.clone() } else { format!("{base}_{count}") };
        if taken.insert(name.clone()) {
            return name;
        }
    }
}

fn shortened(word: &str) -> String {
    word[..word.len().min(MAX_LENGTH)].trim_end_matches('_').to_owned()
}

/// Keeps letters and digits, spells out `ω`, and replaces anything between by one underscore.
fn word(name: &str) -> String {
    let mut word = String::new();
    for character in name.chars() {
        match character {
            '~' => word.push_str("_forever_"),
            _ if character.is_ascii_alphanumeric() => word.push(character),
            _ => word.push('_'),
        }
    }
    let parts: Vec<&str> = word.split('_').filter(|part| !part.is_empty()).collect();
    parts.join("_")
}

#[cfg(test)]
mod tests {
    use super::*;
    use yase::statechart::{Node, NodeKind};

    #[test]
    fn names_are_words_and_no_two_are_alike() {
        let mut chart = Statechart::new("a role");
        for name in ["a~", "(a|b)", "a b", "a_b_2", "ωδ", "", "a b", "x".repeat(99).as_str()] {
            chart.add(Statechart::ROOT, Node::new(NodeKind::Basic, name));
        }
        let ids = Ids::of(&chart);
        let expected = ["a_role", "a_forever", "a_b", "a_b_2", "a_b_2_2", "a_role_BASIC", "a_role_BASIC_2"];
        assert_eq!(ids.names[..7], expected);
        assert_eq!(ids.names[7], "a_b_3");
        assert_eq!(ids.names[8].len(), MAX_LENGTH);
    }
}
