//! A statechart made ready to run: checked, numbered, with every way through it worked out in advance.

mod build;
mod check;
mod direct;
mod entries;
mod events;
mod layout;
mod leaps;
mod paths;
mod roles;
mod scope;
mod scripts;
mod segments;
mod visits;
mod ways;

use std::ops::Range;
use std::time::Duration;

use crate::bits::BitSet;
use crate::diagnostic::Diagnostic;
use crate::expression::{Effect, EventId, EventTable, Guard, MessageSource, ScriptId, ScriptTable, TimerId};
use crate::host::ActionPlace;
use crate::semantics::{EventMatching, Semantics};
use crate::statechart::{NodeId, NodeKind, Statechart, TransitionId};
use crate::typed::Program;
use crate::vocabulary::{TopicId, Vocabulary};

pub(crate) use direct::{Direct, DirectActions, DirectPlace};
pub(crate) use events::Trigger;
pub(crate) use layout::{Layout, Place};
pub(crate) use leaps::{Cell, Does, Leap, More, Reactions};
pub use scripts::{ScriptEntry, ScriptPlace};

/// A blackboard of a running chart: number 0 is the root's, and each region of an AND has one of its own. Composites within a
/// region share it.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Debug)]
pub struct RegionId(pub u32);

impl RegionId {
    /// The root's blackboard.
    pub const ROOT: RegionId = RegionId(0);

    pub(crate) fn index(self) -> usize {
        self.0 as usize
    }
}

/// A compound transition of a [`Chart`]: one way from a state through connectors to a state, taken as a whole.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Debug)]
pub struct CompoundId(pub(crate) u32);

/// A statechart that a [`Machine`](crate::Machine) can run; immutable, meant to be shared behind an `Arc`.
///
/// It is made by [`Statechart::compile`]. Whatever does not depend on data is decided here: which compound transitions there are and
/// in which order they are tried, which states each leaves and enters, and on which blackboard it lives.
#[derive(Clone, Debug)]
pub struct Chart {
    statechart: Statechart,
    semantics: Semantics,
    events: EventTable,
    scripts: ScriptTable,
    script_places: Box<[Box<[ScriptPlace]>]>,
    pub(crate) layout: Layout,
    pub(crate) states: Box<[State]>,
    pub(crate) regions: Box<[Region]>,
    pub(crate) branches: Box<[Branch]>,
    pub(crate) triggers: Box<[Trigger]>,
    pub(crate) guards: Box<[ScopedGuard]>,
    pub(crate) weights: Box<[Weight]>,
    /// The trees of branches in which something is drawn behind a connector, by their first branch.
    pub(crate) deep: Box<[Deep]>,
    pub(crate) rows: Box<[Row]>,
    pub(crate) compounds: Box<[Compound]>,
    pub(crate) choices: Box<[Choice]>,
    /// By their owner.
    pub(crate) histories: Box<[History]>,
    pub(crate) joins: Box<[Join]>,
    pub(crate) activities: Box<[Place]>,
    pub(crate) timers: Box<[Timer]>,
    pub(crate) masks: Masks,
    /// In which order states are looked at without an event, if it is not that of their places.
    pub(crate) visits: Option<Box<[Place]>>,
    pub(crate) direct: Option<Direct>,
    pub(crate) errors: ErrorEvents,
    /// The event that stands for all that no expression names.
    pub(crate) unnamed: EventId,
    /// The actions of segments that no way leads through.
    unreached: Box<[Unreached]>,
    reads: Box<[TopicId]>,
    sources: Box<[MessageSource]>,
    max_activities: usize,
}

/// A segment that no way leads through, where it would be taken, and its actions.
type Unreached = (TransitionId, RegionId, Box<[Effect]>);

