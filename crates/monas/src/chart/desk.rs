//! What a machine knows of its world here: a blackboard for each region, functions, and those who look on.

use std::any::Any;
use std::collections::VecDeque;
use std::sync::Arc;

use narukom::{Moment, Publisher, TopicSlot};
use yase::expression::{CallError, Facts, MessageSource, TimerId, TimerState};
use yase::{
    Activation, Chart, FieldId, FunctionId, Host, NodeId, Occasion, RegionId, Report, TopicId, TraceRecord,
    TransitionId, Value,
};

use super::Home;
use super::lending::Lending;
use super::urgency::Urgency;
use super::values;
use crate::coverage::Counts;
use crate::error::Error;
use crate::function::FunctionDeclaration;
use crate::listener::Listeners;
use crate::monitors::Seen;
use crate::records::{self, CHART, Delivery, MODEL};

/// The host of one machine.
pub(super) struct Desk {
    pub(super) host: String,
    pub(super) agent: String,
    pub(super) number: u32,
    pub(super) now: Moment,
    pub(super) lending: Lending,
    pub(super) urgency: Urgency,
    functions: Arc<[FunctionDeclaration]>,
    /// Activities to be called, in the order in which the machine started them.
    pub(super) started: VecDeque<Activation>,
    /// Activities that were asked to return.
    pub(super) cancelled: Vec<Activation>,
    /// Activities that waited and whose state was left.
    pub(super) left: Vec<Activation>,
    /// What was delivered since the step began.
    pub(super) delivered: Vec<Delivery>,
    pub(super) coverage: Counts,
    /// What has happened since the step began, if somebody asks.
    pub(super) seen: Option<Seen>,
    records: Publisher<records::Chart>,
    listeners: Listeners,
}

impl Desk {
    pub(super) fn new(
        chart: &Chart,
        home: Home<'_>,
        functions: Arc<[FunctionDeclaration]>,
    ) -> Result<Desk, Error> {
        home.hub
            .publisher(MODEL, home.agent)
            .map_err(Error::hub)?
            .of_part(home.part())
            .publish(model(chart, home.number), home.now);
        Ok(Desk {
            host: home.hub.host().into(),
            agent: home.agent.into(),
            number: home.number,
            now: home.now,
            lending: Lending::new(chart, home)?,
            urgency: Urgency::new(chart),
            functions,
            started: VecDeque::new(),
            cancelled: Vec::new(),
            left: Vec::new(),
            delivered: Vec::new(),
            coverage: Counts::new(chart),
            seen: None,
            records: home.hub.publisher(CHART, home.agent).map_err(Error::hub)?.of_part(home.part()),
            listeners: home.listeners.clone(),
        })
    }

    /// Takes over from the desk of a chart that this one replaces.
    pub(super) fn take_over(
        &mut self,
        old: Desk,
        regions: &[(RegionId, RegionId)],
        known: impl Fn(Activation) -> Option<Activation> + Copy,
        counterpart: impl Fn(NodeId) -> Option<NodeId>,
    ) {
        self.started = old.started.into_iter().filter_map(known).collect();
        self.cancelled = old.cancelled.into_iter().filter_map(known).collect();
        self.left = old.left.into_iter().filter_map(known).collect();
        self.urgency.take_over(&old.urgency, counterpart);
        self.lending.take_over(old.lending, regions, known);
    }

    pub(super) fn number(&self) -> u32 {
        self.number
    }

    pub(super) fn seed(&self) -> u64 {
        self.lending.seed()
    }

    pub(super) fn listeners(&self) -> &Listeners {
        &self.listeners
    }

    pub(super) fn begin_step(&mut self, now: Moment) {
        self.now = now;
        self.delivered.clear();
        self.cancelled.clear();
    }

    fn newest(&self, region: RegionId, source: &MessageSource) -> Option<&dyn narukom::AnyMessage> {
        self.lending.newest_of(region, source, self.now).map(|sample| &*sample.message)
    }
}

