//! Every complete way out of every state and out of every connector at which it is decided late: compound transitions, in the order in
//! which they are tried.

use std::collections::{BTreeMap, BTreeSet};

use smallvec::{SmallVec, smallvec};

use crate::chart::roles::{Role, Roles};
use crate::chart::scope::{self, Hull};
use crate::chart::{Condition, Layout, RegionId};
use crate::diagnostic::{Diagnostic, Span};
use crate::semantics::{ActiveAncestor, Eventless, Joining, SegmentOrder, Semantics};
use crate::statechart::{NodeId, NodeKind, Statechart, TransitionId};

/// A chart with more compound transitions is refused: connectors that fan out and in again multiply.
const MAX_WAYS: usize = 1_000_000;

/// Most ways are one segment long: such lists need no memory of their own.
pub(super) type Few<T> = SmallVec<[T; 2]>;

/// One compound transition, or the part of one that is decided on late.
#[derive(Clone, Debug)]
pub(super) struct Way {
    pub(super) segments: Few<TransitionId>,
    pub(super) source: NodeId,
    /// The further sources of a JOIN.
    pub(super) others: Vec<NodeId>,
    /// What is left and entered happens inside this node.
    pub(super) scope: NodeId,
    pub(super) leaves: Few<Leaf>,
    /// The blackboard of its scope.
    pub(super) region: RegionId,
    /// Without a trigger: when it may be taken. Triggers are numbered later.
    pub(super) condition: Option<Condition>,
    /// What it does to the configuration.
    pub(super) change: Change,
}

/// Where a way ends, or goes on when the actions up to there have been done.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub(super) enum Leaf {
    /// A state, or a HISTORY.
    Node(NodeId),
    /// A CHOICE, by its number among those.
    Choice(usize),
    Terminate,
}

/// What a way does to the configuration.
///
/// A way all of whose possible ends are TERMINATE leaves and enters nothing. One that may also lead elsewhere has the scope of its other
/// ends, and leaves what is in that before it is known where it leads.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub(super) enum Change {
    /// Nothing: it is internal and without target, or stops the chart, or is the late part of another.
    None,
    /// Its scope is left and entered.
    Scope,
    /// What is in its scope is left; the scope itself stays, without an active child. For a JOIN, the segment into it that this is.
    Vacates(Option<usize>),
}

/// The ways of a chart.
pub(super) struct Ways {
    /// Out of each state, by [`NodeId`].
    pub(super) of: Vec<Vec<Way>>,
    pub(super) choices: Vec<Late>,
    pub(super) histories: Vec<Late>,
    pub(super) joins: Vec<Join>,
}

/// The ways out of a CHOICE or a HISTORY, on one blackboard.
#[derive(Clone, Debug)]
pub(super) struct Late {
    pub(super) node: NodeId,
    pub(super) ways: Vec<Way>,
}

/// A JOIN and its sources, in the order of the segments into it.
#[derive(Clone, Debug)]
pub(super) struct Join {
    pub(super) around: NodeId,
    pub(super) sources: Vec<NodeId>,
}

impl Ways {
    /// Every way there is.
    pub(super) fn all(&self) -> impl Iterator<Item = &Way> {
        let late = self.choices.iter().chain(&self.histories).map(|late| &late.ways);
        self.of.iter().chain(late).flatten()
    }
}

/// Finds the ways of a chart whose structure has been checked.
pub(super) fn find(
    chart: &Statechart,
    layout: &Layout,
    roles: &Roles,
    regions: &[RegionId],
    semantics: &Semantics,
) -> Result<Ways, Vec<Diagnostic>> {
    let mut search = Search {
        chart,
        layout,
        roles,
        regions,
        semantics,
        outgoing: outgoing(chart, roles, semantics.order),
        numbers: BTreeMap::new(),
        choices: Vec::new(),
        joins: Vec::new(),
        join_numbers: BTreeMap::new(),
        hulls: BTreeMap::new(),
        count: 0,
        errors: Vec::new(),
    };
    search.number_joins();
    let mut of = vec![Vec::new(); chart.nodes().len()];
    for (id, _) in chart.nodes().filter(|(id, _)| roles.of(*id) == Role::State) {
        search.out_of_state(id, &mut of[id.0 as usize]);
    }
    let histories = search.histories();
    let choices = search.late_ways();
    let joins = search.joins;
    if search.errors.is_empty() { Ok(Ways { of, choices, histories, joins }) } else { Err(search.errors) }
}

