//! Regions that arrive by themselves, at a JOIN or an exit point: R12, R25.

use yase::statechart::{NodeId, NodeKind, TransitionId};
use yase::{ExitPointArrival, JoinMode};

use super::{StaticPath, Stepper};

/// The arrival of a region.
#[derive(Clone, Copy, PartialEq, Debug)]
pub(crate) struct Arrival {
    pub join: NodeId,
    pub region: NodeId,
    /// The place of the segment that arrives.
    pub segment: usize,
    /// Whether the way goes on from there, since all others have arrived.
    pub passes: bool,
}

impl StaticPath {
    /// The arrival that a way ends with.
    pub(crate) fn arrives(&self) -> Option<Arrival> {
        self.arrival.filter(|arrival| !arrival.passes)
    }
}

impl Stepper<'_> {
    /// The arrival of a path that has reached a node: of a state, and only its first.
    pub(crate) fn arrival(&self, way: &StaticPath, target: NodeId, rest: &[TransitionId]) -> Option<Arrival> {
        let [source] = way.sources[..] else { return None };
        let state = matches!(self.kind(source), NodeKind::Basic | NodeKind::Or | NodeKind::And);
        if !state || !rest.is_empty() || !way.ends.is_empty() || way.arrival.is_some() {
            return None;
        }
        let regions = self.regions_joined_at(target);
        let region = regions.into_iter().find(|&it| it == source || self.is_inside(source, it))?;
        Some(Arrival { join: target, region, segment: way.segments.len() - 1, passes: false })
    }

    /// The regions that have to arrive at a node by themselves.
    fn regions_joined_at(&self, node: NodeId) -> Vec<NodeId> {
        let and = match self.kind(node) {
            NodeKind::Join if self.semantics.join == JoinMode::Each => self.joined_and(node),
            NodeKind::ExitPoint if self.semantics.exit_points == ExitPointArrival::All => self.parent(node),
            _ => return vec![],
        };
        let sources: Vec<NodeId> = self.incoming(node).iter().map(|&id| self.transition(id).source).collect();
        let reached = |region: &NodeId| {
            self.is_region(*region) && sources.iter().any(|&it| it == *region || self.is_inside(it, *region))
        };
        let regions: Vec<NodeId> = self.chart.children(and).iter().copied().filter(reached).collect();
        if self.kind(and) == NodeKind::And && regions.len() > 1 { regions } else { vec![] }
    }

    /// Whether all other regions have arrived, or do so in this micro-step.
    pub(crate) fn others_arrive(&self, arrival: Arrival) -> bool {
        let (join, chosen) = (arrival.join, !self.taken.is_empty());
        let here = |way: &StaticPath, region: NodeId| {
            way.arrives().is_some_and(|it| (it.join, it.region) == (join, region))
        };
        let arrives = |region: NodeId| match chosen {
            true => self.taken.iter().any(|way| here(way, region)),
            false => self.found.iter().any(|(_, way)| here(way, region)),
        };
        let others = self.regions_joined_at(join).into_iter().filter(|&region| region != arrival.region);
        others.into_iter().all(|region| self.arrivals.contains(&(join, region)) || arrives(region))
    }

    /// The arrival with which a way ends though it was to pass: another one did not happen.
    pub(crate) fn ends_early(&self, way: &StaticPath) -> Option<Arrival> {
        way.arrival.filter(|arrival| arrival.passes && !self.others_arrive(*arrival))
    }

    /// Regions that are exited or filled again have to arrive again.
    pub(crate) fn forget_arrivals(&mut self, node: NodeId) {
        self.arrivals.retain(|&(_, region)| region != node);
    }
}
