//! Implements [`yase::Host`] on Narukom blackboards.

use std::any::Any;
use std::sync::Arc;

use narukom::{AnyMessage, FieldValue, Publisher, Timestamp, TopicSlot};
use yase::expression::{CallError, EvalContext, MessageSource, TimerId, TimerState};
use yase::{
    Activation, CompiledChart, FieldId, FunctionId, Host, MicroStepCause, NodeId, Notice, ScopeId, TopicId,
    TraceRecord, TransitionId, Value,
};

use super::ChartContext;
use super::activity_slots::ActivitySlots;
use super::region_blackboards::RegionBlackboards;
use crate::activity::Activity;
use crate::call;
use crate::coverage::CoverageCounts;
use crate::error::Error;
use crate::function::FunctionDeclaration;
use crate::listener::ListenerSet;
use crate::monitors::StepObservation;
use crate::records::{self, CHART, Delivery, MODEL};

/// The host of one machine.
pub(crate) struct ChartHost {
    pub(crate) host: String,
    pub(crate) agent: String,
    pub(crate) number: u32,
    pub(crate) now: Timestamp,
    pub(crate) blackboards: RegionBlackboards,
    pub(crate) slots: ActivitySlots,
    functions: Arc<[FunctionDeclaration]>,
    /// Waiting activations whose states were exited.
    pub(crate) exited: Vec<Activation>,
    /// Deliveries since the step began.
    pub(crate) delivered: Vec<Delivery>,
    pub(crate) coverage: CoverageCounts,
    /// The observed micro-steps since the step began, if observation is enabled.
    pub(crate) observation: Option<StepObservation>,
    records: Publisher<records::Chart>,
    listeners: ListenerSet,
}

impl ChartHost {
    pub(crate) fn new(
        chart: &CompiledChart,
        home: ChartContext<'_>,
        functions: Arc<[FunctionDeclaration]>,
        activities: Vec<Box<dyn Activity>>,
    ) -> Result<ChartHost, Error> {
        home.hub
            .publisher(MODEL, home.agent)
            .map_err(Error::hub)?
            .of_part(home.part())
            .publish(model(chart, home.number), home.now);
        Ok(ChartHost {
            host: home.hub.host().into(),
            agent: home.agent.into(),
            number: home.number,
            now: home.now,
            blackboards: RegionBlackboards::new(chart, home)?,
            slots: ActivitySlots::new(chart, activities, home.hub, home.agent),
            functions,
            exited: Vec::new(),
            delivered: Vec::new(),
            coverage: CoverageCounts::new(chart),
            observation: None,
            records: home.hub.publisher(CHART, home.agent).map_err(Error::hub)?.of_part(home.part()),
            listeners: home.listeners.clone(),
        })
    }

    /// Takes over from the host of a chart that this one replaces.
    pub(crate) fn take_over(
        &mut self,
        old: ChartHost,
        regions: &[(ScopeId, ScopeId)],
        known: impl Fn(Activation) -> Option<Activation> + Copy,
        counterpart: impl Fn(NodeId) -> Option<NodeId>,
    ) {
        self.exited = old.exited.into_iter().filter_map(known).collect();
        self.slots.take_over(old.slots, counterpart, known);
        self.blackboards.take_over(old.blackboards, regions, known);
    }

    pub(crate) fn number(&self) -> u32 {
        self.number
    }

    pub(crate) fn seed(&self) -> u64 {
        self.blackboards.seed()
    }

    pub(crate) fn listeners(&self) -> &ListenerSet {
        &self.listeners
    }

    pub(crate) fn begin_step(&mut self, now: Timestamp) {
        self.now = now;
        self.delivered.clear();
    }

    fn newest(&self, region: ScopeId, source: &MessageSource) -> Option<&dyn AnyMessage> {
        self.blackboards.newest_of(region, source, self.now).map(|sample| &*sample.message)
    }
}

