//! A statechart compiled for execution: checked, numbered, with all its transition paths
//! enumerated.

mod build;
mod check;
mod compound_transitions;
mod entries;
mod events;
mod function_bindings;
mod node_order;
mod node_roles;
mod node_span;
mod paths;
mod scripts;
mod segment_steps;
mod segments;
mod selection_order;
mod selection_table;

use std::ops::Range;
use std::sync::OnceLock;
use std::time::Duration;

use crate::bits::BitSet;
use crate::diagnostic::Diagnostic;
use crate::expression::{
    Effect, EventId, EventInterner, Guard, MessageSource, ScriptId, ScriptInterner, TimerId,
};
use crate::ids::{ActionLocation, CompoundTransitionId, ScopeId};
use crate::native::NativeProgram;
use crate::semantics::{EventMatching, Semantics};
use crate::statechart::{NodeId, NodeKind, StateNames, Statechart, TransitionId};
use crate::vocabulary::{TopicId, TypeEnvironment};

pub(crate) use events::EventFilter;
pub(crate) use node_order::{NodeIndex, NodeOrder};
pub use scripts::{ScriptEntry, ScriptLocation};
pub(crate) use selection_table::{CompletionGate, SelectionEntry, TimerGate};

/// A statechart that a [`Machine`](crate::Machine) can execute; immutable, shared behind an `Arc`.
///
/// [`Statechart::compile`] creates it. Everything that does not depend on data is precomputed: the
/// compound transitions, their order, the states each leaves and enters, and its scope.
#[derive(Clone, Debug)]
pub struct CompiledChart {
    statechart: Statechart,
    semantics: Semantics,
    events: EventInterner,
    scripts: ScriptInterner,
    script_locations: Box<[Box<[ScriptLocation]>]>,
    pub(crate) layout: NodeOrder,
    pub(crate) states: Box<[CompiledNode]>,
    pub(crate) regions: Box<[Scope]>,
    pub(crate) branches: Box<[SegmentNode]>,
    pub(crate) triggers: Box<[EventFilter]>,
    pub(crate) arrivals: Box<[ArrivalCondition]>,
    pub(crate) guards: Box<[ScopedGuard]>,
    pub(crate) weights: Box<[BranchWeight]>,
    /// The branch trees with a random choice behind a connector, by their first branch.
    pub(crate) late_draw_trees: Box<[LateDrawTree]>,
    pub(crate) candidate_paths: Box<[CandidatePath]>,
    pub(crate) compounds: Box<[CompoundTransition]>,
    pub(crate) choices: Box<[ChoiceNode]>,
    /// Ordered by their owner.
    pub(crate) histories: Box<[HistoryNode]>,
    pub(crate) joins: Box<[JoinNode]>,
    pub(crate) activities: Box<[NodeIndex]>,
    pub(crate) timers: Box<[ScopedTimer]>,
    pub(crate) node_sets: NodeSets,
    /// The selection order without an event, if it is not that of the node indices.
    pub(crate) selection_order: Option<Box<[NodeIndex]>>,
    /// The data that selection reads of each node.
    pub(crate) selection_table: Box<[SelectionEntry]>,
    pub(crate) errors: ErrorEvents,
    /// The event that represents all events that no expression names.
    pub(crate) unnamed: EventId,
    /// The actions of segments that no path contains.
    unreached: Box<[UnreachableSegment]>,
    /// The short names of its states, computed on first use.
    names: OnceLock<StateNames>,
    reads: Box<[TopicId]>,
    sources: Box<[MessageSource]>,
    max_activities: usize,
}

/// A segment that no path contains, the scope in which it would be taken, and its actions.
type UnreachableSegment = (TransitionId, ScopeId, Box<[Effect]>);

