//! What the short way of a step goes by: transitions that an event leads to and nothing complicates.
//!
//! Most steps are alike. One event arrives, no activity runs, nothing waits, and transitions lead from states to states. Whether a transition
//! is of this kind is known beforehand, and so is all that has to be looked at. In a chart of at most 64 nodes a set of places is one word,
//! and selecting is a matter of a few instructions; larger charts, and those with nodes that are decided on while a transition happens,
//! go the long way.

use std::ops::Range;

use crate::chart::leaps::{Leaps, PLACES};
use crate::chart::{
    Branch, Branches, Compound, CompoundId, Condition, Entries, Layout, Place, RegionId, State, Trigger,
};
use crate::expression::{Effect, EventId, ScriptId};
use crate::semantics::{Eventless, Semantics};
use crate::statechart::{NodeId, NodeKind, Statechart};

/// What the short way needs of a chart. Sets of places are words.
#[derive(Clone, Debug)]
pub(crate) struct Direct {
    /// The places that keep a step from the short way while they are active.
    pub(crate) detours: u64,
    /// The places that have ways out.
    pub(crate) sources: u64,
    /// The places without others inside.
    pub(crate) leaves: u64,
    pub(crate) places: Box<[DirectPlace]>,
    pub(crate) ways: Box<[DirectWay]>,
    /// What the ways enter.
    pub(crate) entries: Box<[Place]>,
    /// What need not be looked for.
    pub(crate) leaps: Leaps,
}

/// One place.
#[derive(Clone, Debug)]
pub(crate) struct DirectPlace {
    /// Itself and all places inside.
    pub(crate) inside: u64,
    /// Its ways out, in the order in which they are tried.
    pub(crate) ways: Range<u16>,
    pub(crate) node: NodeId,
    pub(crate) region: RegionId,
    pub(crate) exit: DirectActions,
    pub(crate) entry: DirectActions,
    /// Whether it is entered without more than its actions.
    pub(crate) is_plain: bool,
}

/// What is done at the entry or the exit of a state.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub(crate) enum DirectActions {
    /// Nothing.
    None,
    /// One action, which is the host's.
    Script(ScriptId),
    /// Others.
    Others,
}

impl From<&[Effect]> for DirectActions {
    fn from(effects: &[Effect]) -> DirectActions {
        match effects {
            [] => DirectActions::None,
            [Effect::Script { script }] => DirectActions::Script(*script),
            _ => DirectActions::Others,
        }
    }
}

/// One way out of a state.
#[derive(Clone, Debug)]
pub(crate) struct DirectWay {
    pub(crate) event: EventId,
    pub(crate) guard: Option<u32>,
    pub(crate) compound: CompoundId,
    pub(crate) source: u64,
    /// The places it leaves, if they are active.
    pub(crate) exits: u64,
    /// The places it enters.
    pub(crate) enters: u64,
    /// Whether it has actions of its own.
    pub(crate) acts: bool,
    /// The same in their order, in [`Direct::entries`].
    pub(crate) entries: Range<u32>,
    /// Its place in the order of firing.
    pub(crate) key: u64,
}