impl Host for ChartHost {
    fn field(&self, region: ScopeId, source: &MessageSource, path: &[FieldId]) -> Value<'_> {
        self.newest(region, source).map_or(Value::Missing, |message| message_field(message, path))
    }

    fn message(&self, region: ScopeId, source: &MessageSource) -> Value<'_> {
        self.newest(region, source).map_or(Value::Missing, |message| Value::Message(message.as_any()))
    }

    fn call(&self, function: FunctionId, arguments: &[Value<'_>]) -> Result<Value<'_>, CallError> {
        let declaration = self.functions.get(function.0 as usize);
        let declaration = declaration.ok_or_else(|| CallError::new("there is no such function"))?;
        call::caught(|| (declaration.call)(arguments))
            .map_err(|failure| CallError::new(format!("the function {failure}")))?
            .ok_or_else(|| CallError::new("the function does not take these arguments"))
    }

    fn deliver(&mut self, region: ScopeId) {
        let Some(blackboard) = self.blackboards.deliver(region, self.now) else { return };
        self.delivered.extend(Delivery::all(blackboard, region.0));
        self.delivered.extend(self.blackboards.source_deliveries(region));
    }

    fn inherit(&mut self, region: ScopeId, from: ScopeId) {
        self.blackboards.inherit(region, from, self.now);
    }

    fn assign(
        &mut self,
        region: ScopeId,
        topic: TopicId,
        path: &[FieldId],
        value: Value<'_>,
    ) -> Result<(), CallError> {
        let blackboard = self.blackboards.reclaim_mut(region, self.now);
        let blackboard = blackboard.ok_or_else(|| CallError::new("there is no such region"))?;
        let mut result = Ok(());
        let edited = blackboard.edit(slot(topic), |message| result = set_message_field(message, path, value));
        edited.map_err(|error| CallError::new(error.to_string()))?;
        result
    }

    fn edit(
        &mut self,
        region: ScopeId,
        topic: TopicId,
        change: &mut dyn FnMut(&mut dyn Any) -> Result<(), CallError>,
    ) -> Result<(), CallError> {
        let blackboard = self.blackboards.reclaim_mut(region, self.now);
        let blackboard = blackboard.ok_or_else(|| CallError::new("there is no such region"))?;
        let mut result = Ok(());
        let edited = blackboard.edit(slot(topic), |message| result = change(message.as_any_mut()));
        edited.map_err(|error| CallError::new(error.to_string()))?;
        result
    }

    fn publish(&mut self, region: ScopeId, topic: TopicId) {
        if let Some(blackboard) = self.blackboards.reclaim_mut(region, self.now)
            && let Err(error) = blackboard.edit(slot(topic), |_| {})
        {
            tracing::error!(robot = %self.host, agent = %self.agent, "nothing is published: {error}");
        }
    }

    fn publish_all(&mut self, region: ScopeId) {
        self.blackboards.publish_all(region, self.now);
    }

    fn start(&mut self, activation: Activation) {
        // The previous activation may have been cancelled; this one is not.
        if let Some(blackboard) = self.blackboards.reclaim_mut(activation.region, self.now) {
            blackboard.cancellation().withdraw();
        }
        self.slots.begin(activation);
    }

    fn cancel(&mut self, activation: Activation) {
        self.blackboards.cancel(activation.region);
        self.slots.cancel(activation, self.now);
    }

    fn stop(&mut self, activation: Activation) {
        self.exited.push(activation);
    }

    fn wants_trace(&self) -> bool {
        true
    }

    fn trace(&mut self, chart: &CompiledChart, record: &TraceRecord<'_>) {
        self.coverage.count(chart, record);
        self.slots.record_transitions(chart, record);
        if let Some(seen) = &mut self.observation {
            seen.note(record);
        }
        self.blackboards.delivery_log.publishing();
        let number = self.number;
        self.records.publish_with(|message| write_record(message, number, chart, record), self.now);
        self.listeners.micro_step(&self.host, &self.agent, chart, record);
    }

    fn report(&mut self, chart: &CompiledChart, report: Notice<'_>) {
        let name = |transition| transition_name(chart, transition);
        let (robot, agent) = (&self.host, &self.agent);
        match report {
            Notice::GuardFailed { transition, error } => {
                tracing::warn!(%robot, %agent, transition = %name(transition), "guard without a value: {error}");
            }
            Notice::ActionFailed { location, index, error } => {
                tracing::error!(%robot, %agent, ?location, action = index + 1, "action failed: {error}");
            }
            Notice::StartWaits { start } => {
                tracing::debug!(%robot, %agent, start = %chart.names().name(start), "no outgoing transition of this START is enabled");
            }
            _ => {}
        }
    }
}

/// The values that the blackboard of the chart's root shows.
pub(crate) struct RootScope<'a>(pub(crate) &'a ChartHost);

const ROOT: ScopeId = ScopeId(0);

