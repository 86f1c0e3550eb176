//! Selection and conflicts: R7 to R9, R14, R15.

use std::collections::BTreeSet;

use yase::statechart::{NodeId, NodeKind, Statechart, TransitionId};
use yase::{ActivityOnExit, CompletionTrigger, ConflictResolution, Firing, JoinMode, ScopeId};

use super::{Held, Occurrence, Phase, StaticPath, Stepper};
use crate::test_host::TestHost;

/// The trigger for which a micro-step selects transitions.
#[derive(Clone, Copy)]
pub(crate) enum Offer<'a> {
    Nothing,
    /// The completion of a state, for semantics that offer it once.
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

/// Intermediate state of a search for candidates.
#[derive(Default)]
struct CandidateSearch {
    visited: BTreeSet<NodeId>,
    /// Candidates, each with the first leaf it was found for.
    found: Vec<(NodeId, StaticPath)>,
    waiting: Vec<StaticPath>,
    /// Leaves with a transition that waits for running activities.
    noted: BTreeSet<NodeId>,
}

/// The enabled path of highest priority out of a state and, for an event, the first one that
/// running activities block.
#[derive(Clone, Debug, Default)]
pub(crate) struct Selection {
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
    pub(crate) fn leaves_running(&self, path: &StaticPath) -> bool {
        self.semantics.on_exit == ActivityOnExit::Blocks
            && self.exit_set(path).into_iter().any(|node| self.runs(node))
    }