/// A node as used by the machine.
#[derive(Clone, Debug)]
pub(crate) struct CompiledNode {
    pub(crate) kind: NodeKind,
    /// Its scope; a region has its own.
    pub(crate) region: ScopeId,
    /// Whether it is a region: entering it fills a blackboard.
    pub(crate) is_region: bool,
    /// Whether it is an END of the root.
    pub(crate) finishes: bool,
    pub(crate) parent: Option<NodeIndex>,
    /// The START of an OR.
    pub(crate) start: Option<NodeIndex>,
    /// The regions of an AND, the ENDs of an OR.
    pub(crate) parts: Box<[NodeIndex]>,
    /// Its HISTORYs, by index.
    pub(crate) histories: Range<usize>,
    /// The event raised by its completion.
    pub(crate) done: Option<EventId>,
    /// The index of its activity.
    pub(crate) activity: Option<usize>,
    /// The scope whose blackboard its activity uses: that of a composite has one of its own.
    pub(crate) activity_region: ScopeId,
    pub(crate) entry: Box<[Effect]>,
    pub(crate) exit: Box<[Effect]>,
    pub(crate) defer: Box<[EventId]>,
    /// The branches without a trigger, then those with one.
    pub(crate) eventless: BranchRange,
    pub(crate) triggered: BranchRange,
}

/// A contiguous range of [`CompiledChart::branches`].
#[derive(Clone, Copy, PartialEq, Eq, Debug, Default)]
pub(crate) struct BranchRange {
    pub(crate) start: usize,
    pub(crate) end: usize,
}

impl BranchRange {
    pub(crate) fn is_empty(self) -> bool {
        self.start == self.end
    }
}

/// One segment of the paths out of a state. The paths form a tree, stored depth first in the order
/// in which they are tried: a branch is followed by its first continuation, and `skip` leads past
/// all of them.
#[derive(Clone, Copy, Debug)]
pub(crate) struct SegmentNode {
    pub(crate) condition: EnablingCondition,
    pub(crate) guard: Option<usize>,
    /// Its index among the weighted segments.
    pub(crate) weight: Option<usize>,
    /// The compound transition that ends with this segment.
    pub(crate) compound: Option<CompoundTransitionId>,
    pub(crate) skip: usize,
}

/// The condition of a branch besides its guard.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Debug)]
pub(crate) enum EnablingCondition {
    /// None: it is not the first segment.
    None,
    /// None: it is enabled whenever its source is active.
    Always,
    /// Its source has completed.
    Completed,
    /// Nothing inside its source is enabled or running.
    Quiescent,
    /// Nothing inside its source is enabled; running activities will be interrupted.
    NoStepInside,
    /// All sources of a JOIN have completed.
    AllCompleted(usize),
    /// A region arrives where others do, by the index of the condition.
    Arrival(usize),
    /// The event matches a trigger.
    Trigger(usize),
}

/// When a path takes its region to a JOIN, or to an exit point that joins several.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub(crate) struct ArrivalCondition {
    /// The event matches this trigger; without one, the source has completed.
    pub(crate) trigger: Option<usize>,
    /// The region has not arrived yet, by the index of its arrival.
    pub(crate) slot: usize,
    /// Whether all others have arrived, or arrive in the same micro-step; otherwise some have not.
    pub(crate) passes: bool,
}

/// A weighted segment, at one position in a branch tree.
#[derive(Clone, Debug)]
pub(crate) struct BranchWeight {
    pub(crate) value: f64,
    pub(crate) segment: TransitionId,
    /// The sibling branches, including itself.
    pub(crate) siblings: BranchRange,
}

/// A branch tree with a random choice behind a connector. Its paths may lie in several scopes, so
/// they are examined one by one.
#[derive(Clone, Debug)]
pub(crate) struct LateDrawTree {
    pub(crate) first_branch: usize,
    /// Its paths, in the order in which they are tried.
    pub(crate) rows: Range<usize>,
}

/// One path of such a tree.
#[derive(Clone, Debug)]
pub(crate) struct CandidatePath {
    pub(crate) compound: CompoundTransitionId,
    pub(crate) condition: EnablingCondition,
    /// The guards, by segment.
    pub(crate) guards: Box<[Option<usize>]>,
}