/// The segments that leave each node, in the order in which they are tried. All that leave a FORK are taken, in the order of the model.
fn outgoing(chart: &Statechart, roles: &Roles, order: SegmentOrder) -> Vec<Vec<TransitionId>> {
    let mut outgoing = roles.outgoing.clone();
    for (segments, (node, _)) in outgoing.iter_mut().zip(chart.nodes()) {
        if roles.of(node) == Role::Fork {
            continue;
        }
        segments.sort_by_key(|&id| {
            let transition = chart.transition(id);
            let later = order == SegmentOrder::GuardedFirst && transition.expression.guard.is_none();
            (std::cmp::Reverse(transition.priority), later, id)
        });
    }
    outgoing
}

struct Search<'a> {
    chart: &'a Statechart,
    layout: &'a Layout,
    roles: &'a Roles,
    regions: &'a [RegionId],
    semantics: &'a Semantics,
    outgoing: Vec<Vec<TransitionId>>,
    /// The number of each CHOICE on each blackboard.
    numbers: BTreeMap<(NodeId, RegionId), usize>,
    choices: Vec<(NodeId, RegionId)>,
    joins: Vec<Join>,
    join_numbers: BTreeMap<NodeId, usize>,
    /// What encloses all that a CHOICE may lead to; none if it is TERMINATE only.
    hulls: BTreeMap<NodeId, Option<Hull>>,
    count: usize,
    errors: Vec<Diagnostic>,
}

/// What is still to be followed.
#[derive(Clone, Copy)]
enum Open {
    /// One of the segments that leave it.
    Node(NodeId),
    Segment(TransitionId),
}

/// A way as far as it has been followed.
#[derive(Default)]
struct Trail {
    segments: Few<TransitionId>,
    ends: Few<NodeId>,
    /// What is still to be followed, the next one last.
    open: Few<Open>,
}

/// Where a way begins.
#[derive(Clone, Copy)]
enum Begin<'s> {
    /// At a state, or at the states whose segments a JOIN takes together.
    States(NodeId, &'s [NodeId], Option<Condition>),
    /// At a connector at which it is decided late, on a blackboard.
    Late(NodeId, RegionId),
}

