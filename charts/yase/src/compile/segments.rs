//! Compiles segments for the scopes in which they are taken, and builds branch trees.

use crate::compile::build::ChartCompiler;
use crate::compile::compound_transitions::{CompoundPath, ConfigurationChange, PathArrival, PathEnd as End};
use crate::compile::{
    Arrival, ArrivalCondition, BranchRange, BranchWeight, CandidatePath, CompoundTransition,
    EnablingCondition, EntryPlan, LateDrawTree, NodeIndex, Owner, ScopedGuard, SegmentNode, TransitionTarget,
    entries,
};
use crate::diagnostic::Diagnostic;
use crate::expression::{CompiledTransition, Effect, NameScope};
use crate::ids::{ActionLocation, CompoundTransitionId, ScopeId};
use crate::semantics::{Firing, InitialState};
use crate::statechart::{BriefNames, NodeId, NodeKind, TransitionId};

/// A segment compiled for one scope.
#[derive(Clone, Debug, Default)]
pub(crate) struct CompiledSegment {
    trigger: Option<usize>,
    guard: Option<usize>,
    pub(crate) effects: Box<[Effect]>,
}

impl ChartCompiler<'_> {
    /// Stores the paths of one node, with or without a trigger, as a branch tree.
    pub(crate) fn tree(&mut self, paths: &[CompoundPath], eventless: bool) -> BranchRange {
        let suitable: Vec<&CompoundPath> =
            paths.iter().filter(|path| path.condition.is_some() == eventless).collect();
        let first = self.compounds.len();
        let branches = self.grow(&suitable, 0);
        if suitable.iter().any(|path| self.is_drawn_late(path)) {
            self.write_rows(&suitable, branches.start, first);
        }
        branches
    }

    /// Whether there is a random choice behind a connector.
    fn is_drawn_late(&self, path: &CompoundPath) -> bool {
        path.segments.iter().skip(1).any(|&id| self.chart.transition(id).weight.is_some())
    }

    /// Stores the paths one by one: their compound transitions were created in this order, from
    /// `first` on.
    fn write_rows(&mut self, paths: &[&CompoundPath], first_branch: usize, first: usize) {
        let start = self.rows.len();
        for (index, path) in paths.iter().enumerate() {
            let segments: Vec<CompiledSegment> =
                path.segments.iter().map(|&id| self.segment(id, path.region)).collect();
            let trigger = segments.first().and_then(|segment| segment.trigger);
            let condition = self.condition(path, trigger);
            self.rows.push(CandidatePath {
                compound: CompoundTransitionId((first + index) as u32),
                condition,
                guards: segments.iter().map(|segment| segment.guard).collect(),
            });
        }
        self.deep.push(LateDrawTree { first_branch, rows: start..self.rows.len() });
    }

    /// Adjacent paths in one scope with equal first segments share branches.
    fn grow(&mut self, paths: &[&CompoundPath], depth: usize) -> BranchRange {
        let alike = |a: &&CompoundPath, b: &&CompoundPath| {
            (a.segments[depth], a.region, a.condition, a.arrival)
                == (b.segments[depth], b.region, b.condition, b.arrival)
        };
        let start = self.branches.len();
        let mut weighted = Vec::new();
        for group in paths.chunk_by(alike) {
            let Some(&first) = group.first() else { continue };
            let branch = self.branch(first, depth);
            let index = self.branches.len();
            weighted.extend(branch.weight);
            self.branches.push(branch);
            if first.segments.len() > depth + 1 {
                self.grow(group, depth + 1);
            }
            self.branches[index].skip = self.branches.len();
        }
        let beside = BranchRange { start, end: self.branches.len() };
        weighted.into_iter().for_each(|weight| self.weights[weight].siblings = beside);
        beside
    }

    fn branch(&mut self, path: &CompoundPath, depth: usize) -> SegmentNode {
        let id = path.segments[depth];
        let segment = self.segment(id, path.region);
        let condition = match depth {
            0 => self.condition(path, segment.trigger),
            _ => EnablingCondition::None,
        };
        let weight = self.chart.transition(id).weight.map(|value| {
            let weight = BranchWeight { value, segment: id, siblings: BranchRange::default() };
            number(&mut self.weights, weight)
        });
        let is_last = path.segments.len() == depth + 1;
        let compound = is_last.then(|| self.compound(path));
        SegmentNode { condition, guard: segment.guard, weight, compound, skip: 0 }
    }

    /// The condition of a path besides its guards.
    fn condition(&mut self, path: &CompoundPath, trigger: Option<usize>) -> EnablingCondition {
        if let Some(PathArrival { slot, passes, .. }) = path.arrival {
            let condition = ArrivalCondition { trigger, slot, passes };
            return EnablingCondition::Arrival(number(&mut self.arrivals, condition));
        }
        let trigger = trigger.map(EnablingCondition::Trigger);
        path.condition.or(trigger).unwrap_or(EnablingCondition::None)
    }

    /// A segment in a scope, compiled on first use.
    pub(crate) fn segment(&mut self, id: TransitionId, region: ScopeId) -> CompiledSegment {
        if let Some(segment) = self.segments.get(&(id, region)) {
            return segment.clone();
        }
        let chart = self.chart;
        let transition = chart.transition(id);
        let what = |names: &BriefNames<'_>| {
            format!("from `{}` to `{}`", names.name(transition.source), names.name(transition.target))
        };
        let mut compiled: CompiledTransition =
            self.actions(region, |names| transition.expression.compile(names), what);
        self.bind_functions(&mut compiled.effects, ActionLocation::Transition(id), region);
        if let (Some(wiring), Some(guard)) = (&mut self.wiring, &mut compiled.guard) {
            wiring.guard(guard, id, region, &self.timer_names[region.index()]);
        }
        let segment = CompiledSegment {
            trigger: compiled.trigger.map(|trigger| number(&mut self.triggers, trigger)),
            guard: compiled
                .guard
                .map(|guard| number(&mut self.guards, ScopedGuard { transition: id, region, guard })),
            effects: compiled.effects,
        };
        self.segments.insert((id, region), segment.clone());
        segment
    }

    /// Compiles with the names of a scope; on errors, reports them with their location and returns
    /// the default value.
    pub(crate) fn actions<T: Default>(
        &mut self,
        region: ScopeId,
        compile: impl FnOnce(&mut NameScope<'_>) -> Result<T, Vec<Diagnostic>>,
        what: impl FnOnce(&BriefNames<'_>) -> String,
    ) -> T {
        let mut names = NameScope {
            vocabulary: self.vocabulary,
            constants: &self.chart.constants,
            timers: &self.timer_names[region.index()],
            events: &mut self.events,
            scripts: &mut self.scripts,
            states: &|path| self.index.find(self.chart, path),
            suggestions: &self.suggestions,
        };
        compile(&mut names).unwrap_or_else(|found| {
            let what = what(&self.names);
            self.found.extend(found.into_iter().map(|mut diagnostic| {
                diagnostic.message = format!("{} ({what})", diagnostic.message);
                diagnostic
            }));
            T::default()
        })
    }

    fn compound(&mut self, path: &CompoundPath) -> CompoundTransitionId {
        let mut effects = Vec::new();
        for &id in &path.segments {
            let segment = self.segment(id, path.region);
            if !segment.effects.is_empty() {
                effects.push((id, segment.effects));
            }
        }
        let (source, scope) = (self.layout.index_of(path.source), self.layout.index_of(path.scope));
        let transitions = || path.segments.iter().map(|&id| self.chart.transition(id));
        let is_internal = path.change != ConfigurationChange::Vacates
            && path.scope == path.source
            && transitions().any(|transition| transition.internal);
        let compound = CompoundTransition {
            source,
            others: path.others.iter().map(|&node| self.layout.index_of(node)).collect(),
            region: path.region,
            scope,
            exits: self.inside(scope).filter(|_| path.change != ConfigurationChange::None),
            vacates: match path.change {
                ConfigurationChange::Vacates if self.chart.node(path.scope).kind != NodeKind::Basic => {
                    Some(scope)
                }
                _ => None,
            },
            arrival: path.arrival.map(|arrival| {
                let region = self.layout.index_of(arrival.region);
                Arrival {
                    join: arrival.join,
                    slot: arrival.slot,
                    region,
                    inside: self.inside(region),
                    segment: arrival.segment,
                    passes: arrival.passes,
                }
            }),
            steps: self.steps(path, &effects),
            leaves: self.leaves(path),
            entries: self.entries(path),
            owner: self.owner(path),
            effects: effects.into(),
            interrupts: transitions().any(|transition| transition.interrupts),
            key: u64::from(!is_internal) << 32 | u64::from(self.layout.rank(source)),
            segments: path.segments.iter().copied().collect(),
        };
        CompoundTransitionId(number(&mut self.compounds, compound) as u32)
    }

    /// The nodes to be entered; empty if the target is not entered.
    fn leaves(&self, path: &CompoundPath) -> Box<[TransitionTarget]> {
        let stays = match path.change {
            ConfigurationChange::None => path.leaves[..] == [End::Node(path.source)],
            ConfigurationChange::Vacates => true,
            ConfigurationChange::Scope => false,
        };
        if stays { Box::default() } else { path.leaves.iter().map(|&leaf| self.leaf(leaf)).collect() }
    }

    /// The index range of the nodes inside a node, if there are any.
    pub(crate) fn inside(&self, node: NodeIndex) -> Option<(NodeIndex, NodeIndex)> {
        let first = self.layout.first(node);
        (first < node).then(|| (first, NodeIndex(node.0 - 1)))
    }

    pub(crate) fn leaf(&self, leaf: End) -> TransitionTarget {
        match leaf {
            End::Node(node) => TransitionTarget::Node(self.layout.index_of(node)),
            End::Choice(number) => TransitionTarget::Choice(number),
            End::Terminate => TransitionTarget::Terminate,
        }
    }

    /// The entered nodes are known in advance if there is one target, which is a state, and no
    /// START is left in the same step.
    fn entries(&self, path: &CompoundPath) -> EntryPlan {
        if path.change != ConfigurationChange::Scope || self.semantics.firing == Firing::EachSegment {
            return EntryPlan::None;
        }
        let [End::Node(target)] = path.leaves[..] else { return EntryPlan::Found };
        if self.is_history(target) {
            return EntryPlan::Found;
        }
        let listed = entries::between(self.chart, &self.layout, &self.starts, path.scope, target);
        let goes_on = |list: &entries::InlineVec<NodeIndex>| {
            self.semantics.start == InitialState::SameStep
                && list.iter().any(|&node| self.chart.node(self.layout.node(node)).kind == NodeKind::Start)
        };
        listed
            .filter(|list| !goes_on(list))
            .map_or(EntryPlan::Found, |list| EntryPlan::Listed(list.into_iter().collect()))
    }

    fn owner(&self, path: &CompoundPath) -> Owner {
        match path.leaves.first() {
            Some(End::Choice(_)) => Owner::Dynamic,
            Some(&End::Node(node)) => Owner::State(self.layout.index_of(self.owner_of(node))),
            Some(End::Terminate) | None => Owner::None,
        }
    }

    /// A HISTORY owns nothing; its composite does.
    fn owner_of(&self, node: NodeId) -> NodeId {
        if self.is_history(node) { self.chart.node(node).parent.unwrap_or(node) } else { node }
    }

    fn is_history(&self, node: NodeId) -> bool {
        matches!(self.chart.node(node).kind, NodeKind::ShallowHistory | NodeKind::DeepHistory)
    }
}

/// Appends an item, and returns its index.
fn number<T>(list: &mut Vec<T>, item: T) -> usize {
    list.push(item);
    list.len() - 1
}
