//! What an event does to an innermost state, worked out beforehand: which transition it leads to, and all that this transition does.
//!
//! Where the transitions of an innermost state neither leave nor start at anything that is active beside it, they need not be looked for,
//! nor compared with those of other regions: the state and the event say it all. So the short way looks them up, and goes through
//! a list of what is to be done. What is not of this kind is marked, and is found out as it happens.

use std::collections::BTreeSet;
use std::ops::Range;

use crate::chart::direct::{Direct, DirectActions, DirectWay};
use crate::chart::{CompoundId, Place, RegionId, State};
use crate::expression::{EventId, ScriptId};
use crate::host::ActionPlace;
use crate::statechart::NodeKind;

/// So many places fit into one word.
pub(super) const PLACES: usize = u64::BITS as usize;

/// Charts with more events are not worth the memory: each takes a row.
const MOST_EVENTS: u32 = 256;

/// For each innermost state and each event, what it leads to.
#[derive(Clone, Debug, Default)]
pub(crate) struct Leaps {
    /// By event.
    pub(crate) by_event: Box<[Reactions]>,
    pub(crate) leaps: Box<[Leap]>,
    pub(crate) moves: Box<[Move]>,
}

impl Leaps {
    /// What an event leads to where these innermost states are active, if that can be looked up: not where others have to do with what one of
    /// them leads to, nor where several are active and it leads to nothing.
    #[inline(always)]
    pub(crate) fn of(&self, event: EventId, leaves: u64) -> Option<&Reactions> {
        let reactions = self.by_event.get(event.0 as usize)?;
        let is_known = leaves & reactions.entangled == 0;
        (is_known && (leaves.is_power_of_two() || leaves & reactions.reacting != 0)).then_some(reactions)
    }
}

/// What one event leads to.
#[derive(Clone, Debug)]
pub(crate) struct Reactions {
    /// By place.
    cells: [Cell; PLACES],
    /// Where it leads to something.
    reacting: u64,
    /// Where others have to do with what it leads to.
    entangled: u64,
}

impl Reactions {
    const EMPTY: Reactions = Reactions { cells: [Cell::NONE; PLACES], reacting: 0, entangled: 0 };

    fn set(&mut self, place: usize, cell: Cell) {
        self.cells[place] = cell;
        match cell {
            Cell::NONE => {}
            Cell::ENTANGLED => self.entangled |= 1 << place,
            _ => self.reacting |= 1 << place,
        }
    }

    /// Those of these places where it leads to something.
    #[inline(always)]
    pub(crate) fn reacting(&self, places: u64) -> u64 {
        places & self.reacting
    }

    /// For the first of these places.
    #[inline(always)]
    pub(crate) fn cell(&self, places: u64) -> Cell {
        self.cells[places.trailing_zeros() as usize % PLACES]
    }
}

/// What an event leads to from an innermost state.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub(crate) struct Cell(pub(crate) u16);

impl Cell {
    /// Nothing.
    pub(crate) const NONE: Cell = Cell(u16::MAX);
    /// Something that others who are active beside it have to do with.
    pub(crate) const ENTANGLED: Cell = Cell(u16::MAX - 1);
}

/// A transition, from a certain innermost state.
#[derive(Clone, Debug)]
pub(crate) struct Leap {
    pub(crate) guard: Option<u32>,
    /// What it leads to if the guard does not hold.
    pub(crate) otherwise: Cell,
    pub(crate) compound: CompoundId,
    /// All places but those it leaves.
    pub(crate) stays: u64,
    pub(crate) enters: u64,
    /// What is done, in [`Leaps::moves`].
    pub(crate) moves: Range<u32>,
}

/// One thing to be done, and what is active when it is done.
#[derive(Clone, Debug)]
pub(crate) struct Move {
    /// All places but those that have been left.
    pub(crate) stays: u64,
    pub(crate) entered: u64,
    pub(crate) region: RegionId,
    pub(crate) does: Does,
}

#[derive(Clone, Copy, Debug)]
pub(crate) enum Does {
    /// The only action at an entry or exit, which is the host's.
    Script(ScriptId, ActionPlace),
    /// Something else.
    More(More),
}

#[derive(Clone, Copy, Debug)]
pub(crate) enum More {
    /// The actions of the transition.
    Effects,
    /// The actions at an exit.
    Exit(Place),
    /// The actions at an entry.
    Entry(Place),
    /// An entry that is more than its actions.
    Enter(Place),
}

impl Leaps {
    /// Nothing is looked up if the chart has too many events.
    pub(super) fn new(direct: &Direct, states: &[State]) -> Leaps {
        let events: BTreeSet<EventId> = direct.ways.iter().map(|way| way.event).collect();
        let count = events.last().map_or(0, |last| last.0.saturating_add(1));
        if count > MOST_EVENTS {
            return Leaps::default();
        }
        let mut finder = Finder { direct, states, leaps: Vec::new(), moves: Vec::new() };
        let mut by_event = vec![Reactions::EMPTY; count as usize];
        for event in events {
            for leaf in (0..states.len()).filter(|&place| direct.leaves >> place & 1 == 1) {
                by_event[event.0 as usize].set(leaf, finder.cell(leaf, event));
            }
        }
        if finder.leaps.len() >= usize::from(Cell::ENTANGLED.0) {
            return Leaps::default();
        }
        Leaps { by_event: by_event.into(), leaps: finder.leaps.into(), moves: finder.moves.into() }
    }
}

