//! Execution of a micro-step: R10, R12, R13.

use std::collections::BTreeSet;

use yase::statechart::{NodeId, NodeKind, TransitionId};
use yase::{ActivityOnExit, Host, RootCompletion, ScopeId, Statechart};

use super::arrivals::Arrival;
use super::{Failure, Phase, StaticPath, Stepper};
use crate::test_host::TestHost;

impl Stepper<'_> {
    /// Fires transitions one by one. A transition whose source was exited by an earlier one is
    /// skipped, even if the source is active again.
    pub(crate) fn fire_each(
        &mut self,
        paths: Vec<StaticPath>,
        host: &mut TestHost,
    ) -> Result<Vec<StaticPath>, Failure> {
        let mut fired = vec![];
        let exits: Vec<BTreeSet<NodeId>> = paths.iter().map(|path| self.exit_set(path)).collect();
        let mut left = BTreeSet::new();
        self.taken = paths.clone();
        for (path, exits) in paths.into_iter().zip(exits) {
            let stays = |source: &NodeId| self.active.contains(source) && !left.contains(source);
            if self.running_chart && !self.ended && path.sources.iter().all(stays) {
                self.fire(&path, host)?;
                left.extend(exits);
                fired.push(path);
            } else {
                self.taken.retain(|other| *other != path);
            }
        }
        self.taken.clear();
        Ok(fired)
    }

    /// Whether all sources are still active.
    pub(crate) fn may_fire(&self, path: &StaticPath) -> bool {
        path.sources.iter().all(|source| self.active.contains(source))
    }

    pub(crate) fn fire(&mut self, path: &StaticPath, host: &mut TestHost) -> Result<(), Failure> {
        let early = self.ends_early(path);
        if self.walks_segments() {
            self.walk_whole(path, early, host)?;
        } else {
            let exits = self.exits_of(path, early);
            self.leave_all(&exits, host);
            let targets = self.effects_and_targets(path, early, host)?;
            if !self.is_ended() {
                self.enter_targets(path, early, &targets, host)?;
            }
        }
        if self.walks_segments() && !self.is_ended() {
            self.settle(path, early);
        }
        self.halt_if_terminated(host);
        Ok(())
    }

    /// R13
    fn halt_if_terminated(&mut self, host: &mut TestHost) {
        if std::mem::take(&mut self.terminates) {
            self.halt(host);
        }
    }

    /// Whether the chart has ended, so that no state is entered.
    pub(crate) fn is_ended(&self) -> bool {
        self.terminates || !self.running_chart
    }

    /// Fires transitions in phases: all exits, then all effects, then all entries.
    pub(crate) fn fire_phases(
        &mut self,
        paths: Vec<StaticPath>,
        host: &mut TestHost,
    ) -> Result<Vec<StaticPath>, Failure> {
        let paths = self.with_their_sources(paths);
        self.taken = paths.clone();
        let early: Vec<Option<Arrival>> = paths.iter().map(|path| self.ends_early(path)).collect();
        let exits: BTreeSet<NodeId> =
            paths.iter().zip(&early).flat_map(|(path, early)| self.exits_of(path, *early)).collect();
        self.leave_all(&exits, host);
        let (mut entering, mut stops) = (vec![], false);
        for (path, early) in paths.iter().zip(early) {
            let targets = self.effects_and_targets(path, early, host)?;
            match std::mem::take(&mut self.terminates) {
                true => stops = true, // after the targets of the others have been entered
                false => entering.push((path.clone(), early, targets)),
            }
        }
        entering.sort_by_key(|(path, ..)| self.position(self.scope(path)));
        for (path, early, targets) in entering {
            if !self.is_ended() {
                self.enter_targets(&path, early, &targets, host)?;
            }
        }
        self.taken.clear();
        self.terminates |= stops;
        self.halt_if_terminated(host);
        Ok(paths)
    }

    /// Removes transitions with targets whose source another transition exits: they were selected
    /// only because nothing is active in the source.
    fn with_their_sources(&self, mut paths: Vec<StaticPath>) -> Vec<StaticPath> {
        let mut index = 0;
        while index < paths.len() {
            let path = &paths[index];
            let stays = self.is_targetless(path)
                || self.only_terminates(path)
                || path.arrives().is_some()
                || self.kind(self.scope(path)) == NodeKind::Basic; // it has no content to exit
            let mut others = paths.iter().enumerate().filter(|(other, _)| *other != index);
            let is_left = others.any(|(_, other)| {
                let left = self.exit_set(other);
                path.sources.iter().any(|source| left.contains(source))
            });
            if is_left && !stays {
                paths.remove(index);
            } else {
                index += 1;
            }
        }
        paths
    }

    /// The states that a path exits.
    fn exits_of(&self, path: &StaticPath, early: Option<Arrival>) -> BTreeSet<NodeId> {
        match early {
            Some(arrival) => self.active_inside(arrival.region).into_iter().collect(),
            None => self.exit_set(path),
        }
    }

    pub(crate) fn leave_all(&mut self, exits: &BTreeSet<NodeId>, host: &mut TestHost) {
        self.record_histories(exits);
        for node in self.in_order_of_exit(exits) {
            self.leave(node, host);
        }
    }

    pub(crate) fn record_histories(&mut self, exits: &BTreeSet<NodeId>) {
        for &owner in exits {
            for &child in self.chart.children(owner) {
                let record = match self.kind(child) {
                    NodeKind::ShallowHistory => self.active_children(owner),
                    NodeKind::DeepHistory => self.active_inside(owner),
                    _ => continue,
                };
                let empty = self.active_inside(owner).is_empty();
                if empty && !self.vacated.contains(&owner) {
                    continue; // an exit point has vacated it
                }
                if record.is_empty() && self.kind(owner) == NodeKind::Or {
                    self.records.remove(&child); // it was vacated
                } else {
                    self.records.insert(child, record);
                }
            }
        }
    }

    pub(crate) fn leave(&mut self, node: NodeId, host: &mut TestHost) {
        if let Some(job) = self.jobs.remove(&node) {
            match job.phase {
                Phase::Ongoing => host.stop(self.activation(node, job.number)),
                Phase::Running if self.semantics.on_exit == ActivityOnExit::Interrupted => {
                    host.cancel(self.activation(node, job.number));
                }
                _ => {}
            }
        }
        let actions = self.chart.node(node).exit.clone();
        let before = std::mem::take(&mut self.unbound);
        self.act(&actions, self.region(node), &format!("exit {}", self.name(node)), host);
        let started = std::mem::replace(&mut self.unbound, before); // bound to no state
        self.unbound.retain(|key| !started.contains(key));
        self.active.remove(&node);
        self.waiting.remove(&node);
        self.vacated.remove(&node);
        self.completions.retain(|&other| other != node);
        self.forget_arrivals(node);
        self.unset_timers_of(node);
        self.line.exits.push(node);
    }

    /// Executes the effects of the compound transition, evaluating its CHOICEs between segments;
    /// returns its targets.
    fn effects_and_targets(
        &mut self,
        path: &StaticPath,
        early: Option<Arrival>,
        host: &mut TestHost,
    ) -> Result<Vec<NodeId>, Failure> {
        let region = self.region(self.scope(path));
        if let Some(arrival) = early {
            self.effects(&path.segments[..=arrival.segment], region, host);
            self.bind_timers(None);
            return Ok(vec![]);
        }
        self.effects(&path.segments, region, host);
        let targets = self.choose(&path.ends, region, host)?;
        self.bind_timers(targets.first().copied());
        Ok(targets)
    }

    pub(crate) fn effects(&mut self, segments: &[TransitionId], region: ScopeId, host: &mut TestHost) {
        for &id in segments {
            let transition = self.transition(id);
            let segment = format!("{} -> {}", self.name(transition.source), self.name(transition.target));
            self.act(&transition.expression.actions, region, &segment, host);
        }
    }

    /// R12: evaluates CHOICEs until none is left.
    pub(crate) fn choose(
        &mut self,
        ends: &[NodeId],
        region: ScopeId,
        host: &mut TestHost,
    ) -> Result<Vec<NodeId>, Failure> {
        let mut targets = vec![];
        for &end in ends {
            if self.terminates {
                break; // segments after TERMINATE have no effect
            }
            if self.kind(end) != NodeKind::Choice {
                self.terminates = self.kind(end) == NodeKind::Terminate;
                targets.push(if self.stands_for_composite(end) { self.parent(end) } else { end });
                continue;
            }
            let out = self.outgoing(end);
            let found =
                self.first_path(end, &out, &mut |me, path, so_far| me.all_hold(path, so_far, region, host));
            let Some(path) = found else { return Err(Failure::NoBranch(end)) };
            self.line.taken.extend(&path.segments);
            self.effects(&path.segments, region, host);
            targets.extend(self.choose(&path.ends, region, host)?);
        }
        Ok(targets)
    }

    fn enter_targets(
        &mut self,
        path: &StaticPath,
        early: Option<Arrival>,
        targets: &[NodeId],
        host: &mut TestHost,
    ) -> Result<(), Failure> {
        self.settle(path, early);
        if early.is_none() && self.vacates(path).is_empty() && !self.is_targetless(path) {
            self.enter_below(self.scope(path), targets, host)?;
        }
        Ok(())
    }

    /// Records the composites that a path vacates, and its arrival.
    fn settle(&mut self, path: &StaticPath, early: Option<Arrival>) {
        let arrival = early.or(path.arrives());
        let vacated = match early {
            Some(arrival) => vec![arrival.region],
            None => self.vacates(path),
        };
        for &node in &vacated {
            let is_filled = self.chart.children(node).iter().any(|child| self.active.contains(child));
            if self.kind(node) == NodeKind::Basic || !self.active.contains(&node) || is_filled {
                // a BASIC region has nothing to exit; in phases another transition may have
                // exited or re-entered it before
                continue;
            }
            self.vacated.insert(node);
            match arrival {
                Some(_) => self.complete_around(node), // the region itself has completed before
                None => self.completed(node),
            }
        }
        if let Some(arrival) = arrival.filter(|it| self.active.contains(&self.parent(it.region))) {
            self.arrivals.insert((arrival.join, arrival.region));
        }
    }

    /// The remaining work when the root has reached its END.
    pub(crate) fn end(&mut self, host: &mut TestHost) {
        if !self.ended {
            return;
        }
        self.ended = false;
        if self.semantics.root_end == RootCompletion::ExitsAll {
            for node in self.active_in_document_order().into_iter().rev() {
                self.leave(node, host);
            }
            self.print_finish(host);
        }
        self.halt(host);
    }

    /// R13, and the remaining work when a chart ends.
    pub(crate) fn halt(&mut self, host: &mut TestHost) {
        for node in self.in_order_from_within() {
            let Some(job) = self.jobs.get(&node).cloned() else { continue };
            match job.phase {
                Phase::Running if !job.cancelled => host.cancel(self.activation(node, job.number)),
                Phase::Ongoing => host.stop(self.activation(node, job.number)),
                _ => {}
            }
        }
        self.jobs.clear();
        self.raised.clear();
        self.arrived.clear();
        self.deferred.clear();
        self.held.clear();
        self.pending.clear();
        self.completions.clear();
        self.running_chart = false;
    }

    pub(crate) fn begin_chart(&mut self, host: &mut TestHost) {
        self.begin_micro_step();
        self.enter(Statechart::ROOT, host);
        match self.enter_below(Statechart::ROOT, &[], host) {
            Ok(()) => {
                self.print_start(host);
                self.halt_if_terminated(host);
            }
            Err(failure) => {
                self.active.clear();
                self.failure = Some(failure);
            }
        }
    }
}
