//! Taking a compound transition segment by segment.
//!
//! A segment leaves states, executes its actions and enters the states around its target before the
//! next one begins. The regions of an AND to which no segment leads are entered last.

use crate::compile::{
    Arrival, BranchRange, CompoundTransition, NodeIndex, Owner, SegmentStep, TransitionTarget,
};
use crate::host::Host;
use crate::ids::ActionLocation;
use crate::machine::Status;
use crate::machine::actions::ActionContext;
use crate::machine::errors::StepError;
use crate::machine::step::Macrostep;
use crate::statechart::NodeKind;

impl<H: Host> Macrostep<'_, H> {
    /// Takes the segments of a path, all or up to an arrival, and completes what it has entered.
    pub(crate) fn walk_segments(
        &mut self,
        compound: &CompoundTransition,
        ends_early: Option<&Arrival>,
    ) -> Result<(), StepError> {
        let base = self.run.incomplete.len();
        self.take_segments(compound, ends_early)?;
        self.bind_other_timers(compound, ends_early);
        self.enter_other_regions(base)
    }

    /// Takes, behind executed actions, the segments of a path that is selected now, and completes
    /// what it has entered unless it is part of another path. Returns false if none is enabled.
    pub(crate) fn follow_segments(
        &mut self,
        branches: BranchRange,
        is_whole: bool,
    ) -> Result<bool, StepError> {
        let Some(id) = self.first_open_path(branches) else { return Ok(false) };
        let compound = &self.chart.compounds[id.0 as usize];
        if self.run.log.wanted {
            self.run.log.taken.extend_from_slice(&compound.segments);
        }
        match is_whole {
            true => self.walk_segments(compound, None)?,
            false => self.take_segments(compound, None)?,
        }
        Ok(true)
    }

    fn take_segments(
        &mut self,
        compound: &CompoundTransition,
        ends_early: Option<&Arrival>,
    ) -> Result<(), StepError> {
        let count = ends_early.map_or(compound.steps.len(), |arrival| arrival.segment);
        for step in &compound.steps[..count] {
            self.leave_for(step);
            self.act_on_segment(compound, step);
            self.enter_around(step)?;
            if self.is_over() {
                break;
            }
        }
        if let Some(arrival) = ends_early.filter(|_| !self.is_over()) {
            if let Some((first, last)) = arrival.inside {
                self.leave_between(first, last);
            }
            self.act_on_segment(compound, &compound.steps[arrival.segment]);
        }
        Ok(())
    }

    /// Binds the timers that were started after the last target was entered to the first one.
    fn bind_other_timers(&mut self, compound: &CompoundTransition, ends_early: Option<&Arrival>) {
        while let Some(timer) = self.run.unbound_timers.pop() {
            if let (Owner::State(state), None) = (compound.owner, ends_early) {
                self.run.timers.bind(timer, state);
            }
        }
    }

    fn is_over(&self) -> bool {
        self.run.terminates || self.run.status != Status::Running
    }

    fn leave_for(&mut self, step: &SegmentStep) {
        let Some((first, last)) = step.exits else { return };
        if step.empties_composite {
            let owner = NodeIndex(last.0 + 1);
            self.run.record_histories(self.chart, owner, owner);
        }
        self.leave_between(first, last);
    }

    /// The timers that it starts belong to the next target.
    fn act_on_segment(&mut self, compound: &CompoundTransition, step: &SegmentStep) {
        if let Some((segment, effects)) = step.effects.and_then(|index| compound.effects.get(index)) {
            let location = ActionLocation::Transition(*segment);
            self.perform(effects, ActionContext { location, region: compound.region, owner: Owner::Dynamic });
        }
    }

    fn enter_around(&mut self, step: &SegmentStep) -> Result<(), StepError> {
        if let Some(TransitionTarget::Node(node)) = step.end {
            self.bind_timers(node);
        }
        for &index in &step.enters {
            if !self.run.is_active(index) {
                self.enter(index);
            }
            if self.chart.states[index.index()].kind == NodeKind::And {
                self.run.incomplete.push(index);
            }
            if self.is_over() {
                return Ok(());
            }
        }
        match step.end {
            None => Ok(()),
            Some(TransitionTarget::Node(node)) => self.enter_end(node),
            Some(TransitionTarget::Choice(number)) => {
                let choice = &self.chart.choices[number];
                match self.follow_segments(choice.branches, false)? {
                    true => Ok(()),
                    false => Err(StepError::NoBranch(choice.node)),
                }
            }
            Some(TransitionTarget::Terminate) => {
                self.run.terminates = true;
                self.run.unbound_timers.clear();
                Ok(())
            }
        }
    }

    /// Enters what is inside a target, or what a HISTORY stands for.
    fn enter_end(&mut self, node: NodeIndex) -> Result<(), StepError> {
        match self.chart.histories.iter().find(|history| history.node == node) {
            None => self.enter_inside(node),
            Some(history) => {
                self.run.marked.insert(node.index());
                self.enter_inside(history.owner)
            }
        }
    }

    /// Enters the regions of the ANDs that were entered on the way and to which no segment led.
    fn enter_other_regions(&mut self, base: usize) -> Result<(), StepError> {
        let mut index = base;
        while let Some(&and) = self.run.incomplete.get(index) {
            index += 1;
            for &region in &self.chart.states[and.index()].parts {
                if !self.is_over() && self.run.is_active(and) && !self.run.is_active(region) {
                    self.enter(region);
                    self.enter_inside(region)?;
                }
            }
        }
        self.run.incomplete.truncate(base);
        Ok(())
    }
}