struct Finder<'a> {
    direct: &'a Direct,
    states: &'a [State],
    leaps: Vec<Leap>,
    moves: Vec<Move>,
}

impl<'a> Finder<'a> {
    fn cell(&mut self, leaf: usize, event: EventId) -> Cell {
        let ways = self.ways(leaf, event);
        if ways.iter().any(|&(source, way)| self.is_entangled(leaf, source, way)) {
            return Cell::ENTANGLED;
        }
        let mut cell = Cell::NONE;
        for (_, way) in ways.into_iter().rev() {
            let leap = self.leap(leaf, way, cell);
            cell = Cell(self.leaps.len().min(usize::from(Cell::ENTANGLED.0)) as u16);
            self.leaps.push(leap);
        }
        cell
    }

    /// The transitions that the event can lead to, with their sources, from the inside outward, up to the first without a guard.
    fn ways(&self, leaf: usize, event: EventId) -> Vec<(usize, &'a DirectWay)> {
        let mut found = Vec::new();
        for place in self.outward(leaf) {
            let Range { start, end } = self.direct.places[place].ways;
            for way in &self.direct.ways[usize::from(start)..usize::from(end)] {
                if way.event == event {
                    found.push((place, way));
                    if way.guard.is_none() {
                        return found;
                    }
                }
            }
        }
        found
    }

    fn outward(&self, leaf: usize) -> impl Iterator<Item = usize> + use<'a> {
        let states = self.states;
        std::iter::successors(Some(leaf), move |&place| states[place].parent.map(Place::index))
    }

    /// Whether others that are active beside the leaf are left with it, have the same source, or are to be asked first.
    fn is_entangled(&self, leaf: usize, source: usize, way: &DirectWay) -> bool {
        let is_and = |place: usize| self.states[place].kind == NodeKind::And;
        let others_are_inside = self.outward(leaf).take_while(|&place| place <= source).any(is_and);
        let leaves_others = (0..self.states.len())
            .filter(|&place| way.exits >> place & 1 == 1)
            .any(|place| self.meet(leaf, place).is_some_and(is_and));
        let is_alone = !self.outward(leaf).any(is_and);
        // what fires is in the order of the document but for internal transitions, and guards are read in an order of their own
        let is_in_turn = is_alone || way.guard.is_none() && way.key >> 32 == 1;
        others_are_inside || leaves_others || !is_in_turn
    }

    /// The innermost node that both are in.
    fn meet(&self, one: usize, other: usize) -> Option<usize> {
        self.outward(one).find(|&place| self.direct.places[place].inside >> other & 1 == 1)
    }

    fn leap(&mut self, leaf: usize, way: &DirectWay, otherwise: Cell) -> Leap {
        let first = self.moves.len() as u32;
        let (mut left, mut entered) = (0, 0);
        for place in self.outward(leaf).filter(|&place| way.exits >> place & 1 == 1) {
            let state = &self.direct.places[place];
            self.act(state.exit, place, ActionPlace::Exit(state.node), (left, 0), More::Exit);
            left |= 1 << place;
        }
        if way.acts {
            self.push(RegionId::ROOT, (left, 0), Does::More(More::Effects));
        }
        let Range { start, end } = way.entries;
        for place in self.direct.entries[start as usize..end as usize].iter().map(|place| place.index()) {
            let state = &self.direct.places[place];
            if state.is_plain {
                entered |= 1 << place;
                self.act(state.entry, place, ActionPlace::Entry(state.node), (left, entered), More::Entry);
            } else {
                self.push(state.region, (left, entered), Does::More(More::Enter(Place(place as u32))));
                entered |= 1 << place;
            }
        }
        let (guard, compound, stays, enters) = (way.guard, way.compound, !way.exits, way.enters);
        Leap { guard, otherwise, compound, stays, enters, moves: first..self.moves.len() as u32 }
    }

    fn act(
        &mut self,
        actions: DirectActions,
        place: usize,
        at: ActionPlace,
        changes: (u64, u64),
        others: impl Fn(Place) -> More,
    ) {
        let region = self.direct.places[place].region;
        match actions {
            DirectActions::None => {}
            DirectActions::Script(script) => self.push(region, changes, Does::Script(script, at)),
            DirectActions::Others => self.push(region, changes, Does::More(others(Place(place as u32)))),
        }
    }

    fn push(&mut self, region: RegionId, (left, entered): (u64, u64), does: Does) {
        self.moves.push(Move { stays: !left, entered, region, does });
    }
}