/// A CHOICE in one scope.
#[derive(Clone, Debug)]
pub(crate) struct ChoiceNode {
    pub(crate) node: NodeId,
    pub(crate) branches: BranchRange,
}

/// A HISTORY.
#[derive(Clone, Debug)]
pub(crate) struct HistoryNode {
    pub(crate) node: NodeIndex,
    pub(crate) owner: NodeIndex,
    pub(crate) is_deep: bool,
    /// The paths out of it, used when nothing is recorded.
    pub(crate) branches: BranchRange,
}

/// A JOIN, or an exit point that joins several regions.
#[derive(Clone, Debug)]
pub(crate) struct JoinNode {
    /// The AND whose regions it joins.
    pub(crate) around: NodeIndex,
    /// The index of the arrival of its first region; the others follow.
    pub(crate) first: usize,
    /// The sources of a JOIN.
    pub(crate) sources: Box<[NodeIndex]>,
    /// Its regions, those of a JOIN in the order of its sources.
    pub(crate) regions: Box<[NodeIndex]>,
}

impl JoinNode {
    /// The indices of the arrivals of its regions.
    pub(crate) fn slots(&self) -> Range<usize> {
        self.first..self.first + self.regions.len()
    }
}

/// The guard of a segment in one scope.
#[derive(Clone, Debug)]
pub(crate) struct ScopedGuard {
    pub(crate) transition: TransitionId,
    pub(crate) region: ScopeId,
    pub(crate) guard: Guard,
}

/// A compound transition.
#[derive(Clone, Debug)]
pub(crate) struct CompoundTransition {
    pub(crate) segments: Box<[TransitionId]>,
    pub(crate) source: NodeIndex,
    /// The further sources of a JOIN.
    pub(crate) others: Box<[NodeIndex]>,
    /// The scope in which it is executed.
    pub(crate) region: ScopeId,
    pub(crate) scope: NodeIndex,
    /// The index range of the nodes it leaves, if active.
    pub(crate) exits: Option<(NodeIndex, NodeIndex)>,
    /// The composite that remains without an active child.
    pub(crate) vacates: Option<NodeIndex>,
    pub(crate) arrival: Option<Arrival>,
    /// Its effects segment by segment, if the semantics demands it.
    pub(crate) steps: Box<[SegmentStep]>,
    pub(crate) leaves: Box<[TransitionTarget]>,
    pub(crate) entries: EntryPlan,
    /// The state that owns the timers it starts.
    pub(crate) owner: Owner,
    pub(crate) effects: Box<[(TransitionId, Box<[Effect]>)]>,
    pub(crate) interrupts: bool,
    /// Its position in the order of execution.
    pub(crate) key: u64,
}

impl CompoundTransition {
    /// The arrival with which it ends, by index, if it does not go on from there.
    pub(crate) fn arrives(&self) -> Option<usize> {
        self.arrival.filter(|arrival| !arrival.passes).map(|arrival| arrival.slot)
    }

    /// Its source states.
    #[inline]
    pub(crate) fn sources(&self) -> impl Iterator<Item = NodeIndex> {
        std::iter::once(self.source).chain(self.others.iter().copied())
    }

    /// Whether it leaves a node if that is active.
    #[inline]
    pub(crate) fn leaves(&self, node: NodeIndex) -> bool {
        self.exits.is_some_and(|(first, last)| first <= node && node <= last)
    }

    /// Whether two compound transitions leave a common active state. A composite that was left
    /// without an active child contains none.
    #[inline]
    pub(crate) fn conflicts_with(&self, other: &CompoundTransition, active: &BitSet) -> bool {
        let (Some(a), Some(b)) = (self.exits, other.exits) else { return false };
        // regions that arrive in one place do so together
        if let (Some(a), Some(b)) = (self.arrival, other.arrival)
            && a.join == b.join
        {
            return false;
        }
        let (first, last) = (a.0.max(b.0), a.1.min(b.1));
        first <= last && active.any_in(first.index(), last.index())
    }
}

