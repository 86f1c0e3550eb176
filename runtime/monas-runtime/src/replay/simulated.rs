//! The replay of a recording of simulated time.

use narukom::prost::Message as _;
use narukom::{AnyPublisher, Receiver, RemoteHeader, Timestamp, TopicSlot};

use super::super::admin::HOST_ITSELF;
use super::super::host_status::OUTSIDE;
use super::super::run_config::RunConfig;
use super::super::setup::PreparedRun;
use super::comparison::ComparisonReport;
use super::replay_host::{OutputCapture, ReplayHost};
use super::replayed_agents::unread;
use super::{
    ComparisonCounts, RecordedMessage, RecordedPublisher, RecordedStream, ReplayDifference, no_input,
};
use monas_core::error::Error;
use monas_core::records::{CHANGE, CHANGED, CHART, Changed, HOST, LOG, MODEL};

/// Agents that run again in simulated time.
///
/// The replay follows the recording message by message, in the order of publication. In simulated
/// time agents have turns: at each time in the order of their names, repeatedly until none has
/// anything left to do. The messages of agents that are not replayed mark the turns of those that
/// are.
pub(crate) struct SimulatedReplay {
    hosts: Vec<ReplayHost>,
    capture: OutputCapture,
    inputs: Vec<SimulatedRoute>,
    report: ComparisonReport,
}

/// The treatment of recorded messages.
enum SimulatedRoute {
    /// Compared with the publications of an agent.
    Compared { host: usize, agent: usize, topic: Option<TopicSlot>, path: usize },
    /// Published again. Messages of an agent are published in its turn.
    Published {
        host: usize,
        publisher: AnyPublisher,
        turn: Option<usize>,
        sets_up: bool,
        asks: bool,
        answers: bool,
    },
    /// Received from another host, and delivered as such again.
    Received { host: usize, receiver: Receiver },
    /// Ignored: their host is not replayed, or does not declare the topic.
    Ignored,
}

impl SimulatedReplay {
    pub(crate) fn new(
        mut config: RunConfig,
        seed: u64,
        publishers: &[RecordedPublisher],
    ) -> Result<SimulatedReplay, Error> {
        let capture = OutputCapture::default();
        config.observers.push(Box::new(capture.clone()));
        config.publishers = publishers.to_vec();
        let PreparedRun { hosts: prepared_hosts, factory, .. } = PreparedRun::new(config, seed)?;
        let hosts =
            prepared_hosts.into_iter().map(|prepared| ReplayHost::new(prepared, &factory, publishers));
        let mut hosts = hosts.collect::<Result<Vec<ReplayHost>, Error>>()?;
        for produced in capture.take() {
            let host = hosts.iter_mut().find(|host| host.hub.host() == produced.host);
            host.into_iter().for_each(|host| host.was_set_up(&produced));
        }
        capture.mute(true);
        Ok(SimulatedReplay { hosts, capture, inputs: Vec::new(), report: ComparisonReport::default() })
    }

    /// The names of the hosts.
    pub(crate) fn hosts(&self) -> Vec<&str> {
        self.hosts.iter().map(|host| host.hub.host()).collect()
    }

    pub(crate) fn input(&mut self, recorded: RecordedStream<'_>) -> Result<usize, Error> {
        let route = self.route(recorded)?;
        self.inputs.push(route);
        Ok(self.inputs.len() - 1)
    }

    fn route(&mut self, recorded: RecordedStream<'_>) -> Result<SimulatedRoute, Error> {
        let RecordedStream { host, received_by, publisher, part, topic } = recorded;
        let recorder = received_by.unwrap_or(host);
        let Some(index) = self.hosts.iter().position(|host| host.hub.host() == recorder) else {
            return Ok(SimulatedRoute::Ignored);
        };
        let hub = self.hosts[index].hub.clone();
        let slot = hub.topic(topic);
        if received_by.is_some() {
            let receiver = slot.map(|_| hub.receiver(host, publisher, topic)).transpose();
            let receiver = receiver.map_err(Error::hub)?;
            return Ok(receiver.map_or(SimulatedRoute::Ignored, |receiver| SimulatedRoute::Received {
                host: index,
                receiver,
            }));
        }
        if let Some(agent) = self.hosts[index].agent_index(publisher) {
            let path = self.report.line(host, publisher, topic);
            return Ok(SimulatedRoute::Compared { host: index, agent, topic: slot, path });
        }
        // The host publishes its own record here too.
        if slot.is_none() || (topic == HOST.path() && publisher == "monas") {
            return Ok(SimulatedRoute::Ignored);
        }
        // The reply to a change marks the position at which it was applied.
        let answers = topic == CHANGED.path() && publisher == HOST_ITSELF;
        // An external request was applied immediately, before any turn.
        let asks = topic == CHANGE.path() && publisher == OUTSIDE;
        let turn = self.hosts[index].turn_index(publisher);
        let publisher = hub.publisher_by_name(topic, publisher).map_err(Error::hub)?.of_part(part);
        // A log line may stand anywhere.
        let sets_up = [HOST.path(), MODEL.path(), CHART.path(), LOG.path()].contains(&topic);
        Ok(SimulatedRoute::Published { host: index, publisher, turn, sets_up, asks, answers })
    }

    pub(crate) fn feed(
        &mut self,
        input: usize,
        message: RecordedMessage<'_>,
        on_difference: &mut dyn FnMut(ReplayDifference),
    ) -> Result<(), Error> {
        let SimulatedReplay { hosts, capture, inputs, report } = self;
        let Some(route) = inputs.get_mut(input) else {
            return Err(no_input());
        };
        match route {
            SimulatedRoute::Ignored => {}
            SimulatedRoute::Compared { host, agent, topic, path } => {
                let host = &mut hosts[*host];
                host.advance_to(message.received, capture, report, on_difference);
                host.expect(*agent, *topic, *path, message.bytes, capture);
            }
            SimulatedRoute::Published { host, publisher, turn, sets_up, asks, answers } => {
                let host = &mut hosts[*host];
                host.advance_to(message.received, capture, report, on_difference);
                host.turn_of_another(*turn, *sets_up, capture);
                if *answers {
                    host.apply_requests(capture);
                    host.answered(&Changed::decode(message.bytes).map_err(unread)?);
                }
                publisher.publish_bytes(message.bytes, host.now).map_err(Error::hub)?;
                if *asks {
                    host.apply_requests(capture);
                }
            }
            SimulatedRoute::Received { host, receiver } => {
                let host = &mut hosts[*host];
                host.advance_to(message.received, capture, report, on_difference);
                let arrival = RemoteHeader {
                    sequence: message.sequence.into(),
                    published: message.published,
                    local: message.published,
                    received: message.received,
                };
                receiver.receive_bytes(message.bytes, arrival).map_err(Error::hub)?;
            }
        }
        self.hosts.iter_mut().try_for_each(ReplayHost::check)
    }

    pub(crate) fn end(&mut self, moment: Timestamp, on_difference: &mut dyn FnMut(ReplayDifference)) {
        for host in &mut self.hosts {
            host.advance_to(moment, &self.capture, &mut self.report, on_difference);
            host.stop(&self.capture);
        }
    }

    pub(crate) fn finish(
        mut self,
        is_whole: bool,
        on_difference: &mut dyn FnMut(ReplayDifference),
    ) -> Result<Vec<ComparisonCounts>, Error> {
        for host in &mut self.hosts {
            host.close(is_whole, &self.capture, &mut self.report, on_difference);
            host.check()?;
        }
        Ok(self.report.tallies())
    }
}
