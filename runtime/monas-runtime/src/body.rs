//! The connection of a body to its host: publishes what it senses and forwards the agents'
//! commands.

mod joint_bridge;

use std::time::Duration;

use monas_robot::topics::{ACTUATORS, ANNOUNCEMENT, HEARD, IMAGES, SAID, SENSORS, SIGHTINGS};
use monas_robot::{Announcement, Heard, Images, Percepts, Robot, Sensors, Sightings};
use narukom::{Blackboard, Hub, Publisher, PublisherId, Retention, Sample, Timestamp, Topic};

use monas_core::error::{Error, ErrorKind};

use joint_bridge::JointBridge;

/// The identity of a message: its publisher and sequence number.
type MessageId = (PublisherId, u64);

/// The remark on the start of an agent whose body is in its safe state.
pub(crate) const SAFE_STATE: &str =
    "the body is in its safe state and ignores commands until the end of the run";

/// A body and its connections to the hub of its host.
pub(crate) struct BodyBridge {
    robot: Box<dyn Robot>,
    percepts: Percepts,
    sensors: Publisher<Sensors>,
    sightings: Publisher<Sightings>,
    images: Publisher<Images>,
    announcement: Publisher<Announcement>,
    heard: Publisher<Heard>,
    /// The level of the joints, for a body that has them.
    joints: Option<JointBridge>,
    commands: Blackboard,
    /// The most recently forwarded actuator commands and speech.
    delivered_commands: Option<MessageId>,
    delivered_speech: Option<MessageId>,
    /// Whether it ignores the agents' commands because of the safe state.
    is_safe_state: bool,
}

impl BodyBridge {
    /// The name under which a body publishes.
    pub(crate) const PUBLISHER: &'static str = "body";

    pub(crate) fn new(robot: Box<dyn Robot>, hub: &Hub) -> Result<BodyBridge, Error> {
        let joints = match robot.anatomy() {
            anatomy if anatomy.joints.is_empty() && !anatomy.has_leds => None,
            _ => Some(JointBridge::new(hub)?),
        };
        Ok(BodyBridge {
            robot,
            joints,
            percepts: Percepts::default(),
            sensors: hub.publisher(SENSORS, BodyBridge::PUBLISHER).map_err(Error::hub)?,
            sightings: hub.publisher(SIGHTINGS, BodyBridge::PUBLISHER).map_err(Error::hub)?,
            images: hub.publisher(IMAGES, BodyBridge::PUBLISHER).map_err(Error::hub)?,
            announcement: hub.publisher(ANNOUNCEMENT, BodyBridge::PUBLISHER).map_err(Error::hub)?,
            heard: hub.publisher(HEARD, BodyBridge::PUBLISHER).map_err(Error::hub)?,
            commands: hub.blackboard(BodyBridge::PUBLISHER),
            delivered_commands: None,
            delivered_speech: None,
            is_safe_state: false,
        })
    }

    /// The period of its sensing.
    pub(crate) fn period(&self) -> Duration {
        self.robot.anatomy().cycle
    }

    /// Publishes the present sensor values.
    pub(crate) fn sense(&mut self, now: Timestamp) -> Result<(), Error> {
        self.percepts.clear_news();
        self.robot.sense(now, &mut self.percepts).map_err(failed)?;
        self.sensors.publish(self.percepts.sensors, now);
        if let Some(sightings) = self.percepts.sightings.take() {
            self.sightings.publish(sightings, now);
        }
        if let Some(images) = self.percepts.images.take() {
            self.images.publish(images, now);
        }
        if let Some(announcement) = self.percepts.announcement.take() {
            self.announcement.publish(announcement, now);
        }
        for heard in self.percepts.heard.drain(..) {
            self.heard.publish(heard, now);
        }
        if let Some(joints) = &mut self.joints {
            joints.publish(&self.percepts, now);
        }
        Ok(())
    }

    /// Forwards the newest speech and actuator commands that the body does not have yet. Returns
    /// when the actuator command was published, if there was one.
    pub(crate) fn act(&mut self, now: Timestamp) -> Result<Option<Timestamp>, Error> {
        if self.is_safe_state {
            return Ok(None);
        }
        self.commands.process_messages(now);
        if let Some(said) = newest(&self.commands, SAID, &mut self.delivered_speech)
            && let Err(error) = self.robot.say(now, &said.message.words)
        {
            // A body without speech can still walk.
            tracing::error!(robot = %self.commands.hub().host(), "nothing is said: {error}");
        }
        if let Some(joints) = &mut self.joints {
            joints.act(&self.commands, &mut *self.robot, now);
        }
        let Some(actuators) = newest(&self.commands, ACTUATORS, &mut self.delivered_commands) else {
            return Ok(None);
        };
        self.robot.act(now, actuators.message).map_err(failed)?;
        Ok(Some(actuators.header.published))
    }

    /// Whether the agents' commands are ignored.
    pub(crate) const fn is_safe_state(&self) -> bool {
        self.is_safe_state
    }

    /// Enters the safe state: the agents' commands are ignored from now on.
    pub(crate) fn enter_safe_state(&mut self, now: Timestamp) -> Result<(), Error> {
        self.is_safe_state = true;
        self.robot.rest(now).map_err(failed)
    }
}

/// The newest message of a topic, if it is not the one that was taken before.
fn newest<'a, K: Retention>(
    commands: &'a Blackboard,
    topic: Topic<K>,
    taken: &mut Option<MessageId>,
) -> Option<Sample<'a, K::Message>> {
    let sample = commands.sample(topic)?;
    let which = (sample.header.publisher, sample.header.sequence);
    (taken.replace(which) != Some(which)).then_some(sample)
}

fn failed(error: monas_robot::Error) -> Error {
    Error::new(ErrorKind::Body, format!("the body failed: {error}")).caused_by(error)
}
