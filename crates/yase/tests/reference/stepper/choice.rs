//! What is enabled and who wins: R7 to R9, R14, R15.

use std::cmp::Ordering;
use std::collections::BTreeSet;

use yase::RegionId;
use yase::statechart::{NodeId, NodeKind};

use super::{Occurrence, Phase, Stepper, Way};
use crate::kit::world::World;

impl Stepper<'_> {
    pub(super) fn runs(&self, node: NodeId) -> bool {
        self.jobs.get(&node).is_some_and(|job| matches!(job.phase, Phase::Queued | Phase::Running))
    }

    pub(super) fn region_runs(&self, region: RegionId) -> bool {
        self.jobs.keys().any(|&node| self.runs(node) && self.region(node) == region)
    }

    pub(super) fn leaves_running(&self, way: &Way) -> bool {
        self.exits(way).into_iter().any(|node| self.runs(node))
    }

    pub(super) fn is_complete(&self, node: NodeId) -> bool {
        match self.kind(node) {
            NodeKind::And => self.chart.children(node).iter().all(|&region| self.is_complete(region)),
            NodeKind::Or => self
                .chart
                .children(node)
                .iter()
                .any(|&child| self.active.contains(&child) && self.kind(child) == NodeKind::End),
            _ => self.jobs.get(&node).is_none_or(|job| job.phase == Phase::Done),
        }
    }

    pub(super) fn is_ready(&mut self, way: &Way, world: &mut World) -> bool {
        let (source, target) = (self.source(way), self.target(way));
        let guarded = self.expression(way[0]).guard.is_some();
        if self.is_leaf(source) || !guarded || source == target {
            return self.is_complete(source);
        }
        let inside: Vec<NodeId> = self
            .active_in_document_order()
            .into_iter()
            .filter(|&node| self.is_inside(node, source))
            .collect();
        (self.interrupts(way) || !inside.iter().any(|&node| self.runs(node)))
            && !self.can_step_inside(source, &inside, world)
    }

    pub(super) fn can_step_inside(
        &mut self,
        composite: NodeId,
        inside: &[NodeId],
        world: &mut World,
    ) -> bool {
        let leaves: Vec<NodeId> = inside.iter().copied().filter(|&node| self.is_leaf(node)).collect();
        leaves.into_iter().any(|leaf| {
            let outward: Vec<NodeId> = std::iter::once(leaf)
                .chain(self.chart.ancestors(leaf))
                .take_while(|&node| node != composite)
                .collect();
            outward.into_iter().any(|node| self.judge(node, None, world).0.is_some())
        })
    }

    /// Whether a pending interruption or, without an event, a held event is about to leave a state.
    pub(super) fn is_frozen(&self, node: NodeId, with_event: bool) -> bool {
        let pending = self.pending.iter().any(|(way, _)| self.would_leave(way, node));
        let held = self.held.iter().any(|(_, ways, _)| ways.iter().any(|way| self.would_leave(way, node)));
        pending || !with_event && held
    }

    pub(super) fn would_leave(&self, way: &Way, node: NodeId) -> bool {
        self.exits(way).contains(&node)
    }

    /// The best enabled way out of a state; and, if there is an event, the first that would be but for running activities.
    pub(super) fn judge(
        &mut self,
        node: NodeId,
        occurrence: Option<&Occurrence>,
        world: &mut World,
    ) -> (Option<Way>, Option<Way>) {
        let mut blocked = None;
        if occurrence.is_none() && self.is_frozen(node, false) {
            return (None, None);
        }
        let locked = self.region_runs(self.region(node));
        for way in self.ways(node) {
            if !self.is_triggered(&way, occurrence)
                || occurrence.is_none() && !self.is_ready(&way, world)
                || !self.guards_hold(&way, world)
            {
                continue;
            }
            let frozen = self.is_frozen(node, true);
            if !frozen && (self.interrupts(&way) || !locked && !self.leaves_running(&way)) {
                return (Some(way), blocked);
            }
            if blocked.is_none() {
                blocked = Some(way);
            }
        }
        (None, blocked)
    }

    /// The candidates, and the ways that wait for running activities.
    pub(super) fn candidates(
        &mut self,
        occurrence: Option<&Occurrence>,
        world: &mut World,
    ) -> (Vec<Way>, Vec<Way>) {
        let (mut found, mut waiting): (Vec<Way>, Vec<Way>) = (vec![], vec![]);
        let leaves: Vec<NodeId> =
            self.active_in_document_order().into_iter().filter(|&node| self.is_leaf(node)).collect();
        for leaf in leaves {
            let mut noted = false;
            for node in std::iter::once(leaf).chain(self.chart.ancestors(leaf)) {
                let (enabled, blocked) = self.judge(node, occurrence, world);
                if let Some(way) = blocked
                    && occurrence.is_some()
                    && !noted
                {
                    noted = true;
                    if !waiting.contains(&way) {
                        waiting.push(way);
                    }
                }
                if let Some(way) = enabled {
                    if !found.contains(&way) {
                        found.push(way);
                    }
                    break;
                }
            }
        }
        self.sort_inner_first(&mut waiting);
        (found, waiting)
    }

    /// What is nested before what is around it, else in the order of the document.
    pub(super) fn sort_inner_first(&self, ways: &mut [Way]) {
        ways.sort_by(|a, b| {
            let (a, b) = (self.source(a), self.source(b));
            if self.is_inside(a, b) {
                Ordering::Less
            } else if self.is_inside(b, a) {
                Ordering::Greater
            } else {
                self.position(a).cmp(&self.position(b))
            }
        });
    }

    /// Winners and losers of conflicts.
    pub(super) fn resolve(&self, mut candidates: Vec<Way>) -> (Vec<Way>, Vec<Way>) {
        candidates.sort_by_key(|way| self.position(self.source(way)));
        let mut losers: Vec<Way> = vec![];
        let mut order = candidates.clone();
        self.sort_inner_first(&mut order);
        let mut winners: Vec<Way> = vec![];
        for way in order {
            let exits: BTreeSet<NodeId> = self.exits(&way).into_iter().collect();
            if winners.iter().any(|winner| self.exits(winner).iter().any(|node| exits.contains(node))) {
                losers.push(way);
            } else {
                winners.push(way);
            }
        }
        winners.sort_by_key(|way| (!self.is_internal(way), self.position(self.source(way))));
        (winners, losers)
    }
}