/// The arrival of a region where others arrive too.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub(crate) struct Arrival {
    /// The JOIN or exit point, by index.
    pub(crate) join: usize,
    /// The index of the arrival.
    pub(crate) slot: usize,
    pub(crate) region: NodeIndex,
    /// The index range of the nodes inside the region, if there are any.
    pub(crate) inside: Option<(NodeIndex, NodeIndex)>,
    /// The index of the segment that arrives.
    pub(crate) segment: usize,
    /// Whether the transition goes on if all others have arrived.
    pub(crate) passes: bool,
}

/// The effects of one segment.
#[derive(Clone, Debug)]
pub(crate) struct SegmentStep {
    /// The index range of the nodes it leaves, if active.
    pub(crate) exits: Option<(NodeIndex, NodeIndex)>,
    /// Whether it leads to an exit point of the composite around those nodes, so that their states
    /// are the last ones of that composite.
    pub(crate) empties_composite: bool,
    /// Its index among the segments with actions.
    pub(crate) effects: Option<usize>,
    /// The nodes around its target that are entered, if not active, outermost first, with the
    /// target itself if that is a state. Regions that ANDs among them lack are entered last.
    pub(crate) enters: Box<[NodeIndex]>,
    /// Its target, if the path does not go on from there.
    pub(crate) end: Option<TransitionTarget>,
}

/// The end or the continuation of a compound transition.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub(crate) enum TransitionTarget {
    /// At a state or a HISTORY.
    Node(NodeIndex),
    /// At a CHOICE, by index.
    Choice(usize),
    Terminate,
}

/// The nodes that a compound transition enters.
#[derive(Clone, Debug)]
pub(crate) enum EntryPlan {
    None,
    /// These nodes, outermost first.
    Listed(Box<[NodeIndex]>),
    /// The nodes are determined from its targets during entry.
    Found,
}

/// The state that owns a timer.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub(crate) enum Owner {
    None,
    State(NodeIndex),
    /// The first target, which a CHOICE determines.
    Dynamic,
}

/// A scope.
#[derive(Clone, Debug)]
pub(crate) struct Scope {
    pub(crate) root: NodeIndex,
    pub(crate) parent: Option<ScopeId>,
    /// The index of its first timer; the others follow.
    pub(crate) timers: usize,
}

/// A timer of a scope.
#[derive(Clone, Debug)]
pub(crate) struct ScopedTimer {
    pub(crate) name: Box<str>,
    pub(crate) region: ScopeId,
    /// Its number in its scope.
    pub(crate) number: usize,
    /// The event raised by its expiry, if a trigger names it or a state defers it.
    pub(crate) event: Option<EventId>,
}

/// Sets of node indices.
#[derive(Clone, Debug)]
pub(crate) struct NodeSets {
    pub(crate) starts: BitSet,
    pub(crate) eventless: BitSet,
    /// The states whose transitions without a trigger all wait until the state's activity has
    /// returned.
    pub(crate) awaiting_return: BitSet,
    pub(crate) triggered: BitSet,
    pub(crate) deferring: BitSet,
}

/// The events raised by failures.
#[derive(Clone, Copy, Debug)]
pub(crate) struct ErrorEvents {
    pub(crate) guard: EventId,
    pub(crate) action: EventId,
    pub(crate) activity: EventId,
}

/// The activity of a state.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub struct ActivityEntry<'a> {
    /// The state.
    pub node: NodeId,
    /// The name it is registered under.
    pub name: &'a str,
    /// Higher values run first.
    pub priority: i32,
    /// Its duration in simulated time, if the model specifies one.
    pub duration: Option<Duration>,
    /// The scope whose blackboard it uses.
    pub region: ScopeId,
}