impl Host for Desk {
    fn field(&self, region: RegionId, source: &MessageSource, path: &[FieldId]) -> Value<'_> {
        self.newest(region, source).map_or(Value::Missing, |message| values::field(message, path))
    }

    fn message(&self, region: RegionId, source: &MessageSource) -> Value<'_> {
        self.newest(region, source).map_or(Value::Missing, |message| Value::Message(message.as_any()))
    }

    fn call(&self, function: FunctionId, arguments: &[Value<'_>]) -> Result<Value<'_>, CallError> {
        let declaration = self.functions.get(function.0 as usize);
        let declaration = declaration.ok_or_else(|| CallError::new("there is no such function"))?;
        (declaration.call)(arguments)
            .ok_or_else(|| CallError::new("the function does not take these arguments"))
    }

    fn deliver(&mut self, region: RegionId) {
        let Some(blackboard) = self.lending.deliver(region, self.now) else { return };
        self.delivered.extend(Delivery::all(blackboard, region.0));
        self.delivered.extend(self.lending.followed(region));
    }

    fn inherit(&mut self, region: RegionId, from: RegionId) {
        self.lending.inherit(region, from, self.now);
    }

    fn assign(
        &mut self,
        region: RegionId,
        topic: TopicId,
        path: &[FieldId],
        value: Value<'_>,
    ) -> Result<(), CallError> {
        let blackboard = self.lending.free_mut(region, self.now);
        let blackboard = blackboard.ok_or_else(|| CallError::new("there is no such region"))?;
        let mut result = Ok(());
        let edited = blackboard.edit(slot(topic), |message| result = values::set_field(message, path, value));
        edited.map_err(|error| CallError::new(error.to_string()))?;
        result
    }

    fn edit(
        &mut self,
        region: RegionId,
        topic: TopicId,
        change: &mut dyn FnMut(&mut dyn Any) -> Result<(), CallError>,
    ) -> Result<(), CallError> {
        let blackboard = self.lending.free_mut(region, self.now);
        let blackboard = blackboard.ok_or_else(|| CallError::new("there is no such region"))?;
        let mut result = Ok(());
        let edited = blackboard.edit(slot(topic), |message| result = change(message.as_any_mut()));
        edited.map_err(|error| CallError::new(error.to_string()))?;
        result
    }

    fn publish(&mut self, region: RegionId, topic: TopicId) {
        if let Some(blackboard) = self.lending.free_mut(region, self.now)
            && let Err(error) = blackboard.edit(slot(topic), |_| {})
        {
            tracing::error!(robot = %self.host, agent = %self.agent, "nothing is published: {error}");
        }
    }

    fn publish_all(&mut self, region: RegionId) {
        self.lending.publish_all(region, self.now);
    }

    fn start(&mut self, activation: Activation) {
        // Whoever had the blackboard before may have been asked to return; this one is not, so far.
        if let Some(blackboard) = self.lending.free_mut(activation.region, self.now) {
            blackboard.cancellation().withdraw();
        }
        self.started.push_back(activation);
    }

    fn cancel(&mut self, activation: Activation) {
        self.lending.cancel(activation.region);
        self.cancelled.push(activation);
    }

    fn stop(&mut self, activation: Activation) {
        self.left.push(activation);
    }

    fn wants_trace(&self) -> bool {
        true
    }

    fn trace(&mut self, chart: &Chart, record: &TraceRecord<'_>) {
        self.coverage.count(chart, record);
        self.urgency.note(chart, record);
        if let Some(seen) = &mut self.seen {
            seen.note(record);
        }
        self.lending.fetching.publishing();
        let number = self.number;
        self.records.publish_with(|message| write_record(message, number, chart, record), self.now);
        self.listeners.tell(&self.host, &self.agent, chart, record);
    }

    fn report(&mut self, chart: &Chart, report: Report<'_>) {
        let name = |transition| transition_name(chart, transition);
        let (robot, agent) = (&self.host, &self.agent);
        match report {
            Report::GuardFailed { transition, error } => {
                tracing::warn!(%robot, %agent, transition = %name(transition), "guard without a value: {error}");
            }
            Report::ActionFailed { place, index, error } => {
                tracing::error!(%robot, %agent, ?place, action = index + 1, "action failed: {error}");
            }
            Report::StartWaits { start } => {
                tracing::debug!(%robot, %agent, start = %chart.short_path(start), "no way out of this START is open");
            }
            _ => {}
        }
    }
}

/// What the blackboard of a chart's root shows.
pub(super) struct Root<'a>(pub(super) &'a Desk);

const ROOT: RegionId = RegionId(0);

impl Facts for Root<'_> {
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

/// Fills in the record of a micro-step, with the memory that the message has.
fn write_record(message: &mut records::Chart, number: u32, chart: &Chart, record: &TraceRecord<'_>) {
    (message.chart, message.time) = (number, record.time.as_nanos());
    message.event = match record.occasion {
        Occasion::Event(event) => event.0 + 1,
        _ => 0,
    };
    message.deferred = record.deferred.map_or(0, |node| node.0 + 1);
    for (segments, compounds) in [
        (&mut message.selected, record.selected),
        (&mut message.preempted, record.preempted),
        (&mut message.held, record.held),
    ] {
        let of = |&compound: &yase::CompoundId| chart.segments(compound);
        segments.extend(compounds.iter().flat_map(of).map(|segment| segment.0));
    }
    message.exits.extend(record.exits.iter().map(|node| node.0));
    message.entries.extend(record.entries.iter().map(|node| node.0));
    message.taken.extend(record.taken.iter().map(|segment| segment.0));
}

fn slot(topic: TopicId) -> TopicSlot {
    TopicSlot::new(topic.0)
}

fn model(chart: &Chart, number: u32) -> records::Model {
    let statechart = chart.statechart();
    let events = (0..chart.events().len() as u32).map(yase::expression::EventId);
    records::Model {
        chart: number,
        name: statechart.name.clone(),
        nodes: statechart.nodes().map(|(id, _)| statechart.path(id)).collect(),
        transitions: statechart.transitions().map(|(id, _)| transition_name(chart, id)).collect(),
        events: events.map(|event| chart.events().name(event).to_owned()).collect(),
    }
}

/// `source -> target`, as traces name a transition.
pub(crate) fn transition_name(chart: &Chart, id: TransitionId) -> String {
    let transition = chart.statechart().transition(id);
    format!("{} -> {}", chart.short_path(transition.source), chart.short_path(transition.target))
}