impl Search<'_> {
    fn number_joins(&mut self) {
        for (id, _) in self.chart.nodes().filter(|(id, _)| self.roles.of(*id) == Role::Join) {
            let incoming = &self.roles.incoming[id.0 as usize];
            let sources: Vec<NodeId> = incoming.iter().map(|&id| self.chart.transition(id).source).collect();
            let hull = sources.iter().map(|&node| Hull::of(self.layout.place_of(node))).reduce(Hull::with);
            let Some(hull) = hull else { continue };
            self.join_numbers.insert(id, self.joins.len());
            self.joins.push(Join { around: scope::lowest_node(self.chart, self.layout, hull), sources });
        }
    }

    fn out_of_state(&mut self, state: NodeId, ways: &mut Vec<Way>) {
        if self.semantics.join == Joining::Each {
            self.out_of_joins(state, ways);
        }
        for index in 0..self.outgoing[state.0 as usize].len() {
            let id = self.outgoing[state.0 as usize][index];
            let target = self.chart.transition(id).target;
            match self.join_numbers.get(&target) {
                Some(&join) if self.semantics.join == Joining::Each => self.arrive(state, id, join, ways),
                Some(&join) => self.join_together(state, target, join, ways),
                None => {
                    let mut trail = Trail { open: smallvec![Open::Segment(id)], ..Trail::default() };
                    self.follow(Begin::States(state, &[], None), &mut trail, ways);
                }
            }
        }
    }

    /// The way through a JOIN as one transition: it is that of its first source in the document. Where a completion is looked at once, it is
    /// looked at when the last of the sources completes, whichever that is.
    fn join_together(&mut self, state: NodeId, node: NodeId, join: usize, ways: &mut Vec<Way>) {
        let mut sources = self.joins[join].sources.clone();
        sources.sort_by_key(|&source| self.layout.rank(self.layout.place_of(source)));
        let Some((&first, others)) = sources.split_first() else { return };
        if first != state && self.semantics.eventless != Eventless::Once {
            return;
        }
        let segments = Few::from_slice(&self.roles.incoming[node.0 as usize]);
        let mut trail = Trail { segments, open: smallvec![Open::Node(node)], ..Trail::default() };
        let begin = Begin::States(first, others, Some(Condition::AllCompleted(join)));
        self.follow(begin, &mut trail, ways);
    }

    /// A segment into a JOIN that is taken by itself.
    fn arrive(&mut self, state: NodeId, segment: TransitionId, join: usize, ways: &mut Vec<Way>) {
        let Join { around, sources } = &self.joins[join];
        let slot = sources.iter().position(|&source| source == state);
        let (Some(region), Some(slot)) = (scope::child_towards(self.chart, *around, state), slot) else {
            return;
        };
        let slot = self.joins[..join].iter().map(|join| join.sources.len()).sum::<usize>() + slot;
        self.count += 1;
        ways.push(Way {
            segments: smallvec![segment],
            source: state,
            others: Vec::new(),
            scope: region,
            leaves: Few::new(),
            region: self.regions[region.0 as usize],
            condition: Some(Condition::Arrives(slot)),
            change: Change::Vacates(Some(slot)),
        });
    }

    /// The ways out of the JOINs of an AND, which are taken when all have arrived.
    fn out_of_joins(&mut self, and: NodeId, ways: &mut Vec<Way>) {
        let joins: Vec<(NodeId, usize)> = match self.chart.node(and).kind {
            NodeKind::And => {
                let joins = self.join_numbers.iter().map(|(&node, &join)| (node, join));
                joins.filter(|&(_, join)| self.joins[join].around == and).collect()
            }
            _ => return,
        };
        for (node, join) in joins {
            let mut trail = Trail { open: smallvec![Open::Node(node)], ..Trail::default() };
            self.follow(Begin::States(and, &[], Some(Condition::AllArrived(join))), &mut trail, ways);
        }
    }

    /// The ways out of each HISTORY, for when there is no record.
    fn histories(&mut self) -> Vec<Late> {
        let mut histories = Vec::new();
        for (id, node) in self.chart.nodes().filter(|(id, _)| self.roles.of(*id) == Role::History) {
            let owner = node.parent.unwrap_or(Statechart::ROOT);
            let ways = self.out_of_late(id, self.regions[owner.0 as usize]);
            histories.push(Late { node: id, ways });
        }
        histories
    }

    /// The ways out of each CHOICE that some way leads to; those ways may lead to further ones.
    fn late_ways(&mut self) -> Vec<Late> {
        let mut late = Vec::new();
        while let Some(&(node, region)) = self.choices.get(late.len()) {
            let ways = self.out_of_late(node, region);
            late.push(Late { node, ways });
        }
        late
    }

    fn out_of_late(&mut self, node: NodeId, region: RegionId) -> Vec<Way> {
        let mut ways = Vec::new();
        let mut trail = Trail { open: smallvec![Open::Node(node)], ..Trail::default() };
        self.follow(Begin::Late(node, region), &mut trail, &mut ways);
        ways
    }

    /// Depth first; chains of connectors are short and free of circles, which has been checked. The trail is left as it was found.
    fn follow(&mut self, begin: Begin<'_>, trail: &mut Trail, ways: &mut Vec<Way>) {
        if self.count > MAX_WAYS {
            return;
        }
        let Some(open) = trail.open.pop() else {
            self.complete(begin, trail, ways);
            return;
        };
        match open {
            Open::Node(node) => {
                for index in 0..self.outgoing[node.0 as usize].len() {
                    trail.open.push(Open::Segment(self.outgoing[node.0 as usize][index]));
                    self.follow(begin, trail, ways);
                    trail.open.pop();
                }
            }
            Open::Segment(id) => self.take(begin, id, trail, ways),
        }
        trail.open.push(open);
    }

    fn take(&mut self, begin: Begin<'_>, id: TransitionId, trail: &mut Trail, ways: &mut Vec<Way>) {
        let target = self.chart.transition(id).target;
        let (open, ends) = (trail.open.len(), trail.ends.len());
        trail.segments.push(id);
        match self.roles.of(target) {
            Role::Branch => trail.open.push(Open::Node(target)),
            Role::Fork => {
                let segments = self.outgoing[target.0 as usize].iter().rev();
                trail.open.extend(segments.map(|&id| Open::Segment(id)));
            }
            _ => trail.ends.push(target),
        }
        self.follow(begin, trail, ways);
        trail.segments.pop();
        trail.open.truncate(open);
        trail.ends.truncate(ends);
    }

    fn complete(&mut self, begin: Begin<'_>, trail: &Trail, ways: &mut Vec<Way>) {
        self.count += 1;
        let source = match begin {
            Begin::States(source, ..) | Begin::Late(source, _) => source,
        };
        if self.count > MAX_WAYS {
            let path = self.chart.path(source);
            let message = format!("more than {MAX_WAYS} compound transitions, up to those out of `{path}`");
            self.errors.push(Diagnostic::error("M06", Span::default(), message));
        } else if trail.ends.len() > 1 && trail.ends.iter().any(|&end| self.ends_in_terminate(end)) {
            self.refuse_fork_that_stops(trail);
        } else if trail.ends.len() > 1 && !self.are_orthogonal(&trail.ends) {
            self.refuse_fork(trail);
        } else {
            ways.extend(match begin {
                Begin::Late(source, region) => Some(self.late(source, region, trail)),
                Begin::States(source, others, condition) => self.way(source, others, condition, trail),
            });
        }
    }

    /// A way that is the late part of others: where it lies is their concern.
    fn late(&mut self, source: NodeId, region: RegionId, trail: &Trail) -> Way {
        Way {
            segments: trail.segments.clone(),
            source,
            others: Vec::new(),
            scope: source,
            leaves: self.leaves(&trail.ends, region),
            region,
            condition: None,
            change: Change::None,
        }
    }

    fn way(
        &mut self,
        source: NodeId,
        others: &[NodeId],
        condition: Option<Condition>,
        trail: &Trail,
    ) -> Option<Way> {
        let is_internal = trail.segments.iter().any(|&id| self.chart.transition(id).internal);
        let Some((scope, change)) = self.scope(source, others, trail, is_internal) else {
            self.refuse(source, trail);
            return None;
        };
        let region = self.regions[scope.0 as usize];
        Some(Way {
            segments: trail.segments.clone(),
            source,
            others: others.to_vec(),
            scope,
            leaves: self.leaves(&trail.ends, region),
            region,
            condition: condition.or_else(|| self.condition(source, trail)),
            change,
        })
    }

    fn leaves(&mut self, ends: &[NodeId], region: RegionId) -> Few<Leaf> {
        let leaf = |&end: &NodeId| match self.roles.of(end) {
            Role::Choice => {
                let (numbers, choices) = (&mut self.numbers, &mut self.choices);
                Leaf::Choice(*numbers.entry((end, region)).or_insert_with(|| {
                    choices.push((end, region));
                    choices.len() - 1
                }))
            }
            Role::Terminate => Leaf::Terminate,
            _ => Leaf::Node(end),
        };
        ends.iter().map(leaf).collect()
    }

    /// What happens inside which node.
    fn scope(
        &mut self,
        source: NodeId,
        others: &[NodeId],
        trail: &Trail,
        is_internal: bool,
    ) -> Option<(NodeId, Change)> {
        let stops = trail.ends.iter().all(|&end| self.ends_in_terminate(end));
        let mut hull = Hull::of(self.layout.place_of(source));
        for &node in others {
            hull = hull.with(Hull::of(self.layout.place_of(node)));
        }
        for &end in &trail.ends {
            // only where it leads to nothing else: that walk may be a long one
            hull = hull.with(self.hull(end).unwrap_or_else(|| self.hull_of_terminates(end)));
        }
        if is_internal {
            let inside = scope::lowest_node(self.chart, self.layout, hull) == source;
            let still = stops || trail.ends[..] == [source];
            return inside.then_some((source, if still { Change::None } else { Change::Scope }));
        }
        if let Some(vacated) = self.completes_ancestor(source, others, trail) {
            return Some((vacated, Change::Vacates(None)));
        }
        let scope = scope::lowest_or(self.chart, self.layout, source, hull)?;
        Some((scope, if stops { Change::None } else { Change::Scope }))
    }

    /// What stays without an active child when the target is an ancestor of the source that only counts as complete then.
    fn completes_ancestor(&self, source: NodeId, others: &[NodeId], trail: &Trail) -> Option<NodeId> {
        let (&[target], ActiveAncestor::Completed) = (trail.ends.as_slice(), self.semantics.ancestor) else {
            return None;
        };
        if !others.is_empty() || !self.chart.ancestors(source).any(|ancestor| ancestor == target) {
            return None;
        }
        match self.chart.node(target).kind {
            NodeKind::And => scope::child_towards(self.chart, target, source),
            _ => Some(target),
        }
    }

    /// What encloses all ends that a way may have behind a node, TERMINATE left out.
    fn hull(&mut self, end: NodeId) -> Option<Hull> {
        match self.roles.of(end) {
            Role::Terminate => None,
            Role::State | Role::History => Some(Hull::of(self.layout.place_of(end))),
            _ => {
                if let Some(&hull) = self.hulls.get(&end) {
                    return hull;
                }
                let mut hull: Option<Hull> = None;
                for index in 0..self.roles.outgoing[end.0 as usize].len() {
                    let target = self.chart.transition(self.roles.outgoing[end.0 as usize][index]).target;
                    let behind = self.hull(target);
                    hull = hull.into_iter().chain(behind).reduce(Hull::with);
                }
                self.hulls.insert(end, hull);
                hull
            }
        }
    }

    /// What encloses all TERMINATEs behind a node behind which there is nothing else: its targets, where there are no others.
    fn hull_of_terminates(&self, end: NodeId) -> Hull {
        let mut hull: Option<Hull> = None;
        let (mut open, mut seen) = (vec![end], BTreeSet::new());
        while let Some(node) = open.pop() {
            if self.roles.of(node) == Role::Terminate {
                hull = hull.into_iter().chain([Hull::of(self.layout.place_of(node))]).reduce(Hull::with);
            } else if seen.insert(node) {
                let outgoing = &self.roles.outgoing[node.0 as usize];
                open.extend(outgoing.iter().map(|&id| self.chart.transition(id).target));
            }
        }
        hull.unwrap_or(Hull::of(self.layout.place_of(end)))
    }

    fn ends_in_terminate(&mut self, end: NodeId) -> bool {
        self.hull(end).is_none()
    }

    /// Whether the ends of the branches of a FORK lie in different regions, wherever CHOICEs lead.
    fn are_orthogonal(&mut self, ends: &[NodeId]) -> bool {
        let mut nodes = Vec::new();
        for &end in ends {
            let Some(hull) = self.hull(end) else { return false };
            nodes.push(match self.roles.of(end) {
                Role::History => self.chart.node(end).parent.unwrap_or(end),
                _ => scope::lowest_node(self.chart, self.layout, hull),
            });
        }
        scope::are_orthogonal(self.chart, self.layout, &nodes)
    }

    fn refuse_fork_that_stops(&mut self, trail: &Trail) {
        let stops = trail.ends.iter().copied().find(|&end| self.ends_in_terminate(end));
        let message = format!(
            "a FORK leads to `{}`, which stops the chart",
            self.chart.path(stops.unwrap_or(Statechart::ROOT))
        );
        let hint = "the branches of a FORK lead to states; TERMINATE may stand behind a CHOICE that leads to others too";
        self.errors.push(Diagnostic::error("M04", Span::default(), message).with_hint(hint));
    }

    fn refuse_fork(&mut self, trail: &Trail) {
        let ends: Vec<String> = trail.ends.iter().map(|&end| self.chart.path(end)).collect();
        let message = format!("a FORK leads to `{}`, which cannot be active together", ends.join("` and `"));
        let hint = "the branches of a FORK lead to different regions of one AND";
        self.errors.push(Diagnostic::error("M04", Span::default(), message).with_hint(hint));
    }

    fn refuse(&mut self, source: NodeId, trail: &Trail) {
        let ends: Vec<String> = trail.ends.iter().map(|&end| self.chart.path(end)).collect();
        let (source, target) = (self.chart.path(source), ends.join("` and `"));
        let message = format!("no transition can lead from `{source}` to `{target}`");
        let hint = "what is internal stays inside its source";
        self.errors.push(Diagnostic::error("M03", Span::default(), message).with_hint(hint));
    }

    /// When a way without a trigger may be taken: guardedness is that of its first segment. A completion that is looked at once is consumed
    /// if the state is complete no more by then.
    fn condition(&self, source: NodeId, trail: &Trail) -> Option<Condition> {
        let first = &self.chart.transition(*trail.segments.first()?).expression;
        if first.trigger.is_some() {
            return None;
        }
        let kind = self.chart.node(source).kind;
        let interrupts = trail.segments.iter().any(|&id| self.chart.transition(id).interrupts);
        let waits = matches!(kind, NodeKind::Or | NodeKind::And)
            && first.guard.is_some()
            && trail.ends[..] != [source];
        Some(match self.semantics.eventless {
            _ if kind == NodeKind::Start => Condition::Always,
            Eventless::Always => Condition::Always,
            Eventless::Once => Condition::Completed,
            Eventless::AsWritten if !waits => Condition::Completed,
            Eventless::AsWritten | Eventless::Quiescent if interrupts && waits => Condition::NoStepInside,
            Eventless::AsWritten | Eventless::Quiescent => Condition::Quiescent,
        })
    }
}
