//! Entering states.
//!
//! Where a transition has one target and no START is gone through, what is entered is a list that was worked out in advance. Else the
//! targets are marked with all that is around them, up to the scope, and the way down from the scope follows the marks.

use crate::chart::{Branches, Leaf, Owner, Place};
use crate::host::{ActionPlace, Host};
use crate::machine::Status;
use crate::machine::act::Scene;
use crate::machine::errors::Fault;
use crate::machine::step::Step;
use crate::semantics::{RootEnd, StartRest};
use crate::statechart::NodeKind;

impl<H: Host> Step<'_, H> {
    /// Enters the root and what is in it.
    pub(super) fn enter_root(&mut self) -> Result<(), Fault> {
        let root = self.chart.layout.root();
        self.enter(root);
        self.enter_inside(root)
    }

    /// Marks a target and what is around it, up to the scope.
    pub(super) fn mark(&mut self, target: Place, scope: Place) {
        let mut next = Some(target).filter(|&place| place != scope);
        while let Some(place) = next {
            if self.run.marked.contains(place.index()) {
                return;
            }
            self.run.marked.insert(place.index());
            next = self.chart.states[place.index()].parent.filter(|&parent| parent != scope);
        }
    }

    /// Enters what is marked inside a scope, and what comes with it.
    pub(super) fn enter_inside(&mut self, scope: Place) -> Result<(), Fault> {
        self.unfold(scope)?;
        while let Some(place) = self.run.entering.pop() {
            if self.run.status != Status::Running || self.run.terminates {
                self.run.entering.clear();
                break;
            }
            self.run.marked.remove(place.index());
            self.enter(place);
            self.unfold(place)?;
        }
        Ok(())
    }

    /// Finds out what is entered with a composite: an AND's regions; an OR's marked child, or what its HISTORY or its START leads to.
    fn unfold(&mut self, place: Place) -> Result<(), Fault> {
        let state = &self.chart.states[place.index()];
        match state.kind {
            NodeKind::And => {
                self.resolve_histories(place)?;
                self.run.entering.extend(state.parts.iter().rev());
            }
            NodeKind::Or => {
                self.resolve_histories(place)?;
                let child = match self.marked_child(place) {
                    None if !self.run.terminates => self.begin_at_start(place)?,
                    child => child,
                };
                self.run.entering.extend(child);
            }
            _ => {}
        }
        Ok(())
    }

    /// The child of an OR that is marked: of all places in it the last, since what is marked is so up to the child.
    pub(super) fn marked_child(&self, place: Place) -> Option<Place> {
        let first = self.chart.layout.first(place).index();
        let last = place.index().checked_sub(1)?;
        self.run.marked.last(first, last).map(|index| Place(index as u32))
    }

    /// START, or what it leads to if it is left in the same step.
    fn begin_at_start(&mut self, place: Place) -> Result<Option<Place>, Fault> {
        let start = self.chart.states[place.index()].start;
        let Some(begin) = start.filter(|_| self.semantics().start == StartRest::SameStep) else {
            return Ok(start);
        };
        if !self.follow(self.chart.states[begin.index()].eventless, place)? {
            return Ok(start);
        }
        self.resolve_histories(place)?;
        // a HISTORY that leads nowhere leaves it at START
        Ok(self.marked_child(place).or(start))
    }

    /// Goes on, behind the actions that have been done, on a way that is decided on now. False if none is open.
    pub(super) fn follow(&mut self, branches: Branches, scope: Place) -> Result<bool, Fault> {
        let Some(id) = self.open_way(branches) else { return Ok(false) };
        let way = &self.chart.compounds[id.0 as usize];
        if self.run.log.wanted {
            self.run.log.taken.extend_from_slice(&way.segments);
        }
        self.do_actions(way);
        self.mark_leaves(&way.leaves, scope)?;
        Ok(true)
    }

    /// Marks where a way ends; where it ends at a CHOICE, goes on. Nothing happens behind TERMINATE.
    pub(super) fn mark_leaves(&mut self, leaves: &[Leaf], scope: Place) -> Result<(), Fault> {
        for &leaf in leaves {
            match leaf {
                Leaf::Node(place) => {
                    self.mark(place, scope);
                    self.bind_timers(place);
                }
                Leaf::Choice(number) => {
                    let choice = &self.chart.choices[number];
                    if !self.follow(choice.branches, scope)? {
                        return Err(Fault::NoBranch(choice.node));
                    }
                }
                Leaf::Terminate => {
                    self.run.terminates = true;
                    self.run.unbound.clear();
                }
            }
            if self.run.terminates {
                break;
            }
        }
        Ok(())
    }

    /// Timers that were started before the first target was known belong to it.
    fn bind_timers(&mut self, target: Place) {
        if self.run.unbound.is_empty() {
            return;
        }
        let is_history = self.chart.histories.iter().find(|history| history.place == target);
        let owner = is_history.map_or(target, |history| history.owner);
        while let Some(timer) = self.run.unbound.pop() {
            self.run.timers.bind(timer, owner);
        }
    }

    #[inline(never)]
    pub(super) fn enter(&mut self, place: Place) {
        let state = &self.chart.states[place.index()];
        let node = self.chart.layout.node(place);
        self.run.activate(self.chart, place);
        self.run.occupy(self.chart, state.parent);
        if self.run.log.wanted {
            self.run.log.entries.push(node);
        }
        if state.is_region
            && let Some(around) = self.chart.regions[state.region.index()].parent
        {
            self.host.inherit(state.region, around);
        }
        let scene =
            Scene { place: ActionPlace::Entry(node), region: state.region, owner: Owner::State(place) };
        self.perform(&state.entry, scene);
        if let Some(activity) = state.activity {
            self.run.enqueue_activity(self.chart, place, activity);
        }
        match state.kind {
            NodeKind::End if state.finishes => self.finish_root(),
            NodeKind::End => self.run.end_reached(self.chart, place),
            NodeKind::Basic if state.activity.is_none() => self.run.completed(self.chart, place),
            _ => {}
        }
    }

    fn finish_root(&mut self) {
        match self.semantics().root_end {
            RootEnd::Idle => self.halt(Status::Finished),
            RootEnd::ExitsAll => self.run.ending = true,
        }
    }
}
