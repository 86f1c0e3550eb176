//! Runs agents again on what was recorded, and compares what they publish with what they published then.

mod compare;
mod scene;

use narukom::{AnyPublisher, Arrival, Moment, Receiver, TopicSlot};

use super::Talws;
use super::setup::Stage;
use crate::error::{Error, ErrorKind};
use crate::records::{CHART, HOST, MODEL};

use compare::Ledger;
use scene::{Scene, Spy};

/// A publisher of a host, as it was when the host was recorded.
#[derive(Clone, PartialEq, Eq, PartialOrd, Ord, Debug)]
pub struct Company {
    /// The host.
    pub host: String,
    /// The publisher's name.
    pub publisher: String,
    /// Whether it was an agent: whether it published records of its cycles.
    pub is_agent: bool,
}

/// What the messages of one publisher on one topic have in common.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub struct Recorded<'a> {
    /// The host on which they were published.
    pub host: &'a str,
    /// The host that recorded them, if they came to it from the other one.
    pub received_by: Option<&'a str>,
    /// Who published.
    pub publisher: &'a str,
    /// The path of the topic.
    pub topic: &'a str,
}

/// A recorded message of an [input](Replay::input).
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub struct RecordedMessage<'a> {
    /// Its number among its publisher's messages on the topic; the lower 32 bits.
    pub sequence: u32,
    /// When it was published.
    pub published: Moment,
    /// When it came to the hub that was recorded.
    pub received: Moment,
    /// Its protobuf encoding.
    pub bytes: &'a [u8],
}

/// How what an agent publishes in a replay differs from what it published when it was recorded.
#[derive(Clone, PartialEq, Eq, Debug)]
pub struct Difference {
    /// The agent's host.
    pub host: String,
    /// The agent.
    pub agent: String,
    /// The agent's cycle, counted from 1.
    pub cycle: u64,
    /// When.
    pub time: Moment,
    /// The path of the topic.
    pub topic: String,
    /// What was recorded; none if nothing was.
    pub recorded: Option<Vec<u8>>,
    /// What was published in the replay; none if nothing was. If both are equal, they came in another order.
    pub replayed: Option<Vec<u8>>,
}

/// What was compared of one agent on one topic.
#[derive(Clone, PartialEq, Eq, Debug)]
pub struct Tally {
    /// The agent's host.
    pub host: String,
    /// The agent.
    pub agent: String,
    /// The path of the topic.
    pub topic: String,
    /// Messages that were published both times.
    pub compared: u64,
    /// How many of these differ.
    pub different: u64,
    /// Messages that were only recorded.
    pub only_recorded: u64,
    /// Messages that were only published in the replay.
    pub only_replayed: u64,
}

impl Tally {
    /// How many messages are not what they were.
    pub fn differences(&self) -> u64 {
        self.different + self.only_recorded + self.only_replayed
    }
}

/// Where recorded messages come in: see [`Replay::input`].
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub struct Input(usize);

/// Agents that run again, in simulated time, on what was recorded. What others published is published again, at the moments of
/// then; what the agents publish is compared, byte by byte, with what they published then.
///
/// It follows the recording message by message, in the order of publication. In simulated time agents have turns: those of a moment
/// in the order of their names, again and again until none has anything left to do. The messages of those that are not replayed say
/// when it is the turn of those that are.
///
/// What comes from outside and is no message, an event that somebody raised by hand, is not in a recording and so not in a replay.
pub struct Replay {
    scenes: Vec<Scene>,
    spy: Spy,
    inputs: Vec<Route>,
    ledger: Ledger,
}

/// What becomes of recorded messages.
enum Route {
    /// They are what an agent is compared with.
    Compared { scene: usize, actor: usize, topic: Option<TopicSlot>, path: usize },
    /// They are published again. Those of an agent are published when it is its turn.
    Published { scene: usize, publisher: AnyPublisher, place: Option<usize>, sets_up: bool },
    /// They came from another host, and come from it again.
    Received { scene: usize, receiver: Receiver },
    /// Nothing: their host is not replayed, or nobody here declares the topic.
    Ignored,
}

impl Talws {
    /// Prepares a replay of the agents of these hosts, which need no bodies. The seed is that of the recorded run; `company` are all
    /// who published on the hosts.
    ///
    /// # Errors
    /// As in [`simulate`](Talws::simulate).
    pub fn replay(mut self, seed: u64, company: &[Company]) -> Result<Replay, Error> {
        let spy = Spy::default();
        self.observe(Box::new(spy.clone()));
        self.company = company.to_vec();
        let Stage { stations, .. } = Stage::new(self, seed)?;
        let mut scenes: Vec<Scene> =
            stations.into_iter().map(|station| Scene::new(station, company)).collect();
        for produced in spy.take() {
            let scene = scenes.iter_mut().find(|scene| scene.hub.host() == produced.host);
            scene.into_iter().for_each(|scene| scene.was_set_up(&produced));
        }
        spy.mute(true);
        Ok(Replay { scenes, spy, inputs: Vec::new(), ledger: Ledger::default() })
    }
}

