//! Selection and conflicts: R7 to R9, R14, R15.

use std::collections::BTreeSet;

use yase::statechart::{NodeId, NodeKind, Statechart, TransitionId};
use yase::{ActivityOnExit, CompletionTrigger, ConflictResolution, Firing, JoinMode, ScopeId};

use super::{Held, Occurrence, Phase, StaticPath, Stepper};
use crate::test_host::TestHost;

/// What a micro-step offers to transitions.
#[derive(Clone, Copy)]
pub(crate) enum Offer<'a> {
    Nothing,
    /// The state has completed, which is offered once.
    Completion,
    Event(&'a Occurrence),
}

impl<'a> Offer<'a> {
    pub(crate) fn event(self) -> Option<&'a Occurrence> {
        match self {
            Offer::Event(occurrence) => Some(occurrence),
            _ => None,
        }
    }
}

/// Result of a selection.
#[derive(Default)]
struct Search {
    visited: BTreeSet<NodeId>,
    /// Candidates, and the first leaf that each was found for.
    found: Vec<(NodeId, StaticPath)>,
    waiting: Vec<StaticPath>,
    /// The leaves with a transition that waits.
    noted: BTreeSet<NodeId>,
}

/// The best enabled path out of a state; with an event also the first that running activities
/// block.
#[derive(Clone, Debug, Default)]
pub(crate) struct Judgement {
    pub found: Option<StaticPath>,
    pub blocked: Option<StaticPath>,
}

impl<'c> Stepper<'c> {
    pub(crate) fn runs(&self, node: NodeId) -> bool {
        self.jobs.get(&node).is_some_and(|job| matches!(job.phase, Phase::Queued | Phase::Running))
    }

    pub(crate) fn region_runs(&self, region: ScopeId) -> bool {
        self.jobs.keys().any(|&node| self.runs(node) && self.activity_region(node) == region)
    }

    /// Whether running activities block a path.
    pub(crate) fn leaves_running(&self, way: &StaticPath) -> bool {
        self.semantics.on_exit == ActivityOnExit::Blocks
            && self.exit_set(way).into_iter().any(|node| self.runs(node))
    }

    fn is_locked(&self, way: &StaticPath) -> bool {
        self.semantics.on_exit == ActivityOnExit::Blocks
            && way.sources.iter().any(|&source| self.region_runs(self.region(source)))
    }

    /// R14
    pub(crate) fn is_complete(&self, node: NodeId) -> bool {
        if !self.active.contains(&node) {
            return false;
        }
        match self.kind(node) {
            _ if self.jobs.get(&node).is_some_and(|job| job.phase != Phase::Done) => false,
            _ if self.vacated.contains(&node) => true,
            NodeKind::And => {
                let mut regions = self.chart.children(node).iter().filter(|&&child| self.is_region(child));
                regions.all(|&region| self.is_complete(region))
            }
            NodeKind::Or => {
                let inside = self.active_children(node);
                inside.iter().any(|&child| self.kind(child) == NodeKind::End)
            }
            _ => true,
        }
    }

    /// R15
    fn is_ready(&self, way: &StaticPath, offer: Offer<'_>) -> bool {
        let source = way.sources[0];
        if let Some(arrival) = way.arrival {
            let due = offer.event().is_some() || self.is_complete(source);
            let new = !self.arrivals.contains(&(arrival.join, arrival.region));
            return due && new && self.others_arrive(arrival) == arrival.passes;
        }
        if offer.event().is_some() {
            return true;
        }
        if way.sources.len() > 1 {
            let open = |source| self.leaves_in(source).is_disjoint(&self.closed);
            return way.sources.iter().all(|&source| self.is_complete(source) && open(source));
        }
        if matches!(offer, Offer::Completion) {
            return self.is_complete(source); // it may be complete no more
        }
        let leaf = !matches!(self.kind(source), NodeKind::Or | NodeKind::And);
        let guarded = self.expression(way.segments[0]).guard.is_some();
        match self.semantics.eventless {
            CompletionTrigger::AsWritten if leaf || !guarded || way.ends == way.sources => {
                self.is_complete(source)
            }
            CompletionTrigger::AsWritten | CompletionTrigger::Quiescent => self.is_quiet(way, source),
            _ => true,
        }
    }

