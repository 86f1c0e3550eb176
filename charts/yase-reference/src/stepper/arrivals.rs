//! Separate arrivals of regions at a JOIN or an exit point: R12, R25.

use yase::statechart::{NodeId, NodeKind, TransitionId};
use yase::{ExitPointArrival, JoinMode};

use super::{StaticPath, Stepper};

/// The arrival of a region.
#[derive(Clone, Copy, PartialEq, Debug)]
pub(crate) struct Arrival {
    pub join: NodeId,
    pub region: NodeId,
    /// Index of the segment that arrives.
    pub segment: usize,
    /// Whether the path continues from there because all other regions have arrived.
    pub passes: bool,
}

impl StaticPath {
    /// The arrival at which the path ends.
    pub(crate) fn arrives(&self) -> Option<Arrival> {
        self.arrival.filter(|arrival| !arrival.passes)
    }
}

impl Stepper<'_> {
    /// The arrival of a path at a node; only the first arrival of a path out of a state counts.
    pub(crate) fn arrival(
        &self,
        path: &StaticPath,
        target: NodeId,
        rest: &[TransitionId],
    ) -> Option<Arrival> {
        let [source] = path.sources[..] else { return None };
        let state = matches!(self.kind(source), NodeKind::Basic | NodeKind::Or | NodeKind::And);
        if !state || !rest.is_empty() || !path.ends.is_empty() || path.arrival.is_some() {
            return None;
        }
        let regions = self.regions_joined_at(target);
        let region = regions.into_iter().find(|&it| it == source || self.is_inside(source, it))?;
        Some(Arrival { join: target, region, segment: path.segments.len() - 1, passes: false })
    }

    /// The regions that arrive at a node separately.
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

    /// Whether all other regions have arrived or arrive in this micro-step.
    pub(crate) fn others_arrive(&self, arrival: Arrival) -> bool {
        let (join, chosen) = (arrival.join, !self.taken.is_empty());
        let here = |path: &StaticPath, region: NodeId| {
            path.arrives().is_some_and(|it| (it.join, it.region) == (join, region))
        };
        let arrives = |region: NodeId| match chosen {
            true => self.taken.iter().any(|path| here(path, region)),
            false => self.found.iter().any(|(_, path)| here(path, region)),
        };
        let others = self.regions_joined_at(join).into_iter().filter(|&region| region != arrival.region);
        others.into_iter().all(|region| self.arrivals.contains(&(join, region)) || arrives(region))
    }

    /// The arrival at which a path ends because another expected arrival did not happen.
    pub(crate) fn ends_early(&self, path: &StaticPath) -> Option<Arrival> {
        path.arrival.filter(|arrival| arrival.passes && !self.others_arrive(*arrival))
    }

    /// Forgets the arrivals of a region that is exited or occupied again.
    pub(crate) fn forget_arrivals(&mut self, node: NodeId) {
        self.arrivals.retain(|&(_, region)| region != node);
    }
}