impl EvalContext for RootScope<'_> {
    fn field(&self, source: &MessageSource, path: &[FieldId]) -> Value<'_> {
        self.0.field(ROOT, source, path)
    }

    fn message(&self, source: &MessageSource) -> Value<'_> {
        self.0.message(ROOT, source)
    }

    fn call(&self, function: FunctionId, arguments: &[Value<'_>]) -> Result<Value<'_>, CallError> {
        self.0.call(function, arguments)
    }

    fn timer(&self, _: TimerId) -> TimerState {
        TimerState::Unset
    }

    fn is_active(&self, _: NodeId) -> bool {
        false
    }
}

/// Fills in the record of a micro-step, reusing the memory of the message.
fn write_record(message: &mut records::Chart, number: u32, chart: &CompiledChart, record: &TraceRecord<'_>) {
    (message.chart, message.time) = (number, record.time.as_nanos());
    message.event = match record.cause {
        MicroStepCause::Event(event) => event.0 + 1,
        _ => 0,
    };
    message.deferred = record.deferred.map_or(0, |node| node.0 + 1);
    for (segments, compounds) in [
        (&mut message.selected, record.selected),
        (&mut message.preempted, record.preempted),
        (&mut message.held, record.held),
    ] {
        let of = |&compound: &yase::CompoundTransitionId| chart.segments(compound);
        segments.extend(compounds.iter().flat_map(of).map(|segment| segment.0));
    }
    message.exits.extend(record.exits.iter().map(|node| node.0));
    message.entries.extend(record.entries.iter().map(|node| node.0));
    message.taken.extend(record.taken.iter().map(|segment| segment.0));
}

fn slot(topic: TopicId) -> TopicSlot {
    TopicSlot::new(topic.0)
}

fn model(chart: &CompiledChart, number: u32) -> records::Model {
    let statechart = chart.statechart();
    let events = (0..chart.events().len() as u32).map(yase::expression::EventId);
    // Each transition has two of these paths: computing them anew took a third of many short runs.
    let short: Vec<String> = statechart.nodes().map(|(id, _)| chart.short_path(id)).collect();
    let short = |node: NodeId| short.get(node.0 as usize).map_or("", String::as_str);
    let name =
        |transition: &yase::statechart::Transition| arrow(short(transition.source), short(transition.target));
    records::Model {
        chart: number,
        name: statechart.name.clone(),
        nodes: statechart.nodes().map(|(id, _)| statechart.path(id)).collect(),
        transitions: statechart.transitions().map(|(_, transition)| name(transition)).collect(),
        events: events.map(|event| chart.events().name(event).to_owned()).collect(),
    }
}

/// The name of a transition in traces: `source -> target`.
pub(crate) fn transition_name(chart: &CompiledChart, id: TransitionId) -> String {
    let transition = chart.statechart().transition(id);
    arrow(&chart.short_path(transition.source), &chart.short_path(transition.target))
}

fn arrow(source: &str, target: &str) -> String {
    format!("{source} -> {target}")
}

/// A field of a message; the path leads through nested messages. `Missing` if one of these is not
/// set.
pub(crate) fn message_field<'a>(message: &'a dyn AnyMessage, path: &[FieldId]) -> Value<'a> {
    let Some((last, outer)) = path.split_last() else { return Value::Message(message.as_any()) };
    let mut message = message;
    for step in outer {
        match message.field(step.0 as usize) {
            FieldValue::Message(inner) => message = inner,
            _ => return Value::Missing,
        }
    }
    field_value(message.field(last.0 as usize))
}

fn field_value(field: FieldValue<'_>) -> Value<'_> {
    match field {
        FieldValue::Bool(truth) => Value::Bool(truth),
        FieldValue::Int(number) => Value::Int(number),
        FieldValue::Uint(number) => Value::Uint(number),
        FieldValue::Float(number) => Value::Float(number),
        FieldValue::Text(text) => Value::Text(text),
        FieldValue::Enum(number) => Value::Enum(number),
        FieldValue::Message(message) => Value::Message(message.as_any()),
        // The type environment excludes lists, maps and bytes, so no expression reads them.
        _ => Value::Missing,
    }
}

/// Sets a field of a message; creates missing messages on the path.
pub(crate) fn set_message_field(
    message: &mut dyn AnyMessage,
    path: &[FieldId],
    value: Value<'_>,
) -> Result<(), CallError> {
    let Some((last, outer)) = path.split_last() else {
        return Err(CallError::new("a whole message cannot be assigned"));
    };
    let mut message = message;
    for step in outer {
        let inner = message.message_mut(step.0 as usize);
        message = inner.ok_or_else(|| CallError::new("there is no message inside the message"))?;
    }
    let value = from_value(value).ok_or_else(|| CallError::new("a whole message cannot be assigned"))?;
    message.set_field(last.0 as usize, value).map_err(|error| CallError::new(error.to_string()))
}

fn from_value(value: Value<'_>) -> Option<FieldValue<'_>> {
    Some(match value {
        Value::Missing => FieldValue::Missing,
        Value::Bool(truth) => FieldValue::Bool(truth),
        Value::Int(number) => FieldValue::Int(number),
        Value::Uint(number) => FieldValue::Uint(number),
        Value::Float(number) => FieldValue::Float(number),
        Value::Text(text) => FieldValue::Text(text),
        Value::Enum(number) => FieldValue::Enum(number),
        Value::Message(_) => return None,
    })
}
