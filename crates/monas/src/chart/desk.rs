//! What a machine knows of its world here: a blackboard for each region, functions, and those who look on.

use std::collections::VecDeque;
use std::sync::Arc;

use narukom::{Blackboard, Moment, Publisher, TopicSlot};
use yase::expression::{CallError, MessageSource, Origin};
use yase::{
    Activation, Chart, FieldId, FunctionId, Host, Occasion, RegionId, Report, TopicId, TraceRecord,
    TransitionId, Value,
};

use super::Home;
use super::values;
use crate::coverage::Counts;
use crate::error::Error;
use crate::function::FunctionDeclaration;
use crate::listener::Listeners;
use crate::records::{self, CHART, Delivery, MODEL};

/// The host of one machine.
pub(super) struct Desk {
    pub(super) host: String,
    pub(super) agent: String,
    number: u32,
    pub(super) now: Moment,
    /// By region; none while an activity has it.
    pub(super) blackboards: Vec<Option<Blackboard>>,
    functions: Arc<[FunctionDeclaration]>,
    /// Activities to be called, in the order in which the machine started them.
    pub(super) started: VecDeque<Activation>,
    pub(super) cancelled: Vec<Activation>,
    /// Activities that waited and whose state was left.
    pub(super) left: Vec<Activation>,
    /// What was delivered since the step began.
    pub(super) delivered: Vec<Delivery>,
    pub(super) coverage: Counts,
    records: Publisher<records::Chart>,
    listeners: Listeners,
}

impl Desk {
    pub(super) fn new(
        chart: &Chart,
        home: Home<'_>,
        functions: Arc<[FunctionDeclaration]>,
        blackboards: Vec<Option<Blackboard>>,
    ) -> Result<Desk, Error> {
        home.hub
            .publisher(MODEL, home.agent)
            .map_err(Error::hub)?
            .publish(model(chart, home.number), Moment::ZERO);
        Ok(Desk {
            host: home.hub.host().into(),
            agent: home.agent.into(),
            number: home.number,
            now: Moment::ZERO,
            blackboards,
            functions,
            started: VecDeque::new(),
            cancelled: Vec::new(),
            left: Vec::new(),
            delivered: Vec::new(),
            coverage: Counts::new(chart),
            records: home.hub.publisher(CHART, home.agent).map_err(Error::hub)?,
            listeners: home.listeners.clone(),
        })
    }

    pub(super) fn begin_step(&mut self, now: Moment) {
        self.now = now;
        self.delivered.clear();
    }

    pub(super) fn blackboard_mut(&mut self, region: RegionId) -> Option<&mut Blackboard> {
        self.blackboards.get_mut(region.0 as usize)?.as_mut()
    }

    fn blackboard(&self, region: RegionId) -> Option<&Blackboard> {
        self.blackboards.get(region.0 as usize)?.as_ref()
    }

    pub(super) fn take(&mut self, region: RegionId) -> Option<Blackboard> {
        self.blackboards.get_mut(region.0 as usize)?.take()
    }

    pub(super) fn put(&mut self, region: RegionId, blackboard: Blackboard) {
        if let Some(place) = self.blackboards.get_mut(region.0 as usize) {
            *place = Some(blackboard);
        }
    }

    /// The newest message of a source. A blackboard keeps one newest message for each topic: if that is not by the publisher that is
    /// meant, or if another host is meant, of which nothing arrives on this hub, there is none.
    fn newest(&self, region: RegionId, source: &MessageSource) -> Option<&dyn narukom::AnyMessage> {
        let blackboard = self.blackboard(region)?;
        let sample = blackboard.latest_sample(slot(source.topic))?;
        let is_meant = match &source.origin {
            Origin::Own => true,
            Origin::Host(host) => **host == *self.host,
            Origin::Publisher(publisher) => self.is_published_by(blackboard, sample, publisher),
            Origin::HostPublisher { host, publisher } => {
                **host == *self.host && self.is_published_by(blackboard, sample, publisher)
            }
            _ => false,
        };
        is_meant.then_some(&*sample.message)
    }

    fn is_published_by(&self, blackboard: &Blackboard, sample: &narukom::AnySample, publisher: &str) -> bool {
        blackboard.hub().publisher_name(sample.header.publisher).is_some_and(|name| *name == *publisher)
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
        let now = self.now;
        let Some(blackboard) = self.blackboards.get_mut(region.0 as usize).and_then(Option::as_mut) else {
            return;
        };
        blackboard.process_messages(now);
        self.delivered.extend(Delivery::all(blackboard, region.0));
    }

    fn inherit(&mut self, region: RegionId, from: RegionId) {
        let places = [region.0 as usize, from.0 as usize];
        if let Ok([Some(inner), Some(outer)]) = self.blackboards.get_disjoint_mut(places) {
            inner.adopt(outer);
        }
    }

    fn assign(
        &mut self,
        region: RegionId,
        topic: TopicId,
        path: &[FieldId],
        value: Value<'_>,
    ) -> Result<(), CallError> {
        let blackboard = self.blackboard_mut(region);
        let blackboard = blackboard.ok_or_else(|| CallError::new("an activity has the blackboard"))?;
        let mut result = Ok(());
        let edited = blackboard.edit(slot(topic), |message| result = values::set_field(message, path, value));
        edited.map_err(|error| CallError::new(error.to_string()))?;
        result
    }

    fn publish(&mut self, region: RegionId, topic: TopicId) {
        if let Some(blackboard) = self.blackboard_mut(region)
            && let Err(error) = blackboard.edit(slot(topic), |_| {})
        {
            tracing::error!(agent = %self.agent, "nothing is published: {error}");
        }
    }

    fn publish_all(&mut self, region: RegionId) {
        let now = self.now;
        if let Some(blackboard) = self.blackboard_mut(region) {
            blackboard.publish_all(now);
        }
    }

    fn start(&mut self, activation: Activation) {
        self.started.push_back(activation);
    }

    fn cancel(&mut self, activation: Activation) {
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
        self.records.publish(self.record(chart, record), self.now);
        self.listeners.tell(&self.host, &self.agent, chart, record);
    }

    fn report(&mut self, chart: &Chart, report: Report<'_>) {
        let name = |transition| transition_name(chart, transition);
        let agent = &self.agent;
        match report {
            Report::GuardFailed { transition, error } => {
                tracing::warn!(%agent, transition = %name(transition), "guard without a value: {error}");
            }
            Report::ActionFailed { place, index, error } => {
                tracing::error!(%agent, ?place, action = index + 1, "action failed: {error}");
            }
            Report::StartWaits { start } => {
                tracing::debug!(%agent, start = %chart.short_path(start), "no way out of this START is open");
            }
            _ => {}
        }
    }
}

impl Desk {
    fn record(&self, chart: &Chart, record: &TraceRecord<'_>) -> records::Chart {
        let segments = |list: &[yase::CompoundId]| -> Vec<u32> {
            list.iter().flat_map(|&compound| chart.segments(compound)).map(|segment| segment.0).collect()
        };
        let nodes = |list: &[yase::NodeId]| list.iter().map(|node| node.0).collect();
        records::Chart {
            chart: self.number,
            time: record.time.as_nanos(),
            event: match record.occasion {
                Occasion::Event(event) => event.0 + 1,
                _ => 0,
            },
            selected: segments(record.selected),
            preempted: segments(record.preempted),
            held: segments(record.held),
            deferred: record.deferred.map_or(0, |node| node.0 + 1),
            exits: nodes(record.exits),
            entries: nodes(record.entries),
        }
    }
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
