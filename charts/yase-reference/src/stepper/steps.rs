//! Steps, and the order of events: R16 to R20.

use yase::expression::{Action, ActionKind, Trigger};
use yase::statechart::{NodeId, NodeKind, Statechart};
use yase::{Deferral, Delivery, EventMatching, EventPool, FailureEvents, Firing, Host, ScopeId, Timestamp};

use super::log_lines::Heading;
use super::selection::Offer;
use super::{Failure, Held, Line, Occurrence, Phase, StaticPath, Stepper};
use crate::test_host::TestHost;

impl Stepper<'_> {
    pub(crate) fn raise(&mut self, event: &str) {
        self.queue(event, true, None);
    }

    pub(crate) fn arrive(&mut self, event: &str, expiry: Option<(ScopeId, String)>) {
        self.queue(event, false, expiry);
    }

    fn queue(&mut self, event: &str, raised: bool, expiry: Option<(ScopeId, String)>) {
        self.count += 1;
        let occurrence = Occurrence { event: event.to_owned(), number: self.count, raised, expiry };
        self.queue_of(&occurrence).push(occurrence);
    }

    fn queue_of(&mut self, occurrence: &Occurrence) -> &mut Vec<Occurrence> {
        match occurrence.raised && self.semantics.pool == EventPool::RaisedFirst {
            true => &mut self.raised,
            false => &mut self.arrived,
        }
    }

    /// Whether errors are one event that is raised every time, as under `scxml`.
    pub(crate) fn raises_every_error(&self) -> bool {
        self.semantics.failures == FailureEvents::EveryTime
    }

    pub(crate) fn error_event<'a>(&self, otherwise: &'a str) -> &'a str {
        if self.raises_every_error() { "error.execution" } else { otherwise }
    }

    pub(crate) fn whole_step(&mut self, host: &mut TestHost) -> Result<(), Failure> {
        self.begin(host);
        loop {
            self.before = self.active.clone();
            match self.micro_step(host) {
                Ok(true) => {}
                Ok(false) => break,
                Err(failure) => {
                    self.active = self.before.clone();
                    return Err(failure);
                }
            }
        }
        self.finish(host);
        Ok(())
    }

    fn begin(&mut self, host: &mut TestHost) {
        self.due = false;
        self.micro_steps = 0;
        self.did_something = false;
        if self.instant != self.now {
            (self.instant, self.steps_at_instant) = (self.now, 0);
        }
        while let Some(key) = self.next_expiry() {
            self.timers.get_mut(&key).unwrap().announced = true;
            let reads = self.guards_that_read(&key.1);
            self.erred.retain(|(id, other)| *other != key.0 || !reads.contains(id));
            if self.is_named(&key.1, false) {
                self.arrive(&key.1.clone(), Some(key));
            }
        }
        if self.semantics.delivery == Delivery::Explicit {
            return;
        }
        for (index, node) in self.tree.regions.clone().into_iter().enumerate() {
            let region = ScopeId(index as u32);
            if self.active.contains(&node) && !self.region_runs(region) {
                self.deliver(region, host);
            }
        }
    }

    /// The earliest expired timer that has not been processed; the chooser picks among timers that
    /// expired at the same time.
    fn next_expiry(&mut self) -> Option<(ScopeId, String)> {
        let over: Vec<(Timestamp, (ScopeId, String))> = self
            .timers
            .iter()
            .filter(|(_, deadline)| !deadline.announced && deadline.moment <= self.now)
            .map(|(key, deadline)| (deadline.moment, key.clone()))
            .collect();
        let first = over.iter().map(|(moment, _)| *moment).min()?;
        let mut together: Vec<(ScopeId, String)> =
            over.into_iter().filter(|(moment, _)| *moment == first).map(|(_, key)| key).collect();
        together.sort_by_key(|key| self.timer_numbers.iter().position(|other| other == key));
        let index = self.chooser.pick(together.len());
        Some(together.remove(index))
    }

    /// Whether a trigger names an event or a state defers it; `anywhere`: also `raise` and `not`.
    pub(crate) fn is_named(&self, event: &str, anywhere: bool) -> bool {
        let raised = |actions: &[Action]| {
            actions
                .iter()
                .any(|action| matches!(&action.kind, ActionKind::Raise(name) if name.text() == event))
        };
        let triggered =
            self.chart.transitions().any(|(_, transition)| match &transition.expression.trigger {
                Some(Trigger::OneOf(names)) => names.iter().any(|name| name.text() == event),
                Some(Trigger::Not(name)) => anywhere && name.text() == event,
                _ => false,
            });
        let raises = self.chart.transitions().any(|(_, transition)| raised(&transition.expression.actions))
            || self.chart.nodes().any(|(_, node)| raised(&node.entry) || raised(&node.exit));
        let defers = self.chart.nodes().any(|(_, node)| node.defer.iter().any(|name| name == event));
        triggered || defers || anywhere && raises
    }

    /// The name under which the chart knows an event: its own, or the longest prefix of its tokens
    /// that the chart names.
    pub(crate) fn known_name(&self, event: &str) -> Option<String> {
        let mut name = event;
        loop {
            if self.is_named(name, true) || name.starts_with("error.") || name.starts_with("done.state.") {
                return Some(name.to_owned());
            }
            name = match self.semantics.matching {
                EventMatching::TokenPrefix => name.rsplit_once('.')?.0,
                _ => return None,
            };
        }
    }

    fn micro_step(&mut self, host: &mut TestHost) -> Result<bool, Failure> {
        if let Some(failure) = self.failure.take() {
            return Err(failure);
        }
        if !self.running_chart || self.ended {
            return Ok(false);
        }
        if self.interrupt_something(host)? {
            return Ok(true);
        }
        if let Some(index) = self.held.iter().position(|held| held.offer) {
            let occurrence = self.held.remove(index).occurrence;
            return self.offer(occurrence, host);
        }
        if self.complete_something(host)? {
            return Ok(true);
        }
        let (candidates, _) = self.candidates(Offer::Nothing, host);
        if !candidates.is_empty() {
            self.admit()?;
            self.take(candidates, None, host)?;
            return Ok(true);
        }
        self.restore_deferred();
        let next = match self.raised.is_empty() {
            false => self.raised.remove(0),
            true if self.arrived.is_empty() => return Ok(false),
            true => self.arrived.remove(0),
        };
        self.offer(next, host)
    }

    /// R15, `once`: completions precede events; a completion without an enabled transition is
    /// consumed.
    fn complete_something(&mut self, host: &mut TestHost) -> Result<bool, Failure> {
        while !self.completions.is_empty() {
            let node = self.completions.remove(0);
            self.begin_micro_step(); // reads for a consumed completion are not reported
            if let Some(path) = self.select_from(node, Offer::Completion, host).found {
                self.admit()?;
                self.take(vec![path], None, host)?;
                return Ok(true);
            }
        }
        Ok(false)
    }

    /// Resets the record of the micro-step, which begins with each selection.
    pub(crate) fn begin_micro_step(&mut self) {
        self.line = Line::default();
        self.leaves = self.active_leaves();
        self.found.clear();
        self.closed.clear();
        self.reported.clear();
        self.drawn.clear();
    }

    /// Fires a pending interruption whose activities have returned.
    fn interrupt_something(&mut self, host: &mut TestHost) -> Result<bool, Failure> {
        let Some(index) = self.pending.iter().position(|(path, _)| !self.leaves_running(path)) else {
            return Ok(false);
        };
        self.admit()?;
        let (path, event) = self.pending.remove(index);
        self.begin_micro_step();
        self.taken = vec![path.clone()];
        self.fire(&path, host)?;
        self.taken.clear();
        let pending = std::mem::take(&mut self.pending);
        self.pending = pending.into_iter().filter(|(path, _)| self.may_fire(path)).collect();
        for held in &mut self.held {
            held.offer = true;
        }
        self.print(&Heading { event: event.as_deref(), fired: &[path], ..Heading::default() }, host);
        Ok(true)
    }

    /// Returns deferred events to the queue before newer ones.
    fn restore_deferred(&mut self) {
        let (kept, recalled): (Vec<Occurrence>, Vec<Occurrence>) = std::mem::take(&mut self.deferred)
            .into_iter()
            .partition(|occurrence| self.deferring(&occurrence.event).is_some());
        self.deferred = kept;
        for occurrence in recalled {
            self.queue_of(&occurrence).push(occurrence);
        }
        self.raised.sort_by_key(|occurrence| occurrence.number);
        self.arrived.sort_by_key(|occurrence| occurrence.number);
    }

    /// R17
    fn admit(&mut self) -> Result<(), Failure> {
        let limit = self.semantics.limit.get();
        if self.micro_steps == limit {
            return Err(Failure::Endless);
        }
        if !self.did_something {
            self.did_something = true;
            self.steps_at_instant += 1;
            if self.steps_at_instant > limit {
                return Err(Failure::Endless);
            }
        }
        self.micro_steps += 1;
        Ok(())
    }

    fn offer(&mut self, occurrence: Occurrence, host: &mut TestHost) -> Result<bool, Failure> {
        self.admit()?;
        let (candidates, waiting) = self.candidates(Offer::Event(&occurrence), host);
        let event = occurrence.event.clone();
        let heading = Heading { event: Some(&event), ..Heading::default() };
        let found = if candidates.is_empty() { &waiting } else { &candidates };
        if let Some(overriding_deferral) = self.overriding_deferral(&event, found) {
            self.defer(occurrence);
            self.print(&Heading { deferring: Some(overriding_deferral), ..heading }, host);
            return Ok(true);
        }
        if !candidates.is_empty() {
            self.take(candidates, Some(&event), host)?;
        } else if !waiting.is_empty() {
            self.held.push(Held { occurrence, paths: waiting.clone(), offer: false });
            self.held.sort_by_key(|held| held.occurrence.number);
            self.print(&Heading { held: &waiting, ..heading }, host);
        } else {
            let deferring = self.deferring(&event);
            if deferring.is_some() {
                self.defer(occurrence);
            }
            self.print(&Heading { deferring, ..heading }, host);
        }
        Ok(true)
    }

    fn defer(&mut self, occurrence: Occurrence) {
        self.deferred.push(occurrence);
        self.deferred.sort_by_key(|occurrence| occurrence.number);
    }

    /// R26: the first state that defers an event for which transitions were found, if none of them
    /// starts at or inside that state.
    fn overriding_deferral(&self, event: &str, found: &[StaticPath]) -> Option<NodeId> {
        if self.semantics.deferral != Deferral::Innermost {
            return None;
        }
        let own = |node: NodeId, path: &StaticPath| {
            path.sources.iter().any(|&source| source == node || self.is_inside(source, node))
        };
        let all = self.in_order_from_within();
        let mut deferring = all.into_iter().filter(|&node| self.defers(node, event));
        deferring.find(|&node| !found.iter().any(|path| own(node, path)))
    }

    fn defers(&self, node: NodeId, event: &str) -> bool {
        let named = self.chart.node(node).defer.iter().any(|name| self.matches(name, event));
        self.active.contains(&node) && named
    }

    /// All nodes, children before their parents.
    pub(crate) fn in_order_from_within(&self) -> Vec<NodeId> {
        fn visit(stepper: &Stepper<'_>, node: NodeId, out: &mut Vec<NodeId>) {
            for &child in stepper.chart.children(node) {
                visit(stepper, child, out);
            }
            out.push(node);
        }
        let mut out = vec![];
        visit(self, Statechart::ROOT, &mut out);
        out
    }

    /// The innermost active state that defers an event; of several, the first in document order.
    fn deferring(&self, event: &str) -> Option<NodeId> {
        let mut all = self.in_order_from_within().into_iter();
        all.find(|&node| self.semantics.deferral != Deferral::Off && self.defers(node, event))
    }

    fn take(
        &mut self,
        candidates: Vec<StaticPath>,
        event: Option<&str>,
        host: &mut TestHost,
    ) -> Result<(), Failure> {
        let (winners, losers) = self.resolve(candidates);
        let (mut now, mut later) = (vec![], vec![]);
        for path in winners {
            if self.leaves_running(&path) {
                for node in self.in_order_from_within() {
                    if self.would_leave(&path, node) {
                        self.cancel(node, host);
                    }
                }
                self.pending.push((path.clone(), event.map(str::to_owned)));
                later.push(path);
            } else {
                now.push(path);
            }
        }
        let fired = match self.semantics.firing {
            Firing::Phases => self.fire_phases(now, host)?,
            _ => self.fire_each(now, host)?,
        };
        self.print(
            &Heading { event, fired: &fired, preempted: &losers, held: &later, deferring: None },
            host,
        );
        Ok(())
    }

    fn cancel(&mut self, node: NodeId, host: &mut TestHost) {
        if !self.runs(node) {
            return;
        }
        let job = self.jobs.get_mut(&node).unwrap();
        let (is_new, phase, number) = (!job.cancelled, job.phase, job.number);
        job.cancelled = true;
        if is_new && phase == Phase::Running {
            host.cancel(self.activation(node, number));
        }
    }

    fn finish(&mut self, host: &mut TestHost) {
        self.end(host);
        for region in std::mem::take(&mut self.written) {
            host.publish_all(region);
        }
        for node in self.in_order_from_within() {
            let Some(job) = self.jobs.get_mut(&node) else { continue };
            if job.phase == Phase::Queued {
                job.phase = Phase::Running;
                let (number, cancelled) = (job.number, job.cancelled);
                host.start(self.activation(node, number));
                if cancelled {
                    host.cancel(self.activation(node, number));
                }
            }
        }
        if !self.running_chart {
            return;
        }
        for node in self.active_in_document_order() {
            let is_new = !self.waiting.contains(&node) && !self.is_frozen(node, false);
            if self.kind(node) == NodeKind::Start && is_new {
                self.waiting.insert(node);
                host.say(format!("  waits at {}", self.name(node)));
            }
        }
    }
}