/// A node as the machine sees it.
#[derive(Clone, Debug)]
pub(crate) struct State {
    pub(crate) kind: NodeKind,
    /// The blackboard it lies in; that of a region is its own.
    pub(crate) region: RegionId,
    /// Whether it is the region itself: entering it fills a blackboard.
    pub(crate) is_region: bool,
    /// Whether it is an END of the root.
    pub(crate) finishes: bool,
    pub(crate) parent: Option<Place>,
    /// An OR's START.
    pub(crate) start: Option<Place>,
    /// An AND's regions, an OR's ENDs.
    pub(crate) parts: Box<[Place]>,
    /// Its HISTORYs, by number.
    pub(crate) histories: Range<usize>,
    /// The event that its completion is.
    pub(crate) done: Option<EventId>,
    /// Its number among the activities.
    pub(crate) activity: Option<usize>,
    pub(crate) entry: Box<[Effect]>,
    pub(crate) exit: Box<[Effect]>,
    pub(crate) defer: Box<[EventId]>,
    /// The branches without a trigger, then those with one.
    pub(crate) eventless: Branches,
    pub(crate) triggered: Branches,
}

/// Neighbours in [`Chart::branches`].
#[derive(Clone, Copy, PartialEq, Eq, Debug, Default)]
pub(crate) struct Branches {
    pub(crate) start: usize,
    pub(crate) end: usize,
}

impl Branches {
    pub(crate) fn is_empty(self) -> bool {
        self.start == self.end
    }
}

/// One segment on the ways out of a state. The ways form a tree, written depth first in the order in which they are tried: what follows
/// a branch is its first continuation, and `skip` leads past all of them.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Branch {
    pub(crate) condition: Condition,
    pub(crate) guard: Option<usize>,
    /// Its number among the segments with a weight.
    pub(crate) weight: Option<usize>,
    /// The compound transition that is complete with this segment.
    pub(crate) compound: Option<CompoundId>,
    pub(crate) skip: usize,
}

/// What a branch asks for beside its guard.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Debug)]
pub(crate) enum Condition {
    /// Nothing: it is not the first segment.
    None,
    /// Nothing: it may be taken whenever its source is active.
    Always,
    /// That its source has completed.
    Completed,
    /// That nothing inside its source can step or runs.
    Quiescent,
    /// That nothing inside its source can step; what runs there will be interrupted.
    NoStepInside,
    /// That all sources of a JOIN have completed.
    AllCompleted(usize),
    /// That its source has completed and has not yet arrived at a JOIN.
    Arrives(usize),
    /// That all have arrived at a JOIN.
    AllArrived(usize),
    /// An event that a trigger matches.
    Trigger(usize),
}

/// A segment with a weight, on one place in a tree of branches.
#[derive(Clone, Debug)]
pub(crate) struct Weight {
    pub(crate) value: f64,
    pub(crate) segment: TransitionId,
    /// The branches beside it, itself among them.
    pub(crate) beside: Branches,
}

/// A tree of branches in which something is drawn behind a connector, whose ways may lie on several blackboards: so they are gone through
/// one by one.
#[derive(Clone, Debug)]
pub(crate) struct Deep {
    pub(crate) first_branch: usize,
    /// Its ways, in the order in which they are tried.
    pub(crate) rows: Range<usize>,
}

/// One way of such a tree.
#[derive(Clone, Debug)]
pub(crate) struct Row {
    pub(crate) compound: CompoundId,
    pub(crate) condition: Condition,
    /// By segment.
    pub(crate) guards: Box<[Option<usize>]>,
}

/// A CHOICE on one blackboard.
#[derive(Clone, Debug)]
pub(crate) struct Choice {
    pub(crate) node: NodeId,
    pub(crate) branches: Branches,
}

/// A HISTORY.
#[derive(Clone, Debug)]
pub(crate) struct History {
    pub(crate) place: Place,
    pub(crate) owner: Place,
    pub(crate) is_deep: bool,
    /// The ways out of it, for when nothing is recorded.
    pub(crate) branches: Branches,
}

