//! Entering states.
//!
//! If a transition has one target and passes no START, the list of entered nodes is precomputed.
//! Otherwise the targets are marked with all their ancestors up to the scope, and entry follows the
//! marks down from the scope.

use crate::compile::{BranchRange, NodeIndex, Owner, TransitionTarget};
use crate::host::Host;
use crate::ids::ActionLocation;
use crate::machine::Status;
use crate::machine::actions::ActionContext;
use crate::machine::errors::StepError;
use crate::machine::step::Macrostep;
use crate::semantics::{Firing, InitialState, RootCompletion};
use crate::statechart::NodeKind;

impl<H: Host> Macrostep<'_, H> {
    /// Enters the root and its default state.
    pub(crate) fn enter_root(&mut self) -> Result<(), StepError> {
        let root = self.chart.layout.root();
        self.enter(root);
        self.enter_inside(root)
    }

    /// Marks a target and its ancestors up to the scope.
    pub(crate) fn mark_for_entry(&mut self, target: NodeIndex, scope: NodeIndex) {
        let mut next = Some(target).filter(|&node| node != scope);
        while let Some(index) = next {
            if self.run.marked.contains(index.index()) {
                return;
            }
            self.run.marked.insert(index.index());
            next = self.chart.states[index.index()].parent.filter(|&parent| parent != scope);
        }
    }

    /// Enters the marked nodes inside a scope, and those entered with them.
    pub(crate) fn enter_inside(&mut self, scope: NodeIndex) -> Result<(), StepError> {
        let base = self.run.entering.len();
        self.expand_targets(scope)?;
        while self.run.entering.len() > base
            && let Some(node) = self.run.entering.pop()
        {
            if self.run.status != Status::Running || self.run.terminates {
                self.run.entering.clear();
                break;
            }
            self.run.marked.remove(node.index());
            self.enter(node);
            self.expand_targets(node)?;
        }
        Ok(())
    }

    /// Determines the nodes entered with a composite: the regions of an AND; the marked child of an
    /// OR, or the target of its HISTORY or its START.
    fn expand_targets(&mut self, node: NodeIndex) -> Result<(), StepError> {
        let state = &self.chart.states[node.index()];
        match state.kind {
            NodeKind::And => {
                self.resolve_histories(node)?;
                let run = &mut *self.run;
                let regions = state.parts.iter().rev().filter(|region| !run.active.contains(region.index()));
                run.entering.extend(regions);
            }
            NodeKind::Or => {
                if self.resolve_histories(node)? && self.has_active_inside(node) {
                    return Ok(());
                }
                let child = match self.marked_child(node) {
                    None if !self.run.terminates => self.enter_start(node)?,
                    child => child,
                };
                self.run.entering.extend(child);
            }
            _ => {}
        }
        Ok(())
    }

    /// The marked child of an OR: the last marked node inside it, since marks extend up to the
    /// child.
    pub(crate) fn marked_child(&self, node: NodeIndex) -> Option<NodeIndex> {
        let first = self.chart.layout.first(node).index();
        let last = node.index().checked_sub(1)?;
        self.run.marked.last(first, last).map(|index| NodeIndex(index as u32))
    }

    /// Returns START, or its target if it is left in the same step.
    fn enter_start(&mut self, node: NodeIndex) -> Result<Option<NodeIndex>, StepError> {
        let start = self.chart.states[node.index()].start;
        let Some(begin) = start else {
            self.run.mark_vacated(self.chart, node, false);
            return Ok(None);
        };
        if self.semantics().start == InitialState::Place {
            return Ok(start);
        }
        if self.semantics().firing == Firing::EachSegment {
            return self.leave_start(begin, node);
        }
        if !self.follow(self.chart.states[begin.index()].eventless, node)? {
            return Ok(start);
        }
        self.resolve_histories(node)?;
        // the composite remains in START if a HISTORY leads nowhere
        Ok(self.marked_child(node).or(start))
    }

    /// Takes the segments out of START. The composite remains in START if none is enabled, or if
    /// they lead to a HISTORY that leads nowhere.
    fn leave_start(&mut self, start: NodeIndex, node: NodeIndex) -> Result<Option<NodeIndex>, StepError> {
        if self.run.starting == Some(node) {
            return Ok(None);
        }
        let outer = self.run.starting.replace(node);
        let goes_on = self.follow_segments(self.chart.states[start.index()].eventless, true);
        self.run.starting = outer;
        goes_on?;
        let stays =
            !self.run.terminates && self.run.status == Status::Running && !self.has_active_inside(node);
        Ok(stays.then_some(start))
    }

    fn has_active_inside(&self, node: NodeIndex) -> bool {
        let first = self.chart.layout.first(node).index();
        node.index() > first && self.run.active.any_in(first, node.index() - 1)
    }

    /// Continues, behind executed actions, on a path that is selected now. Returns false if none is
    /// enabled.
    pub(crate) fn follow(&mut self, branches: BranchRange, scope: NodeIndex) -> Result<bool, StepError> {
        let Some(id) = self.first_open_path(branches) else { return Ok(false) };
        let compound = &self.chart.compounds[id.0 as usize];
        if self.run.log.wanted {
            self.run.log.taken.extend_from_slice(&compound.segments);
        }
        self.do_actions(compound);
        self.mark_leaves(&compound.leaves, scope)?;
        Ok(true)
    }

    /// Marks the end of a path; at a CHOICE, continues. Nothing happens behind TERMINATE.
    pub(crate) fn mark_leaves(
        &mut self,
        leaves: &[TransitionTarget],
        scope: NodeIndex,
    ) -> Result<(), StepError> {
        for &leaf in leaves {
            match leaf {
                TransitionTarget::Node(node) => {
                    self.mark_for_entry(node, scope);
                    self.bind_timers(node);
                }
                TransitionTarget::Choice(number) => {
                    let choice = &self.chart.choices[number];
                    if !self.follow(choice.branches, scope)? {
                        return Err(StepError::NoBranch(choice.node));
                    }
                }
                TransitionTarget::Terminate => {
                    self.run.terminates = true;
                    self.run.unbound_timers.clear();
                }
            }
            if self.run.terminates {
                break;
            }
        }
        Ok(())
    }

    /// Binds timers that were started before the first target was known to that target.
    pub(crate) fn bind_timers(&mut self, target: NodeIndex) {
        if self.run.unbound_timers.is_empty() {
            return;
        }
        let is_history = self.chart.histories.iter().find(|history| history.node == target);
        let owner = is_history.map_or(target, |history| history.owner);
        while let Some(timer) = self.run.unbound_timers.pop() {
            self.run.timers.bind(timer, owner);
        }
    }

    #[inline(never)]
    pub(crate) fn enter(&mut self, index: NodeIndex) {
        let state = &self.chart.states[index.index()];
        let node = self.chart.layout.node(index);
        self.run.activate(self.chart, index);
        self.run.mark_occupied(self.chart, state.parent);
        if self.run.log.wanted {
            self.run.log.entries.push(node);
        }
        if state.is_region
            && let Some(around) = self.chart.regions[state.region.index()].parent
        {
            self.host.inherit(state.region, around);
        }
        let scene = ActionContext {
            location: ActionLocation::Entry(node),
            region: state.region,
            owner: Owner::State(index),
        };
        self.perform(&state.entry, scene);
        if state.activity_region != state.region {
            self.host.inherit(state.activity_region, state.region);
        }
        if let Some(activity) = state.activity {
            self.run.enqueue_activity(self.chart, index, activity);
        }
        match state.kind {
            NodeKind::End if state.finishes => self.finish_root(),
            NodeKind::End => self.run.end_reached(self.chart, index),
            NodeKind::Basic if state.activity.is_none() => self.run.completed(self.chart, index),
            _ => {}
        }
    }

    fn finish_root(&mut self) {
        match self.semantics().root_end {
            RootCompletion::Idle => self.halt(Status::Finished),
            RootCompletion::ExitsAll => self.run.root_is_final = true,
        }
    }
}
