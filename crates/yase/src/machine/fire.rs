//! What a transition does: leaving, acting, entering.

use crate::chart::{CompoundId, Place, RegionId};
use crate::expression::{Effect, GuardError, Operand};
use crate::host::{ActionError, ActionPlace, Host, Report};
use crate::machine::activities::Phase;
use crate::machine::script::Performance;
use crate::machine::step::Step;
use crate::machine::view::View;
use crate::machine::{MachineErrorKind, Status};
use crate::statechart::NodeKind;
use crate::trace::Occasion;
use crate::vocabulary::{FieldId, TopicId, Value};

impl<H: Host> Step<'_, H> {
    /// Enters the root and its START.
    pub(super) fn enter_root(&mut self) {
        self.run.log.clear();
        let root = self.chart.layout.root();
        self.enter(root);
        for &child in &self.chart.states[root.index()].children {
            if self.chart.states[child.index()].kind == NodeKind::Start {
                self.enter(child);
            }
        }
        self.run.selection.clear();
        self.emit(Occasion::Start, None);
    }

    /// Fires the oldest interrupting transition whose activities have all returned.
    pub(super) fn fire_pending(&mut self) -> Result<bool, MachineErrorKind> {
        let ready =
            self.run.pending.iter().position(|pending| !self.leaves_running(self.compound(pending.compound)));
        let Some(index) = ready else { return Ok(false) };
        self.admit()?;
        let pending = self.run.pending.remove(index);
        self.run.selection.clear();
        self.run.log.clear();
        self.run.selection.selected.push(pending.compound);
        self.fire_selected();
        self.forget_left();
        self.emit(pending.event.map_or(Occasion::Eventless, Occasion::Event), None);
        Ok(true)
    }

    /// Once a pending transition has fired: others may have lost their source, and what was held because of it can be offered.
    fn forget_left(&mut self) {
        let chart = self.chart;
        let (active, pending) = (&self.run.active, &mut self.run.pending);
        pending
            .retain(|pending| active.contains(chart.compounds[pending.compound.0 as usize].source.index()));
        self.run.queues.release(|_| true);
    }

    /// Fires the selected transitions one after the other. What comes after the end does not fire, nor a way to TERMINATE whose source
    /// another has left: it leaves nothing itself, so it is in conflict with none.
    pub(super) fn fire_selected(&mut self) {
        let mut index = 0;
        while let Some(&id) = self.run.selection.selected.get(index) {
            if self.run.status == Status::Running && self.run.is_active(self.compound(id).source) {
                self.fire(id);
                index += 1;
            } else {
                self.run.selection.selected.remove(index);
            }
        }
    }

    fn fire(&mut self, id: CompoundId) {
        let compound = &self.chart.compounds[id.0 as usize];
        self.summary.transitions += 1;
        self.run.bound.remember(id);
        if let Some((first, last)) = compound.exits {
            self.leave_between(first, last);
        }
        for (segment, effects) in &compound.effects {
            self.perform(effects, compound.region, ActionPlace::Transition(*segment));
        }
        for &place in &compound.entries {
            self.enter(place);
        }
        if compound.terminates {
            self.halt(Status::Stopped);
        }
    }

    /// Leaves all that is active from one place to another, innermost first.
    fn leave_between(&mut self, first: Place, last: Place) {
        let mut next = self.run.active.next(first.index(), last.index());
        while let Some(index) = next {
            self.leave(Place(index as u32));
            next = self.run.active.next(index + 1, last.index());
        }
    }

    /// Leaves every state.
    pub(super) fn leave_all(&mut self) {
        let root = self.chart.layout.root();
        self.leave_between(Place(0), root);
        self.halt(Status::Stopped);
    }

    fn leave(&mut self, place: Place) {
        let state = &self.chart.states[place.index()];
        if let Some(activity) = state.activity {
            self.release_activity(place, activity);
        }
        self.perform(&state.exit, state.region, ActionPlace::Exit(self.chart.layout.node(place)));
        self.run.active.remove(place.index());
        if state.kind == NodeKind::Start {
            self.run.waiting_starts.remove(place.index());
        }
        if self.run.log.wanted {
            self.run.log.exits.push(self.chart.layout.node(place));
        }
    }

    /// The activity of a state that is left: one that waited to be called again is told.
    fn release_activity(&mut self, place: Place, activity: usize) {
        let slot = self.run.activities.slot(activity);
        if slot.phase == Phase::Ongoing {
            let activation = self.run.activation(self.chart, place, slot);
            self.host.stop(activation);
        }
        self.run.activities.slot_mut(activity).phase = Phase::Idle;
    }

    pub(super) fn enter(&mut self, place: Place) {
        let state = &self.chart.states[place.index()];
        let node = self.chart.layout.node(place);
        self.run.active.insert(place.index());
        if self.run.log.wanted {
            self.run.log.entries.push(node);
        }
        if state.is_region
            && let Some(around) = self.chart.regions[state.region.index()].parent
        {
            self.host.inherit(state.region, around);
        }
        self.perform(&state.entry, state.region, ActionPlace::Entry(node));
        if let Some(activity) = state.activity {
            self.run.enqueue_activity(self.chart, place, activity);
        }
        if state.finishes {
            self.halt(Status::Finished);
        }
    }

    /// Does the actions of one place in order.
    fn perform(&mut self, effects: &[Effect], region: RegionId, place: ActionPlace) {
        if effects.is_empty() {
            return;
        }
        if self.run.log.wanted {
            self.run.log.effects.push(place);
        }
        for (index, effect) in effects.iter().enumerate() {
            if let Err(error) = self.act(effect, region) {
                self.run.raise(self.chart, self.chart.errors.action, true, 0);
                self.host.report(self.chart, Report::ActionFailed { place, index, error: &error });
            }
        }
    }

    fn act(&mut self, effect: &Effect, region: RegionId) -> Result<(), ActionError> {
        match effect {
            Effect::Assign { topic, field, value } => self.assign(region, *topic, field, value)?,
            Effect::Publish { topic } => {
                self.host.publish(region, *topic);
                self.run.written.insert(region.index());
            }
            Effect::ProcessMessages => self.deliver(region),
            Effect::PublishAll => {
                self.host.publish_all(region);
                self.run.written.remove(region.index());
            }
            Effect::StartTimeout { timer, delay } => {
                let timer = self.chart.regions[region.index()].timers + timer.0 as usize;
                if self.run.timers.set(timer, self.run.now + *delay) {
                    self.run.queues.withdraw(timer);
                }
                self.run.timer_changed(self.chart, timer);
            }
            Effect::Raise { event } => self.run.raise(self.chart, *event, true, 0),
            Effect::Script { script } => {
                let mut performance = Performance { chart: self.chart, run: self.run };
                self.host.perform(*script, region, &mut performance).map_err(ActionError::Script)?;
            }
        }
        Ok(())
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
            Ok(value) => self.host.assign(region, topic, field, value).map_err(ActionError::from),
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