impl Statechart {
    /// Checks the chart and compiles it with a type environment, with the semantics
    /// [`Semantics::yase`].
    ///
    /// # Errors
    /// All errors of its structure ([`check`](Statechart::check)), or else of its expressions.
    pub fn compile(&self, vocabulary: &TypeEnvironment) -> Result<CompiledChart, Vec<Diagnostic>> {
        self.compile_with(vocabulary, Semantics::yase())
    }

    /// Checks the chart and compiles it for the given semantics.
    ///
    /// # Errors
    /// All errors of its structure ([`check`](Statechart::check)), or else of its expressions.
    pub fn compile_with(
        &self,
        vocabulary: &TypeEnvironment,
        semantics: Semantics,
    ) -> Result<CompiledChart, Vec<Diagnostic>> {
        build::build(self, vocabulary, semantics, None)
    }

    /// Checks the chart and compiles it, with Rust functions for its guards and assigned values.
    ///
    /// # Errors
    /// All errors of its structure or its expressions, and functions that were generated for
    /// another chart or another type environment.
    pub fn compile_with_functions(
        &self,
        vocabulary: &TypeEnvironment,
        semantics: Semantics,
        functions: &NativeProgram,
    ) -> Result<CompiledChart, Vec<Diagnostic>> {
        build::build(self, vocabulary, semantics, Some(functions))
    }
}

impl CompiledChart {
    /// The statechart from which it was compiled; every [`NodeId`] and [`TransitionId`] refers to
    /// it.
    pub fn statechart(&self) -> &Statechart {
        &self.statechart
    }

    /// The semantics for which it was compiled.
    pub fn semantics(&self) -> Semantics {
        self.semantics
    }

    #[inline]
    pub(crate) fn semantics_ref(&self) -> &Semantics {
        &self.semantics
    }

    /// The event for an occurrence of that name, and whether an expression names exactly this
    /// event: otherwise, with matching [by tokens](EventMatching::TokenPrefix), the event that
    /// names the longest prefix of its tokens, or else `?`.
    pub fn event(&self, name: &str) -> (EventId, bool) {
        if let Some(event) = self.events.find(name) {
            return (event, true);
        }
        let prefix = match self.semantics.matching {
            EventMatching::Exact => None,
            EventMatching::TokenPrefix => self.events.find_prefix(name),
        };
        (prefix.unwrap_or(self.unnamed), false)
    }

    /// The events that its expressions name.
    pub fn events(&self) -> &EventInterner {
        &self.events
    }

    /// The segments of a compound transition, in order.
    pub fn segments(&self, compound: CompoundTransitionId) -> &[TransitionId] {
        self.compounds.get(compound.0 as usize).map_or(&[], |compound| &compound.segments)
    }

    /// All scopes: the root, then the others in document order.
    pub fn regions(&self) -> impl ExactSizeIterator<Item = ScopeId> + use<> {
        (0..self.regions.len() as u32).map(ScopeId)
    }

    /// The scope of a node; a region has its own.
    pub fn region_of(&self, node: NodeId) -> Option<ScopeId> {
        self.layout.find_index(node).map(|index| self.states[index.index()].region)
    }

    /// The enclosing scope; none for the root.
    pub fn parent_region(&self, region: ScopeId) -> Option<ScopeId> {
        self.regions.get(region.index())?.parent
    }

    /// The scope whose node it is, if there is one: the inverse of
    /// [`region_node`](CompiledChart::region_node).
    pub fn region_at(&self, node: NodeId) -> Option<ScopeId> {
        let index = self.layout.find_index(node)?;
        let found = self.regions.iter().position(|region| region.root == index)?;
        Some(ScopeId(found as u32))
    }

    /// The node of a scope: the root, a region of an AND, or a composite with an activity, which
    /// has a blackboard of its own.
    pub fn region_node(&self, region: ScopeId) -> Option<NodeId> {
        self.regions.get(region.index()).map(|region| self.layout.node(region.root))
    }

