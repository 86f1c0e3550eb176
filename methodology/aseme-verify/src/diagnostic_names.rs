//! Names of states in diagnostics.

use std::collections::BTreeMap;
use std::sync::OnceLock;

use aseme::path;
use yase::statechart::StateNames;
use yase::{NodeId, NodeKind, Statechart, TransitionId};
use yase_export::notation::kind_word;

/// The largest chart whose nodes get the shortest unique path: the search for it is slow in large
/// charts.
const MAX_SEARCHED_NODES: usize = 400;

/// The most characters of a path in a diagnostic. The path of a composite is a whole term of a
/// formula; if it is longer, the [short name](StateNames) is used.
const MAX_PATH_LENGTH: usize = 60;

/// The names of the nodes of a chart in diagnostics, unique in the chart: the shortest path as a
/// role writes it (`Look~`, `decision/CONDITION`) if that is brief, otherwise the short name.
#[derive(Debug)]
pub struct DiagnosticNames {
    chart: Statechart,
    names: OnceLock<StateNames>,
    /// The nodes of a small chart, by name.
    nodes: OnceLock<BTreeMap<String, NodeId>>,
}

impl PartialEq for DiagnosticNames {
    fn eq(&self, other: &DiagnosticNames) -> bool {
        self.chart == other.chart
    }
}

impl DiagnosticNames {
    /// The names of a chart's nodes.
    pub fn new(chart: &Statechart) -> DiagnosticNames {
        DiagnosticNames { chart: chart.clone(), names: OnceLock::new(), nodes: OnceLock::new() }
    }

    fn names(&self) -> &StateNames {
        self.names.get_or_init(|| StateNames::of(&self.chart))
    }

    /// The name of a node.
    pub fn name(&self, node: NodeId) -> String {
        let is_free = |path: &String| self.names().named(path).is_none_or(|other| other == node);
        let brief =
            self.written(node).filter(|path| path.chars().count() <= MAX_PATH_LENGTH && is_free(path));
        brief.unwrap_or_else(|| self.names().name(node).to_owned())
    }

    /// The name of a transition: `decision/START -> Search`.
    pub fn transition(&self, id: TransitionId) -> String {
        self.arrow(id, |node| self.name(node))
    }

    /// The paths of the ends of a transition.
    pub fn transition_path(&self, id: TransitionId) -> String {
        self.arrow(id, |node| self.path(node))
    }

    fn arrow(&self, id: TransitionId, name: impl Fn(NodeId) -> String) -> String {
        let transition = self.chart.transition(id);
        format!("{} -> {}", name(transition.source), name(transition.target))
    }

    /// The node of a name.
    pub fn find(&self, name: &str) -> Option<NodeId> {
        if self.chart.nodes().len() > MAX_SEARCHED_NODES {
            return self.names().named(name);
        }
        let nodes =
            self.nodes.get_or_init(|| self.chart.nodes().map(|(id, _)| (self.name(id), id)).collect());
        nodes.get(name).copied()
    }

    /// The path of a node.
    pub fn path(&self, node: NodeId) -> String {
        self.names().path(node)
    }

    /// The shortest path of a node that a role could write.
    fn written(&self, node: NodeId) -> Option<String> {
        if self.chart.nodes().len() > MAX_SEARCHED_NODES {
            return None;
        }
        if !self.chart.node(node).name.is_empty() || node == Statechart::ROOT {
            return Some(path::shortest_path(&self.chart, node));
        }
        let kind = self.chart.node(node).kind;
        let parent = self.chart.node(node).parent?;
        let is_alike = |id: NodeId| {
            let other = self.chart.node(id);
            other.kind == kind && other.name.is_empty()
        };
        let siblings = self.chart.children(parent);
        let alike: Vec<NodeId> = siblings.iter().copied().filter(|&it| is_alike(it)).collect();
        let number = alike.iter().position(|&it| it == node).map_or(1, |index| index + 1);
        let word = match alike.len() {
            _ if self.chart.node(parent).kind == NodeKind::And => number.to_string(),
            1 => kind_word(kind).to_owned(),
            _ => format!("{}[{number}]", kind_word(kind)),
        };
        let is_alone = self.chart.nodes().filter(|&(id, _)| is_alike(id)).nth(1).is_none();
        Some(if is_alone { word } else { format!("{}/{word}", self.name(parent)) })
    }
}

#[cfg(test)]
mod tests {
    use std::collections::BTreeSet;

    use super::*;

    fn names(chart: &Statechart) -> Vec<String> {
        let names = DiagnosticNames::new(chart);
        let all: Vec<String> = chart.nodes().map(|(id, _)| names.name(id)).collect();
        assert_eq!(all.iter().collect::<BTreeSet<_>>().len(), all.len(), "two of the same name: {all:?}");
        for ((id, _), name) in chart.nodes().zip(&all) {
            assert_eq!(names.find(name), Some(id), "{name} of {all:?}");
        }
        all
    }

    fn chart(formulas: &str) -> Statechart {
        aseme::liveness_to_statechart(&aseme::liveness::parse(formulas).0).0
    }

    #[test]
    fn a_name_is_the_term_of_the_formula_if_that_is_brief() {
        let found = names(&chart("r = Look~ || walk\nwalk = Turn . (Step | Jump)"));
        assert!(
            ["Look~", "walk", "Turn", "Step", "(Step|Jump)/START", "CONDITION"]
                .iter()
                .all(|name| found.contains(&(*name).to_owned())),
            "{found:?}"
        );
        let long = names(&chart(
            "r = (LookForTheBall . WalkToTheBall . TurnToTheGoal . KickTheBall . LookAgain)+ . Rest",
        ));
        assert_eq!(long[2], "1", "{long:?}");
    }

    #[test]
    fn the_names_in_random_charts_are_unique() {
        for seed in 0..300 {
            names(&yase_reference::random::Case::numbered(seed).chart);
        }
    }

    #[test]
    fn the_names_in_the_models_are_unique() {
        let folder = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("../../models");
        let mut charts = 0;
        for file in std::fs::read_dir(folder).unwrap() {
            let path = file.unwrap().path();
            let text = std::fs::read_to_string(&path).unwrap();
            let source = yase::Source::new(path.to_string_lossy(), text);
            if let Ok((chart, _)) = crate::checked_model::chart_and_transition_spans(&source) {
                names(&chart);
                charts += 1;
            }
        }
        assert!(charts >= 4, "{charts} charts");
    }
}
