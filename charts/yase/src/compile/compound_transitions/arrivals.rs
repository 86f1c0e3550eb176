//! Nodes that join regions: JOINs, and exit points that several regions reach.

use std::collections::BTreeSet;

use super::{
    CompoundPath, CompoundPathSearch, ConfigurationChange, JoinSources, PartialPath, PathArrival, PathStart,
    PathVec,
};
use crate::compile::EnablingCondition;
use crate::compile::node_roles::is_state;
use crate::compile::node_span::{self, NodeSpan};
use crate::semantics::{ExitPointArrival, JoinMode};
use crate::statechart::{NodeId, NodeKind};

impl CompoundPathSearch<'_> {
    pub(super) fn number_joins(&mut self) {
        for (id, node) in self.chart.nodes() {
            let found = match node.kind {
                NodeKind::Join => self.joined_sources(id),
                NodeKind::ExitPoint if self.semantics.exit_points == ExitPointArrival::All => {
                    self.joined_regions(id)
                }
                _ => None,
            };
            if let Some(join) = found {
                self.join_numbers.insert(id, self.joins.len());
                self.joins.push(join);
            }
        }
    }

    fn joined_sources(&self, join: NodeId) -> Option<JoinSources> {
        let incoming = &self.roles.incoming[join.0 as usize];
        let sources: Vec<NodeId> = incoming.iter().map(|&id| self.chart.transition(id).source).collect();
        let hull =
            sources.iter().map(|&node| NodeSpan::of(self.layout.index_of(node))).reduce(NodeSpan::with)?;
        let around = node_span::lowest_node(self.chart, self.layout, hull);
        let region = |&node: &NodeId| node_span::child_towards(self.chart, around, node).unwrap_or(node);
        Some(JoinSources { around, regions: sources.iter().map(region).collect(), sources })
    }

    /// The regions from which an exit point is reached, if there are several.
    fn joined_regions(&self, point: NodeId) -> Option<JoinSources> {
        let around = self.chart.node(point).parent?;
        let sources =
            self.roles.incoming[point.0 as usize].iter().map(|&id| self.chart.transition(id).source);
        let regions: BTreeSet<NodeId> = sources.filter_map(|source| self.region_in(around, source)).collect();
        let joins = self.chart.node(around).kind == NodeKind::And && regions.len() > 1;
        let mut regions: Vec<NodeId> = regions.into_iter().collect();
        regions.sort_by_key(|&region| self.layout.rank(self.layout.index_of(region)));
        joins.then_some(JoinSources { around, regions, sources: Vec::new() })
    }

    /// The region of an AND that contains a node.
    fn region_in(&self, and: NodeId, node: NodeId) -> Option<NodeId> {
        let region = node_span::child_towards(self.chart, and, node)?;
        is_state(self.chart.node(region).kind).then_some(region)
    }

    /// The arrival of a path at a node that joins regions, if the path begins at a state in one of
    /// them and has not arrived anywhere else.
    pub(super) fn arrival(
        &self,
        begin: PathStart<'_>,
        target: NodeId,
        path: &PartialPath,
    ) -> Option<PathArrival> {
        let PathStart::States(source, [], _) = begin else { return None };
        if self.chart.node(source).kind == NodeKind::Start {
            return None;
        }
        let is_only = path.arrival.is_none() && path.open.is_empty() && path.ends.is_empty();
        let by_itself =
            self.chart.node(target).kind != NodeKind::Join || self.semantics.join == JoinMode::Each;
        let join = *self.join_numbers.get(&target).filter(|_| is_only && by_itself)?;
        let region = self.region_in(self.joins[join].around, source)?;
        let index = self.joins[join].regions.iter().position(|&other| other == region)?;
        let slot = self.joins[..join].iter().map(|join| join.regions.len()).sum::<usize>() + index;
        Some(PathArrival { join, slot, region, segment: path.segments.len() - 1, passes: false })
    }

    /// A path that ends where its region arrives before others.
    pub(super) fn path_that_arrives(
        &mut self,
        begin: PathStart<'_>,
        arrival: PathArrival,
        path: &PartialPath,
    ) -> Option<CompoundPath> {
        let PathStart::States(source, ..) = begin else { return None };
        self.count += 1;
        Some(CompoundPath {
            segments: path.segments.clone(),
            source,
            others: Vec::new(),
            scope: arrival.region,
            leaves: PathVec::new(),
            region: self.regions[arrival.region.0 as usize],
            condition: self.arrival_condition(path),
            change: ConfigurationChange::Vacates,
            arrival: Some(arrival),
        })
    }

    /// A path without a trigger arrives when its source has completed.
    pub(super) fn arrival_condition(&self, path: &PartialPath) -> Option<EnablingCondition> {
        let first = self.chart.transition(*path.segments.first()?);
        first.expression.trigger.is_none().then_some(EnablingCondition::Completed)
    }
}
