//! A body on its host: what it senses is published, what the agents want is handed to it.

use std::time::Duration;

use monas_robot::topics::{ACTUATORS, ANNOUNCEMENT, SENSORS, SIGHTINGS};
use monas_robot::{Actuators, Announcement, Percepts, Robot, Sensors, Sightings};
use narukom::{Blackboard, Moment, Narukom, Publisher};

use crate::error::{Error, ErrorKind};

/// A body and its connections to the hub of its host.
pub(crate) struct Body {
    robot: Box<dyn Robot>,
    percepts: Percepts,
    sensors: Publisher<Sensors>,
    sightings: Publisher<Sightings>,
    announcement: Publisher<Announcement>,
    commands: Blackboard,
    /// The sequence number and publisher of the actuators that were handed over last.
    handed: Option<(narukom::PublisherId, u64)>,
    /// Whether it is to stand still whatever the agents want.
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
            commands: hub.blackboard(Body::PUBLISHER),
            handed: None,
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
        self.robot.sense(now, &mut self.percepts).map_err(failed)?;
        self.sensors.publish(self.percepts.sensors, now);
        if let Some(sightings) = self.percepts.sightings.take() {
            self.sightings.publish(sightings, now);
        }
        if let Some(announcement) = self.percepts.announcement.take() {
            self.announcement.publish(announcement, now);
        }
        Ok(())
    }

    /// Hands over the newest actuators, if there are any that it does not have yet.
    pub(crate) fn act(&mut self, now: Moment) -> Result<(), Error> {
        if self.safe {
            return Ok(());
        }
        self.commands.process_messages(now);
        let Some(sample) = self.commands.sample(ACTUATORS) else { return Ok(()) };
        let newest = (sample.header.publisher, sample.header.sequence);
        if self.handed == Some(newest) {
            return Ok(());
        }
        self.handed = Some(newest);
        self.robot.act(now, sample.message).map_err(failed)
    }

    /// Lets it stand still from now on, whatever the agents want.
    pub(crate) fn rest(&mut self, now: Moment) -> Result<(), Error> {
        self.safe = true;
        self.robot.act(now, &Actuators::default()).map_err(failed)
    }
}

fn failed(error: monas_robot::Error) -> Error {
    Error::new(ErrorKind::Body, format!("the body failed: {error}")).caused_by(error)
}
