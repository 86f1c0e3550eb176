//! The execution of a micro-step: exits, actions, entries.

use crate::compile::{Arrival, CompoundTransition, EntryPlan, NodeIndex, Owner};
use crate::host::Host;
use crate::ids::{ActionLocation, CompoundTransitionId};
use crate::machine::Status;
use crate::machine::actions::ActionContext;
use crate::machine::errors::StepError;
use crate::machine::step::Macrostep;
use crate::semantics::Firing;
use crate::trace::MicroStepCause;

impl<H: Host> Macrostep<'_, H> {
    /// Enters the root and its START. The first step returns an error that occurs here.
    pub(crate) fn begin_run(&mut self) {
        self.run.begin_micro_step();
        match self.enter_root() {
            Ok(()) => {
                self.emit_trace(MicroStepCause::Start, None);
                self.stop_if_terminated();
            }
            Err(fault) => {
                self.run.clear_entered();
                self.run.failure = Some(fault);
            }
        }
    }

    /// Takes the oldest pending interrupting transition whose activities have all returned.
    pub(crate) fn fire_pending(&mut self) -> Result<bool, StepError> {
        let ready = self
            .run
            .pending
            .iter()
            .position(|pending| !self.exits_running_activity(self.compound(pending.compound)));
        let Some(index) = ready else { return Ok(false) };
        self.count_micro_step()?;
        let pending = self.run.pending.remove(index);
        self.run.begin_micro_step();
        self.run.selection.selected.push(pending.compound);
        self.fire_selected()?;
        self.clear_exited();
        self.emit_trace(pending.event.map_or(MicroStepCause::Eventless, MicroStepCause::Event), None);
        Ok(true)
    }

    /// Cleans up after a pending transition: others may have lost their source, and the events it
    /// held can be offered.
    fn clear_exited(&mut self) {
        let chart = self.chart;
        let (active, pending) = (&self.run.active, &mut self.run.pending);
        pending.retain(|pending| {
            let mut sources = chart.compounds[pending.compound.0 as usize].sources();
            sources.all(|source| active.contains(source.index()))
        });
        self.run.queues.release(|_| true);
    }

    /// Takes the selected transitions, one after the other or in phases. If one fails at a CHOICE,
    /// the configuration is restored.
    pub(crate) fn fire_selected(&mut self) -> Result<(), StepError> {
        if !self.chart.choices.is_empty() {
            self.run.previous_configuration.copy_from(&self.run.active);
        }
        let fired = match self.semantics().firing {
            Firing::EachTransition | Firing::EachSegment => self.fire_each(),
            Firing::Phases => self.fire_phases(),
        };
        if fired.is_err() {
            self.run.active.copy_from(&self.run.previous_configuration);
            // the machine stops: records of this micro-step are invalid, earlier ones no longer
            // needed
            self.run.vacated.clear();
            self.run.arrived.clear();
        }
        fired
    }

    /// Skips transitions after the end of the chart, and those whose source another has left, even
    /// if it is active again: a transition that leaves nothing, such as a path to TERMINATE,
    /// conflicts with none.
    fn fire_each(&mut self) -> Result<(), StepError> {
        let mut index = 0;
        while let Some(&id) = self.run.selection.selected.get(index) {
            let fired = &self.run.selection.selected[..index];
            let stays = |source: NodeIndex| {
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

    fn fire(&mut self, id: CompoundTransitionId) -> Result<(), StepError> {
        let compound = &self.chart.compounds[id.0 as usize];
        self.count_fired(id);
        let ends_early = self.ends_early(compound);
        if self.semantics().firing == Firing::EachSegment {
            self.walk_segments(compound, ends_early)?;
        } else {
            if let Some((first, last)) = self.exits_of(compound, ends_early) {
                self.leave_between(first, last);
            }
            self.execute_effects(compound, ends_early)?;
        }
        self.enter_targets(compound, ends_early)?;
        self.stop_if_terminated();
        Ok(())
    }

    /// Whether a transition that was to pass where all regions have arrived ends there, since
    /// another one that was to arrive in this micro-step was not taken.
    #[inline]
    fn ends_early<'c>(&self, compound: &'c CompoundTransition) -> Option<&'c Arrival> {
        compound.arrival.as_ref().filter(|arrival| arrival.passes && !self.others_arrive(arrival.slot))
    }

    /// Whether all other regions have arrived where one does, or arrive in this micro-step.
    pub(crate) fn others_arrive(&self, slot: usize) -> bool {
        let selection = &self.run.selection;
        let arriving = |other: usize| {
            let taken =
                if selection.selected.is_empty() { &selection.candidates } else { &selection.selected };
            taken.iter().any(|&id| self.compound(id).arrives() == Some(other))
        };
        let join = self.chart.joins.iter().find(|join| join.slots().contains(&slot));
        join.is_some_and(|join| {
            join.slots().all(|other| other == slot || self.run.arrived.contains(other) || arriving(other))
        })
    }

    /// The index range of the nodes that a transition leaves, if active.
    #[inline]
    fn exits_of(
        &self,
        compound: &CompoundTransition,
        ends_early: Option<&Arrival>,
    ) -> Option<(NodeIndex, NodeIndex)> {
        match ends_early {
            None => compound.exits,
            Some(arrival) => arrival.inside,
        }
    }

    #[inline]
    pub(crate) fn count_fired(&mut self, id: CompoundTransitionId) {
        self.summary.transitions += 1;
        self.run.livelock_limit.record_transition(id);
    }

    /// Executes the actions of a transition, and determines its targets.
    fn execute_effects(
        &mut self,
        compound: &CompoundTransition,
        ends_early: Option<&Arrival>,
    ) -> Result<(), StepError> {
        if let Some(arrival) = ends_early {
            self.do_actions_up_to(compound, arrival);
            return Ok(());
        }
        self.do_actions(compound);
        match compound.entries {
            EntryPlan::Listed(_) => Ok(()),
            EntryPlan::None | EntryPlan::Found => self.mark_leaves(&compound.leaves, compound.scope),
        }
    }

    /// Executes the actions of a path, segment by segment.
    #[inline(never)]
    pub(crate) fn do_actions(&mut self, compound: &CompoundTransition) {
        for (segment, effects) in &compound.effects {
            let scene = ActionContext {
                location: ActionLocation::Transition(*segment),
                region: compound.region,
                owner: compound.owner,
            };
            self.perform(effects, scene);
        }
    }

    /// Executes the actions of the segments up to an arrival.
    fn do_actions_up_to(&mut self, compound: &CompoundTransition, arrival: &Arrival) {
        let taken = &compound.segments[..=arrival.segment];
        for (segment, effects) in compound.effects.iter().filter(|(segment, _)| taken.contains(segment)) {
            let location = ActionLocation::Transition(*segment);
            self.perform(effects, ActionContext { location, region: compound.region, owner: Owner::None });
        }
    }

    /// Enters the targets of a transition, unless the chart has reached its end.
    fn enter_targets(
        &mut self,
        compound: &CompoundTransition,
        ends_early: Option<&Arrival>,
    ) -> Result<(), StepError> {
        if self.run.terminates || self.run.status != Status::Running {
            return Ok(());
        }
        // in phases another transition may have left it before, or entered it again with something
        // inside
        let is_empty = |node: NodeIndex| {
            let first = self.chart.layout.first(node).index();
            self.run.active.next(first, node.index()) == Some(node.index())
        };
        let arrival = ends_early.or(compound.arrival.as_ref().filter(|arrival| !arrival.passes));
        let vacated = match ends_early {
            Some(arrival) => arrival.inside.map(|_| arrival.region),
            None => compound.vacates,
        };
        if let Some(index) = vacated.filter(|&node| is_empty(node)) {
            self.run.mark_vacated(self.chart, index, arrival.is_some());
        }
        if let Some(arrival) = arrival {
            self.run.arrive(self.chart, *arrival);
        }
        if ends_early.is_some() {
            return Ok(());
        }
        match &compound.entries {
            EntryPlan::None => {}
            EntryPlan::Listed(list) => list.iter().for_each(|&node| self.enter(node)),
            EntryPlan::Found => self.enter_inside(compound.scope)?,
        }
        Ok(())
    }

    /// Stops the chart if a path has reached TERMINATE.
    pub(crate) fn stop_if_terminated(&mut self) {
        if std::mem::take(&mut self.run.terminates) {
            self.halt(Status::Stopped);
        }
    }

    /// All exits, then all actions, then all entries: each as one set, with the actions in the
    /// order of selection. If one transition leads to TERMINATE, the targets of the others are
    /// entered before the chart stops.
    fn fire_phases(&mut self) -> Result<(), StepError> {
        let chart = self.chart;
        let compound = |id: CompoundTransitionId| &chart.compounds[id.0 as usize];
        self.drop_transitions_without_source();
        self.run.ending_early.clear();
        self.each_selected(|step, id| {
            if step.ends_early(compound(id)).is_some() {
                step.run.ending_early.push(id);
            }
            Ok(())
        })?;
        self.each_selected(|step, id| {
            step.count_fired(id);
            if let Some((first, last)) = step.exits_of(compound(id), step.noted_early(id, compound(id))) {
                step.run.record_histories(chart, first, last);
                step.collect_between(first, last);
            }
            Ok(())
        })?;
        self.leave_collected();
        self.run.document_order.clear();
        let mut stops = false;
        self.each_selected(|step, id| {
            step.execute_effects(compound(id), step.noted_early(id, compound(id)))?;
            match std::mem::take(&mut step.run.terminates) {
                true => stops = true,
                false => step.run.document_order.push(id),
            }
            Ok(())
        })?;
        self.run.document_order.sort_by_key(|&id| chart.layout.rank(compound(id).scope));
        let mut index = 0;
        while let Some(&id) = self.run.document_order.get(index) {
            self.enter_targets(compound(id), self.noted_early(id, compound(id)))?;
            index += 1;
        }
        self.run.terminates |= stops;
        self.stop_if_terminated();
        Ok(())
    }

    fn noted_early<'c>(
        &self,
        id: CompoundTransitionId,
        compound: &'c CompoundTransition,
    ) -> Option<&'c Arrival> {
        compound.arrival.as_ref().filter(|_| self.run.ending_early.contains(&id))
    }

    /// A transition out of a composite without active children leaves nothing, and so conflicts
    /// with none. But it is not taken together with another that leaves that composite: the targets
    /// of both would be active together.
    fn drop_transitions_without_source(&mut self) {
        let mut index = 0;
        while let Some(&id) = self.run.selection.selected.get(index) {
            let (compound, others) = (self.compound(id), &self.run.selection.selected);
            let is_left = |source: NodeIndex| {
                others.iter().any(|&other| other != id && self.compound(other).leaves(source))
            };
            if compound.exits.is_some() && compound.arrives().is_none() && compound.sources().any(is_left) {
                self.run.selection.selected.remove(index);
            } else {
                index += 1;
            }
        }
    }

    fn each_selected(
        &mut self,
        mut act: impl FnMut(&mut Self, CompoundTransitionId) -> Result<(), StepError>,
    ) -> Result<(), StepError> {
        let mut index = 0;
        while let Some(&id) = self.run.selection.selected.get(index) {
            act(self, id)?;
            index += 1;
        }
        Ok(())
    }
}
