//! Execution of actions: R19, R21.

use std::collections::BTreeSet;
use std::time::Duration;

use yase::expression::{Action, ActionKind};
use yase::statechart::{NodeId, NodeKind, TransitionId};
use yase::{Activation, FieldId, Host, ScopeId, TimerScope, Value, WriteVisibility};

use super::{Deadline, Stepper, topic};
use crate::test_host::TestHost;

impl Stepper<'_> {
    pub(crate) fn act(&mut self, actions: &[Action], region: ScopeId, owner: &str, host: &mut TestHost) {
        if actions.is_empty() {
            return;
        }
        let texts: Vec<String> = actions.iter().map(ToString::to_string).collect();
        self.line.effects.push(format!("{} ({owner})", texts.join(", ")));
        for action in actions {
            if let Err(error) = self.perform(action, region, host) {
                self.raise(self.error_event("error.action"));
                host.say(format!("  action failed: {error}"));
            }
        }
    }

    fn perform(&mut self, action: &Action, region: ScopeId, host: &mut TestHost) -> Result<(), String> {
        match &action.kind {
            ActionKind::Raise(event) => self.raise(&event.text()),
            ActionKind::ProcessMessages => self.deliver(region, host),
            ActionKind::PublishAll => {
                host.publish_all(region);
                self.written.remove(&region);
            }
            ActionKind::Publish(path) => {
                host.publish(region, topic(&path.text()).unwrap());
                self.data_written(region, host);
            }
            ActionKind::StartTimeout { timer, delay, .. } => self.start_timer(&timer.text(), *delay, region),
            ActionKind::Assign { target, value } => {
                let name = &target.segments[0].text;
                let value = self
                    .number(value, region, host)?
                    .ok_or("the value depends on a message that has not arrived")?;
                host.assign(region, topic(name).unwrap(), &[FieldId(0)], Value::Int(value))
                    .map_err(|error| format!("the value cannot be assigned: {error}"))?;
                self.clear_guard_failures(name, region);
                self.data_written(region, host);
            }
            other => panic!("the generator makes no {other:?}"),
        }
        Ok(())
    }

    /// Allows guards that read changed data to report a failure again.
    fn clear_guard_failures(&mut self, name: &str, region: ScopeId) {
        let reads = self.guards_that_read(name);
        self.erred.retain(|(id, other)| *other != region || !reads.contains(id));
    }

    /// Publishes written data with the step or, by the semantics, delivers it at once.
    fn data_written(&mut self, region: ScopeId, host: &mut TestHost) {
        self.written.insert(region);
        if self.semantics.sharing == WriteVisibility::NextStep {
            return;
        }
        host.publish_all(region);
        self.written.remove(&region);
        for (index, node) in self.tree.regions.clone().into_iter().enumerate() {
            let other = ScopeId(index as u32);
            if other != region && self.active.contains(&node) && !self.region_runs(other) {
                self.deliver(other, host);
            }
        }
    }

    pub(crate) fn deliver(&mut self, region: ScopeId, host: &mut TestHost) {
        host.deliver(region);
        let stale = self.stale.clone();
        self.erred.retain(|key| key.1 != region || !stale.contains(key));
        self.stale.retain(|key| key.1 != region);
    }

    fn start_timer(&mut self, name: &str, delay: Duration, region: ScopeId) {
        let key = (region, name.to_owned());
        self.cancel_timer(&key);
        self.timers.insert(key.clone(), Deadline { moment: self.now + delay, announced: false, bound: None });
        self.clear_guard_failures(name, region);
        self.unbound.retain(|other| *other != key);
        self.unbound.push(key);
    }

    fn cancel_timer(&mut self, key: &(ScopeId, String)) {
        for queue in [&mut self.raised, &mut self.arrived, &mut self.deferred] {
            queue.retain(|occurrence| occurrence.expiry.as_ref() != Some(key));
        }
        self.held.retain(|held| held.occurrence.expiry.as_ref() != Some(key));
    }

    /// Binds the timers that were just started to a state.
    pub(crate) fn bind_timers(&mut self, target: Option<NodeId>) {
        let target = target.and_then(|node| match self.kind(node) {
            NodeKind::ShallowHistory | NodeKind::DeepHistory => Some(self.parent(node)),
            NodeKind::Terminate | NodeKind::Join | NodeKind::ExitPoint => None,
            NodeKind::EntryPoint => Some(self.parent(node)),
            _ => Some(node),
        });
        for key in std::mem::take(&mut self.unbound) {
            if let Some(deadline) = self.timers.get_mut(&key) {
                deadline.bound = target;
            }
        }
    }

    pub(crate) fn unset_timers_of(&mut self, node: NodeId) {
        if self.semantics.timers != TimerScope::State {
            return;
        }
        let bound = self.timers.iter().filter(|(_, deadline)| deadline.bound == Some(node));
        for key in bound.map(|(key, _)| key.clone()).collect::<Vec<_>>() {
            self.cancel_timer(&key);
            self.timers.remove(&key);
            self.clear_guard_failures(&key.1, key.0);
        }
    }

    /// The segments whose guard contains a word.
    pub(crate) fn guards_that_read(&self, word: &str) -> BTreeSet<TransitionId> {
        let all = self.chart.transitions().map(|(id, _)| id);
        all.filter(|id| self.tree.words[id.0 as usize].iter().any(|other| other == word)).collect()
    }

    pub(crate) fn activation(&self, node: NodeId, number: u64) -> Activation {
        Activation { node, region: self.activity_region(node), number }
    }

    /// The blackboard of an activity: the activity of a composite has its own.
    pub(crate) fn activity_region(&self, node: NodeId) -> ScopeId {
        let own = self.tree.regions.iter().position(|&it| it == node).filter(|_| !self.is_region(node));
        let composite = self.kind(node) != NodeKind::Basic;
        own.filter(|_| composite).map_or(self.region(node), |index| ScopeId(index as u32))
    }
}