/// A JOIN.
#[derive(Clone, Debug)]
pub(crate) struct Join {
    /// The AND around its sources.
    pub(crate) around: Place,
    /// The number of its first segment among all segments into JOINs; the others follow.
    pub(crate) first: usize,
    pub(crate) sources: Box<[Place]>,
    /// The region that each source lies in.
    pub(crate) regions: Box<[Place]>,
}

impl Join {
    /// The numbers of its segments.
    pub(crate) fn slots(&self) -> Range<usize> {
        self.first..self.first + self.sources.len()
    }
}

/// A guard of a segment on one blackboard.
#[derive(Clone, Debug)]
pub(crate) struct ScopedGuard {
    pub(crate) transition: TransitionId,
    pub(crate) region: RegionId,
    pub(crate) guard: Guard,
}

/// A compound transition.
#[derive(Clone, Debug)]
pub(crate) struct Compound {
    pub(crate) segments: Box<[TransitionId]>,
    pub(crate) source: Place,
    /// The further sources of a JOIN.
    pub(crate) others: Box<[Place]>,
    /// The blackboard of its scope.
    pub(crate) region: RegionId,
    pub(crate) scope: Place,
    /// Places of which all active ones are left.
    pub(crate) exits: Option<(Place, Place)>,
    /// What stays without an active child.
    pub(crate) vacates: Option<Place>,
    /// The number of the segment into a JOIN that it is.
    pub(crate) arrives: Option<usize>,
    pub(crate) leaves: Box<[Leaf]>,
    pub(crate) entries: Entries,
    /// The state that timers which it starts belong to.
    pub(crate) owner: Owner,
    pub(crate) effects: Box<[(TransitionId, Box<[Effect]>)]>,
    pub(crate) interrupts: bool,
    /// Its place in the order of firing.
    pub(crate) key: u64,
}

impl Compound {
    /// The states it begins at.
    pub(crate) fn sources(&self) -> impl Iterator<Item = Place> {
        std::iter::once(self.source).chain(self.others.iter().copied())
    }

    /// Whether it leaves a place if that is active.
    pub(crate) fn leaves(&self, place: Place) -> bool {
        self.exits.is_some_and(|(first, last)| first <= place && place <= last)
    }

    /// Whether two compound transitions leave common states: what is active in what both of them leave. A composite that was left without
    /// an active child has nothing to be left.
    pub(crate) fn conflicts_with(&self, other: &Compound, active: &BitSet) -> bool {
        let (Some(a), Some(b)) = (self.exits, other.exits) else { return false };
        let (first, last) = (a.0.max(b.0), a.1.min(b.1));
        first <= last && active.any_in(first.index(), last.index())
    }
}

/// Where a compound transition ends or goes on.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub(crate) enum Leaf {
    /// At a state or a HISTORY.
    Node(Place),
    /// At a CHOICE, by its number.
    Choice(usize),
    Terminate,
}

/// What a compound transition enters.
#[derive(Clone, Debug)]
pub(crate) enum Entries {
    None,
    /// These, outermost first.
    Listed(Box<[Place]>),
    /// What its leaves ask for, found out while entering.
    Found,
}

/// The state that a timer belongs to.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub(crate) enum Owner {
    None,
    State(Place),
    /// The state that is the first target, which a CHOICE decides on.
    Later,
}

/// A blackboard.
#[derive(Clone, Debug)]
pub(crate) struct Region {
    pub(crate) root: Place,
    pub(crate) parent: Option<RegionId>,
    /// The first of its timers; the others follow.
    pub(crate) timers: usize,
}

/// A timer of a blackboard.
#[derive(Clone, Debug)]
pub(crate) struct Timer {
    pub(crate) name: Box<str>,
    pub(crate) region: RegionId,
    /// Its number on its blackboard.
    pub(crate) number: usize,
    /// The event that its expiry is, if a trigger names it or a state defers it.
    pub(crate) event: Option<EventId>,
}

