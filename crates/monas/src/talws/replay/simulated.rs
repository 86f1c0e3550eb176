//! The replay of a recording of simulated time.

use narukom::prost::Message as _;
use narukom::{AnyPublisher, Arrival, Moment, Receiver, TopicSlot};

use super::super::Talws;
use super::super::management::HOST_ITSELF;
use super::super::overview::OUTSIDE;
use super::super::setup::Stage;
use super::changes::unread;
use super::compare::Ledger;
use super::scene::{Scene, Spy};
use super::{Company, Difference, Recorded, RecordedMessage, Tally, no_input};
use crate::error::Error;
use crate::records::{CHANGE, CHANGED, CHART, Changed, HOST, LOG, MODEL};

/// Agents that run again in simulated time.
///
/// It follows the recording message by message, in the order of publication. In simulated time agents have turns: those of a moment
/// in the order of their names, again and again until none has anything left to do. The messages of those that are not replayed say
/// when it is the turn of those that are.
pub(super) struct Simulated {
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
    Published {
        scene: usize,
        publisher: AnyPublisher,
        place: Option<usize>,
        sets_up: bool,
        asks: bool,
        answers: bool,
    },
    /// They came from another host, and come from it again.
    Received { scene: usize, receiver: Receiver },
    /// Nothing: their host is not replayed, or nobody here declares the topic.
    Ignored,
}

impl Simulated {
    pub(super) fn new(mut talws: Talws, seed: u64, company: &[Company]) -> Result<Simulated, Error> {
        let spy = Spy::default();
        talws.observe(Box::new(spy.clone()));
        talws.company = company.to_vec();
        let Stage { stations, crew, .. } = Stage::new(talws, seed)?;
        let scenes = stations.into_iter().map(|station| Scene::new(station, &crew, company));
        let mut scenes = scenes.collect::<Result<Vec<Scene>, Error>>()?;
        for produced in spy.take() {
            let scene = scenes.iter_mut().find(|scene| scene.hub.host() == produced.host);
            scene.into_iter().for_each(|scene| scene.was_set_up(&produced));
        }
        spy.mute(true);
        Ok(Simulated { scenes, spy, inputs: Vec::new(), ledger: Ledger::default() })
    }

    /// The hosts.
    pub(super) fn hosts(&self) -> Vec<&str> {
        self.scenes.iter().map(|scene| scene.hub.host()).collect()
    }

    pub(super) fn input(&mut self, recorded: Recorded<'_>) -> Result<usize, Error> {
        let route = self.route(recorded)?;
        self.inputs.push(route);
        Ok(self.inputs.len() - 1)
    }

    fn route(&mut self, recorded: Recorded<'_>) -> Result<Route, Error> {
        let Recorded { host, received_by, publisher, part, topic } = recorded;
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
        // Where the answer to a change stands the change was made.
        let answers = topic == CHANGED.path() && publisher == HOST_ITSELF;
        // One that was asked for from outside was made at once, before anybody had a turn.
        let asks = topic == CHANGE.path() && publisher == OUTSIDE;
        let place = self.scenes[scene].place(publisher);
        let publisher = hub.publisher_by_name(topic, publisher).map_err(Error::hub)?.of_part(part);
        // A line of the log may stand anywhere.
        let sets_up = [HOST.path(), MODEL.path(), CHART.path(), LOG.path()].contains(&topic);
        Ok(Route::Published { scene, publisher, place, sets_up, asks, answers })
    }

    pub(super) fn feed(
        &mut self,
        input: usize,
        message: RecordedMessage<'_>,
        told: &mut dyn FnMut(Difference),
    ) -> Result<(), Error> {
        let Simulated { scenes, spy, inputs, ledger } = self;
        let Some(route) = inputs.get_mut(input) else {
            return Err(no_input());
        };
        match route {
            Route::Ignored => {}
            Route::Compared { scene, actor, topic, path } => {
                let scene = &mut scenes[*scene];
                scene.reach(message.received, spy, ledger, told);
                scene.expect(*actor, *topic, *path, message.bytes, spy);
            }
            Route::Published { scene, publisher, place, sets_up, asks, answers } => {
                let scene = &mut scenes[*scene];
                scene.reach(message.received, spy, ledger, told);
                scene.turn_of_another(*place, *sets_up, spy);
                if *answers {
                    scene.attend(spy);
                    scene.answered(&Changed::decode(message.bytes).map_err(unread)?);
                }
                publisher.publish_bytes(message.bytes, scene.now).map_err(Error::hub)?;
                if *asks {
                    scene.attend(spy);
                }
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
        self.scenes.iter_mut().try_for_each(Scene::check)
    }

    pub(super) fn end(&mut self, moment: Moment, told: &mut dyn FnMut(Difference)) {
        for scene in &mut self.scenes {
            scene.reach(moment, &self.spy, &mut self.ledger, told);
            scene.stop(&self.spy);
        }
    }

    pub(super) fn finish(
        mut self,
        is_whole: bool,
        told: &mut dyn FnMut(Difference),
    ) -> Result<Vec<Tally>, Error> {
        for scene in &mut self.scenes {
            scene.close(is_whole, &self.spy, &mut self.ledger, told);
            scene.check()?;
        }
        Ok(self.ledger.tallies())
    }
}