    fn is_locked(&self, path: &StaticPath) -> bool {
        self.semantics.on_exit == ActivityOnExit::Blocks
            && path.sources.iter().any(|&source| self.region_runs(self.region(source)))
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
    fn is_ready(&self, path: &StaticPath, offer: Offer<'_>) -> bool {
        let source = path.sources[0];
        if let Some(arrival) = path.arrival {
            let due = offer.event().is_some() || self.is_complete(source);
            let new = !self.arrivals.contains(&(arrival.join, arrival.region));
            return due && new && self.others_arrive(arrival) == arrival.passes;
        }
        if offer.event().is_some() {
            return true;
        }
        if path.sources.len() > 1 {
            let open = |source| self.leaves_in(source).is_disjoint(&self.closed);
            return path.sources.iter().all(|&source| self.is_complete(source) && open(source));
        }
        if matches!(offer, Offer::Completion) {
            return self.is_complete(source); // it may have become incomplete since
        }
        let leaf = !matches!(self.kind(source), NodeKind::Or | NodeKind::And);
        let guarded = self.expression(path.segments[0]).guard.is_some();
        match self.semantics.eventless {
            CompletionTrigger::AsWritten if leaf || !guarded || path.ends == path.sources => {
                self.is_complete(source)
            }
            CompletionTrigger::AsWritten | CompletionTrigger::Quiescent => self.is_quiet(path, source),
            _ => true,
        }
    }

    /// Whether nothing inside a state can step or runs, except activities that the guarded exit of
    /// a composite may interrupt.
    fn is_quiet(&self, path: &StaticPath, source: NodeId) -> bool {
        let inside = self.active_inside(source);
        let exit = self.expression(path.segments[0]).guard.is_some() && path.ends != path.sources;
        let composite = matches!(self.kind(source), NodeKind::Or | NodeKind::And);
        let may_run = exit && composite && self.interrupts(path);
        let runs = self.runs(source) || inside.iter().any(|&node| self.runs(node));
        let steps = |path: &StaticPath| path.sources.iter().any(|&other| self.is_inside(other, source));
        (may_run || !runs) && !self.found.iter().any(|(_, path)| steps(path))
    }

    /// Whether a pending interruption or, without an event, a held event is about to exit a state.
    pub(crate) fn is_frozen(&self, node: NodeId, with_event: bool) -> bool {
        let pending = self.pending.iter().any(|(path, _)| self.would_leave(path, node));
        let held =
            self.held.iter().any(|Held { paths, .. }| paths.iter().any(|path| self.would_leave(path, node)));
        pending || !with_event && held
    }

    pub(crate) fn select_from(&mut self, node: NodeId, offer: Offer<'_>, host: &mut TestHost) -> Selection {
        let event = offer.event();
        if event.is_none() && self.is_frozen(node, false) {
            return Selection::default();
        }
        let mut selection = Selection::default();
        self.select_among(node, self.outgoing(node), offer, &mut selection, host);
        selection
    }

    fn select_among(
        &mut self,
        node: NodeId,
        list: Vec<TransitionId>,
        offer: Offer<'_>,
        selection: &mut Selection,
        host: &mut TestHost,
    ) {
        let event = offer.event();
        let matching: Vec<TransitionId> = list
            .into_iter()
            .filter(|&id| self.is_triggered(id, event) && self.may_be_drawn(node, id, offer))
            .collect();
        let blocked = &mut selection.blocked;
        selection.found = self.first_path(node, &matching, &mut |me, path, so_far| {
            if so_far.is_some() {
                return me.is_ready(path, offer) && me.guards_hold(path, so_far, host);
            }
            let frozen = path.sources.iter().any(|&node| me.is_frozen(node, true));
            let locked = !me.interrupts(path) && me.is_locked(path);
            if !me.is_ready(path, offer) || !me.guards_hold(path, None, host) {
                return false;
            }
            if frozen || locked || !me.interrupts(path) && me.leaves_running(path) {
                blocked.get_or_insert(path.clone());
                return false;
            }
            true
        });
    }

    /// Whether the chooser may pick a segment: it has no weight, or R15 allows one of its paths.
    fn may_be_drawn(&mut self, node: NodeId, id: TransitionId, offer: Offer<'_>) -> bool {
        let start = StaticPath { sources: vec![node], ..StaticPath::default() };
        self.transition(id).weight.is_none()
            || self.any_path(&start, &[id], &mut |me, path, _| me.is_ready(path, offer))
    }

    /// The candidates, and the paths that wait for running activities.
    pub(crate) fn candidates(
        &mut self,
        offer: Offer<'_>,
        host: &mut TestHost,
    ) -> (Vec<StaticPath>, Vec<StaticPath>) {
        self.begin_micro_step();
        let mut search = CandidateSearch::default();
        self.visit(Statechart::ROOT, offer, &mut search, host);
        let mut found = search.found;
        if self.semantics.firing == Firing::Phases {
            found.sort_by_key(|(leaf, _)| self.position(*leaf)); // as SCXML goes through atomic states
        }
        (found.into_iter().map(|(_, path)| path).collect(), search.waiting)
    }

    /// R7: children before their parent and, since a JOIN takes its sources only when nothing
    /// inside them can step, the content of all sources before the first of them.
    fn visit(&mut self, node: NodeId, offer: Offer<'_>, search: &mut CandidateSearch, host: &mut TestHost) {
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

    /// The other sources of the JOINs that have a state as first source.
    fn joined_with(&self, node: NodeId) -> Vec<NodeId> {
        if self.semantics.join != JoinMode::Together || self.semantics.eventless == CompletionTrigger::Once {
            return vec![];
        }
        let first = |list: &&Vec<NodeId>| list.iter().min_by_key(|it| self.position(**it)) == Some(&node);
        let lists = self.tree.joined.iter().filter(first);
        lists.flatten().copied().filter(|&source| source != node).collect()
    }

    /// Adds the path of a state if one of its active leaves has no candidate yet.
    fn consider(
        &mut self,
        node: NodeId,
        offer: Offer<'_>,
        search: &mut CandidateSearch,
        host: &mut TestHost,
    ) {
        let leaves = self.leaves_in(node);
        let Some(&open) = leaves.difference(&self.closed).min_by_key(|&&leaf| self.position(leaf)) else {
            return;
        };
        if let (Offer::Nothing, CompletionTrigger::Once) = (offer, self.semantics.eventless)
            && self.kind(node) != NodeKind::Start
        {
            return;
        }
        let Selection { found, blocked } = self.select_from(node, offer, host);
        if let Some(path) = blocked.filter(|_| offer.event().is_some())
            && !leaves.is_subset(&search.noted)
        {
            search.noted.extend(&leaves);
            search.waiting.push(path);
        }
        if let Some(path) = found {
            for &source in &path.sources {
                let inside = self.leaves_in(source);
                self.closed.extend(inside);
            }
            self.found.push((node, path.clone()));
            search.found.push((open, path));
        }
    }

    /// The active leaves inside an active state, or the state itself if it is a leaf.
    fn leaves_in(&self, node: NodeId) -> BTreeSet<NodeId> {
        let inside = |leaf: &NodeId| *leaf == node || self.is_inside(*leaf, node);
        self.leaves.iter().copied().filter(inside).collect()
    }

    fn is_nested(&self, inner: &StaticPath, outer: &StaticPath) -> bool {
        inner.sources.iter().any(|&a| outer.sources.iter().any(|&b| self.is_inside(a, b)))
    }

    pub(crate) fn key(&self, path: &StaticPath) -> usize {
        path.sources.iter().map(|&source| self.position(source)).min().unwrap()
    }

    /// Sorts nested paths before those around them, and others in document order.
    pub(crate) fn sort_inner_first(&self, paths: &mut Vec<StaticPath>) {
        paths.sort_by_key(|path| self.key(path));
        let mut sorted: Vec<StaticPath> = vec![];
        while !paths.is_empty() {
            let free = |path: &StaticPath| !paths.iter().any(|other| self.is_nested(other, path));
            let index = paths.iter().position(free).unwrap_or(0);
            sorted.push(paths.remove(index));
        }
        *paths = sorted;
    }

    /// Resolves conflicts: the winners in firing order, and the losers.
    pub(crate) fn resolve(&mut self, candidates: Vec<StaticPath>) -> (Vec<StaticPath>, Vec<StaticPath>) {
        match self.semantics.firing {
            Firing::Phases => self.remove_conflicting(candidates),
            _ => self.strongest(candidates),
        }
    }

    fn strongest(&mut self, mut candidates: Vec<StaticPath>) -> (Vec<StaticPath>, Vec<StaticPath>) {
        self.sort_inner_first(&mut candidates);
        let (mut winners, losers) = self.remove_conflicting(candidates);
        winners.sort_by_key(|path| (!self.stays_inside(path), self.key(path)));
        (winners, losers)
    }

    fn stays_inside(&self, path: &StaticPath) -> bool {
        self.is_internal(path) && self.scope(path) == path.sources[0]
    }

    /// Whether a later candidate preempts an earlier one: it is nested in it, or chosen.
    fn preempts(&mut self, path: &StaticPath, winner: &StaticPath) -> bool {
        self.is_nested(path, winner)
            || !self.is_nested(winner, path)
                && self.semantics.conflict == ConflictResolution::Random
                && self.chooser.pick(2) == 1
    }

    fn conflict(&self, a: &StaticPath, b: &StaticPath) -> bool {
        // regions that arrive at the same node arrive together
        let together = a.arrival.zip(b.arrival).is_some_and(|(a, b)| a.join == b.join);
        !together && !self.exit_set(a).is_disjoint(&self.exit_set(b))
    }

    /// SCXML's `removeConflictingTransitions`.
    fn remove_conflicting(&mut self, candidates: Vec<StaticPath>) -> (Vec<StaticPath>, Vec<StaticPath>) {
        let (mut winners, mut losers): (Vec<StaticPath>, Vec<StaticPath>) = (vec![], vec![]);
        for path in candidates {
            let against: Vec<usize> =
                (0..winners.len()).filter(|&index| self.conflict(&winners[index], &path)).collect();
            if against.iter().all(|&index| self.preempts(&path, &winners[index])) {
                losers.extend(against.iter().map(|&index| winners[index].clone()));
                winners.retain(|winner| !losers.contains(winner));
                winners.push(path);
            } else {
                losers.push(path);
            }
        }
        (winners, losers)
    }
}