/// Sets of places.
#[derive(Clone, Debug)]
pub(crate) struct Masks {
    pub(crate) starts: BitSet,
    pub(crate) eventless: BitSet,
    pub(crate) triggered: BitSet,
    pub(crate) deferring: BitSet,
}

/// The events that failures are.
#[derive(Clone, Copy, Debug)]
pub(crate) struct ErrorEvents {
    pub(crate) guard: EventId,
    pub(crate) action: EventId,
    pub(crate) activity: EventId,
}

/// The activity of a BASIC state.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub struct ActivityEntry<'a> {
    /// The state.
    pub node: NodeId,
    /// The name it is registered under.
    pub name: &'a str,
    /// Higher runs first.
    pub priority: i32,
    /// How long it takes in simulated time, if the model says so.
    pub duration: Option<Duration>,
    /// The blackboard it works on.
    pub region: RegionId,
}

impl Statechart {
    /// Checks the chart and makes it ready to run with the words of a vocabulary, read as [`Semantics::yase`] does.
    ///
    /// # Errors
    /// Everything that is wrong with its structure ([`check`](Statechart::check)), or else with its expressions.
    pub fn compile(&self, vocabulary: &Vocabulary) -> Result<Chart, Vec<Diagnostic>> {
        self.compile_with(vocabulary, Semantics::yase())
    }

    /// Checks the chart and makes it ready to run, read in one of the ways in which dialects read charts.
    ///
    /// # Errors
    /// Everything that is wrong with its structure ([`check`](Statechart::check)), or else with its expressions.
    pub fn compile_with(
        &self,
        vocabulary: &Vocabulary,
        semantics: Semantics,
    ) -> Result<Chart, Vec<Diagnostic>> {
        Chart::build(self, vocabulary, semantics, None)
    }
}

impl Chart {
    pub(crate) fn build(
        statechart: &Statechart,
        vocabulary: &Vocabulary,
        semantics: Semantics,
        program: Option<&Program>,
    ) -> Result<Chart, Vec<Diagnostic>> {
        build::build(statechart, vocabulary, semantics, program)
    }

    /// The statechart it was made from; every [`NodeId`] and [`TransitionId`] is one of it.
    pub fn statechart(&self) -> &Statechart {
        &self.statechart
    }

    /// How it is read.
    pub fn semantics(&self) -> Semantics {
        self.semantics
    }

    pub(crate) fn semantics_ref(&self) -> &Semantics {
        &self.semantics
    }

    /// The event that an occurrence of that name is, and whether any expression names it so: else it is, if names match
    /// [by tokens](EventMatching::TokenPrefix), the event that the longest row of its first tokens names, or else `?`.
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
    pub fn events(&self) -> &EventTable {
        &self.events
    }

    /// The segments of a compound transition, in order.
    pub fn segments(&self, compound: CompoundId) -> &[TransitionId] {
        self.compounds.get(compound.0 as usize).map_or(&[], |compound| &compound.segments)
    }

    /// Every blackboard, the root's first, then in the order of the document.
    pub fn regions(&self) -> impl ExactSizeIterator<Item = RegionId> + use<> {
        (0..self.regions.len() as u32).map(RegionId)
    }

    /// The blackboard that a node lies in; that of a region is its own.
    pub fn region_of(&self, node: NodeId) -> Option<RegionId> {
        self.layout.place(node).map(|place| self.states[place.index()].region)
    }

    /// The blackboard that a region's lies in; none for the root's.
    pub fn parent_region(&self, region: RegionId) -> Option<RegionId> {
        self.regions.get(region.index())?.parent
    }

    /// The node that a blackboard belongs to: the root, or a region of an AND.
    pub fn region_node(&self, region: RegionId) -> Option<NodeId> {
        self.regions.get(region.index()).map(|region| self.layout.node(region.root))
    }

