//! Enumerates the compound transitions: all complete paths out of each state, and out of each
//! connector that is decided dynamically, in the order in which they are tried.

mod arrivals;
mod scope;

use std::collections::BTreeMap;

use smallvec::{SmallVec, smallvec};

use crate::compile::node_roles::{NodeRole, NodeRoles};
use crate::compile::node_span::{self, NodeSpan};
use crate::compile::{EnablingCondition, NodeOrder};
use crate::diagnostic::{Diagnostic, Span};
use crate::ids::ScopeId;
use crate::semantics::{CompletionTrigger, JoinMode, SegmentOrder, Semantics};
use crate::statechart::{BriefNames, NodeId, NodeKind, Statechart, TransitionId};

/// The maximum number of compound transitions of a chart: connectors that fan out and in again
/// multiply.
const MAX_WAYS: usize = 1_000_000;

/// Most paths have one segment: such lists need no allocation.
pub(crate) type PathVec<T> = SmallVec<[T; 2]>;

/// One compound transition, or the part of one that is decided dynamically.
#[derive(Clone, Debug)]
pub(crate) struct CompoundPath {
    pub(crate) segments: PathVec<TransitionId>,
    pub(crate) source: NodeId,
    /// The further sources of a JOIN.
    pub(crate) others: Vec<NodeId>,
    /// The node inside which states are left and entered.
    pub(crate) scope: NodeId,
    pub(crate) leaves: PathVec<PathEnd>,
    /// The scope of that node.
    pub(crate) region: ScopeId,
    /// Without a trigger: when it may be taken. Triggers are numbered later.
    pub(crate) condition: Option<EnablingCondition>,
    /// Its effect on the configuration.
    pub(crate) change: ConfigurationChange,
    /// The JOIN or exit point at which its region arrives by itself.
    pub(crate) arrival: Option<PathArrival>,
}

/// The arrival of one region at a JOIN, or at an exit point that joins several regions.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub(crate) struct PathArrival {
    /// The JOIN or exit point, by index.
    pub(crate) join: usize,
    /// The index of the region among all regions that arrive somewhere.
    pub(crate) slot: usize,
    pub(crate) region: NodeId,
    /// The index of the segment that arrives.
    pub(crate) segment: usize,
    /// Whether the path goes on, since all other regions have arrived.
    pub(crate) passes: bool,
}

/// The end of a path, or its continuation after its actions.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub(crate) enum PathEnd {
    /// A state, or a HISTORY.
    Node(NodeId),
    /// A CHOICE, by its index among the CHOICEs.
    Choice(usize),
    Terminate,
}

/// The effect of a path on the configuration.
///
/// A path whose possible ends are all TERMINATE leaves and enters nothing, unless the semantics has
/// its source left. A path that may also
/// lead elsewhere has the scope of its other ends, and leaves the states in it before its end is
/// known.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub(crate) enum ConfigurationChange {
    /// None: it is internal and without target, or terminates the chart, or is the dynamic part of
    /// another path.
    None,
    /// Its scope is left and entered.
    Scope,
    /// The states in its scope are left; the scope itself remains, without an active child.
    Vacates,
}

/// The paths of a chart.
pub(crate) struct CompoundPaths {
    /// The paths out of each state, by [`NodeId`].
    pub(crate) of: Vec<Vec<CompoundPath>>,
    pub(crate) choices: Vec<DynamicBranches>,
    pub(crate) histories: Vec<DynamicBranches>,
    pub(crate) joins: Vec<JoinSources>,
}

/// The paths out of a CHOICE or a HISTORY, in one scope.
#[derive(Clone, Debug)]
pub(crate) struct DynamicBranches {
    pub(crate) node: NodeId,
    pub(crate) paths: Vec<CompoundPath>,
}

/// A JOIN or an exit point, with the AND whose regions it joins.
#[derive(Clone, Debug)]
pub(crate) struct JoinSources {
    pub(crate) around: NodeId,
    /// The regions, for a JOIN in the order of the segments into it.
    pub(crate) regions: Vec<NodeId>,
    /// The sources of a JOIN, in the same order.
    pub(crate) sources: Vec<NodeId>,
}

impl CompoundPaths {
    /// All paths.
    pub(crate) fn all(&self) -> impl Iterator<Item = &CompoundPath> {
        let late = self.choices.iter().chain(&self.histories).map(|late| &late.paths);
        self.of.iter().chain(late).flatten()
    }
}

