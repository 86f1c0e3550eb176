//! What a transition does: R10 to R13, R21.

use std::collections::BTreeSet;
use std::time::Duration;

use yase::expression::{Action, ActionKind};
use yase::statechart::{NodeId, NodeKind, Statechart, TransitionId};
use yase::{Activation, FieldId, Host, RegionId, Value};

use super::{Deadline, Job, Phase, Stepper, Way, topic};
use crate::kit::world::World;

impl Stepper<'_> {
    pub(super) fn fire(&mut self, way: &Way, world: &mut World) {
        let terminates = self.kind(self.target(way)) == NodeKind::Terminate;
        let targetless = self.is_internal(way) && self.source(way) == self.target(way);
        let (scope, target) = (self.scope(way), self.target(way));
        for node in self.exits(way) {
            self.leave(node, world);
        }
        let region = self.region(scope);
        for &id in way {
            let transition = self.chart.transition(id);
            let place = format!("{} -> {}", self.name(transition.source), self.name(transition.target));
            self.act(&transition.expression.actions.clone(), region, &place, world);
        }
        if terminates {
            self.halt(world);
        } else if !targetless {
            self.enter_inside(scope, target, world);
        }
    }

    pub(super) fn leave(&mut self, node: NodeId, world: &mut World) {
        if let Some(job) = self.jobs.remove(&node)
            && job.phase == Phase::Ongoing
        {
            world.stop(self.activation(node, job.number));
        }
        let actions = self.chart.node(node).exit.clone();
        self.act(&actions, self.region(node), &format!("exit {}", self.name(node)), world);
        self.active.remove(&node);
        self.waiting.remove(&node);
        self.line.exits.push(node);
    }

    /// Enters what of a composite leads to a target, and what must be entered with it.
    pub(super) fn enter_inside(&mut self, composite: NodeId, target: NodeId, world: &mut World) {
        for &child in self.chart.children(composite) {
            let on_the_way = child == target || self.is_inside(target, child);
            let whole = !self.is_inside(target, composite);
            let start = whole && self.kind(child) == NodeKind::Start;
            if on_the_way || start || self.kind(composite) == NodeKind::And {
                self.enter(child, world);
                if !self.is_leaf(child) {
                    self.enter_inside(child, target, world);
                }
            }
        }
    }

    pub(super) fn enter(&mut self, node: NodeId, world: &mut World) {
        self.active.insert(node);
        self.line.entries.push(node);
        if self.is_region(node) {
            let around = self.chart.node(node).parent.unwrap();
            world.inherit(self.region(node), self.region(around));
        }
        let actions = self.chart.node(node).entry.clone();
        self.act(&actions, self.region(node), &format!("entry {}", self.name(node)), world);
        if self.chart.node(node).activity.is_some() {
            self.job_count += 1;
            let job = Job { phase: Phase::Queued, number: self.job_count, cancelled: false };
            self.jobs.insert(node, job);
        }
        if self.kind(node) == NodeKind::End && self.chart.node(node).parent == Some(Statechart::ROOT) {
            self.halt(world);
        }
    }

    pub(super) fn act(&mut self, actions: &[Action], region: RegionId, place: &str, world: &mut World) {
        if actions.is_empty() {
            return;
        }
        let texts: Vec<String> = actions.iter().map(ToString::to_string).collect();
        self.line.effects.push(format!("{} ({place})", texts.join(", ")));
        for action in actions {
            if let Err(error) = self.perform(action, region, world) {
                self.raise("error.action");
                world.say(format!("  action failed: {error}"));
            }
        }
    }

    pub(super) fn perform(
        &mut self,
        action: &Action,
        region: RegionId,
        world: &mut World,
    ) -> Result<(), String> {
        match &action.kind {
            ActionKind::Raise(event) => self.raise(&event.text()),
            ActionKind::Script(_) => panic!("the tests have no scripts"),
            ActionKind::ProcessMessages => self.deliver(region, world),
            ActionKind::PublishAll => {
                world.publish_all(region);
                self.written.remove(&region);
            }
            ActionKind::Publish(path) => {
                world.publish(region, topic(&path.text()).unwrap());
                self.written.insert(region);
            }
            ActionKind::StartTimeout { timer, delay, .. } => self.start_timer(&timer.text(), *delay, region),
            ActionKind::Assign { target, value } => {
                let name = &target.segments[0].text;
                let value = self
                    .number(value, region, world)?
                    .ok_or("the value depends on a message that has not arrived")?;
                world
                    .assign(region, topic(name).unwrap(), &[FieldId(0)], Value::Int(value))
                    .map_err(|error| format!("the value cannot be assigned: {error}"))?;
                self.written.insert(region);
                let reads = self.guards_that_read(name);
                self.erred.retain(|(id, other)| *other != region || !reads.contains(id));
            }
        }
        Ok(())
    }

    pub(super) fn start_timer(&mut self, name: &str, delay: Duration, region: RegionId) {
        let key = (region, name.to_owned());
        for queue in [&mut self.raised, &mut self.arrived, &mut self.deferred] {
            queue.retain(|occurrence| occurrence.expiry.as_ref() != Some(&key));
        }
        self.held.retain(|(occurrence, _, _)| occurrence.expiry.as_ref() != Some(&key));
        self.timers.insert(key, Deadline { moment: self.now + delay, announced: false });
        let reads = self.guards_that_read(name);
        self.erred.retain(|(id, other)| *other != region || !reads.contains(id));
    }

    /// The segments whose guard has a word in it.
    pub(super) fn guards_that_read(&self, word: &str) -> BTreeSet<TransitionId> {
        let has_word = |text: String| text.split(|c: char| !c.is_alphanumeric()).any(|other| other == word);
        self.chart
            .transitions()
            .filter(|(_, transition)| {
                transition.expression.guard.as_ref().is_some_and(|guard| has_word(guard.to_string()))
            })
            .map(|(id, _)| id)
            .collect()
    }

    /// R13, and what is left to do when a chart ends.
    pub(super) fn halt(&mut self, world: &mut World) {
        for node in self.document() {
            let Some(job) = self.jobs.get(&node).cloned() else { continue };
            match job.phase {
                Phase::Running if !job.cancelled => world.cancel(self.activation(node, job.number)),
                Phase::Ongoing => world.stop(self.activation(node, job.number)),
                _ => {}
            }
        }
        self.jobs.clear();
        self.raised.clear();
        self.arrived.clear();
        self.deferred.clear();
        self.held.clear();
        self.pending.clear();
        self.running_chart = false;
    }

    pub(super) fn activation(&self, node: NodeId, number: u64) -> Activation {
        Activation { node, region: self.region(node), number }
    }
}
