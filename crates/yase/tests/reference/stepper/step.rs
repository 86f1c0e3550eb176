//! Steps, and the order of events: R16 to R20.

use yase::expression::{Action, ActionKind, Trigger};
use yase::statechart::{NodeId, NodeKind, Statechart};
use yase::{Host, RegionId};

use super::{LIMIT, Line, Occurrence, Phase, Stepper, Way};
use crate::kit::world::World;

impl Stepper<'_> {
    pub(super) fn raise(&mut self, event: &str) {
        self.count += 1;
        let occurrence =
            Occurrence { event: event.to_owned(), number: self.count, raised: true, expiry: None };
        self.raised.push(occurrence);
    }

    pub(super) fn arrive(&mut self, event: &str, expiry: Option<(RegionId, String)>) {
        self.count += 1;
        let occurrence = Occurrence { event: event.to_owned(), number: self.count, raised: false, expiry };
        self.arrived.push(occurrence);
    }

    pub(super) fn deliver(&mut self, region: RegionId, world: &mut World) {
        world.deliver(region);
        let stale = self.stale.clone();
        self.erred.retain(|key| key.1 != region || !stale.contains(key));
        self.stale.retain(|key| key.1 != region);
    }

    pub(super) fn begin(&mut self, world: &mut World) {
        self.due = false;
        self.micro_steps = 0;
        self.did_something = false;
        if self.instant != self.now {
            (self.instant, self.steps_at_instant) = (self.now, 0);
        }
        // expiries, the earliest first
        loop {
            let next = self
                .timers
                .iter()
                .filter(|(_, deadline)| !deadline.announced && deadline.moment <= self.now)
                .min_by_key(|(key, deadline)| (deadline.moment, (*key).clone()))
                .map(|(key, _)| key.clone());
            let Some(key) = next else { break };
            self.timers.get_mut(&key).unwrap().announced = true;
            let reads = self.guards_that_read(&key.1);
            self.erred.retain(|(id, other)| *other != key.0 || !reads.contains(id));
            if self.is_named(&key.1, false) {
                self.arrive(&key.1.clone(), Some(key));
            }
        }
        for (index, node) in self.region_nodes().into_iter().enumerate() {
            let region = RegionId(index as u32);
            if self.active.contains(&node) && !self.region_runs(region) {
                self.deliver(region, world);
            }
        }
    }

    /// Whether a trigger names an event or a state defers it; `anywhere`: also `raise` and `not`.
    pub(super) fn is_named(&self, event: &str, anywhere: bool) -> bool {
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

    pub(super) fn micro_step(&mut self, world: &mut World) -> Result<bool, String> {
        if !self.running_chart {
            return Ok(false);
        }
        // interruptions whose activities have returned
        if let Some(index) = self.pending.iter().position(|(way, _)| !self.leaves_running(way)) {
            self.admit()?;
            let (way, event) = self.pending.remove(index);
            self.line = Line::default();
            self.fire(&way, world);
            let active = self.active.clone();
            let chart = self.chart;
            self.pending.retain(|(way, _)| active.contains(&chart.transition(way[0]).source));
            for held in &mut self.held {
                held.2 = true;
            }
            self.print(event.as_deref(), &[way], &[], &[], None, world);
            return Ok(true);
        }
        // held events
        if let Some(index) = self.held.iter().position(|held| held.2) {
            let occurrence = self.held.remove(index).0;
            return self.offer(occurrence, world);
        }
        // no event
        let (candidates, _) = self.candidates(None, world);
        if !candidates.is_empty() {
            self.admit()?;
            self.take(candidates, None, world);
            return Ok(true);
        }
        // deferred events come back before newer ones
        let recalled: Vec<Occurrence> = self
            .deferred
            .iter()
            .filter(|occurrence| self.deferring(&occurrence.event).is_none())
            .cloned()
            .collect();
        self.deferred.retain(|occurrence| !recalled.contains(occurrence));
        for occurrence in recalled {
            if occurrence.raised { &mut self.raised } else { &mut self.arrived }.push(occurrence);
        }
        self.raised.sort_by_key(|occurrence| occurrence.number);
        self.arrived.sort_by_key(|occurrence| occurrence.number);
        if !self.raised.is_empty() {
            let occurrence = self.raised.remove(0);
            return self.offer(occurrence, world);
        }
        if !self.arrived.is_empty() {
            let occurrence = self.arrived.remove(0);
            return self.offer(occurrence, world);
        }
        Ok(false)
    }

    /// R17
    pub(super) fn admit(&mut self) -> Result<(), String> {
        if self.micro_steps == LIMIT {
            return Err("never rests".to_owned());
        }
        if !self.did_something {
            self.did_something = true;
            self.steps_at_instant += 1;
            if self.steps_at_instant > LIMIT {
                return Err("never advances".to_owned());
            }
        }
        self.micro_steps += 1;
        Ok(())
    }

    pub(super) fn offer(&mut self, occurrence: Occurrence, world: &mut World) -> Result<bool, String> {
        self.admit()?;
        let (candidates, waiting) = self.candidates(Some(&occurrence), world);
        let event = occurrence.event.clone();
        if !candidates.is_empty() {
            self.take(candidates, Some(&event), world);
        } else if !waiting.is_empty() {
            self.line = Line::default();
            self.held.push((occurrence, waiting.clone(), false));
            self.held.sort_by_key(|held| held.0.number);
            self.print(Some(&event), &[], &[], &waiting, None, world);
        } else {
            self.line = Line::default();
            let deferring = self.deferring(&event);
            if deferring.is_some() {
                self.deferred.push(occurrence);
                self.deferred.sort_by_key(|occurrence| occurrence.number);
            }
            self.print(Some(&event), &[], &[], &[], deferring, world);
        }
        Ok(true)
    }

    /// The innermost active state that defers an event; of several, the first of the document.
    pub(super) fn deferring(&self, event: &str) -> Option<NodeId> {
        fn visit(stepper: &Stepper<'_>, node: NodeId, event: &str) -> Option<NodeId> {
            let inside = stepper.chart.children(node).iter().find_map(|&child| visit(stepper, child, event));
            let itself = || {
                let defers = stepper.chart.node(node).defer.iter().any(|name| name == event);
                (stepper.active.contains(&node) && defers).then_some(node)
            };
            inside.or_else(itself)
        }
        visit(self, Statechart::ROOT, event)
    }

    pub(super) fn take(&mut self, candidates: Vec<Way>, event: Option<&str>, world: &mut World) {
        let (winners, losers) = self.resolve(candidates);
        self.line = Line::default();
        let (mut now, mut later) = (vec![], vec![]);
        for way in winners {
            if self.leaves_running(&way) {
                for node in self.exits(&way) {
                    self.cancel(node, world);
                }
                self.pending.push((way.clone(), event.map(str::to_owned)));
                later.push(way);
            } else {
                now.push(way);
            }
        }
        let mut fired = vec![];
        for way in now {
            if self.running_chart && self.active.contains(&self.source(&way)) {
                self.fire(&way, world);
                fired.push(way);
            }
        }
        self.print(event, &fired, &losers, &later, None, world);
    }

    pub(super) fn cancel(&mut self, node: NodeId, world: &mut World) {
        if !self.runs(node) {
            return;
        }
        let job = self.jobs.get_mut(&node).unwrap();
        let (is_new, phase, number) = (!job.cancelled, job.phase, job.number);
        job.cancelled = true;
        if is_new && phase == Phase::Running {
            world.cancel(self.activation(node, number));
        }
    }

    pub(super) fn finish(&mut self, world: &mut World) {
        for region in std::mem::take(&mut self.written) {
            world.publish_all(region);
        }
        for node in self.document() {
            let Some(job) = self.jobs.get_mut(&node) else { continue };
            if job.phase == Phase::Queued {
                job.phase = Phase::Running;
                let (number, cancelled) = (job.number, job.cancelled);
                world.start(self.activation(node, number));
                if cancelled {
                    world.cancel(self.activation(node, number));
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
                world.say(format!("  waits at {}", self.name(node)));
            }
        }
    }
}