    /// Whether nothing inside can step or runs, except what the guarded exit of a composite may
    /// interrupt.
    fn is_quiet(&self, way: &StaticPath, source: NodeId) -> bool {
        let inside = self.active_inside(source);
        let exit = self.expression(way.segments[0]).guard.is_some() && way.ends != way.sources;
        let composite = matches!(self.kind(source), NodeKind::Or | NodeKind::And);
        let may_run = exit && composite && self.interrupts(way);
        let runs = self.runs(source) || inside.iter().any(|&node| self.runs(node));
        let steps = |way: &StaticPath| way.sources.iter().any(|&other| self.is_inside(other, source));
        (may_run || !runs) && !self.found.iter().any(|(_, way)| steps(way))
    }

    /// Whether a pending interruption or, without an event, a held event is about to exit a state.
    pub(crate) fn is_frozen(&self, node: NodeId, with_event: bool) -> bool {
        let pending = self.pending.iter().any(|(way, _)| self.would_leave(way, node));
        let held =
            self.held.iter().any(|Held { ways, .. }| ways.iter().any(|way| self.would_leave(way, node)));
        pending || !with_event && held
    }

    pub(crate) fn judge_ways(&mut self, node: NodeId, offer: Offer<'_>, host: &mut TestHost) -> Judgement {
        let event = offer.event();
        if event.is_none() && self.is_frozen(node, false) {
            return Judgement::default();
        }
        let mut judgement = Judgement::default();
        self.judge_list(node, self.outgoing(node), offer, &mut judgement, host);
        judgement
    }

    fn judge_list(
        &mut self,
        node: NodeId,
        list: Vec<TransitionId>,
        offer: Offer<'_>,
        judgement: &mut Judgement,
        host: &mut TestHost,
    ) {
        let event = offer.event();
        let matching: Vec<TransitionId> = list
            .into_iter()
            .filter(|&id| self.is_triggered(id, event) && self.may_be_drawn(node, id, offer))
            .collect();
        let blocked = &mut judgement.blocked;
        judgement.found = self.first_way(node, &matching, &mut |me, way, so_far| {
            if so_far.is_some() {
                return me.is_ready(way, offer) && me.guards_hold(way, so_far, host);
            }
            let frozen = way.sources.iter().any(|&node| me.is_frozen(node, true));
            let locked = !me.interrupts(way) && me.is_locked(way);
            if !me.is_ready(way, offer) || !me.guards_hold(way, None, host) {
                return false;
            }
            if frozen || locked || !me.interrupts(way) && me.leaves_running(way) {
                blocked.get_or_insert(way.clone());
                return false;
            }
            true
        });
    }

    /// Those with a weight are drawn among if R15 allows one of their ways.
    fn may_be_drawn(&mut self, node: NodeId, id: TransitionId, offer: Offer<'_>) -> bool {
        let start = StaticPath { sources: vec![node], ..StaticPath::default() };
        self.transition(id).weight.is_none()
            || self.any_way(&start, &[id], &mut |me, way, _| me.is_ready(way, offer))
    }

    /// The candidates, and the ways that wait for running activities.
    pub(crate) fn candidates(
        &mut self,
        offer: Offer<'_>,
        host: &mut TestHost,
    ) -> (Vec<StaticPath>, Vec<StaticPath>) {
        self.begin_micro_step();
        let mut search = Search::default();
        self.visit(Statechart::ROOT, offer, &mut search, host);
        let mut found = search.found;
        if self.semantics.firing == Firing::Phases {
            found.sort_by_key(|(leaf, _)| self.position(*leaf)); // as SCXML goes through atomic states
        }
        (found.into_iter().map(|(_, way)| way).collect(), search.waiting)
    }

    /// R7: children before their parent and, since a JOIN takes its sources only when nothing
    /// inside them can step, the content of all sources before the first of them.
    fn visit(&mut self, node: NodeId, offer: Offer<'_>, search: &mut Search, host: &mut TestHost) {
        if !search.visited.insert(node) {
            return;
        }
        let others = if offer.event().is_none() { self.joined_with(node) } else { vec![] };
        for outer in std::iter::once(node).chain(others) {
            for &child in self.chart.children(outer) {
                self.visit(child, offer, search, host);
            }
        }
        if self.active.contains(&node) {
            self.consider(node, offer, search, host);
        }
    }

    /// The other sources of the JOINs whose first source a state is.
    fn joined_with(&self, node: NodeId) -> Vec<NodeId> {
        if self.semantics.join != JoinMode::Together || self.semantics.eventless == CompletionTrigger::Once {
            return vec![];
        }
        let first = |list: &&Vec<NodeId>| list.iter().min_by_key(|it| self.position(**it)) == Some(&node);
        let lists = self.tree.joined.iter().filter(first);
        lists.flatten().copied().filter(|&source| source != node).collect()
    }

