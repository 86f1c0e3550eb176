//! What actions do.

use crate::chart::{Owner, RegionId};
use crate::expression::{Effect, GuardError, Operand, TimerId};
use crate::host::{ActionError, ActionPlace, Host, Report};
use crate::machine::script::Performance;
use crate::machine::step::Step;
use crate::machine::view::View;
use crate::moment::Moment;
use crate::semantics::{Sharing, TimerScope};
use crate::vocabulary::{FieldId, TopicId, Value};

/// Where actions are done: their place in the chart, their blackboard, and the state that timers they start belong to.
#[derive(Clone, Copy)]
pub(super) struct Scene {
    pub(super) place: ActionPlace,
    pub(super) region: RegionId,
    pub(super) owner: Owner,
}

impl<H: Host> Step<'_, H> {
    /// Does the actions of one place in order.
    #[inline(always)]
    pub(super) fn perform(&mut self, effects: &[Effect], scene: Scene) {
        if effects.is_empty() {
            return;
        }
        if self.run.log.wanted {
            self.run.log.effects.push(scene.place);
        }
        for (index, effect) in effects.iter().enumerate() {
            if let Err(error) = self.act(effect, scene) {
                self.action_failed(scene.place, index, &error);
            }
        }
    }

    #[cold]
    pub(super) fn action_failed(&mut self, place: ActionPlace, index: usize, error: &ActionError) {
        self.run.raise(self.chart, self.chart.errors.action, true, 0);
        self.host.report(self.chart, Report::ActionFailed { place, index, error });
    }

    /// What is the host's to do is done without a detour.
    #[inline(always)]
    fn act(&mut self, effect: &Effect, scene: Scene) -> Result<(), ActionError> {
        let Effect::Script { script } = effect else { return self.act_itself(effect, scene) };
        let mut performance = Performance { chart: self.chart, run: self.run };
        self.host.perform(*script, scene.region, &mut performance).map_err(ActionError::Script)
    }

    #[inline(never)]
    fn act_itself(&mut self, effect: &Effect, scene: Scene) -> Result<(), ActionError> {
        let region = scene.region;
        match effect {
            Effect::Assign { topic, field, value } => {
                self.assign(region, *topic, field, value)?;
                self.share(region);
            }
            Effect::Publish { topic } => {
                self.host.publish(region, *topic);
                self.run.written.insert(region.index());
                self.share(region);
            }
            Effect::ProcessMessages => self.deliver(region),
            Effect::PublishAll => self.publish_all(region),
            Effect::StartTimeout { timer, delay } => self.start_timer(*timer, self.run.now + *delay, scene),
            Effect::Raise { event } => self.run.raise(self.chart, *event, true, 0),
            Effect::Script { .. } => return self.act(effect, scene),
        }
        Ok(())
    }

    fn publish_all(&mut self, region: RegionId) {
        self.host.publish_all(region);
        self.run.written.remove(region.index());
    }

    /// What was written on a blackboard is seen by the others at once, if that is meant.
    fn share(&mut self, region: RegionId) {
        if self.semantics().sharing == Sharing::NextStep {
            return;
        }
        self.publish_all(region);
        for (index, other) in self.chart.regions.iter().enumerate() {
            let is_free = self.run.is_active(other.root) && !self.run.running_regions.contains(index);
            if index != region.index() && is_free {
                self.deliver(RegionId(index as u32));
            }
        }
    }

    fn start_timer(&mut self, timer: TimerId, deadline: Moment, scene: Scene) {
        let timer = self.chart.regions[scene.region.index()].timers + timer.0 as usize;
        if self.run.timers.set(timer, deadline) {
            self.run.queues.withdraw(timer);
        }
        self.run.timer_changed(self.chart, timer);
        if self.semantics().timers == TimerScope::State {
            match scene.owner {
                Owner::None => {}
                Owner::State(state) => self.run.timers.bind(timer, state),
                Owner::Later => self.run.unbound.push(timer),
            }
        }
    }

    fn assign(
        &mut self,
        region: RegionId,
        topic: TopicId,
        field: &[FieldId],
        operand: &Operand,
    ) -> Result<(), ActionError> {
        let mut text = std::mem::take(&mut self.run.text);
        let view = View { chart: self.chart, run: self.run, host: self.host, region };
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

/// A value that no longer borrows from the blackboard it was read from.
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