impl Direct {
    /// None if the short way cannot serve the chart.
    pub(super) fn new(
        chart: &Statechart,
        semantics: &Semantics,
        layout: &Layout,
        states: &[State],
        ways: &Ways<'_>,
    ) -> Option<Direct> {
        if states.len() > PLACES || !is_as_worked_out(semantics) || !has_known_kinds_only(chart) {
            return None;
        }
        let mut direct = Direct {
            detours: 0,
            sources: 0,
            leaves: 0,
            places: Box::default(),
            ways: Box::default(),
            entries: Box::default(),
            leaps: Leaps::default(),
        };
        let (mut places, mut found) = (Vec::<DirectPlace>::new(), Found::default());
        for (place, state) in states.iter().enumerate() {
            let (bit, first) = (1 << place, found.ways.len());
            let rests = state.kind == NodeKind::Start; // whether it waits there is told at the end of a step
            if rests
                || state.activity.is_some()
                || !state.eventless.is_empty()
                || !ways.append(state.triggered, &mut found)
            {
                found.ways.truncate(first);
                direct.detours |= bit;
            }
            if found.ways.len() > first {
                direct.sources |= bit;
            }
            if !matches!(state.kind, NodeKind::Or | NodeKind::And) {
                direct.leaves |= bit;
            }
            places.push(DirectPlace {
                inside: bit,
                ways: first as u16..found.ways.len() as u16,
                node: layout.node(Place(place as u32)),
                region: state.region,
                exit: DirectActions::from(&*state.exit),
                entry: DirectActions::from(&*state.entry),
                is_plain: state.activity.is_none() && !state.is_region && !state.finishes,
            });
        }
        if found.ways.len() > usize::from(u16::MAX) {
            return None;
        }
        // children stand before their parents
        for place in 0..states.len() {
            if let Some(parent) = states[place].parent {
                places[parent.index()].inside |= places[place].inside;
            }
        }
        (direct.places, direct.ways, direct.entries) =
            (places.into(), found.ways.into(), found.entries.into());
        direct.leaps = Leaps::new(&direct, states);
        Some(direct)
    }
}

/// Whether transitions happen one after the other, as they were worked out, and no account of completions is kept.
fn is_as_worked_out(semantics: &Semantics) -> bool {
    let Semantics { eventless, delivery, deferral, limit, .. } = *semantics;
    eventless != Eventless::Once
        && *semantics == Semantics { eventless, delivery, deferral, limit, ..Semantics::yase() }
}

/// Whether everything is decided before a transition happens.
fn has_known_kinds_only(chart: &Statechart) -> bool {
    use NodeKind::{And, Basic, Condition, End, Junction, Or, Start, Terminate};
    let is_known = |kind| matches!(kind, Or | And | Basic | End | Start | Condition | Junction | Terminate);
    chart.nodes().all(|(_, node)| is_known(node.kind))
        && chart.transitions().all(|(_, transition)| transition.weight.is_none())
}

/// The ways that have been found to be direct.
#[derive(Default)]
struct Found {
    ways: Vec<DirectWay>,
    entries: Vec<Place>,
}

/// The ways of a chart.
pub(super) struct Ways<'a> {
    pub(super) branches: &'a [Branch],
    pub(super) triggers: &'a [Trigger],
    pub(super) compounds: &'a [Compound],
}

impl Ways<'_> {
    /// Appends the ways of a state; false if some is more than a segment with a trigger that names its events.
    fn append(&self, range: Branches, found: &mut Found) -> bool {
        for branch in &self.branches[range.start..range.end] {
            let (Condition::Trigger(trigger), Some(id)) = (branch.condition, branch.compound) else {
                return false;
            };
            let compound = &self.compounds[id.0 as usize];
            let (Trigger::OneOf(events), Some((exits, entries))) = (&self.triggers[trigger], moves(compound))
            else {
                return false;
            };
            let enters = entries.iter().fold(0, |enters, place| enters | 1 << place.0);
            let first = found.entries.len() as u32;
            found.entries.extend_from_slice(entries);
            let entries = first..found.entries.len() as u32;
            found.ways.extend(events.iter().map(|&event| DirectWay {
                event,
                guard: branch.guard.map(|guard| guard as u32),
                compound: id,
                source: 1 << compound.source.0,
                exits,
                enters,
                acts: !compound.effects.is_empty(),
                entries: entries.clone(),
                key: compound.key,
            }));
        }
        true
    }
}

/// The places that are left and entered; none if that is not known beforehand.
fn moves(compound: &Compound) -> Option<(u64, &[Place])> {
    match (compound.exits, &compound.entries) {
        (None, Entries::None) if compound.leaves.is_empty() => Some((0, &[])),
        (Some((first, last)), Entries::Listed(entries)) => {
            Some(((u64::MAX >> (63 - last.0)) & (u64::MAX << first.0), entries))
        }
        _ => None,
    }
}
