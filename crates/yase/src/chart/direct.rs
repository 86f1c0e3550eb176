//! What the short way of a step goes by: transitions that an event leads to and nothing complicates.
//!
//! Most steps are alike. One event arrives, no activity runs, nothing waits, and transitions lead from states to states. Whether a transition
//! is of this kind is known beforehand, and so is all that has to be looked at. In a chart of at most 64 nodes, which most are, a set of
//! places is one word, and selecting is a matter of a few instructions; larger charts go the long way.

use crate::chart::{Branch, Branches, Compound, CompoundId, Condition, State, Trigger};
use crate::expression::EventId;
use crate::semantics::{ExitOrder, Firing, Semantics, StartRest};

/// So many places fit into one word.
const PLACES: usize = u64::BITS as usize;

/// What the short way needs of a chart. Sets of places are words.
#[derive(Clone, Debug)]
pub(crate) struct Direct {
    /// The places that keep a step from the short way while they are active.
    pub(crate) detours: u64,
    /// The places that have ways out.
    pub(crate) sources: u64,
    /// The places that are entered without more than their actions.
    pub(crate) plain: u64,
    /// The places without others inside.
    pub(crate) leaves: u64,
    pub(crate) places: Box<[DirectPlace]>,
    ways: Box<[DirectWay]>,
}

/// One place.
#[derive(Clone, Copy, Debug)]
pub(crate) struct DirectPlace {
    /// Itself and all places inside.
    pub(crate) inside: u64,
    /// Its ways out, in the order in which they are tried.
    first: u32,
    last: u32,
}

/// One way out of a state.
#[derive(Clone, Copy, Debug)]
pub(crate) struct DirectWay {
    pub(crate) event: EventId,
    pub(crate) guard: Option<u32>,
    pub(crate) compound: CompoundId,
    /// The places it leaves, if they are active.
    pub(crate) exits: u64,
}

impl Direct {
    /// None for charts that are too large, or read in a way in which transitions do not happen one after the other, as they were worked out.
    pub(super) fn new(
        semantics: &Semantics,
        states: &[State],
        branches: &[Branch],
        triggers: &[Trigger],
        compounds: &[Compound],
    ) -> Option<Direct> {
        let serves = semantics.firing == Firing::EachTransition
            && semantics.exits == ExitOrder::Forward
            && semantics.start == StartRest::Place;
        if states.len() > PLACES || !serves {
            return None;
        }
        let mut direct = Direct { detours: 0, sources: 0, plain: 0, leaves: 0, places: Box::default(), ways: Box::default() };
        let (mut places, mut ways) = (Vec::new(), Vec::new());
        for (place, state) in states.iter().enumerate() {
            let first = ways.len() as u32;
            if is_simple(state) && append(state.triggered, branches, triggers, compounds, &mut ways) {
                direct.sources |= u64::from(ways.len() as u32 > first) << place;
            } else {
                ways.truncate(first as usize);
                direct.detours |= 1 << place;
            }
            let inside = state.children.iter().map(|child| places[child.index()]).fold(1 << place, |inside, child: DirectPlace| inside | child.inside);
            let is_plain = state.activity.is_none() && !state.is_region && !state.finishes;
            direct.plain |= u64::from(is_plain) << place;
            direct.leaves |= u64::from(state.children.is_empty()) << place;
            places.push(DirectPlace { inside, first, last: ways.len() as u32 });
        }
        (direct.places, direct.ways) = (places.into(), ways.into());
        Some(direct)
    }

    /// The ways out of a place, in the order in which they are tried.
    #[inline]
    pub(crate) fn ways(&self, place: &DirectPlace) -> &[DirectWay] {
        self.ways.get(place.first as usize..place.last as usize).unwrap_or(&[])
    }
}

/// Whether entering and leaving a state is a matter of its actions, and it is left for events alone.
fn is_simple(state: &State) -> bool {
    state.activity.is_none() && state.eventless.is_empty()
}

/// Appends the ways of a state, if each is a single segment with a trigger that names its events.
fn append(
    range: Branches,
    branches: &[Branch],
    triggers: &[Trigger],
    compounds: &[Compound],
    ways: &mut Vec<DirectWay>,
) -> bool {
    for branch in &branches[range.start..range.end] {
        let (Condition::Trigger(trigger), Some(id)) = (branch.condition, branch.compound) else { return false };
        let (Trigger::OneOf(events), compound) = (&triggers[trigger], &compounds[id.0 as usize]) else { return false };
        if compound.terminates {
            return false;
        }
        let exits = compound.exits.map_or(0, |(first, last)| (u64::MAX >> (63 - last.0)) & (u64::MAX << first.0));
        let guard = branch.guard.map(|guard| guard as u32);
        ways.extend(events.iter().map(|&event| DirectWay { event, guard, compound: id, exits }));
    }
    true
}
