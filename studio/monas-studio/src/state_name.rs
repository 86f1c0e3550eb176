//! The names of the active states of a drawn chart.

use std::collections::{BTreeMap, BTreeSet};

use serde_json::Value;

/// The states of a chart by its shapes, see [`yase_export::to_picture`].
#[derive(Clone, Default, Debug)]
pub(crate) struct StateNames {
    names: Vec<String>,
    parents: Vec<Option<usize>>,
    /// For each node, whether it is a state that can be active: no pseudostate.
    are_states: Vec<bool>,
    /// For each node, the innermost region around it.
    regions: Vec<usize>,
    /// The region with most states without substates.
    main: usize,
}

impl StateNames {
    pub(crate) fn of(picture: &Value) -> StateNames {
        let nodes = picture["nodes"].as_array().map(Vec::as_slice).unwrap_or_default();
        let kind = |node: usize| nodes.get(node).and_then(|node| node["kind"].as_str()).unwrap_or_default();
        let parents: Vec<Option<usize>> = nodes
            .iter()
            .map(|node| node["parent"].as_u64().and_then(|parent| usize::try_from(parent).ok()))
            .collect();
        let region = |node: usize| {
            let mut around = lineage(&parents, node);
            around.find(|id| parents[*id].is_some_and(|parent| kind(parent) == "AND")).unwrap_or(0)
        };
        let regions: Vec<usize> = (0..nodes.len()).map(region).collect();
        let mut counts: BTreeMap<usize, usize> = BTreeMap::new();
        for node in (0..nodes.len()).filter(|node| kind(*node) == "BASIC") {
            *counts.entry(regions[node]).or_default() += 1;
        }
        let main = counts.iter().max_by_key(|(region, count)| (**count, usize::MAX - **region));
        StateNames {
            names: nodes.iter().map(|node| node["name"].as_str().unwrap_or_default().to_owned()).collect(),
            are_states: (0..nodes.len()).map(|node| matches!(kind(node), "BASIC" | "OR" | "AND")).collect(),
            main: main.map_or(0, |(region, _)| *region),
            parents,
            regions,
        }
    }

    /// The last words of the names of active states without active substates: of the one in the
    /// main region, and of all.
    pub(crate) fn active(&self, active: &BTreeSet<u32>) -> (String, Vec<String>) {
        let nodes: BTreeSet<usize> = active.iter().map(|node| *node as usize).collect();
        let nodes: BTreeSet<usize> =
            nodes.into_iter().filter(|node| self.are_states.get(*node) == Some(&true)).collect();
        let around: BTreeSet<usize> =
            nodes.iter().flat_map(|node| lineage(&self.parents, *node).skip(1)).collect();
        let leaves: Vec<usize> = nodes.difference(&around).copied().collect();
        let main = leaves.iter().find(|leaf| self.regions[**leaf] == self.main).or(leaves.first());
        let word = |node: &usize| last_word(&self.names[*node]).to_owned();
        (main.map(word).unwrap_or_default(), leaves.iter().map(word).collect())
    }
}

/// A node and those around it, outwards.
fn lineage(parents: &[Option<usize>], node: usize) -> impl Iterator<Item = usize> {
    let outwards = std::iter::successors(Some(node), |node| parents.get(*node).copied().flatten());
    // A circle of parents would not end.
    outwards.take(parents.len()).filter(|node| *node < parents.len())
}

/// The last part of a short name; the whole name if that part is only a number.
fn last_word(name: &str) -> &str {
    let word = name.rsplit('/').next().unwrap_or(name);
    if word.chars().all(|letter| letter.is_ascii_digit() || letter == '#') { name } else { word }
}

#[cfg(test)]
mod tests {
    use serde_json::json;

    use super::*;

    fn node(kind: &str, name: &str, parent: Option<u32>) -> Value {
        json!({"kind": kind, "name": name, "parent": parent})
    }

    #[test]
    fn the_region_with_most_states_names_the_chart() {
        let nodes = [
            node("AND", "player", None),
            node("OR", "sense", Some(0)),
            node("BASIC", "sense/Vision", Some(1)),
            node("OR", "decide", Some(0)),
            node("BASIC", "decide/Search", Some(3)),
            node("BASIC", "decide/Kick", Some(3)),
            node("START", "decide/1", Some(3)),
        ];
        let names = StateNames::of(&json!({"nodes": nodes}));
        let active = |nodes: &[u32]| names.active(&nodes.iter().copied().collect());
        assert_eq!(active(&[0, 1, 2, 3, 5]), ("Kick".into(), vec!["Vision".into(), "Kick".into()]));
        // between two states of the region the composite is the innermost
        assert_eq!(active(&[0, 1, 2, 3, 6]), ("decide".into(), vec!["Vision".into(), "decide".into()]));
        assert_eq!(active(&[]), (String::new(), Vec::new()));
        assert_eq!(active(&[99]), (String::new(), Vec::new()));
        assert_eq!(StateNames::of(&Value::Null).active(&[0].into()), (String::new(), Vec::new()));
    }
}
