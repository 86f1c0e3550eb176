//! The states of a chart as an enumeration.

use std::collections::{BTreeMap, BTreeSet};

use yase::{NodeId, NodeKind, Statechart};

use super::RustBindings;
use super::code::quoted;
use super::names::identifier;

/// The Rust names of the nodes.
pub(crate) struct GeneratedStates {
    variants: Vec<String>,
    labels: Vec<String>,
}

impl GeneratedStates {
    /// Names each node by the shortest unique end of its path.
    pub(crate) fn new(chart: &Statechart) -> GeneratedStates {
        let segments = segments(chart);
        let path = |node: NodeId| {
            let outwards = std::iter::once(node).chain(chart.ancestors(node));
            outwards.map(|node| segments[node.0 as usize].as_str()).collect::<Vec<&str>>()
        };
        let paths: Vec<Vec<&str>> = chart.nodes().map(|(id, _)| path(id)).collect();
        let mut counts: BTreeMap<&[&str], usize> = BTreeMap::new();
        for path in &paths {
            (1..=path.len()).for_each(|length| *counts.entry(&path[..length]).or_default() += 1);
        }
        let shortest = |path: &Vec<&str>| {
            let length = (1..path.len()).find(|&length| counts.get(&path[..length]) == Some(&1));
            identifier(&path[..length.unwrap_or(path.len())])
        };
        let labels =
            chart.nodes().map(|(id, node)| format!("{}: {}", kind(node.kind), quoted(&chart.path(id))));
        GeneratedStates { variants: paths.iter().map(shortest).collect(), labels: labels.collect() }
    }

    /// The variant of a node.
    pub(crate) fn variant(&self, node: NodeId) -> &str {
        &self.variants[node.0 as usize]
    }

    pub(crate) fn file(&self, words: &RustBindings) -> String {
        let variants: Vec<String> = self
            .labels
            .iter()
            .zip(&self.variants)
            .map(|(label, variant)| format!("    /// {label}\n    {variant},\n"))
            .collect();
        format!(
            "//! The states.\n\nuse {runtime}::NodeId;\n\n\
             /// The nodes of the chart, in its order. Each is named by the shortest unique end of its path.\n\
             #[allow(non_camel_case_types, clippy::upper_case_acronyms)] // names as in the model\n\
             #[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Debug)]\n\
             pub enum State {{\n{variants}}}\n\n\
             impl From<State> for NodeId {{\n    fn from(state: State) -> NodeId {{\n        NodeId(state as u32)\n    }}\n}}\n",
            runtime = words.runtime,
            variants = variants.concat(),
        )
    }
}

/// The last segment of each node's path, numbered if an older sibling has the same.
fn segments(chart: &Statechart) -> Vec<String> {
    let mut segments = vec![String::new(); chart.nodes().len()];
    segments[Statechart::ROOT.0 as usize] = chart.node(Statechart::ROOT).name.clone();
    for (id, _) in chart.nodes() {
        let mut taken = BTreeSet::new();
        for (&child, number) in chart.children(id).iter().zip(1..) {
            let own = segment(chart, child, number);
            let numbered = (2..).map(|count| format!("{own}[{count}]"));
            let free = std::iter::once(own.clone()).chain(numbered).find(|name| !taken.contains(name));
            let free = free.unwrap_or(own);
            taken.insert(free.clone());
            segments[child.0 as usize] = free;
        }
    }
    segments
}

fn segment(chart: &Statechart, node: NodeId, number: usize) -> String {
    match chart.node(node) {
        named if !named.name.is_empty() => named.name.clone(),
        unnamed if matches!(unnamed.kind, NodeKind::Or | NodeKind::And | NodeKind::Basic) => {
            format!("region{number}")
        }
        connector => kind(connector.kind).to_owned(),
    }
}

/// The word for a kind in the list of nodes.
fn kind(kind: NodeKind) -> &'static str {
    match kind {
        NodeKind::Or => "OR",
        NodeKind::And => "AND",
        NodeKind::Basic => "BASIC",
        NodeKind::End => "END",
        NodeKind::Start => "START",
        NodeKind::Condition => "CONDITION",
        NodeKind::Junction => "JUNCTION",
        NodeKind::Choice => "CHOICE",
        NodeKind::Fork => "FORK",
        NodeKind::Join => "JOIN",
        NodeKind::ShallowHistory => "HISTORY",
        NodeKind::DeepHistory => "DEEP_HISTORY",
        NodeKind::Terminate => "TERMINATE",
        NodeKind::EntryPoint => "ENTRY",
        NodeKind::ExitPoint => "EXIT",
    }
}
