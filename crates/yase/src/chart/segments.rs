//! Segments compiled for the blackboards on which they are taken, and trees of them.

use crate::chart::build::Builder;
use crate::chart::ways::{Change, Leaf as End, Way};
use crate::chart::{
    Branch, Branches, Compound, CompoundId, Condition, Deep, Entries, Leaf, Owner, Place, RegionId, Row,
    ScopedGuard, Weight, entries,
};
use crate::diagnostic::Diagnostic;
use crate::expression::{CompiledTransition, Effect, Names};
use crate::host::ActionPlace;
use crate::semantics::StartRest;
use crate::statechart::{NodeId, NodeKind, TransitionId};

/// A segment compiled for one blackboard.
#[derive(Clone, Debug, Default)]
pub(super) struct Segment {
    trigger: Option<usize>,
    guard: Option<usize>,
    pub(super) effects: Box<[Effect]>,
}

impl Builder<'_> {
    /// Writes the ways of one node, with or without a trigger, as a tree of branches.
    pub(super) fn tree(&mut self, ways: &[Way], eventless: bool) -> Branches {
        let ways: Vec<&Way> = ways.iter().filter(|way| way.condition.is_some() == eventless).collect();
        let first = self.compounds.len();
        let branches = self.grow(&ways, 0);
        if ways.iter().any(|way| self.is_drawn_late(way)) {
            self.write_rows(&ways, branches.start, first);
        }
        branches
    }

    /// Whether something is drawn behind a connector.
    fn is_drawn_late(&self, way: &Way) -> bool {
        way.segments.iter().skip(1).any(|&id| self.chart.transition(id).weight.is_some())
    }

    /// The ways one by one: their compound transitions were made in this order, from `first` on.
    fn write_rows(&mut self, ways: &[&Way], first_branch: usize, first: usize) {
        let start = self.rows.len();
        for (index, way) in ways.iter().enumerate() {
            let segments: Vec<Segment> =
                way.segments.iter().map(|&id| self.segment(id, way.region)).collect();
            let trigger = segments.first().and_then(|segment| segment.trigger).map(Condition::Trigger);
            self.rows.push(Row {
                compound: CompoundId((first + index) as u32),
                condition: way.condition.or(trigger).unwrap_or(Condition::None),
                guards: segments.iter().map(|segment| segment.guard).collect(),
            });
        }
        self.deep.push(Deep { first_branch, rows: start..self.rows.len() });
    }

    /// Neighbouring ways that begin alike, on one blackboard, share branches.
    fn grow(&mut self, ways: &[&Way], depth: usize) -> Branches {
        let alike = |a: &&Way, b: &&Way| {
            (a.segments[depth], a.region, a.condition) == (b.segments[depth], b.region, b.condition)
        };
        let start = self.branches.len();
        let mut weighted = Vec::new();
        for group in ways.chunk_by(alike) {
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
        let beside = Branches { start, end: self.branches.len() };
        weighted.into_iter().for_each(|weight| self.weights[weight].beside = beside);
        beside
    }

    fn branch(&mut self, way: &Way, depth: usize) -> Branch {
        let id = way.segments[depth];
        let segment = self.segment(id, way.region);
        let condition = match (depth, way.condition, segment.trigger) {
            (0, Some(condition), _) => condition,
            (0, None, Some(trigger)) => Condition::Trigger(trigger),
            _ => Condition::None,
        };
        let weight = self.chart.transition(id).weight.map(|value| {
            let weight = Weight { value, segment: id, beside: Branches::default() };
            number(&mut self.weights, weight)
        });
        let is_last = way.segments.len() == depth + 1;
        let compound = is_last.then(|| self.compound(way));
        Branch { condition, guard: segment.guard, weight, compound, skip: 0 }
    }

    /// A segment on a blackboard, compiled when it is met first.
    pub(super) fn segment(&mut self, id: TransitionId, region: RegionId) -> Segment {
        if let Some(segment) = self.segments.get(&(id, region)) {
            return segment.clone();
        }
        let chart = self.chart;
        let transition = chart.transition(id);
        let what =
            || format!("from `{}` to `{}`", chart.path(transition.source), chart.path(transition.target));
        let mut compiled: CompiledTransition =
            self.actions(region, |names| transition.expression.compile(names), what);
        self.wire(&mut compiled.effects, ActionPlace::Transition(id), region);
        if let (Some(wiring), Some(guard)) = (&mut self.wiring, &mut compiled.guard) {
            wiring.guard(guard, id, region, &self.timer_names[region.index()]);
        }
        let segment = Segment {
            trigger: compiled.trigger.map(|trigger| number(&mut self.triggers, trigger)),
            guard: compiled
                .guard
                .map(|guard| number(&mut self.guards, ScopedGuard { transition: id, region, guard })),
            effects: compiled.effects,
        };
        self.segments.insert((id, region), segment.clone());
        segment
    }

    /// Compiles with the names of a blackboard; on errors says where they stand, and yields nothing.
    pub(super) fn actions<T: Default>(
        &mut self,
        region: RegionId,
        compile: impl FnOnce(&mut Names<'_>) -> Result<T, Vec<Diagnostic>>,
        what: impl FnOnce() -> String,
    ) -> T {
        let mut names = Names {
            vocabulary: self.vocabulary,
            constants: &self.chart.constants,
            timers: &self.timer_names[region.index()],
            events: &mut self.events,
            scripts: &mut self.scripts,
            states: &|path| self.index.find(self.chart, path),
        };
        compile(&mut names).unwrap_or_else(|found| {
            let what = what();
            self.found.extend(found.into_iter().map(|mut diagnostic| {
                diagnostic.message = format!("{} ({what})", diagnostic.message);
                diagnostic
            }));
            T::default()
        })
    }

    fn compound(&mut self, way: &Way) -> CompoundId {
        let mut effects = Vec::new();
        for &id in &way.segments {
            let segment = self.segment(id, way.region);
            if !segment.effects.is_empty() {
                effects.push((id, segment.effects));
            }
        }
        let (source, scope) = (self.layout.place_of(way.source), self.layout.place_of(way.scope));
        let first = self.layout.first(scope);
        let transitions = || way.segments.iter().map(|&id| self.chart.transition(id));
        let is_internal = transitions().any(|transition| transition.internal);
        let compound = Compound {
            source,
            others: way.others.iter().map(|&node| self.layout.place_of(node)).collect(),
            region: way.region,
            scope,
            exits: (way.change != Change::None && first < scope).then(|| (first, Place(scope.0 - 1))),
            vacates: match way.change {
                Change::Vacates(_) if self.chart.node(way.scope).kind != NodeKind::Basic => Some(scope),
                _ => None,
            },
            arrives: match way.change {
                Change::Vacates(slot) => slot,
                _ => None,
            },
            leaves: self.leaves(way),
            entries: self.entries(way),
            owner: self.owner(way),
            effects: effects.into(),
            interrupts: transitions().any(|transition| transition.interrupts),
            key: u64::from(!is_internal) << 32 | u64::from(self.layout.rank(source)),
            segments: way.segments.iter().copied().collect(),
        };
        CompoundId(number(&mut self.compounds, compound) as u32)
    }

    /// What is to be entered; nothing where the target is not entered.
    fn leaves(&self, way: &Way) -> Box<[Leaf]> {
        let stays = match way.change {
            Change::None => way.leaves[..] == [End::Node(way.source)],
            Change::Vacates(_) => true,
            Change::Scope => false,
        };
        if stays { Box::default() } else { way.leaves.iter().map(|&leaf| self.leaf(leaf)).collect() }
    }

    fn leaf(&self, leaf: End) -> Leaf {
        match leaf {
            End::Node(node) => Leaf::Node(self.layout.place_of(node)),
            End::Choice(number) => Leaf::Choice(number),
            End::Terminate => Leaf::Terminate,
        }
    }

    /// What is entered is known beforehand if there is one target, which is a state, and no START is left at once.
    fn entries(&self, way: &Way) -> Entries {
        if way.change != Change::Scope {
            return Entries::None;
        }
        let [End::Node(target)] = way.leaves[..] else { return Entries::Found };
        if self.is_history(target) {
            return Entries::Found;
        }
        let listed = entries::between(self.chart, &self.layout, &self.starts, way.scope, target);
        let goes_on = |list: &entries::Few<Place>| {
            self.semantics.start == StartRest::SameStep
                && list.iter().any(|&place| self.chart.node(self.layout.node(place)).kind == NodeKind::Start)
        };
        listed
            .filter(|list| !goes_on(list))
            .map_or(Entries::Found, |list| Entries::Listed(list.into_iter().collect()))
    }

    fn owner(&self, way: &Way) -> Owner {
        match way.leaves.first() {
            Some(End::Choice(_)) => Owner::Later,
            Some(&End::Node(node)) => Owner::State(self.layout.place_of(self.owner_of(node))),
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

/// Appends, and says at which place.
fn number<T>(list: &mut Vec<T>, item: T) -> usize {
    list.push(item);
    list.len() - 1
}