/// Enumerates the paths of a chart whose structure has been checked.
pub(crate) fn find(
    chart: &Statechart,
    layout: &NodeOrder,
    roles: &NodeRoles,
    regions: &[ScopeId],
    semantics: &Semantics,
) -> Result<CompoundPaths, Vec<Diagnostic>> {
    let mut search = CompoundPathSearch {
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
        terminates: BTreeMap::new(),
        count: 0,
        names: BriefNames::new(chart),
        errors: Vec::new(),
    };
    search.number_joins();
    let mut of = vec![Vec::new(); chart.nodes().len()];
    for (id, _) in chart.nodes().filter(|(id, _)| roles.of(*id) == NodeRole::State) {
        search.out_of_state(id, &mut of[id.0 as usize]);
    }
    let histories = search.histories();
    let choices = search.dynamic_branches();
    let joins = search.joins;
    if search.errors.is_empty() {
        Ok(CompoundPaths { of, choices, histories, joins })
    } else {
        Err(search.errors)
    }
}

/// The segments that leave each node, in the order in which they are tried. All segments out of a
/// FORK are taken, in the order of the model.
fn outgoing(chart: &Statechart, roles: &NodeRoles, order: SegmentOrder) -> Vec<Vec<TransitionId>> {
    let mut outgoing = roles.outgoing.clone();
    for (segments, (node, _)) in outgoing.iter_mut().zip(chart.nodes()) {
        if roles.of(node) == NodeRole::Fork {
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

struct CompoundPathSearch<'a> {
    chart: &'a Statechart,
    names: BriefNames<'a>,
    layout: &'a NodeOrder,
    roles: &'a NodeRoles,
    regions: &'a [ScopeId],
    semantics: &'a Semantics,
    outgoing: Vec<Vec<TransitionId>>,
    /// The index of each CHOICE in each scope.
    numbers: BTreeMap<(NodeId, ScopeId), usize>,
    choices: Vec<(NodeId, ScopeId)>,
    joins: Vec<JoinSources>,
    join_numbers: BTreeMap<NodeId, usize>,
    /// The span of all nodes to which a CHOICE may lead; none if it leads to TERMINATE only.
    hulls: BTreeMap<NodeId, Option<NodeSpan>>,
    /// Whether a node leads to nothing but TERMINATEs.
    terminates: BTreeMap<NodeId, bool>,
    count: usize,
    errors: Vec<Diagnostic>,
}

/// An item still to be followed.
#[derive(Clone, Copy)]
enum Frontier {
    /// One of the segments that leave it.
    Node(NodeId),
    Segment(TransitionId),
}

/// A path as far as it has been followed.
#[derive(Default)]
struct PartialPath {
    segments: PathVec<TransitionId>,
    ends: PathVec<NodeId>,
    /// The items still to be followed, the next one last.
    open: PathVec<Frontier>,
    arrival: Option<PathArrival>,
}

/// The start of a path.
#[derive(Clone, Copy)]
enum PathStart<'s> {
    /// A state, or the states whose segments a JOIN takes together.
    States(NodeId, &'s [NodeId], Option<EnablingCondition>),
    /// A connector that is decided dynamically, in a scope.
    Late(NodeId, ScopeId),
}

impl CompoundPathSearch<'_> {
    fn out_of_state(&mut self, state: NodeId, paths: &mut Vec<CompoundPath>) {
        for index in 0..self.outgoing[state.0 as usize].len() {
            let id = self.outgoing[state.0 as usize][index];
            let target = self.chart.transition(id).target;
            match self.join_numbers.get(&target) {
                Some(&join) if self.roles.of(target) == NodeRole::Join && self.takes_together() => {
                    self.path_through_join(state, target, join, paths)
                }
                _ => {
                    let mut path =
                        PartialPath { open: smallvec![Frontier::Segment(id)], ..PartialPath::default() };
                    self.follow(PathStart::States(state, &[], None), &mut path, paths);
                }
            }
        }
    }

    fn takes_together(&self) -> bool {
        self.semantics.join == JoinMode::Together
    }

    /// The path through a JOIN as one transition: it belongs to its first source in document order.
    /// If completion is examined once, it is examined when the last of the sources completes, in
    /// any order.
    fn path_through_join(&mut self, state: NodeId, node: NodeId, join: usize, paths: &mut Vec<CompoundPath>) {
        let mut sources = self.joins[join].sources.clone();
        sources.sort_by_key(|&source| self.layout.rank(self.layout.index_of(source)));
        let Some((&first, others)) = sources.split_first() else { return };
        if first != state && self.semantics.eventless != CompletionTrigger::Once {
            return;
        }
        let segments = PathVec::from_slice(&self.roles.incoming[node.0 as usize]);
        let mut path =
            PartialPath { segments, open: smallvec![Frontier::Node(node)], ..PartialPath::default() };
        let begin = PathStart::States(first, others, Some(EnablingCondition::AllCompleted(join)));
        self.follow(begin, &mut path, paths);
    }

    /// The paths out of each HISTORY, used when there is no record.
    fn histories(&mut self) -> Vec<DynamicBranches> {
        let mut histories = Vec::new();
        for (id, node) in self.chart.nodes().filter(|(id, _)| self.roles.of(*id) == NodeRole::History) {
            let owner = node.parent.unwrap_or(Statechart::ROOT);
            let paths = self.paths_out_of_dynamic(id, self.regions[owner.0 as usize]);
            histories.push(DynamicBranches { node: id, paths });
        }
        histories
    }

    /// The paths out of each CHOICE that some path leads to; these may lead to further ones.
    fn dynamic_branches(&mut self) -> Vec<DynamicBranches> {
        let mut late = Vec::new();
        while let Some(&(node, region)) = self.choices.get(late.len()) {
            let paths = self.paths_out_of_dynamic(node, region);
            late.push(DynamicBranches { node, paths });
        }
        late
    }

    fn paths_out_of_dynamic(&mut self, node: NodeId, region: ScopeId) -> Vec<CompoundPath> {
        let mut paths = Vec::new();
        let mut path = PartialPath { open: smallvec![Frontier::Node(node)], ..PartialPath::default() };
        self.follow(PathStart::Late(node, region), &mut path, &mut paths);
        paths
    }

    /// Follows paths depth first; chains of connectors are short and acyclic, which has been
    /// checked. The path is restored.
    fn follow(&mut self, begin: PathStart<'_>, path: &mut PartialPath, paths: &mut Vec<CompoundPath>) {
        if self.count > MAX_WAYS {
            return;
        }
        let Some(open) = path.open.pop() else {
            self.complete(begin, path, paths);
            return;
        };
        match open {
            Frontier::Node(node) => {
                for index in 0..self.outgoing[node.0 as usize].len() {
                    path.open.push(Frontier::Segment(self.outgoing[node.0 as usize][index]));
                    self.follow(begin, path, paths);
                    path.open.pop();
                }
            }
            Frontier::Segment(id) => self.take(begin, id, path, paths),
        }
        path.open.push(open);
    }

    fn take(
        &mut self,
        begin: PathStart<'_>,
        id: TransitionId,
        path: &mut PartialPath,
        paths: &mut Vec<CompoundPath>,
    ) {
        let target = self.chart.transition(id).target;
        let (open, ends) = (path.open.len(), path.ends.len());
        path.segments.push(id);
        let arrival = self.arrival(begin, target, path);
        if let Some(arrival) = arrival {
            paths.extend(self.path_that_arrives(begin, arrival, path));
            path.arrival = Some(PathArrival { passes: true, ..arrival });
        }
        match self.roles.of(target) {
            NodeRole::Branch | NodeRole::Join => path.open.push(Frontier::Node(target)),
            NodeRole::Fork => {
                let segments = self.outgoing[target.0 as usize].iter().rev();
                path.open.extend(segments.map(|&id| Frontier::Segment(id)));
            }
            _ => path.ends.push(target),
        }
        self.follow(begin, path, paths);
        path.segments.pop();
        path.open.truncate(open);
        path.ends.truncate(ends);
        if arrival.is_some() {
            path.arrival = None;
        }
    }

    fn complete(&mut self, begin: PathStart<'_>, partial: &PartialPath, paths: &mut Vec<CompoundPath>) {
        self.count += 1;
        let source = match begin {
            PathStart::States(source, ..) | PathStart::Late(source, _) => source,
        };
        if self.count > MAX_WAYS {
            let path = self.names.name(source);
            let message = format!("more than {MAX_WAYS} compound transitions, up to those out of `{path}`");
            self.errors.push(Diagnostic::error("M06", Span::default(), message));
        } else if partial.ends.len() > 1 && partial.ends.iter().any(|&end| self.leads_to_terminate(end)) {
            self.refuse_fork_that_stops(partial);
        } else if partial.ends.len() > 1 && !self.are_orthogonal(&partial.ends) {
            self.refuse_fork(partial);
        } else {
            paths.extend(match begin {
                PathStart::Late(source, region) => Some(self.dynamic_path(source, region, partial)),
                PathStart::States(source, others, condition) => {
                    self.compound_path(source, others, condition, partial)
                }
            });
        }
    }

    /// A path that is the dynamic part of others, which determine its scope.
    fn dynamic_path(&mut self, source: NodeId, region: ScopeId, path: &PartialPath) -> CompoundPath {
        CompoundPath {
            segments: path.segments.clone(),
            source,
            others: Vec::new(),
            scope: source,
            leaves: self.leaves(&path.ends, region),
            region,
            condition: None,
            change: ConfigurationChange::None,
            arrival: None,
        }
    }

    fn compound_path(
        &mut self,
        source: NodeId,
        others: &[NodeId],
        condition: Option<EnablingCondition>,
        path: &PartialPath,
    ) -> Option<CompoundPath> {
        let Some((scope, change)) = self.scope(source, others, path) else {
            self.refuse(source, path);
            return None;
        };
        let region = self.regions[scope.0 as usize];
        let condition = match path.arrival {
            Some(_) => self.arrival_condition(path),
            None => condition.or_else(|| self.condition(source, path)),
        };
        Some(CompoundPath {
            segments: path.segments.clone(),
            source,
            others: others.to_vec(),
            scope,
            leaves: self.leaves(&path.ends, region),
            region,
            condition,
            change,
            arrival: path.arrival,
        })
    }

    fn leaves(&mut self, ends: &[NodeId], region: ScopeId) -> PathVec<PathEnd> {
        let leaf = |&end: &NodeId| match self.roles.of(end) {
            NodeRole::Choice => {
                let (numbers, choices) = (&mut self.numbers, &mut self.choices);
                PathEnd::Choice(*numbers.entry((end, region)).or_insert_with(|| {
                    choices.push((end, region));
                    choices.len() - 1
                }))
            }
            NodeRole::Terminate => PathEnd::Terminate,
            // an entry point that leads nowhere
            _ if self.chart.node(end).kind == NodeKind::EntryPoint => {
                PathEnd::Node(self.chart.node(end).parent.unwrap_or(end))
            }
            _ => PathEnd::Node(end),
        };
        ends.iter().map(leaf).collect()
    }

    /// Whether the ends of the branches of a FORK lie in different regions, for every outcome of
    /// CHOICEs.
    fn are_orthogonal(&mut self, ends: &[NodeId]) -> bool {
        let mut nodes = Vec::new();
        for &end in ends {
            let Some(hull) = self.target_span(end) else { return false };
            nodes.push(match self.roles.of(end) {
                NodeRole::History => self.chart.node(end).parent.unwrap_or(end),
                _ => node_span::lowest_node(self.chart, self.layout, hull),
            });
        }
        node_span::are_orthogonal(self.chart, self.layout, &nodes)
    }

    fn refuse_fork_that_stops(&mut self, path: &PartialPath) {
        let stops = path.ends.iter().copied().find(|&end| self.leads_to_terminate(end));
        let message = format!(
            "a FORK leads to `{}`, which stops the chart",
            self.names.name(stops.unwrap_or(Statechart::ROOT))
        );
        let hint = "the branches of a FORK lead to states; TERMINATE may stand behind a CHOICE that leads to others too";
        self.errors.push(Diagnostic::error("M04", Span::default(), message).with_hint(hint));
    }

    fn refuse_fork(&mut self, path: &PartialPath) {
        let ends: Vec<String> = path.ends.iter().map(|&end| self.names.name(end)).collect();
        let message = format!("a FORK leads to `{}`, which cannot be active together", ends.join("` and `"));
        let hint = "the branches of a FORK lead to different regions of one AND";
        self.errors.push(Diagnostic::error("M04", Span::default(), message).with_hint(hint));
    }

    fn refuse(&mut self, source: NodeId, path: &PartialPath) {
        let ends: Vec<String> = path.ends.iter().map(|&end| self.names.name(end)).collect();
        let (source, target) = (self.names.name(source), ends.join("` and `"));
        let message = format!("no transition can lead from `{source}` to `{target}`");
        let hint = "what is internal stays inside its source";
        self.errors.push(Diagnostic::error("M03", Span::default(), message).with_hint(hint));
    }

    /// When a path without a trigger may be taken, which depends on the guard of its first segment.
    /// A completion that is examined once is discarded if the state is no longer complete by then.
    fn condition(&self, source: NodeId, path: &PartialPath) -> Option<EnablingCondition> {
        let first = &self.chart.transition(*path.segments.first()?).expression;
        if first.trigger.is_some() {
            return None;
        }
        let kind = self.chart.node(source).kind;
        let interrupts = path.segments.iter().any(|&id| self.chart.transition(id).interrupts);
        let waits = matches!(kind, NodeKind::Or | NodeKind::And)
            && first.guard.is_some()
            && path.ends[..] != [source];
        Some(match self.semantics.eventless {
            _ if kind == NodeKind::Start => EnablingCondition::Always,
            CompletionTrigger::Always => EnablingCondition::Always,
            CompletionTrigger::Once => EnablingCondition::Completed,
            CompletionTrigger::AsWritten if !waits => EnablingCondition::Completed,
            CompletionTrigger::AsWritten | CompletionTrigger::Quiescent if interrupts && waits => {
                EnablingCondition::NoStepInside
            }
            CompletionTrigger::AsWritten | CompletionTrigger::Quiescent => EnablingCondition::Quiescent,
        })
    }
}
