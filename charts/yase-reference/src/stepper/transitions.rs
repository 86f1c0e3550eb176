//! Compound transitions: R2, R6, and what a compound would leave.

use std::collections::BTreeSet;

use yase::statechart::{NodeId, NodeKind, Transition, TransitionId};
use yase::{
    CompletionTrigger, ExitOrder, Firing, JoinMode, StructureRules, TerminateExit, TransitionToAncestor,
};

use super::Stepper;
use super::arrive::Arrival;

/// The static part of a compound transition: everything up to the first CHOICE, HISTORY or state on
/// each of its paths.
#[derive(Clone, PartialEq, Debug, Default)]
pub(crate) struct StaticPath {
    pub sources: Vec<NodeId>,
    /// In the order of their effects.
    pub segments: Vec<TransitionId>,
    pub ends: Vec<NodeId>,
    /// Where its region arrives by itself.
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

/// Accepts a complete path or, given a number of segments, an incomplete one.
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

    /// An ENTRY point of an AND with several ways without guards into different regions.
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

    /// Tries segments in their order. Those with weights are drawn, at the place of the first of
    /// them, if there is a draw.
    pub(crate) fn try_each(
        &mut self,
        list: &[TransitionId],
        attempt: &mut dyn FnMut(&mut Stepper<'c>, TransitionId) -> bool,
    ) -> bool {
        let mut drawn = false;
        for &id in list {
            let taken = match self.transition(id).weight {
                None => attempt(self, id),
                Some(_) if !self.chance.draws() => attempt(self, id),
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

    /// A draw is kept for the rest of the micro-step.
    fn draw_one(&mut self, rest: &[TransitionId]) -> TransitionId {
        let weights: Vec<f64> = rest.iter().filter_map(|&id| self.transition(id).weight).collect();
        let id = rest[self.chance.weighted(&weights)];
        self.drawn.push(id);
        id
    }

    /// Follows segments depth-first to the first complete path that is accepted; `open` are those
    /// still to be followed.
    pub(crate) fn follow(&mut self, way: &StaticPath, open: &[TransitionId], accept: Accept<'_, 'c>) -> bool {
        let Some((&segment, rest)) = open.split_first() else { return accept(self, way, None) };
        let mut way = way.clone();
        way.segments.push(segment);
        let target = self.transition(segment).target;
        if let Some(arrival) = self.arrival(&way, target, rest) {
            let stopping = StaticPath { ends: vec![target], arrival: Some(arrival), ..way.clone() };
            way.arrival = Some(Arrival { passes: true, ..arrival });
            return accept(self, &stopping, None) || self.branch(&way, target, rest, accept);
        }
        match self.role(target) {
            Role::Branch => self.branch(&way, target, rest, accept),
            Role::Fork => {
                let mut all = self.outgoing(target);
                all.sort();
                all.extend(rest);
                self.follow(&way, &all, accept)
            }
            Role::Join if !self.is_offered(target, way.sources[0]) => false,
            Role::Join => {
                way.segments = self.incoming(target);
                way.sources = way.segments.iter().map(|&id| self.transition(id).source).collect();
                self.branch(&way, target, rest, accept)
            }
            Role::End => {
                way.ends.push(target);
                self.follow(&way, rest, accept)
            }
        }
    }

    /// Whether any complete path is accepted, regardless of choices.
    pub(crate) fn any_way(
        &mut self,
        way: &StaticPath,
        open: &[TransitionId],
        accept: Accept<'_, 'c>,
    ) -> bool {
        self.without_chance(|me| me.follow(way, open, accept))
    }

    fn without_chance(&mut self, look: impl FnOnce(&mut Stepper<'c>) -> bool) -> bool {
        let (chance, declared) = (self.chance.clone(), crate::chance::Freedom::Declared);
        self.chance = crate::chance::Chance::new(declared);
        let found = look(self);
        self.chance = chance;
        found
    }

    fn branch(
        &mut self,
        way: &StaticPath,
        node: NodeId,
        rest: &[TransitionId],
        accept: Accept<'_, 'c>,
    ) -> bool {
        let out = self.outgoing(node);
        let drawn = self.chance.draws() && out.iter().any(|&id| self.transition(id).weight.is_some());
        if drawn && !self.is_come_by(way, node, rest, accept) {
            return false;
        }
        self.try_each(&out, &mut |me, id| {
            let open = [&[id], rest].concat();
            me.follow(way, &open, accept)
        })
    }

    /// Nothing is drawn at a connector that no open segments reach, on the blackboard of any path
    /// through it.
    fn is_come_by(
        &mut self,
        way: &StaticPath,
        node: NodeId,
        rest: &[TransitionId],
        accept: Accept<'_, 'c>,
    ) -> bool {
        let so_far = way.segments.len();
        self.without_chance(|me| {
            me.branch(way, node, rest, &mut |me, whole, _| accept(me, whole, Some(so_far)))
        })
    }

    /// The first way out of a node that is accepted.
    pub(crate) fn first_way(
        &mut self,
        node: NodeId,
        list: &[TransitionId],
        accept: Accept<'_, 'c>,
    ) -> Option<StaticPath> {
        let start = StaticPath { sources: vec![node], ..StaticPath::default() };
        let mut found = None;
        self.try_each(list, &mut |me, id| {
            me.follow(&start, &[id], &mut |me, way, so_far| {
                let yes = accept(me, way, so_far);
                if yes && so_far.is_none() {
                    found = Some(way.clone());
                }
                yes
            })
        });
        found
    }

    /// The path through a JOIN belongs to its first source; evaluated once, to the source that
    /// completes.
    fn is_offered(&self, join: NodeId, source: NodeId) -> bool {
        let sources = self.incoming(join).into_iter().map(|id| self.transition(id).source);
        self.semantics.eventless == CompletionTrigger::Once
            || sources.min_by_key(|&node| self.position(node)) == Some(source)
    }

    /// The AND that JOINs' sources lie in.
    pub(crate) fn joined_and(&self, join: NodeId) -> NodeId {
        let sources: Vec<NodeId> = self.incoming(join).iter().map(|&id| self.transition(id).source).collect();
        self.lowest_around(&sources, |kind| kind == NodeKind::And)
    }

    pub(crate) fn incoming(&self, node: NodeId) -> Vec<TransitionId> {
        let into = self.chart.transitions().filter(|(_, transition)| transition.target == node);
        into.map(|(id, _)| id).collect()
    }

    /// In UML only the segment out of a state can be internal, and a path that leads out through an
    /// exit point is not.
    pub(crate) fn is_internal(&self, way: &StaticPath) -> bool {
        let internal = |id: &TransitionId| self.transition(*id).internal;
        if self.semantics.structure == StructureRules::Strict {
            return way.segments.iter().any(internal);
        }
        let from_source = |id: &TransitionId| way.sources.contains(&self.transition(*id).source);
        let source = way.sources[0];
        let inside = |node: NodeId| node == source || self.is_inside(node, source);
        let passed = way.segments.iter().map(|&id| self.transition(id).target);
        let passed = passed.filter(|_| self.walks_segments());
        way.segments.iter().any(|id| from_source(id) && internal(id))
            && way.sources.len() == 1
            && self.possible_targets(way).into_iter().chain(passed).all(inside)
    }

    pub(crate) fn is_targetless(&self, way: &StaticPath) -> bool {
        let direct = !self.walks_segments() || way.segments.len() == 1;
        self.is_internal(way) && way.ends == way.sources && direct
    }

    pub(crate) fn walks_segments(&self) -> bool {
        self.semantics.firing == Firing::EachSegment
    }

    pub(crate) fn interrupts(&self, way: &StaticPath) -> bool {
        way.segments.iter().any(|&id| self.transition(id).interrupts)
    }

    /// Where a path may lead to in the end, whatever its CHOICEs say.
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
    pub(crate) fn scope(&self, way: &StaticPath) -> NodeId {
        if self.is_internal(way) {
            return way.sources[0];
        }
        if let [vacated] = self.vacates(way)[..] {
            return vacated;
        }
        let mut all = way.sources.clone();
        all.extend(self.possible_targets(way));
        if self.walks_segments() {
            let passed = way.segments.iter().map(|&id| self.transition(id).target);
            all.extend(passed.filter(|&node| self.is_passed(node)));
        }
        all.extend(way.arrival.map(|arrival| self.parent(arrival.region)));
        self.lowest_around(&all, |kind| kind == NodeKind::Or)
    }

    /// Whether a path goes on from a node.
    fn is_passed(&self, node: NodeId) -> bool {
        let state = matches!(
            self.kind(node),
            NodeKind::Or | NodeKind::And | NodeKind::Basic | NodeKind::End | NodeKind::Start
        );
        !state && self.kind(node) != NodeKind::Terminate && !self.stands_for_composite(node)
    }

    /// An entry point that leads nowhere.
    pub(crate) fn stands_for_composite(&self, node: NodeId) -> bool {
        self.kind(node) == NodeKind::EntryPoint && self.outgoing(node).is_empty()
    }

    /// Where a path may lead, with the connectors on its ways. A TERMINATE at which nothing is
    /// exited counts only if there is nothing else.
    fn possible_targets(&self, way: &StaticPath) -> Vec<NodeId> {
        let counts = |target: &NodeId| {
            self.semantics.terminate == TerminateExit::Source || self.kind(*target) != NodeKind::Terminate
        };
        let behind = |&end: &NodeId| {
            let targets = self.final_targets(end);
            let some: Vec<NodeId> = targets.iter().copied().filter(counts).collect();
            let connectors_only = some.iter().all(|&node| self.is_passed(node) && !self.is_history(node));
            if connectors_only { targets.into_iter().filter(|node| !counts(node)).collect() } else { some }
        };
        way.ends.iter().flat_map(behind).collect()
    }

    fn is_history(&self, node: NodeId) -> bool {
        matches!(self.kind(node), NodeKind::ShallowHistory | NodeKind::DeepHistory)
    }

    /// R13: a way all of whose possible ends are TERMINATE leaves and enters nothing, unless its
    /// source is exited; where it may also lead elsewhere, its scope is that of the other ends.
    pub(crate) fn only_terminates(&self, way: &StaticPath) -> bool {
        let targets = way.ends.iter().flat_map(|&end| self.final_targets(end));
        let mut ends = targets.filter(|&node| !self.is_passed(node) || self.is_history(node));
        self.semantics.terminate == TerminateExit::Nothing
            && way.arrives().is_none()
            && ends.all(|target| self.kind(target) == NodeKind::Terminate)
    }

    pub(crate) fn lowest_around(&self, nodes: &[NodeId], wanted: impl Fn(NodeKind) -> bool) -> NodeId {
        let around = |outer: &NodeId| nodes.iter().all(|&node| self.is_inside(node, *outer));
        self.chart.ancestors(nodes[0]).find(|outer| wanted(self.kind(*outer)) && around(outer)).unwrap()
    }

    /// The composites that stay but lose what is active in them: `uml`'s arrival at a JOIN, and its
    /// way to an active ancestor.
    pub(crate) fn vacates(&self, way: &StaticPath) -> Vec<NodeId> {
        let [end] = way.ends[..] else { return vec![] };
        if let Some(arrival) = way.arrives() {
            return vec![arrival.region];
        }
        if !self.completes_ancestor(way, end) {
            return vec![];
        }
        let around = end;
        match self.kind(around) {
            NodeKind::And => way.sources.iter().map(|&source| self.child_towards(around, source)).collect(),
            _ => vec![around],
        }
    }

    fn completes_ancestor(&self, way: &StaticPath, end: NodeId) -> bool {
        self.semantics.ancestor == TransitionToAncestor::Completed
            && !self.is_internal(way)
            && matches!(self.kind(end), NodeKind::Or | NodeKind::And)
            && way.sources.len() == 1
            && self.is_inside(way.sources[0], end)
            && (!self.walks_segments() || self.stays_beside(way, end))
    }

    /// Whether the connectors of a path lie in the composite that it completes.
    fn stays_beside(&self, way: &StaticPath, end: NodeId) -> bool {
        let vacated = match self.kind(end) {
            NodeKind::And => self.child_towards(end, way.sources[0]),
            _ => end,
        };
        let passed = way.segments.iter().map(|&id| self.transition(id).target);
        passed.filter(|&node| node != end).all(|node| self.is_inside(node, vacated))
    }

    pub(crate) fn child_towards(&self, outer: NodeId, inner: NodeId) -> NodeId {
        self.outward(inner).into_iter().find(|&node| self.chart.node(node).parent == Some(outer)).unwrap()
    }

    /// The active states a way would leave.
    pub(crate) fn exit_set(&self, way: &StaticPath) -> BTreeSet<NodeId> {
        if self.is_targetless(way) || self.only_terminates(way) {
            return BTreeSet::new();
        }
        let mut vacated = self.vacates(way);
        if vacated.is_empty() {
            vacated.push(self.scope(way));
        }
        vacated.into_iter().flat_map(|outer| self.active_inside(outer)).collect()
    }

    /// States in the order they are left.
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

    pub(crate) fn would_leave(&self, way: &StaticPath, node: NodeId) -> bool {
        self.exit_set(way).contains(&node)
    }
}
