//! What a swap would make of each node, and what the caller says of it.

use std::collections::BTreeMap;
use std::sync::Arc;

use crate::chart::{Chart, RegionId};
use crate::host::Activation;
use crate::machine::Machine;
use crate::machine::snapshot::Paths;
use crate::statechart::{NodeId, Statechart, TransitionId};
use crate::swap::Verdict;
use crate::swap::matching::{self, Match, Reason, Side};

/// How an old chart's nodes are found in a new one. It is made by [`plan`](super::plan), and may be told more.
#[derive(Clone, Debug)]
pub struct Plan {
    pub(super) old: Arc<Chart>,
    pub(super) new: Arc<Chart>,
    pub(super) old_paths: Paths,
    pub(super) new_paths: Paths,
    replaced: BTreeMap<NodeId, NodeId>,
    pub(super) accepts_losses: bool,
    pub(super) matches: Vec<Match>,
    pub(super) segments: Vec<Option<TransitionId>>,
    pub(super) is_same: bool,
}

/// A path that names no node of a chart, or several.
#[derive(Clone, PartialEq, Eq, Debug, thiserror::Error)]
#[error("the {chart} chart has no single node `{path}`")]
pub struct UnknownPath {
    chart: &'static str,
    path: String,
}

impl Plan {
    pub(super) fn new(old: &Arc<Chart>, new: &Arc<Chart>) -> Plan {
        let plan = Plan {
            old: old.clone(),
            new: new.clone(),
            old_paths: Paths::new(old),
            new_paths: Paths::new(new),
            replaced: BTreeMap::new(),
            accepts_losses: false,
            matches: Vec::new(),
            segments: Vec::new(),
            is_same: false,
        };
        plan.matched()
    }

    /// Has a node of the new chart stand for one of the old: a state that is gone or has another name, or one that is to be left for
    /// another. What lies in the old one is then looked for in the new one. Paths are whole (`chart/outer/inner`), or as much of their end as
    /// names one node.
    ///
    /// # Errors
    /// If a path names no node or several.
    pub fn with_replacement(mut self, old: &str, new: &str) -> Result<Plan, UnknownPath> {
        let old = find(&self.old, &self.old_paths, "old", old)?;
        let new = find(&self.new, &self.new_paths, "new", new)?;
        self.replaced.insert(old, new);
        Ok(self.matched())
    }

    /// Agrees to the loss of history, timers and events that have no place in the new chart. What is active or runs is never lost.
    #[must_use]
    pub fn accepting_losses(mut self) -> Plan {
        self.accepts_losses = true;
        self
    }

    /// Whether the new chart says what the old one says, however its nodes are numbered: then a swap changes nothing.
    pub fn is_same(&self) -> bool {
        self.is_same
    }

    /// The node of the new chart that a node of the old one is.
    pub fn node(&self, old: NodeId) -> Option<NodeId> {
        self.matches.get(old.0 as usize).and_then(|found| found.node())
    }

    /// Every node of the old chart by its path, in the order of its numbers, with what becomes of it.
    pub fn nodes(&self) -> impl Iterator<Item = (&str, Verdict)> {
        let nodes = self.old.statechart().nodes();
        nodes.map(|(id, _)| (self.old_paths.node(id), self.verdict(id)))
    }

    /// Activations by their numbers before and after, as far as they go on.
    pub(super) fn activations(
        &self,
        known: impl Iterator<Item = Activation>,
        machine: &Machine,
    ) -> Vec<(Activation, Activation)> {
        let found: BTreeMap<u64, Activation> =
            machine.activations().map(|(activation, _)| (activation.number, activation)).collect();
        known.filter_map(|old| Some((old, *found.get(&old.number)?))).collect()
    }

    /// The blackboard that goes on as that of a region, if there is one.
    pub(super) fn region(&self, old: RegionId) -> Option<RegionId> {
        let node = self.node(self.old.region_node(old)?)?;
        self.new.region_of(node).filter(|&region| self.new.region_node(region) == Some(node))
    }

    pub(super) fn verdict(&self, old: NodeId) -> Verdict {
        let path = |node| self.new_paths.node(node).to_owned();
        match self.matches.get(old.0 as usize) {
            Some(Match::Kept(_)) => Verdict::Kept,
            Some(Match::Moved(node)) => Verdict::Moved(path(*node)),
            Some(Match::Replaced(node)) => Verdict::Replaced(path(*node)),
            Some(Match::Gone(Reason::Ambiguous)) => Verdict::Lost("several nodes could be it"),
            Some(Match::Gone(Reason::OtherKind)) => Verdict::Lost("it is of another kind now"),
            Some(Match::Gone(Reason::Missing)) | None => Verdict::Lost("there is nothing like it"),
        }
    }

    fn matched(mut self) -> Plan {
        let old = Side { chart: &self.old, paths: &self.old_paths };
        let new = Side { chart: &self.new, paths: &self.new_paths };
        self.matches = matching::nodes(old, new, &self.replaced);
        self.segments = matching::segments(&self.old, &self.new, &self.matches);
        self.is_same = matching::is_same(&self.old, &self.new, &self.matches, &self.segments);
        self
    }
}

fn find(chart: &Chart, paths: &Paths, which: &'static str, path: &str) -> Result<NodeId, UnknownPath> {
    let statechart: &Statechart = chart.statechart();
    let found = paths.find_node(path).or_else(|| statechart.find(path));
    found.ok_or_else(|| UnknownPath { chart: which, path: path.to_owned() })
}
