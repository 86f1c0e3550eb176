//! The mapping of nodes for a migration, with the replacements supplied by the caller.

use std::collections::BTreeMap;
use std::sync::Arc;

use crate::compile::CompiledChart;
use crate::ids::{Activation, ScopeId};
use crate::machine::Machine;
use crate::machine::snapshot::PathTable;
use crate::migrate::Disposition;
use crate::migrate::matching::{self, MismatchReason, NamedChart, NodeMatch};
use crate::statechart::{NodeId, TransitionId, UnknownState};

/// Maps the nodes of an old chart to those of a new one. [`plan`](super::plan()) creates it; the
/// caller may add replacements.
#[derive(Clone, Debug)]
pub struct NodeMapping {
    pub(crate) old: Arc<CompiledChart>,
    pub(crate) new: Arc<CompiledChart>,
    pub(crate) old_paths: PathTable,
    pub(crate) new_paths: PathTable,
    replaced: BTreeMap<NodeId, NodeId>,
    pub(crate) accepts_losses: bool,
    pub(crate) matches: Vec<NodeMatch>,
    pub(crate) segments: Vec<Option<TransitionId>>,
    pub(crate) is_same: bool,
}

/// A text that names no node of a chart, or several.
#[derive(Clone, PartialEq, Eq, Debug, thiserror::Error)]
#[error("in the {chart} chart: {unknown}")]
pub struct UnknownPath {
    chart: &'static str,
    unknown: UnknownState,
}

impl NodeMapping {
    pub(crate) fn new(old: &Arc<CompiledChart>, new: &Arc<CompiledChart>) -> NodeMapping {
        let plan = NodeMapping {
            old: old.clone(),
            new: new.clone(),
            old_paths: PathTable::new(old),
            new_paths: PathTable::new(new),
            replaced: BTreeMap::new(),
            accepts_losses: false,
            matches: Vec::new(),
            segments: Vec::new(),
            is_same: false,
        };
        plan.matched()
    }

    /// Replaces a node of the old chart by one of the new chart: for a state that was removed or
    /// renamed, or is to be replaced by another. Nodes inside the old one are then matched inside
    /// the new one. Both are named by their paths (`chart/outer/inner`), by their short names, or
    /// by as much of the end of either as identifies one node.
    ///
    /// # Errors
    /// If a name fits no node or several.
    pub fn with_replacement(mut self, old: &str, new: &str) -> Result<NodeMapping, UnknownPath> {
        let old = find(&self.old, &self.old_paths, "old", old)?;
        let new = find(&self.new, &self.new_paths, "new", new)?;
        self.replaced.insert(old, new);
        Ok(self.matched())
    }

    /// Accepts the loss of history, timers and events without counterpart. Active states and
    /// running activities are never lost.
    #[must_use]
    pub fn accepting_losses(mut self) -> NodeMapping {
        self.accepts_losses = true;
        self
    }

    /// Whether the charts are equivalent apart from the numbering of nodes: a migration then
    /// changes nothing.
    pub fn is_same(&self) -> bool {
        self.is_same
    }

    /// The counterpart of a node of the old chart.
    pub fn node(&self, old: NodeId) -> Option<NodeId> {
        self.matches.get(old.0 as usize).and_then(|found| found.node())
    }

    /// Every node of the old chart by its path, in numeric order, with its disposition.
    pub fn nodes(&self) -> impl Iterator<Item = (&str, Disposition)> {
        let nodes = self.old.statechart().nodes();
        nodes.map(|(id, _)| (self.old_paths.node(id), self.verdict(id)))
    }

    /// Activations that continue, with their old and new numbers.
    pub(crate) fn activations(
        &self,
        known: impl Iterator<Item = Activation>,
        machine: &Machine,
    ) -> Vec<(Activation, Activation)> {
        let found: BTreeMap<u64, Activation> =
            machine.activations().map(|(activation, _)| (activation.number, activation)).collect();
        known.filter_map(|old| Some((old, *found.get(&old.number)?))).collect()
    }

    /// The scope that continues a scope of the old chart, if there is one.
    pub(crate) fn region(&self, old: ScopeId) -> Option<ScopeId> {
        self.new.region_at(self.node(self.old.region_node(old)?)?)
    }

    pub(crate) fn verdict(&self, old: NodeId) -> Disposition {
        let path = |node| self.new_paths.node(node).to_owned();
        match self.matches.get(old.0 as usize) {
            Some(NodeMatch::Kept(_)) => Disposition::Kept,
            Some(NodeMatch::Moved(node)) => Disposition::Moved(path(*node)),
            Some(NodeMatch::Replaced(node)) => Disposition::Replaced(path(*node)),
            Some(NodeMatch::Gone(MismatchReason::Ambiguous)) => {
                Disposition::Lost("several nodes could be it")
            }
            Some(NodeMatch::Gone(MismatchReason::OtherKind)) => {
                Disposition::Lost("it is of another kind now")
            }
            Some(NodeMatch::Gone(MismatchReason::Missing)) | None => {
                Disposition::Lost("there is nothing like it")
            }
        }
    }

    fn matched(mut self) -> NodeMapping {
        let old = NamedChart { chart: &self.old, paths: &self.old_paths };
        let new = NamedChart { chart: &self.new, paths: &self.new_paths };
        self.matches = matching::nodes(old, new, &self.replaced);
        self.segments = matching::segments(&self.old, &self.new, &self.matches);
        self.is_same = matching::is_same(&self.old, &self.new, &self.matches, &self.segments);
        self
    }
}

fn find(
    chart: &CompiledChart,
    paths: &PathTable,
    which: &'static str,
    path: &str,
) -> Result<NodeId, UnknownPath> {
    let found = paths.find_node(path).map_or_else(|| chart.names().find(path), Ok);
    found.map_err(|unknown| UnknownPath { chart: which, unknown })
}