impl Replay {
    /// Where the messages of a publisher on a topic come in.
    ///
    /// # Errors
    /// A message of another host names the host that it came to, or there are too many hosts.
    pub fn input(&mut self, recorded: Recorded<'_>) -> Result<Input, Error> {
        let route = self.route(recorded)?;
        self.inputs.push(route);
        Ok(Input(self.inputs.len() - 1))
    }

    fn route(&mut self, recorded: Recorded<'_>) -> Result<Route, Error> {
        let Recorded { host, received_by, publisher, topic } = recorded;
        let recorder = received_by.unwrap_or(host);
        let Some(scene) = self.scenes.iter().position(|scene| scene.hub.host() == recorder) else {
            return Ok(Route::Ignored);
        };
        let hub = self.scenes[scene].hub.clone();
        let slot = hub.topic(topic);
        if received_by.is_some() {
            let receiver = slot.map(|_| hub.receiver(host, publisher, topic)).transpose();
            let receiver = receiver.map_err(Error::hub)?;
            return Ok(receiver.map_or(Route::Ignored, |receiver| Route::Received { scene, receiver }));
        }
        if let Some(actor) = self.scenes[scene].actor(publisher) {
            let path = self.ledger.line(host, publisher, topic);
            return Ok(Route::Compared { scene, actor, topic: slot, path });
        }
        // The host has introduced itself here too.
        if slot.is_none() || (topic == HOST.path() && publisher == "monas") {
            return Ok(Route::Ignored);
        }
        let place = self.scenes[scene].place(publisher);
        let publisher = hub.publisher_by_name(topic, publisher).map_err(Error::hub)?;
        let sets_up = [HOST.path(), MODEL.path(), CHART.path()].contains(&topic);
        Ok(Route::Published { scene, publisher, place, sets_up })
    }

    /// Goes on to the next recorded message. `told` hears of each difference that is certain by now.
    ///
    /// # Errors
    /// The bytes are no message of the topic's type.
    pub fn feed(
        &mut self,
        input: Input,
        message: RecordedMessage<'_>,
        told: &mut dyn FnMut(Difference),
    ) -> Result<(), Error> {
        let Replay { scenes, spy, inputs, ledger } = self;
        let Some(route) = inputs.get_mut(input.0) else {
            return Err(Error::new(ErrorKind::Invalid, "no such input of this replay"));
        };
        match route {
            Route::Ignored => {}
            Route::Compared { scene, actor, topic, path } => {
                let scene = &mut scenes[*scene];
                scene.reach(message.received, spy, ledger, told);
                scene.expect(*actor, *topic, *path, message.bytes, spy);
            }
            Route::Published { scene, publisher, place, sets_up } => {
                let scene = &mut scenes[*scene];
                scene.reach(message.received, spy, ledger, told);
                scene.turn_of_another(*place, *sets_up, spy);
                publisher.publish_bytes(message.bytes, scene.now).map_err(Error::hub)?;
            }
            Route::Received { scene, receiver } => {
                let scene = &mut scenes[*scene];
                scene.reach(message.received, spy, ledger, told);
                let arrival = Arrival {
                    sequence: message.sequence.into(),
                    published: message.published,
                    local: message.published,
                    received: message.received,
                };
                receiver.receive_bytes(message.bytes, arrival).map_err(Error::hub)?;
            }
        }
        Ok(())
    }

    /// The recorded run ended at this moment: what is recorded from now on was published while its agents were being stopped.
    pub fn end(&mut self, moment: Moment, told: &mut dyn FnMut(Difference)) {
        for scene in &mut self.scenes {
            scene.reach(moment, &self.spy, &mut self.ledger, told);
            scene.stop(&self.spy);
        }
    }

    /// Ends the replay, and tells what was compared, by host, agent and topic. The end of a recording that was cut off is not taken
    /// for an end of the run: what agents would have published then is no difference.
    pub fn finish(mut self, is_whole: bool, told: &mut dyn FnMut(Difference)) -> Vec<Tally> {
        for scene in &mut self.scenes {
            scene.close(is_whole, &self.spy, &mut self.ledger, told);
        }
        self.ledger.tallies()
    }
}

impl std::fmt::Debug for Replay {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let hosts: Vec<&str> = self.scenes.iter().map(|scene| scene.hub.host()).collect();
        f.debug_struct("Replay").field("hosts", &hosts).finish_non_exhaustive()
    }
}

/// The names of those who published on a host.
pub(super) fn names_on(company: &[Company], host: &str) -> impl Iterator<Item = String> {
    company.iter().filter(move |one| one.host == host).map(|one| one.publisher.clone())
}
