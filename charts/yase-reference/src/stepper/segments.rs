//! Taking a compound transition segment by segment: R25, R27.

use std::collections::BTreeSet;

use yase::statechart::{NodeId, NodeKind};
use yase::{ScopeId, TerminateExit};

use super::arrivals::Arrival;
use super::{Failure, StaticPath, Stepper};
use crate::test_host::TestHost;

impl Stepper<'_> {
    /// Takes a path from a state, then enters the regions that no segment has entered.
    pub(crate) fn walk_whole(
        &mut self,
        path: &StaticPath,
        early: Option<Arrival>,
        host: &mut TestHost,
    ) -> Result<(), Failure> {
        let region = self.region(self.scope(path));
        let base = self.late.len();
        self.walk(path, early, region, None, host)?;
        self.bind_rest(path, early);
        self.enter_late(base, host)
    }

    /// Binds timers that were started after the last target was entered to the first target.
    pub(crate) fn bind_rest(&mut self, path: &StaticPath, early: Option<Arrival>) {
        let first =
            path.ends.first().copied().filter(|&end| early.is_none() && self.kind(end) != NodeKind::Choice);
        self.bind_timers(first);
    }

    /// Enters the other regions of the ANDs that segments have entered.
    pub(crate) fn enter_late(&mut self, base: usize, host: &mut TestHost) -> Result<(), Failure> {
        let late = self.late.split_off(base);
        for and in late {
            for &region in self.chart.children(and) {
                let missing = self.is_region(region) && !self.active.contains(&region);
                if missing && self.active.contains(&and) && !self.is_ended() {
                    self.enter(region, host);
                    self.enter_below(region, &[], host)?;
                }
            }
        }
        Ok(())
    }

    /// Takes the segments of a path; `start` is the START that it begins at.
    pub(crate) fn walk(
        &mut self,
        path: &StaticPath,
        early: Option<Arrival>,
        region: ScopeId,
        start: Option<NodeId>,
        host: &mut TestHost,
    ) -> Result<(), Failure> {
        let count = early.map_or(path.segments.len(), |arrival| arrival.segment + 1);
        for index in 0..count {
            self.leave_by_segment(path, index, early, host);
            self.effects(&path.segments[index..=index], region, host);
            let stops = early.is_some_and(|arrival| arrival.segment == index);
            if !stops {
                self.enter_by_segment(path, index, region, start, host)?;
            }
            if self.is_ended() {
                break;
            }
        }
        Ok(())
    }

    fn ends_of(&self, path: &StaticPath, index: usize) -> (NodeId, NodeId) {
        let transition = self.transition(path.segments[index]);
        (transition.source, transition.target)
    }

    /// The composite that contains a node on a path: for a border point its own composite, else an
    /// OR.
    fn stand(&self, node: NodeId) -> NodeId {
        match self.is_point(node) {
            true => self.parent(node),
            false => self.lowest_around(&[node], |kind| kind == NodeKind::Or),
        }
    }

    fn is_state(&self, node: NodeId) -> bool {
        use NodeKind::{And, Basic, End, Or, Start};
        matches!(self.kind(node), Or | And | Basic | End | Start)
    }

    /// The AND whose regions a path joins.
    fn joined_on(&self, path: &StaticPath) -> Option<NodeId> {
        let together = || self.lowest_around(&path.sources, |kind| kind == NodeKind::And);
        let arrival = path.arrival.map(|arrival| self.parent(arrival.region));
        arrival.or_else(|| (path.sources.len() > 1).then(together))
    }

    /// The innermost composite that a segment neither exits nor enters.
    fn border(&self, path: &StaticPath, index: usize) -> NodeId {
        let (source, target) = self.ends_of(path, index);
        let local = self.transition(path.segments[index]).internal;
        if index == 0 && local && self.is_state(source) && self.is_inside(target, source) {
            return source;
        }
        let around = self.parent(target);
        if self.kind(target) == NodeKind::ExitPoint && (self.is_inside(source, around)) {
            return around;
        }
        let mut all = vec![source];
        all.extend(self.beside(path, source, target));
        if self.kind(source) == NodeKind::Join || self.kind(target) == NodeKind::Join {
            all.extend(self.joined_on(path));
        }
        let stand = self.stand(source);
        let holds = |outer: NodeId| all.iter().all(|&node| self.is_inside(node, outer));
        if self.is_point(source) && holds(stand) {
            return stand;
        }
        self.lowest_around(&all, |kind| kind == NodeKind::Or)
    }

    /// The targets of all segments of a path that leave the same node.
    fn beside(&self, path: &StaticPath, source: NodeId, target: NodeId) -> Vec<NodeId> {
        let all = path.segments.iter().map(|&id| self.transition(id));
        let forks = [NodeKind::Fork, NodeKind::EntryPoint].contains(&self.kind(source));
        match forks {
            true => all.filter(|other| other.source == source).map(|other| other.target).collect(),
            false => vec![target],
        }
    }

    fn leave_by_segment(
        &mut self,
        path: &StaticPath,
        index: usize,
        early: Option<Arrival>,
        host: &mut TestHost,
    ) {
        let exits = self.exits_by_segment(path, index, early);
        let (_, target) = self.ends_of(path, index);
        let arrival = early.or(path.arrives()).filter(|arrival| arrival.segment == index);
        if self.kind(target) == NodeKind::ExitPoint && arrival.is_none() && !exits.is_empty() {
            self.record_histories(&BTreeSet::from([self.parent(target)]));
        }
        self.leave_all(&exits, host);
    }

    fn exits_by_segment(&self, path: &StaticPath, index: usize, early: Option<Arrival>) -> BTreeSet<NodeId> {
        let (source, target) = self.ends_of(path, index);
        let inside = |node: NodeId| self.active_inside(node).into_iter().collect::<BTreeSet<_>>();
        if let Some(arrival) = early.or(path.arrives()).filter(|arrival| arrival.segment == index) {
            return inside(arrival.region);
        }
        if let [vacated] = self.vacates(path)[..]
            && index + 1 == path.segments.len()
        {
            return inside(vacated);
        }
        if self.is_targetless(path) {
            return BTreeSet::new();
        }
        let incoming = path.segments.iter().filter(|&&id| self.transition(id).target == target).count();
        if self.kind(target) == NodeKind::Join && path.sources.len() > 1 && index + 1 < incoming {
            let and = self.joined_on(path).unwrap();
            return inside(self.child_towards(and, source));
        }
        if self.kind(target) == NodeKind::Terminate && self.semantics.terminate == TerminateExit::Nothing {
            return BTreeSet::new();
        }
        let point_out = self.kind(source) == NodeKind::EntryPoint && self.parent(source) == target;
        if point_out {
            return BTreeSet::new();
        }
        let border = self.border(path, index);
        if self.kind(target) == NodeKind::ExitPoint && self.parent(target) == border {
            let on_border = source == border || self.is_point(source) && self.parent(source) == border;
            return if on_border { BTreeSet::new() } else { inside(border) };
        }
        if border == source {
            return inside(source);
        }
        let first = self.beside(path, source, target)[0];
        if first != target || !self.is_state(source) && self.stand(source) == border {
            return BTreeSet::new();
        }
        let branch = self.child_towards(border, source);
        let active = self.active.iter().copied();
        active.filter(|&node| node == branch || self.is_inside(node, branch)).collect()
    }

    fn is_point(&self, node: NodeId) -> bool {
        use NodeKind::{DeepHistory, EntryPoint, ExitPoint, ShallowHistory};
        matches!(self.kind(node), EntryPoint | ExitPoint | ShallowHistory | DeepHistory)
    }

    /// Enters the composites around the target of a segment, and the target if the path ends there.
    fn enter_by_segment(
        &mut self,
        path: &StaticPath,
        index: usize,
        region: ScopeId,
        start: Option<NodeId>,
        host: &mut TestHost,
    ) -> Result<(), Failure> {
        let (source, target) = self.ends_of(path, index);
        let last = index + 1 == path.segments.len();
        let arrives = path.arrives().is_some_and(|arrival| arrival.segment == index);
        if arrives || self.is_targetless(path) || last && !self.vacates(path).is_empty() {
            return Ok(());
        }
        if self.kind(source) == NodeKind::EntryPoint && self.parent(source) == target {
            return Ok(());
        }
        let border = self.border(path, index);
        match self.kind(target) {
            NodeKind::Terminate => {
                if self.semantics.terminate == TerminateExit::Source {
                    self.enter_down(border, self.stand(target), host);
                }
                self.terminates = true;
                Ok(())
            }
            NodeKind::Join => {
                if !self.joined_on(path).is_some_and(|and| self.is_inside(target, and)) {
                    self.enter_down(border, self.stand(target), host);
                }
                Ok(())
            }
            NodeKind::ExitPoint => {
                let above = self.lowest_around(&[self.parent(target)], |kind| kind == NodeKind::Or);
                self.enter_down(border, above, host);
                Ok(())
            }
            NodeKind::EntryPoint if self.stands_for_composite(target) => {
                self.enter_target(border, self.parent(target), host)
            }
            NodeKind::EntryPoint if !self.leads_inside(path, index) => {
                self.enter_target(border, self.parent(target), host)
            }
            NodeKind::ShallowHistory | NodeKind::DeepHistory => {
                let owner = self.parent(target);
                self.enter_down(border, owner, host);
                self.bind_timers(Some(target));
                if self.is_ended() {
                    return Ok(());
                }
                self.enter_remembered(target, start.filter(|&start| self.parent(start) == owner), host)
            }
            NodeKind::Choice => {
                self.enter_down(border, self.stand(target), host);
                self.choose_segment(target, region, start, host)
            }
            _ if self.is_state(target) => self.enter_target(border, target, host),
            _ => {
                self.enter_down(border, self.stand(target), host);
                Ok(())
            }
        }
    }

    fn leads_inside(&self, path: &StaticPath, index: usize) -> bool {
        let point = self.ends_of(path, index).1;
        let Some(&next) = path.segments.get(index + 1) else { return true };
        let (source, target) = (self.transition(next).source, self.transition(next).target);
        let exit = self.kind(target) == NodeKind::ExitPoint && self.parent(target) == self.parent(point);
        source != point || self.is_inside(target, self.parent(point)) && !exit
    }

    fn choose_segment(
        &mut self,
        choice: NodeId,
        region: ScopeId,
        start: Option<NodeId>,
        host: &mut TestHost,
    ) -> Result<(), Failure> {
        if self.is_ended() {
            return Ok(());
        }
        let out = self.outgoing(choice);
        let found =
            self.first_path(choice, &out, &mut |me, path, so_far| me.all_hold(path, so_far, region, host));
        let Some(path) = found else { return Err(Failure::NoBranch(choice)) };
        self.line.taken.extend(&path.segments);
        self.walk(&path, None, region, start, host)
    }

    fn enter_target(&mut self, border: NodeId, target: NodeId, host: &mut TestHost) -> Result<(), Failure> {
        self.bind_timers(Some(target));
        self.enter_down(border, target, host);
        if self.is_ended() {
            return Ok(());
        }
        self.enter_below(target, &[], host)
    }

    /// Enters the inactive composites between a composite and a node inside it.
    fn enter_down(&mut self, border: NodeId, node: NodeId, host: &mut TestHost) {
        let mut path = self.outward(node);
        path.retain(|&it| self.is_inside(it, border));
        path.reverse();
        if self.kind(border) == NodeKind::And && !path.is_empty() {
            self.late.push(border); // all its regions may have been exited
        }
        for it in path {
            if self.active.contains(&it) || self.is_ended() {
                continue;
            }
            self.enter(it, host);
            if self.kind(it) == NodeKind::And {
                self.late.push(it);
            }
        }
    }
}
