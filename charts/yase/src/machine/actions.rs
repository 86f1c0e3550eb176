//! The execution of actions.

use crate::compile::Owner;
use crate::expression::{Effect, GuardError, Operand, TimerId};
use crate::host::{ActionError, Host, Notice};
use crate::ids::{ActionLocation, ScopeId};
use crate::machine::script::ScriptedMachine;
use crate::machine::step::Macrostep;
use crate::machine::view::ScopeView;
use crate::script::ScriptContext;
use crate::semantics::{TimerScope, WriteVisibility};
use crate::timestamp::Timestamp;
use crate::vocabulary::{FieldId, TopicId, Value};

/// The context of an action list: its location, its scope, and the state that owns the timers it
/// starts.
#[derive(Clone, Copy)]
pub(crate) struct ActionContext {
    pub(crate) location: ActionLocation,
    pub(crate) region: ScopeId,
    pub(crate) owner: Owner,
}

impl<H: Host> Macrostep<'_, H> {
    /// Executes an action list in order.
    #[inline(always)]
    pub(crate) fn perform(&mut self, effects: &[Effect], scene: ActionContext) {
        if effects.is_empty() {
            return;
        }
        if self.run.log.wanted {
            self.run.log.effects.push(scene.location);
        }
        for (index, effect) in effects.iter().enumerate() {
            if let Err(error) = self.execute(effect, scene) {
                self.action_failed(scene.location, index, &error);
            }
        }
    }

    #[cold]
    pub(crate) fn action_failed(&mut self, location: ActionLocation, index: usize, error: &ActionError) {
        self.run.raise(self.chart, self.chart.errors.action, true, 0);
        self.host.report(self.chart, Notice::ActionFailed { location, index, error });
    }

    /// Actions of the host are forwarded directly.
    #[inline(always)]
    fn execute(&mut self, effect: &Effect, scene: ActionContext) -> Result<(), ActionError> {
        let Effect::Script { script } = effect else { return self.execute_action(effect, scene) };
        let mut machine = ScriptedMachine { chart: self.chart, run: self.run };
        let mut performance = ScriptContext::new(&mut machine);
        self.host.perform(*script, scene.region, &mut performance).map_err(ActionError::Script)
    }

    #[inline(never)]
    fn execute_action(&mut self, effect: &Effect, scene: ActionContext) -> Result<(), ActionError> {
        let region = scene.region;
        match effect {
            Effect::Assign { topic, field, value } => {
                self.assign(region, *topic, field, value)?;
                self.share_write(region);
            }
            Effect::Publish { topic } => {
                self.host.publish(region, *topic);
                self.run.written.insert(region.index());
                self.share_write(region);
            }
            Effect::ProcessMessages => self.deliver(region),
            Effect::PublishAll => self.publish_all(region),
            Effect::StartTimeout { timer, delay } => self.start_timer(*timer, self.run.now + *delay, scene),
            Effect::Raise { event } => self.run.raise(self.chart, *event, true, 0),
            Effect::Script { .. } => return self.execute(effect, scene),
        }
        Ok(())
    }

    fn publish_all(&mut self, region: ScopeId) {
        self.host.publish_all(region);
        self.run.written.remove(region.index());
    }

    /// Makes a write visible on the other blackboards at once, if the semantics requires it.
    fn share_write(&mut self, region: ScopeId) {
        if self.semantics().sharing == WriteVisibility::NextStep {
            return;
        }
        self.publish_all(region);
        for (index, other) in self.chart.regions.iter().enumerate() {
            let is_free = self.run.is_active(other.root) && !self.run.running_regions.contains(index);
            if index != region.index() && is_free {
                self.deliver(ScopeId(index as u32));
            }
        }
    }

    fn start_timer(&mut self, timer: TimerId, deadline: Timestamp, scene: ActionContext) {
        let timer = self.chart.regions[scene.region.index()].timers + timer.0 as usize;
        if self.run.timers.set(timer, deadline) {
            self.run.queues.withdraw(timer);
        }
        self.run.timer_changed(self.chart, timer);
        if self.semantics().timers == TimerScope::State {
            self.run.unbound_timers.retain(|&other| other != timer);
            match scene.owner {
                Owner::None => {}
                Owner::State(state) => self.run.timers.bind(timer, state),
                Owner::Dynamic => self.run.unbound_timers.push(timer),
            }
        }
    }

    fn assign(
        &mut self,
        region: ScopeId,
        topic: TopicId,
        field: &[FieldId],
        operand: &Operand,
    ) -> Result<(), ActionError> {
        let mut text = std::mem::take(&mut self.run.text);
        let view = ScopeView { chart: self.chart, run: self.run, host: self.host, region };
        let result = match operand
            .evaluate(&view)
            .map_err(ActionError::from)
            .and_then(|value| detach(value, &mut text))
        {
            Ok(value) => match operand.change() {
                None => self.host.assign(region, topic, field, value).map_err(ActionError::from),
                Some(change) => {
                    let edited = self.host.edit(region, topic, &mut |message| change.make(message, value));
                    edited.map_err(ActionError::from)
                }
            },
            Err(error) => Err(error),
        };
        self.run.text = text;
        result?;
        self.run.written.insert(region.index());
        self.run.topic_changed(self.chart, topic, Some(region));
        Ok(())
    }
}

/// A value independent of the blackboard from which it was read.
fn detach<'t>(value: Value<'_>, text: &'t mut String) -> Result<Value<'t>, ActionError> {
    Ok(match value {
        Value::Bool(value) => Value::Bool(value),
        Value::Int(value) => Value::Int(value),
        Value::Uint(value) => Value::Uint(value),
        Value::Float(value) => Value::Float(value),
        Value::Enum(value) => Value::Enum(value),
        Value::Text(value) => {
            text.clear();
            text.push_str(value);
            Value::Text(text)
        }
        Value::Missing => return Err(ActionError::Missing),
        Value::Message(_) => return Err(GuardError::WrongType.into()),
    })
}
