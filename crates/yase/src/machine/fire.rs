//! What a micro-step does: leaving, acting, entering.

use crate::chart::{Compound, CompoundId, Entries, Place};
use crate::host::{ActionPlace, Host};
use crate::machine::Status;
use crate::machine::act::Scene;
use crate::machine::errors::Fault;
use crate::machine::step::Step;
use crate::semantics::Firing;
use crate::trace::Occasion;

impl<H: Host> Step<'_, H> {
    /// Enters the root and its START. What goes wrong is said by the first step.
    pub(super) fn begin_run(&mut self) {
        self.run.begin_micro_step();
        match self.enter_root() {
            Ok(()) => {
                self.emit(Occasion::Start, None);
                self.stop_if_terminated();
            }
            Err(fault) => {
                self.run.forget_entered();
                self.run.failure = Some(fault);
            }
        }
    }

    /// Fires the oldest interrupting transition whose activities have all returned.
    pub(super) fn fire_pending(&mut self) -> Result<bool, Fault> {
        let ready =
            self.run.pending.iter().position(|pending| !self.leaves_running(self.compound(pending.compound)));
        let Some(index) = ready else { return Ok(false) };
        self.admit()?;
        let pending = self.run.pending.remove(index);
        self.run.begin_micro_step();
        self.run.selection.selected.push(pending.compound);
        self.fire_selected()?;
        self.forget_left();
        self.emit(pending.event.map_or(Occasion::Eventless, Occasion::Event), None);
        Ok(true)
    }

    /// Once a pending transition has fired: others may have lost their source, and what was held because of it can be offered.
    fn forget_left(&mut self) {
        let chart = self.chart;
        let (active, pending) = (&self.run.active, &mut self.run.pending);
        pending.retain(|pending| {
            let mut sources = chart.compounds[pending.compound.0 as usize].sources();
            sources.all(|source| active.contains(source.index()))
        });
        self.run.queues.release(|_| true);
    }

    /// Fires the selected transitions, one after the other or in phases. If one cannot go on at a CHOICE, the configuration is what it was
    /// before.
    pub(super) fn fire_selected(&mut self) -> Result<(), Fault> {
        if !self.chart.choices.is_empty() {
            self.run.before.copy_from(&self.run.active);
        }
        let fired = match self.semantics().firing {
            Firing::EachTransition => self.fire_each(),
            Firing::Phases => self.fire_phases(),
        };
        if fired.is_err() {
            self.run.active.copy_from(&self.run.before);
            // what was vacated or has arrived in this micro-step has not, and it is of no more interest
            self.run.vacated.clear();
            self.run.arrived.clear();
        }
        fired
    }

    /// What comes after the end does not fire, nor what begins at a state that another has left, be it active again: that is in conflict
    /// with none if it leaves nothing itself, as a way to TERMINATE.
    fn fire_each(&mut self) -> Result<(), Fault> {
        let mut index = 0;
        while let Some(&id) = self.run.selection.selected.get(index) {
            let fired = &self.run.selection.selected[..index];
            let stays = |source: Place| {
                self.run.is_active(source) && !fired.iter().any(|&fired| self.compound(fired).leaves(source))
            };
            if self.run.status == Status::Running && self.compound(id).sources().all(stays) {
                self.fire(id)?;
                index += 1;
            } else {
                self.run.selection.selected.remove(index);
            }
        }
        Ok(())
    }

    fn fire(&mut self, id: CompoundId) -> Result<(), Fault> {
        let compound = &self.chart.compounds[id.0 as usize];
        self.count_fired(id);
        if let Some((first, last)) = compound.exits {
            self.leave_between(first, last);
        }
        self.act_on(compound)?;
        self.enter_on(compound)?;
        self.stop_if_terminated();
        Ok(())
    }

    #[inline]
    pub(super) fn count_fired(&mut self, id: CompoundId) {
        self.summary.transitions += 1;
        self.run.bound.remember(id);
    }

    /// Does the actions of a transition, and finds out where it leads.
    fn act_on(&mut self, way: &Compound) -> Result<(), Fault> {
        self.do_actions(way);
        match way.entries {
            Entries::Listed(_) => Ok(()),
            Entries::None | Entries::Found => self.mark_leaves(&way.leaves, way.scope),
        }
    }

    /// Does the actions of a way, segment by segment.
    #[inline(never)]
    pub(super) fn do_actions(&mut self, way: &Compound) {
        for (segment, effects) in &way.effects {
            let scene =
                Scene { place: ActionPlace::Transition(*segment), region: way.region, owner: way.owner };
            self.perform(effects, scene);
        }
    }

    /// Enters what a transition leads to. Nothing is entered any more when the chart has reached its end.
    fn enter_on(&mut self, compound: &Compound) -> Result<(), Fault> {
        if self.run.terminates || self.run.status != Status::Running {
            return Ok(());
        }
        // in phases another may have left it before, or entered it again with something inside
        let is_empty = |place: Place| {
            let first = self.chart.layout.first(place).index();
            self.run.active.next(first, place.index()) == Some(place.index())
        };
        if let Some(place) = compound.vacates.filter(|&place| is_empty(place)) {
            self.run.vacate(self.chart, place, compound.arrives.is_some());
        }
        self.run.arrive_at_join(self.chart, compound);
        match &compound.entries {
            Entries::None => {}
            Entries::Listed(list) => list.iter().for_each(|&place| self.enter(place)),
            Entries::Found => self.enter_inside(compound.scope)?,
        }
        Ok(())
    }

    /// A way to TERMINATE stops the chart.
    pub(super) fn stop_if_terminated(&mut self) {
        if std::mem::take(&mut self.run.terminates) {
            self.halt(Status::Stopped);
        }
    }

    /// All that is left, then all actions, then all that is entered: each as one set, and the actions in the order of selection. If one
    /// leads to TERMINATE, what the others lead to is entered before the chart stops.
    fn fire_phases(&mut self) -> Result<(), Fault> {
        let chart = self.chart;
        let compound = |id: CompoundId| &chart.compounds[id.0 as usize];
        self.drop_what_loses_its_source();
        self.each_selected(|step, id| {
            step.count_fired(id);
            if let Some((first, last)) = compound(id).exits {
                step.run.record_histories(chart, first, last);
                step.collect_between(first, last);
            }
            Ok(())
        })?;
        self.leave_collected();
        self.run.in_document.clear();
        let mut stops = false;
        self.each_selected(|step, id| {
            step.act_on(compound(id))?;
            match std::mem::take(&mut step.run.terminates) {
                true => stops = true,
                false => step.run.in_document.push(id),
            }
            Ok(())
        })?;
        self.run.in_document.sort_by_key(|&id| chart.layout.rank(compound(id).scope));
        let mut index = 0;
        while let Some(&id) = self.run.in_document.get(index) {
            self.enter_on(compound(id))?;
            index += 1;
        }
        self.run.terminates |= stops;
        self.stop_if_terminated();
        Ok(())
    }

    /// What leads out of a composite in which nothing is active leaves nothing, and so is in conflict with none. But it does not fire beside
    /// another that leaves that composite: what both enter would be active together.
    fn drop_what_loses_its_source(&mut self) {
        let mut index = 0;
        while let Some(&id) = self.run.selection.selected.get(index) {
            let (way, others) = (self.compound(id), &self.run.selection.selected);
            let is_left = |source: Place| {
                others.iter().any(|&other| other != id && self.compound(other).leaves(source))
            };
            if way.exits.is_some() && way.arrives.is_none() && way.sources().any(is_left) {
                self.run.selection.selected.remove(index);
            } else {
                index += 1;
            }
        }
    }

    fn each_selected(
        &mut self,
        mut act: impl FnMut(&mut Self, CompoundId) -> Result<(), Fault>,
    ) -> Result<(), Fault> {
        let mut index = 0;
        while let Some(&id) = self.run.selection.selected.get(index) {
            act(self, id)?;
            index += 1;
        }
        Ok(())
    }
}