    /// Every state with an activity, inner ones first, otherwise in document order.
    pub fn activities(&self) -> impl ExactSizeIterator<Item = ActivityEntry<'_>> {
        self.activities.iter().map(|&node| self.activity_entry(node))
    }

    /// The activity of a state, if it has one.
    pub fn activity(&self, node: NodeId) -> Option<ActivityEntry<'_>> {
        let index = self.layout.find_index(node)?;
        self.states[index.index()].activity?;
        Some(self.activity_entry(index))
    }

    /// Every timer that an action starts: its scope and its name.
    pub fn timers(&self) -> impl ExactSizeIterator<Item = (ScopeId, &str)> {
        self.timers.iter().map(|timer| (timer.region, timer.name.as_ref()))
    }

    /// The name of a timer of a scope; empty if the scope does not have it.
    pub fn timer_name(&self, region: ScopeId, timer: TimerId) -> &str {
        let first = self.regions.get(region.index()).map_or(0, |region| region.timers);
        let timer = self.timers.get(first + timer.0 as usize);
        timer.filter(|timer| timer.region == region).map_or("", |timer| &timer.name)
    }

    /// The guard of each segment in each scope in which it is taken.
    pub fn guards(&self) -> impl ExactSizeIterator<Item = (TransitionId, ScopeId, &Guard)> {
        self.guards.iter().map(|guard| (guard.transition, guard.region, &guard.guard))
    }

    /// The actions of transitions, entries and exits, in the scopes in which they are executed.
    pub fn effects(&self) -> impl Iterator<Item = (ActionLocation, ScopeId, &[Effect])> {
        let compounds = self.compounds.iter().flat_map(|compound| {
            let effects = compound.effects.iter();
            effects.map(|(id, effects)| (ActionLocation::Transition(*id), compound.region, &**effects))
        });
        let states = self.states.iter().zip(self.layout.indices()).flat_map(|(state, index)| {
            let node = self.layout.node(index);
            let entry = (ActionLocation::Entry(node), state.region, &*state.entry);
            [entry, (ActionLocation::Exit(node), state.region, &*state.exit)]
        });
        let unreached = self.unreached.iter();
        let unreached =
            unreached.map(|(id, region, effects)| (ActionLocation::Transition(*id), *region, &**effects));
        compounds.chain(states).chain(unreached)
    }

    /// The largest number of simultaneously active activities: an upper bound for useful threads.
    pub fn max_activities(&self) -> usize {
        self.max_activities
    }

    /// The topics that guards or triggers read, in order: messages on other topics do not affect
    /// the chart.
    pub fn reads(&self) -> &[TopicId] {
        &self.reads
    }

    /// The messages that guards, assigned values or triggers read, in order, each once.
    #[inline]
    pub fn sources(&self) -> impl ExactSizeIterator<Item = &MessageSource> {
        self.sources.iter()
    }

    /// The text of a script; empty for a script of another chart.
    pub fn script(&self, script: ScriptId) -> &str {
        self.scripts.text(script)
    }

    /// The scripts of its conditions and actions, with their locations.
    pub fn scripts(&self) -> impl ExactSizeIterator<Item = ScriptEntry<'_>> {
        self.script_locations.iter().enumerate().map(|(id, locations)| {
            let id = ScriptId(id as u32);
            ScriptEntry { id, text: self.scripts.text(id), locations }
        })
    }

    /// The short names of its states.
    pub fn names(&self) -> &StateNames {
        self.names.get_or_init(|| StateNames::of(&self.statechart))
    }

    /// A node's path without the root's name; the root's own name for the root.
    pub fn short_path(&self, node: NodeId) -> String {
        let path = self.statechart.path(node);
        match path.split_once('/') {
            Some((_, rest)) => rest.to_owned(),
            None => path,
        }
    }

    fn activity_entry(&self, index: NodeIndex) -> ActivityEntry<'_> {
        let id = self.layout.node(index);
        let node = self.statechart.node(id);
        ActivityEntry {
            node: id,
            name: node.activity.as_deref().unwrap_or_default(),
            priority: node.priority,
            duration: node.duration,
            region: self.states[index.index()].activity_region,
        }
    }
}
