//! Compound transitions and the states they exit: R2, R6.

use std::collections::BTreeSet;

use yase::statechart::{NodeId, NodeKind, Transition, TransitionId};
use yase::{
    CompletionTrigger, ExitOrder, Firing, JoinMode, StructureRules, TerminateExit, TransitionToAncestor,
};

use super::Stepper;
use super::arrivals::Arrival;

/// The static part of a compound transition: everything up to the first CHOICE, HISTORY or state on
/// each of its paths.
#[derive(Clone, PartialEq, Debug, Default)]
pub(crate) struct StaticPath {
    pub sources: Vec<NodeId>,
    /// The segments, in the order in which their effects are executed.
    pub segments: Vec<TransitionId>,
    pub ends: Vec<NodeId>,
    /// The JOIN or exit point at which its region arrives alone.
    pub arrival: Option<Arrival>,
}

/// Role of a node in a compound transition.
enum Role {
    /// One of its outgoing segments is taken.
    Branch,
    /// All of its outgoing segments are taken.
    Fork,
    /// Its other incoming segments belong to the compound transition.
    Join,
    /// The static part ends.
    End,
}

/// Predicate for a complete path or, with a number of segments, for an incomplete one.
pub(crate) type Accept<'a, 'c> = &'a mut dyn FnMut(&mut Stepper<'c>, &StaticPath, Option<usize>) -> bool;

