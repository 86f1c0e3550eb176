//! Execution of a micro-step: R10, R12, R13.

use std::collections::BTreeSet;

use yase::statechart::{NodeId, NodeKind, TransitionId};
use yase::{ActivityOnExit, CompletionTrigger, Host, RootCompletion, ScopeId, Statechart};

use super::{Failure, Phase, StaticPath, Stepper};
use crate::world::World;

impl Stepper<'_> {
    /// Fires transitions in order, without those whose source an earlier one has exited, even if it
    /// is active again.
    pub(crate) fn fire_each(
        &mut self,
        ways: Vec<StaticPath>,
        world: &mut World,
    ) -> Result<Vec<StaticPath>, Failure> {
        let mut fired = vec![];
        for way in ways {
            let left = way.sources.iter().any(|source| self.line.exits.contains(source));
            if self.running_chart && !self.ended && !left {
                self.fire(&way, world)?;
                fired.push(way);
            }
        }
        Ok(fired)
    }

    /// Whether all sources are still active.
    pub(crate) fn may_fire(&self, way: &StaticPath) -> bool {
        way.sources.iter().all(|source| self.active.contains(source))
    }

    pub(crate) fn fire(&mut self, way: &StaticPath, world: &mut World) -> Result<(), Failure> {
        let exits = self.exit_set(way);
        self.leave_all(&exits, world);
        let targets = self.effects_and_targets(way, world)?;
        if !self.terminates {
            self.enter_targets(way, &targets, world)?;
        }
        self.halt_if_terminated(world);
        Ok(())
    }

    /// R13
    fn halt_if_terminated(&mut self, world: &mut World) {
        if std::mem::take(&mut self.terminates) {
            self.halt(world);
        }
    }

    /// Whether no further state is entered.
    pub(crate) fn is_ended(&self) -> bool {
        self.terminates || !self.running_chart
    }

    /// All exits, then all effects, then all entries.
    pub(crate) fn fire_phases(
        &mut self,
        ways: Vec<StaticPath>,
        world: &mut World,
    ) -> Result<Vec<StaticPath>, Failure> {
        let ways = self.with_their_sources(ways);
        let exits: BTreeSet<NodeId> = ways.iter().flat_map(|way| self.exit_set(way)).collect();
        self.leave_all(&exits, world);
        let (mut entering, mut stops) = (vec![], false);
        for way in &ways {
            let targets = self.effects_and_targets(way, world)?;
            match std::mem::take(&mut self.terminates) {
                true => stops = true, // after the targets of the others have been entered
                false => entering.push((way.clone(), targets)),
            }
        }
        entering.sort_by_key(|(way, _)| self.position(self.scope(way)));
        for (way, targets) in entering {
            if !self.is_ended() {
                self.enter_targets(&way, &targets, world)?;
            }
        }
        self.terminates |= stops;
        self.halt_if_terminated(world);
        Ok(ways)
    }

    /// Removes transitions with a target whose source another one exits: they were selected only
    /// because nothing is active in that source.
    fn with_their_sources(&self, mut ways: Vec<StaticPath>) -> Vec<StaticPath> {
        let mut index = 0;
        while index < ways.len() {
            let way = &ways[index];
            let stays = self.is_targetless(way)
                || self.only_terminates(way)
                || self.kind(way.ends[0]) == NodeKind::Join
                || self.kind(self.scope(way)) == NodeKind::Basic; // nothing inside can be exited
            let mut others = ways.iter().enumerate().filter(|(other, _)| *other != index);
            let is_left = others.any(|(_, other)| {
                let left = self.exit_set(other);
                way.sources.iter().any(|source| left.contains(source))
            });
            if is_left && !stays {
                ways.remove(index);
            } else {
                index += 1;
            }
        }
        ways
    }

    fn leave_all(&mut self, exits: &BTreeSet<NodeId>, world: &mut World) {
        self.record_histories(exits);
        for node in self.in_order_of_exit(exits) {
            self.leave(node, world);
        }
    }

    fn record_histories(&mut self, exits: &BTreeSet<NodeId>) {
        for &owner in exits {
            for &child in self.chart.children(owner) {
                let record = match self.kind(child) {
                    NodeKind::ShallowHistory => self.active_children(owner),
                    NodeKind::DeepHistory => self.active_inside(owner),
                    _ => continue,
                };
                if record.is_empty() && self.kind(owner) == NodeKind::Or {
                    self.records.remove(&child); // it was vacated
                } else {
                    self.records.insert(child, record);
                }
            }
        }
    }

    pub(crate) fn leave(&mut self, node: NodeId, world: &mut World) {
        if let Some(job) = self.running.remove(&node) {
            match job.phase {
                Phase::Ongoing => world.stop(self.activation(node, job.number)),
                Phase::Running if self.semantics.on_exit == ActivityOnExit::Interrupted => {
                    world.cancel(self.activation(node, job.number));
                }
                _ => {}
            }
        }
        let actions = self.chart.node(node).exit.clone();
        let before = self.unbound.clone();
        self.act(&actions, self.region(node), &format!("exit {}", self.name(node)), world);
        self.unbound = before; // timers started by exit actions belong to no state
        self.active.remove(&node);
        self.waiting.remove(&node);
        self.vacated.remove(&node);
        self.completions.retain(|&other| other != node);
        self.forget_arrivals(node);
        self.unset_timers_of(node);
        self.line.exits.push(node);
    }

    /// Resets the arrivals at the JOINs of an exited AND, or those of an exited region.
    fn forget_arrivals(&mut self, node: NodeId) {
        let (chart, is_region) = (self.chart, self.is_region(node));
        let from = |id: &TransitionId| chart.transition(*id).source;
        let inside = |source: NodeId| chart.ancestors(source).any(|above| above == node);
        if self.kind(node) == NodeKind::And || is_region {
            self.arrivals.retain(|id| !(inside(from(id)) || is_region && from(id) == node));
        }
    }

    /// Executes the effects of the complete compound transition, with its CHOICEs evaluated on the
    /// way; returns its targets.
    fn effects_and_targets(&mut self, way: &StaticPath, world: &mut World) -> Result<Vec<NodeId>, Failure> {
        let region = self.region(self.scope(way));
        self.effects(&way.segments, region, world);
        let targets = self.choose(&way.ends, region, world)?;
        self.bind_timers(targets.first().copied());
        Ok(targets)
    }

    pub(crate) fn effects(&mut self, segments: &[TransitionId], region: ScopeId, world: &mut World) {
        for &id in segments {
            let transition = self.transition(id);
            let place = format!("{} -> {}", self.name(transition.source), self.name(transition.target));
            self.act(&transition.expression.actions, region, &place, world);
        }
    }

    /// R12: evaluates CHOICEs until none is left.
    pub(crate) fn choose(
        &mut self,
        ends: &[NodeId],
        region: ScopeId,
        world: &mut World,
    ) -> Result<Vec<NodeId>, Failure> {
        let mut targets = vec![];
        for &end in ends {
            if self.terminates {
                break; // nothing follows TERMINATE
            }
            if self.kind(end) != NodeKind::Choice {
                self.terminates = self.kind(end) == NodeKind::Terminate;
                targets.push(end);
                continue;
            }
            let out = self.outgoing(end);
            let found =
                self.first_way(end, &out, &mut |me, way, so_far| me.all_hold(way, so_far, region, world));
            let Some(way) = found else { return Err(Failure::NoBranch(end)) };
            self.line.taken.extend(&way.segments);
            self.effects(&way.segments, region, world);
            targets.extend(self.choose(&way.ends, region, world)?);
        }
        Ok(targets)
    }

    fn enter_targets(
        &mut self,
        way: &StaticPath,
        targets: &[NodeId],
        world: &mut World,
    ) -> Result<(), Failure> {
        let vacated = self.vacates(way);
        let arrives = self.kind(way.ends[0]) == NodeKind::Join;
        for &node in &vacated {
            let is_filled = self.chart.children(node).iter().any(|child| self.active.contains(child));
            if self.kind(node) == NodeKind::Basic || !self.active.contains(&node) || is_filled {
                // a BASIC region has nothing to exit; in phases another may have exited or
                // re-entered it before
                continue;
            }
            self.vacated.insert(node);
            match arrives {
                true => self.complete_around(node), // not newly completed for the region
                false => self.completed(node),
            }
        }
        if arrives && self.joined_and(way.ends[0]).is_some_and(|and| self.active.contains(&and)) {
            self.arrivals.extend(&way.segments);
            self.arrived_at(way.ends[0]);
        }
        if vacated.is_empty() && !self.is_targetless(way) {
            self.enter_below(self.scope(way), targets, world)?;
        }
        Ok(())
    }

    /// Offers the completion of an AND again when all sources of a JOIN have arrived.
    fn arrived_at(&mut self, join: NodeId) {
        let all = self.incoming(join).iter().all(|id| self.arrivals.contains(id));
        if let Some(and) =
            self.joined_and(join).filter(|_| all && self.semantics.eventless == CompletionTrigger::Once)
            && !self.completions.contains(&and)
        {
            self.completions.push(and);
        }
    }

    /// The remaining work when the root has reached its END.
    pub(crate) fn end(&mut self, world: &mut World) {
        if !self.ended {
            return;
        }
        self.ended = false;
        if self.semantics.root_end == RootCompletion::ExitsAll {
            for node in self.active_in_document_order().into_iter().rev() {
                self.leave(node, world);
            }
            self.print_finish(world);
        }
        self.halt(world);
    }

    /// R13, and the remaining work when a chart ends.
    pub(crate) fn halt(&mut self, world: &mut World) {
        for node in self.tree.document.clone() {
            let Some(job) = self.running.get(&node).cloned() else { continue };
            match job.phase {
                Phase::Running if !job.cancelled => world.cancel(self.activation(node, job.number)),
                Phase::Ongoing => world.stop(self.activation(node, job.number)),
                _ => {}
            }
        }
        self.running.clear();
        self.raised.clear();
        self.arrived.clear();
        self.deferred.clear();
        self.held.clear();
        self.pending.clear();
        self.completions.clear();
        self.running_chart = false;
    }

    pub(crate) fn begin_chart(&mut self, world: &mut World) {
        self.begin_micro_step();
        self.enter(Statechart::ROOT, world);
        match self.enter_below(Statechart::ROOT, &[], world) {
            Ok(()) => {
                self.print_start(world);
                self.halt_if_terminated(world);
            }
            Err(failure) => {
                self.active.clear();
                self.failure = Some(failure);
            }
        }
    }
}
