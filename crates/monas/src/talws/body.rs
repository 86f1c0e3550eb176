//! A body on its host: what it senses is published, what the agents want is handed to it.

use std::time::Duration;

use monas_robot::topics::{ACTUATORS, ANNOUNCEMENT, HEARD, SAID, SENSORS, SIGHTINGS};
use monas_robot::{Announcement, Heard, Percepts, Robot, Sensors, Sightings};
use narukom::{Blackboard, Keep, Moment, Narukom, Publisher, PublisherId, Topic};

use crate::error::{Error, ErrorKind};

/// A message, by its publisher and sequence number.
type Which = (PublisherId, u64);

/// A body and its connections to the hub of its host.
pub(crate) struct Body {
    robot: Box<dyn Robot>,
    percepts: Percepts,
    sensors: Publisher<Sensors>,
    sightings: Publisher<Sightings>,
    announcement: Publisher<Announcement>,
    heard: Publisher<Heard>,
    commands: Blackboard,
    /// The actuators and the words that were handed over last.
    handed: Option<Which>,
    said: Option<Which>,
    /// Whether it is to rest whatever the agents want.
    safe: bool,
}

impl Body {
    /// The name under which a body publishes.
    pub(crate) const PUBLISHER: &'static str = "body";

    pub(crate) fn new(robot: Box<dyn Robot>, hub: &Narukom) -> Result<Body, Error> {
        Ok(Body {
            robot,
            percepts: Percepts::default(),
            sensors: hub.publisher(SENSORS, Body::PUBLISHER).map_err(Error::hub)?,
            sightings: hub.publisher(SIGHTINGS, Body::PUBLISHER).map_err(Error::hub)?,
            announcement: hub.publisher(ANNOUNCEMENT, Body::PUBLISHER).map_err(Error::hub)?,
            heard: hub.publisher(HEARD, Body::PUBLISHER).map_err(Error::hub)?,
            commands: hub.blackboard(Body::PUBLISHER),
            handed: None,
            said: None,
            safe: false,
        })
    }

    /// How often it senses.
    pub(crate) fn period(&self) -> Duration {
        self.robot.anatomy().cycle
    }

    /// Publishes what it senses now.
    pub(crate) fn sense(&mut self, now: Moment) -> Result<(), Error> {
        self.percepts.sightings = None;
        self.percepts.announcement = None;
        self.percepts.heard.clear();
        self.robot.sense(now, &mut self.percepts).map_err(failed)?;
        self.sensors.publish(self.percepts.sensors, now);
        if let Some(sightings) = self.percepts.sightings.take() {
            self.sightings.publish(sightings, now);
        }
        if let Some(announcement) = self.percepts.announcement.take() {
            self.announcement.publish(announcement, now);
        }
        for heard in self.percepts.heard.drain(..) {
            self.heard.publish(heard, now);
        }
        Ok(())
    }

    /// Hands over the newest words and actuators, if there are any that it does not have yet.
    pub(crate) fn act(&mut self, now: Moment) -> Result<(), Error> {
        if self.safe {
            return Ok(());
        }
        self.commands.process_messages(now);
        if let Some(said) = newest(&self.commands, SAID, &mut self.said)
            && let Err(error) = self.robot.say(now, &said.words)
        {
            // a body that cannot speak can still walk
            tracing::error!(robot = %self.commands.hub().host(), "nothing is said: {error}");
        }
        match newest(&self.commands, ACTUATORS, &mut self.handed) {
            Some(actuators) => self.robot.act(now, actuators).map_err(failed),
            None => Ok(()),
        }
    }

    /// Lets it rest from now on, whatever the agents want.
    pub(crate) fn rest(&mut self, now: Moment) -> Result<(), Error> {
        self.safe = true;
        self.robot.rest(now).map_err(failed)
    }
}

/// The newest message of a topic, if it is not the one that was taken before.
fn newest<'a, K: Keep>(
    commands: &'a Blackboard,
    topic: Topic<K>,
    taken: &mut Option<Which>,
) -> Option<&'a K::Message> {
    let sample = commands.sample(topic)?;
    let which = (sample.header.publisher, sample.header.sequence);
    (taken.replace(which) != Some(which)).then_some(sample.message)
}

fn failed(error: monas_robot::Error) -> Error {
    Error::new(ErrorKind::Body, format!("the body failed: {error}")).caused_by(error)
}