    /// A state contributes if from some active leaf outward nothing has been found yet.
    fn consider(&mut self, node: NodeId, offer: Offer<'_>, search: &mut Search, host: &mut TestHost) {
        let leaves = self.leaves_in(node);
        let Some(&open) = leaves.difference(&self.closed).min_by_key(|&&leaf| self.position(leaf)) else {
            return;
        };
        if let (Offer::Nothing, CompletionTrigger::Once) = (offer, self.semantics.eventless)
            && self.kind(node) != NodeKind::Start
        {
            return;
        }
        let Judgement { found, blocked } = self.judge_ways(node, offer, host);
        if let Some(way) = blocked.filter(|_| offer.event().is_some())
            && !leaves.is_subset(&search.noted)
        {
            search.noted.extend(&leaves);
            search.waiting.push(way);
        }
        if let Some(way) = found {
            for &source in &way.sources {
                let inside = self.leaves_in(source);
                self.closed.extend(inside);
            }
            self.found.push((node, way.clone()));
            search.found.push((open, way));
        }
    }

    /// The active leaves inside an active state, which may be one itself.
    fn leaves_in(&self, node: NodeId) -> BTreeSet<NodeId> {
        let inside = |leaf: &NodeId| *leaf == node || self.is_inside(*leaf, node);
        self.leaves.iter().copied().filter(inside).collect()
    }

    fn is_nested(&self, inner: &StaticPath, outer: &StaticPath) -> bool {
        inner.sources.iter().any(|&a| outer.sources.iter().any(|&b| self.is_inside(a, b)))
    }

    pub(crate) fn key(&self, way: &StaticPath) -> usize {
        way.sources.iter().map(|&source| self.position(source)).min().unwrap()
    }

    /// What is nested before what is around it, else in the order of the document.
    pub(crate) fn sort_inner_first(&self, ways: &mut Vec<StaticPath>) {
        ways.sort_by_key(|way| self.key(way));
        let mut sorted: Vec<StaticPath> = vec![];
        while !ways.is_empty() {
            let free = |way: &StaticPath| !ways.iter().any(|other| self.is_nested(other, way));
            let index = ways.iter().position(free).unwrap_or(0);
            sorted.push(ways.remove(index));
        }
        *ways = sorted;
    }

    /// Winners, in the order they fire, and losers of conflicts.
    pub(crate) fn resolve(&mut self, candidates: Vec<StaticPath>) -> (Vec<StaticPath>, Vec<StaticPath>) {
        match self.semantics.firing {
            Firing::Phases => self.remove_conflicting(candidates),
            _ => self.strongest(candidates),
        }
    }

    fn strongest(&mut self, mut candidates: Vec<StaticPath>) -> (Vec<StaticPath>, Vec<StaticPath>) {
        self.sort_inner_first(&mut candidates);
        let (mut winners, losers) = self.remove_conflicting(candidates);
        winners.sort_by_key(|way| (!self.stays_inside(way), self.key(way)));
        (winners, losers)
    }

    fn stays_inside(&self, way: &StaticPath) -> bool {
        self.is_internal(way) && self.scope(way) == way.sources[0]
    }

    /// Whether a later candidate wins against an earlier one: it is nested in it, or chosen.
    fn upsets(&mut self, way: &StaticPath, winner: &StaticPath) -> bool {
        self.is_nested(way, winner)
            || !self.is_nested(winner, way)
                && self.semantics.conflict == ConflictResolution::Random
                && self.chance.pick(2) == 1
    }

    fn conflict(&self, a: &StaticPath, b: &StaticPath) -> bool {
        // regions that arrive in one place do so together
        let together = a.arrival.zip(b.arrival).is_some_and(|(a, b)| a.join == b.join);
        !together && !self.exit_set(a).is_disjoint(&self.exit_set(b))
    }

    /// SCXML's `removeConflictingTransitions`.
    fn remove_conflicting(&mut self, candidates: Vec<StaticPath>) -> (Vec<StaticPath>, Vec<StaticPath>) {
        let (mut winners, mut losers): (Vec<StaticPath>, Vec<StaticPath>) = (vec![], vec![]);
        for way in candidates {
            let against: Vec<usize> =
                (0..winners.len()).filter(|&index| self.conflict(&winners[index], &way)).collect();
            if against.iter().all(|&index| self.upsets(&way, &winners[index])) {
                losers.extend(against.iter().map(|&index| winners[index].clone()));
                winners.retain(|winner| !losers.contains(winner));
                winners.push(way);
            } else {
                losers.push(way);
            }
        }
        (winners, losers)
    }
}
