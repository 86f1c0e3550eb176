//! Entering: R10, R11, R14, and histories.

use yase::statechart::{NodeId, NodeKind};
use yase::{CompletionTrigger, Host, InitialState, RootCompletion, Statechart};

use super::{Failure, Job, Phase, StaticPath, Stepper};
use crate::test_host::TestHost;

impl Stepper<'_> {
    /// Enters the descendants of an active composite on the path to targets, and the states entered
    /// with them.
    pub(crate) fn enter_below(
        &mut self,
        composite: NodeId,
        targets: &[NodeId],
        host: &mut TestHost,
    ) -> Result<(), Failure> {
        self.enter_below_from(composite, targets, None, host)
    }

    fn enter_below_from(
        &mut self,
        composite: NodeId,
        targets: &[NodeId],
        start: Option<NodeId>,
        host: &mut TestHost,
    ) -> Result<(), Failure> {
        let remembered = targets.iter().copied().find(|&target| {
            let history = matches!(self.kind(target), NodeKind::ShallowHistory | NodeKind::DeepHistory);
            history && self.parent(target) == composite
        });
        if let Some(history) = remembered {
            return self.enter_remembered(history, start, host);
        }
        let inner: Vec<NodeId> =
            targets.iter().copied().filter(|&target| self.is_inside(target, composite)).collect();
        match (self.kind(composite), inner.first()) {
            (NodeKind::And, _) => self.enter_regions(composite, &inner, host),
            (NodeKind::Or, None) => self.enter_start(composite, host),
            (NodeKind::Or, Some(&target)) => {
                let child = self.child_towards(composite, target);
                self.enter_whole(child, &inner, host)
            }
            _ => Ok(()),
        }
    }

    fn enter_whole(&mut self, node: NodeId, targets: &[NodeId], host: &mut TestHost) -> Result<(), Failure> {
        if self.is_ended() {
            return Ok(());
        }
        self.enter(node, host);
        self.enter_below(node, targets, host)
    }

    fn enter_regions(&mut self, and: NodeId, targets: &[NodeId], host: &mut TestHost) -> Result<(), Failure> {
        for &child in self.chart.children(and) {
            if self.is_region(child) && !self.active.contains(&child) {
                self.enter_whole(child, targets, host)?;
            }
        }
        Ok(())
    }

    /// Enters START; depending on the semantics entry stops there or continues at once.
    fn enter_start(&mut self, composite: NodeId, host: &mut TestHost) -> Result<(), Failure> {
        let mut children = self.chart.children(composite).iter().copied();
        let Some(start) = children.find(|&child| self.kind(child) == NodeKind::Start) else {
            self.vacated.insert(composite);
            self.completed(composite);
            return Ok(());
        };
        if self.semantics.start == InitialState::SameStep
            && let Some(path) = self.open_path(start, host)
        {
            return self.go_on(&path, composite, Some(start), host);
        }
        self.enter(start, host);
        Ok(())
    }

    /// The enabled path out of START or HISTORY.
    fn open_path(&mut self, connector: NodeId, host: &mut TestHost) -> Option<StaticPath> {
        let out = self.outgoing(connector);
        // the blackboard of the composite, even for a path from an AND's HISTORY into a region
        let region = self.region(self.parent(connector));
        self.first_path(connector, &out, &mut |me, path, so_far| me.all_hold(path, so_far, region, host))
    }

    /// `start` is the START of the current path: a HISTORY without transitions leads back to it,
    /// where entering ends.
    fn go_on(
        &mut self,
        path: &StaticPath,
        composite: NodeId,
        start: Option<NodeId>,
        host: &mut TestHost,
    ) -> Result<(), Failure> {
        let outer = std::mem::take(&mut self.unbound);
        self.line.taken.extend(&path.segments);
        let region = self.region(composite);
        if self.walks_segments() {
            let base = self.late.len();
            self.walk(path, None, region, start, host)?;
            self.bind_rest(path, None);
            self.enter_late(base, host)?;
            self.unbound = outer;
            if self.kind(composite) == NodeKind::And && !self.is_ended() {
                self.enter_regions(composite, &[], host)?;
            }
            let stays = !self.is_ended() && self.active_inside(composite).is_empty();
            if let Some(start) = start.filter(|&start| stays && self.parent(start) == composite) {
                self.enter(start, host);
            }
            return Ok(());
        }
        self.effects(&path.segments, region, host);
        let targets = self.choose(&path.ends, region, host)?;
        self.bind_timers(targets.first().copied());
        self.unbound = outer;
        if self.terminates {
            return Ok(());
        }
        self.enter_below_from(composite, &targets, start, host)
    }

    pub(crate) fn enter_remembered(
        &mut self,
        history: NodeId,
        start: Option<NodeId>,
        host: &mut TestHost,
    ) -> Result<(), Failure> {
        let owner = self.parent(history);
        let Some(record) = self.records.get(&history).cloned() else {
            return match self.open_path(history, host) {
                Some(path) => self.go_on(&path, owner, start, host),
                None if start.is_some() => {
                    start.into_iter().for_each(|start| self.enter(start, host));
                    Ok(())
                }
                None => self.enter_below(owner, &[], host),
            };
        };
        match (self.kind(history), self.kind(owner)) {
            (NodeKind::DeepHistory, _) => self.enter_below(owner, &record, host),
            (_, NodeKind::And) => self.enter_regions(owner, &[], host),
            _ => match record[..] {
                [child] => self.enter_whole(child, &[], host), // also START, which stays active
                _ => Ok(()),
            },
        }
    }

    pub(crate) fn enter(&mut self, node: NodeId, host: &mut TestHost) {
        self.occupy(node);
        self.active.insert(node);
        self.line.entries.push(node);
        if self.is_region(node) {
            host.inherit(self.region(node), self.region(self.parent(node)));
        }
        let actions = self.chart.node(node).entry.clone();
        let before = std::mem::take(&mut self.unbound);
        self.act(&actions, self.region(node), &format!("entry {}", self.name(node)), host);
        let started = self.unbound.clone();
        self.bind_timers(Some(node));
        self.unbound = before;
        self.unbound.retain(|key| !started.contains(key));
        let runs = self.chart.node(node).activity.is_some();
        if self.activity_region(node) != self.region(node) {
            host.inherit(self.activity_region(node), self.region(node));
        }
        if runs {
            self.job_count += 1;
            let job = Job { phase: Phase::Queued, number: self.job_count, cancelled: false };
            self.jobs.insert(node, job);
        }
        match self.kind(node) {
            NodeKind::Basic if !runs => self.completed(node),
            NodeKind::End => self.reached(node, host),
            _ => {}
        }
    }

    /// Marks the region of a node as occupied again: its arrival at a JOIN has to be repeated.
    fn occupy(&mut self, node: NodeId) {
        let Some(around) = self.chart.node(node).parent else { return };
        if self.vacated.remove(&around) && self.is_region(around) {
            self.forget_arrivals(around);
        }
    }

    fn reached(&mut self, end: NodeId, host: &mut TestHost) {
        let composite = self.parent(end);
        if composite == Statechart::ROOT {
            match self.semantics.root_end {
                RootCompletion::ExitsAll => self.ended = true,
                _ => self.halt(host),
            }
            return;
        }
        self.completed(composite);
        if self.semantics.completion_events {
            self.raise_done(composite);
            let mut around = self.parent(composite);
            while self.kind(around) == NodeKind::And && self.has_ended(around) {
                self.raise_done(around);
                around = self.parent(around);
            }
        }
    }

    /// SCXML's `isInFinalState`: a BASIC state may have completed but is not in a final state.
    fn has_ended(&self, node: NodeId) -> bool {
        match self.kind(node) {
            NodeKind::And => {
                let mut regions = self.chart.children(node).iter().filter(|&&child| self.is_region(child));
                regions.all(|&region| self.has_ended(region))
            }
            NodeKind::Or => self.is_complete(node),
            _ => false,
        }
    }

    fn raise_done(&mut self, node: NodeId) {
        self.raise(&format!("done.state.{}", self.chart.node(node).name));
    }

    /// Raises the completion of a state and of the ANDs around it that complete with it.
    pub(crate) fn completed(&mut self, node: NodeId) {
        if self.semantics.eventless != CompletionTrigger::Once || node == Statechart::ROOT {
            return;
        }
        if !self.completions.contains(&node) {
            self.completions.push(node);
        }
        self.complete_around(node);
    }

    /// Raises the completion of the AND around a region if all its regions have completed.
    pub(crate) fn complete_around(&mut self, region: NodeId) {
        let around = self.parent(region);
        if self.semantics.eventless == CompletionTrigger::Once
            && self.kind(around) == NodeKind::And
            && self.is_complete(around)
        {
            self.completed(around);
        }
    }
}