    /// Every BASIC state with an activity, in the order of the document.
    pub fn activities(&self) -> impl ExactSizeIterator<Item = ActivityEntry<'_>> {
        self.activities.iter().map(|&place| self.activity_entry(place))
    }

    /// The activity of a BASIC state, if it has one.
    pub fn activity(&self, node: NodeId) -> Option<ActivityEntry<'_>> {
        let place = self.layout.place(node)?;
        self.states[place.index()].activity?;
        Some(self.activity_entry(place))
    }

    /// Every timer that some action starts: the blackboard it lies on, and its name.
    pub fn timers(&self) -> impl ExactSizeIterator<Item = (RegionId, &str)> {
        self.timers.iter().map(|timer| (timer.region, timer.name.as_ref()))
    }

    /// The name of a timer of a blackboard; empty for one of another.
    pub fn timer_name(&self, region: RegionId, timer: TimerId) -> &str {
        let first = self.regions.get(region.index()).map_or(0, |region| region.timers);
        let timer = self.timers.get(first + timer.0 as usize);
        timer.filter(|timer| timer.region == region).map_or("", |timer| &timer.name)
    }

    /// The guard of each segment on each blackboard on which it is taken.
    pub fn guards(&self) -> impl ExactSizeIterator<Item = (TransitionId, RegionId, &Guard)> {
        self.guards.iter().map(|guard| (guard.transition, guard.region, &guard.guard))
    }

    /// The actions of transitions, entries and exits, on the blackboards on which they are done.
    pub fn effects(&self) -> impl Iterator<Item = (ActionPlace, RegionId, &[Effect])> {
        let compounds = self.compounds.iter().flat_map(|compound| {
            let effects = compound.effects.iter();
            effects.map(|(id, effects)| (ActionPlace::Transition(*id), compound.region, &**effects))
        });
        let states = self.states.iter().zip(self.layout.places()).flat_map(|(state, place)| {
            let node = self.layout.node(place);
            let entry = (ActionPlace::Entry(node), state.region, &*state.entry);
            [entry, (ActionPlace::Exit(node), state.region, &*state.exit)]
        });
        let unreached = self.unreached.iter();
        let unreached =
            unreached.map(|(id, region, effects)| (ActionPlace::Transition(*id), *region, &**effects));
        compounds.chain(states).chain(unreached)
    }

    /// The largest number of activities that can be active at once: how many threads can be of use.
    pub fn max_activities(&self) -> usize {
        self.max_activities
    }

    /// The topics that guards or triggers read, in order: a message on any other changes nothing that the chart can see.
    pub fn reads(&self) -> &[TopicId] {
        &self.reads
    }

    /// The messages that guards, the values of assignments or triggers read, in order, each once.
    pub fn sources(&self) -> impl ExactSizeIterator<Item = &MessageSource> {
        self.sources.iter()
    }

    /// The text of a script; empty for one of another chart.
    pub fn script(&self, script: ScriptId) -> &str {
        self.scripts.text(script)
    }

    /// The scripts of its conditions and actions, and where each stands.
    pub fn scripts(&self) -> impl ExactSizeIterator<Item = ScriptEntry<'_>> {
        self.script_places.iter().enumerate().map(|(id, places)| {
            let id = ScriptId(id as u32);
            ScriptEntry { id, text: self.scripts.text(id), places }
        })
    }

    /// A node's path without the root's name, as traces show it; the root's own name for the root.
    pub fn short_path(&self, node: NodeId) -> String {
        let path = self.statechart.path(node);
        match path.split_once('/') {
            Some((_, rest)) => rest.to_owned(),
            None => path,
        }
    }

    fn activity_entry(&self, place: Place) -> ActivityEntry<'_> {
        let id = self.layout.node(place);
        let node = self.statechart.node(id);
        ActivityEntry {
            node: id,
            name: node.activity.as_deref().unwrap_or_default(),
            priority: node.priority,
            duration: node.duration,
            region: self.states[place.index()].region,
        }
    }
}