impl<'c> Stepper<'c> {
    pub(crate) fn transition(&self, id: TransitionId) -> &'c Transition {
        self.chart.transition(id)
    }

    fn role(&self, node: NodeId) -> Role {
        match self.kind(node) {
            NodeKind::Condition | NodeKind::Junction | NodeKind::ExitPoint => Role::Branch,
            NodeKind::EntryPoint if self.outgoing(node).is_empty() => Role::End,
            NodeKind::EntryPoint if self.is_fork(node) => Role::Fork,
            NodeKind::EntryPoint => Role::Branch,
            NodeKind::Fork => Role::Fork,
            NodeKind::Join if self.semantics.join == JoinMode::Together => Role::Join,
            _ => Role::End,
        }
    }

    /// Whether a node is an ENTRY point of an AND with several unguarded segments into its regions.
    fn is_fork(&self, point: NodeId) -> bool {
        let around = self.parent(point);
        let out = self.outgoing(point);
        let plain = out.iter().all(|&id| self.transition(id).expression.guard.is_none());
        let holding = |&id: &TransitionId| {
            let target = self.transition(id).target;
            self.outward(target).into_iter().find(|&node| self.chart.node(node).parent == Some(around))
        };
        let regions: BTreeSet<Option<NodeId>> = out.iter().map(holding).collect();
        self.kind(around) == NodeKind::And && out.len() > 1 && plain && regions.len() == out.len()
    }

    /// Tries segments in their order. If weights are used, the chooser picks among the weighted
    /// segments at the position of the first of them.
    pub(crate) fn try_each(
        &mut self,
        list: &[TransitionId],
        attempt: &mut dyn FnMut(&mut Stepper<'c>, TransitionId) -> bool,
    ) -> bool {
        let mut drawn = false;
        for &id in list {
            let taken = match self.transition(id).weight {
                None => attempt(self, id),
                Some(_) if !self.chooser.uses_weights() => attempt(self, id),
                Some(_) if drawn => false,
                Some(_) => {
                    drawn = true;
                    let weighted = list.iter().copied().filter(|&id| self.transition(id).weight.is_some());
                    self.draw(weighted.collect(), attempt)
                }
            };
            if taken {
                return true;
            }
        }
        false
    }

    fn draw(
        &mut self,
        mut rest: Vec<TransitionId>,
        attempt: &mut dyn FnMut(&mut Stepper<'c>, TransitionId) -> bool,
    ) -> bool {
        while !rest.is_empty() {
            let id = match self.drawn.iter().position(|id| rest.contains(id)) {
                Some(index) => self.drawn[index],
                None => self.draw_one(&rest),
            };
            rest.retain(|&other| other != id);
            if attempt(self, id) {
                return true;
            }
        }
        false
    }

    /// Picks a weighted segment; the pick holds for the rest of the micro-step.
    fn draw_one(&mut self, rest: &[TransitionId]) -> TransitionId {
        let weights: Vec<f64> = rest.iter().filter_map(|&id| self.transition(id).weight).collect();
        let id = rest[self.chooser.weighted(&weights)];
        self.drawn.push(id);
        id
    }

    /// Follows segments depth-first to the first complete path that is accepted; `open` holds the
    /// segments that remain to be followed.
    pub(crate) fn follow(
        &mut self,
        path: &StaticPath,
        open: &[TransitionId],
        accept: Accept<'_, 'c>,
    ) -> bool {
        let Some((&segment, rest)) = open.split_first() else { return accept(self, path, None) };
        let mut path = path.clone();
        path.segments.push(segment);
        let target = self.transition(segment).target;
        if let Some(arrival) = self.arrival(&path, target, rest) {
            let stopping = StaticPath { ends: vec![target], arrival: Some(arrival), ..path.clone() };
            path.arrival = Some(Arrival { passes: true, ..arrival });
            return accept(self, &stopping, None) || self.branch(&path, target, rest, accept);
        }
        match self.role(target) {
            Role::Branch => self.branch(&path, target, rest, accept),
            Role::Fork => {
                let mut all = self.outgoing(target);
                all.sort();
                all.extend(rest);
                self.follow(&path, &all, accept)
            }
            Role::Join if !self.is_offered(target, path.sources[0]) => false,
            Role::Join => {
                path.segments = self.incoming(target);
                path.sources = path.segments.iter().map(|&id| self.transition(id).source).collect();
                self.branch(&path, target, rest, accept)
            }
            Role::End => {
                path.ends.push(target);
                self.follow(&path, rest, accept)
            }
        }
    }

    /// Whether any complete path is accepted, whatever the chooser picks.
    pub(crate) fn any_path(
        &mut self,
        path: &StaticPath,
        open: &[TransitionId],
        accept: Accept<'_, 'c>,
    ) -> bool {
        self.without_choices(|me| me.follow(path, open, accept))
    }

    fn without_choices(&mut self, look: impl FnOnce(&mut Stepper<'c>) -> bool) -> bool {
        let (chooser, declared) = (self.chooser.clone(), crate::chooser::ChoicePolicy::Declared);
        self.chooser = crate::chooser::ReferenceChooser::new(declared);
        let found = look(self);
        self.chooser = chooser;
        found
    }

    fn branch(
        &mut self,
        path: &StaticPath,
        node: NodeId,
        rest: &[TransitionId],
        accept: Accept<'_, 'c>,
    ) -> bool {
        let out = self.outgoing(node);
        let drawn = self.chooser.uses_weights() && out.iter().any(|&id| self.transition(id).weight.is_some());
        if drawn && !self.is_reached(path, node, rest, accept) {
            return false;
        }
        self.try_each(&out, &mut |me, id| {
            let open = [&[id], rest].concat();
            me.follow(path, &open, accept)
        })
    }

    /// Whether a path that is enabled so far reaches a connector: only there the chooser picks.
    fn is_reached(
        &mut self,
        path: &StaticPath,
        node: NodeId,
        rest: &[TransitionId],
        accept: Accept<'_, 'c>,
    ) -> bool {
        let so_far = path.segments.len();
        self.without_choices(|me| {
            me.branch(path, node, rest, &mut |me, whole, _| accept(me, whole, Some(so_far)))
        })
    }

    /// The first accepted path out of a node.
    pub(crate) fn first_path(
        &mut self,
        node: NodeId,
        list: &[TransitionId],
        accept: Accept<'_, 'c>,
    ) -> Option<StaticPath> {
        let start = StaticPath { sources: vec![node], ..StaticPath::default() };
        let mut found = None;
        self.try_each(list, &mut |me, id| {
            me.follow(&start, &[id], &mut |me, path, so_far| {
                let yes = accept(me, path, so_far);
                if yes && so_far.is_none() {
                    found = Some(path.clone());
                }
                yes
            })
        });
        found
    }

    /// Whether a source offers the path through a JOIN: its first source does, or, if completion
    /// is evaluated once, the source that completes.
    fn is_offered(&self, join: NodeId, source: NodeId) -> bool {
        let sources = self.incoming(join).into_iter().map(|id| self.transition(id).source);
        self.semantics.eventless == CompletionTrigger::Once
            || sources.min_by_key(|&node| self.position(node)) == Some(source)
    }

    /// The AND that contains the sources of a JOIN.
    pub(crate) fn joined_and(&self, join: NodeId) -> NodeId {
        let sources: Vec<NodeId> = self.incoming(join).iter().map(|&id| self.transition(id).source).collect();
        self.lowest_around(&sources, |kind| kind == NodeKind::And)
    }

    pub(crate) fn incoming(&self, node: NodeId) -> Vec<TransitionId> {
        let into = self.chart.transitions().filter(|(_, transition)| transition.target == node);
        into.map(|(id, _)| id).collect()
    }

    /// Whether a transition is internal. In UML only the segment out of a state can be internal,
    /// and a path through an exit point is not.
    pub(crate) fn is_internal(&self, path: &StaticPath) -> bool {
        let internal = |id: &TransitionId| self.transition(*id).internal;
        if self.semantics.structure == StructureRules::Strict {
            return path.segments.iter().any(internal);
        }
        let from_source = |id: &TransitionId| path.sources.contains(&self.transition(*id).source);
        let source = path.sources[0];
        let inside = |node: NodeId| node == source || self.is_inside(node, source);
        let passed = path.segments.iter().map(|&id| self.transition(id).target);
        let passed = passed.filter(|_| self.walks_segments());
        path.segments.iter().any(|id| from_source(id) && internal(id))
            && path.sources.len() == 1
            && self.possible_targets(path).into_iter().chain(passed).all(inside)
    }

    pub(crate) fn is_targetless(&self, path: &StaticPath) -> bool {
        let direct = !self.walks_segments() || path.segments.len() == 1;
        self.is_internal(path) && path.ends == path.sources && direct
    }

    pub(crate) fn walks_segments(&self) -> bool {
        self.semantics.firing == Firing::EachSegment
    }

    pub(crate) fn interrupts(&self, path: &StaticPath) -> bool {
        path.segments.iter().any(|&id| self.transition(id).interrupts)
    }

    /// All possible targets of the paths from a node, for all outcomes of its CHOICEs.
    fn final_targets(&self, node: NodeId) -> Vec<NodeId> {
        match self.kind(node) {
            NodeKind::Choice
            | NodeKind::Condition
            | NodeKind::Junction
            | NodeKind::Fork
            | NodeKind::EntryPoint
            | NodeKind::ExitPoint
                if !self.outgoing(node).is_empty() =>
            {
                let out = self.outgoing(node);
                let own = self.walks_segments().then_some(node);
                own.into_iter()
                    .chain(out.into_iter().flat_map(|id| self.final_targets(self.transition(id).target)))
                    .collect()
            }
            _ => vec![node],
        }
    }

    /// R2
    pub(crate) fn scope(&self, path: &StaticPath) -> NodeId {
        if self.is_internal(path) {
            return path.sources[0];
        }
        if let [vacated] = self.vacates(path)[..] {
            return vacated;
        }
        let mut all = path.sources.clone();
        all.extend(self.possible_targets(path));
        if self.walks_segments() {
            let passed = path.segments.iter().map(|&id| self.transition(id).target);
            all.extend(passed.filter(|&node| self.is_passed(node)));
        }
        all.extend(path.arrival.map(|arrival| self.parent(arrival.region)));
        self.lowest_around(&all, |kind| kind == NodeKind::Or)
    }

    /// Whether a path continues at a node.
    fn is_passed(&self, node: NodeId) -> bool {
        let state = matches!(
            self.kind(node),
            NodeKind::Or | NodeKind::And | NodeKind::Basic | NodeKind::End | NodeKind::Start
        );
        !state && self.kind(node) != NodeKind::Terminate && !self.stands_for_composite(node)
    }

    /// Whether a node is an entry point without segments: it stands for its composite.
    pub(crate) fn stands_for_composite(&self, node: NodeId) -> bool {
        self.kind(node) == NodeKind::EntryPoint && self.outgoing(node).is_empty()
    }

    /// All possible targets of a path and the connectors before them. A TERMINATE that exits
    /// nothing counts only if there is no other target.
    fn possible_targets(&self, path: &StaticPath) -> Vec<NodeId> {
        let counts = |target: &NodeId| {
            self.semantics.terminate == TerminateExit::Source || self.kind(*target) != NodeKind::Terminate
        };
        let behind = |&end: &NodeId| {
            let targets = self.final_targets(end);
            let some: Vec<NodeId> = targets.iter().copied().filter(counts).collect();
            let connectors_only = some.iter().all(|&node| self.is_passed(node) && !self.is_history(node));
            if connectors_only { targets.into_iter().filter(|node| !counts(node)).collect() } else { some }
        };
        path.ends.iter().flat_map(behind).collect()
    }

    fn is_history(&self, node: NodeId) -> bool {
        matches!(self.kind(node), NodeKind::ShallowHistory | NodeKind::DeepHistory)
    }

    /// R13: a path whose only possible targets are TERMINATE exits and enters nothing, unless its
    /// source is exited. With other targets, those determine its scope.
    pub(crate) fn only_terminates(&self, path: &StaticPath) -> bool {
        let targets = path.ends.iter().flat_map(|&end| self.final_targets(end));
        let mut ends = targets.filter(|&node| !self.is_passed(node) || self.is_history(node));
        self.semantics.terminate == TerminateExit::Nothing
            && path.arrives().is_none()
            && ends.all(|target| self.kind(target) == NodeKind::Terminate)
    }

    pub(crate) fn lowest_around(&self, nodes: &[NodeId], wanted: impl Fn(NodeKind) -> bool) -> NodeId {
        let around = |outer: &NodeId| nodes.iter().all(|&node| self.is_inside(node, *outer));
        self.chart.ancestors(nodes[0]).find(|outer| wanted(self.kind(*outer)) && around(outer)).unwrap()
    }

    /// Composites that stay active while their content is exited: by an arrival at a JOIN or a
    /// transition to an active ancestor under `uml`.
    pub(crate) fn vacates(&self, path: &StaticPath) -> Vec<NodeId> {
        let [end] = path.ends[..] else { return vec![] };
        if let Some(arrival) = path.arrives() {
            return vec![arrival.region];
        }
        if !self.completes_ancestor(path, end) {
            return vec![];
        }
        let around = end;
        match self.kind(around) {
            NodeKind::And => path.sources.iter().map(|&source| self.child_towards(around, source)).collect(),
            _ => vec![around],
        }
    }

    fn completes_ancestor(&self, path: &StaticPath, end: NodeId) -> bool {
        self.semantics.ancestor == TransitionToAncestor::Completed
            && !self.is_internal(path)
            && matches!(self.kind(end), NodeKind::Or | NodeKind::And)
            && path.sources.len() == 1
            && self.is_inside(path.sources[0], end)
            && (!self.walks_segments() || self.stays_beside(path, end))
    }

    /// Whether all connectors of a path lie in the composite that the path completes.
    fn stays_beside(&self, path: &StaticPath, end: NodeId) -> bool {
        let vacated = match self.kind(end) {
            NodeKind::And => self.child_towards(end, path.sources[0]),
            _ => end,
        };
        let passed = path.segments.iter().map(|&id| self.transition(id).target);
        passed.filter(|&node| node != end).all(|node| self.is_inside(node, vacated))
    }

    pub(crate) fn child_towards(&self, outer: NodeId, inner: NodeId) -> NodeId {
        self.outward(inner).into_iter().find(|&node| self.chart.node(node).parent == Some(outer)).unwrap()
    }

    /// The active states that a path would exit.
    pub(crate) fn exit_set(&self, path: &StaticPath) -> BTreeSet<NodeId> {
        if self.is_targetless(path) || self.only_terminates(path) {
            return BTreeSet::new();
        }
        let mut vacated = self.vacates(path);
        if vacated.is_empty() {
            vacated.push(self.scope(path));
        }
        vacated.into_iter().flat_map(|outer| self.active_inside(outer)).collect()
    }

    /// States in the order in which they are exited.
    pub(crate) fn in_order_of_exit(&self, set: &BTreeSet<NodeId>) -> Vec<NodeId> {
        fn visit(stepper: &Stepper<'_>, node: NodeId, set: &BTreeSet<NodeId>, out: &mut Vec<NodeId>) {
            for &child in stepper.chart.children(node) {
                visit(stepper, child, set, out);
            }
            if set.contains(&node) {
                out.push(node);
            }
        }
        match self.semantics.exits {
            ExitOrder::Forward => {
                let mut out = vec![];
                visit(self, yase::Statechart::ROOT, set, &mut out);
                out
            }
            _ => self.tree.document.iter().rev().copied().filter(|node| set.contains(node)).collect(),
        }
    }

    pub(crate) fn would_leave(&self, path: &StaticPath, node: NodeId) -> bool {
        self.exit_set(path).contains(&node)
    }
}
