//! The level of the joints: publishes their measurements and forwards commands to them.

use monas_robot::topics::{BATTERY, CONTACTS, INERTIAL, JOINT_COMMANDS, JOINTS, LEDS, SONAR};
use monas_robot::{Battery, Contacts, Inertial, Joints, Percepts, Robot, Sonar};
use narukom::{Blackboard, Hub, Message, Publisher, Timestamp};

use super::{BodyBridge, MessageId, newest};
use monas_core::error::Error;

/// Publishers for what a body with joints measures, and the last commands that it has.
pub(super) struct JointBridge {
    joints: Publisher<Joints>,
    inertial: Publisher<Inertial>,
    contacts: Publisher<Contacts>,
    sonar: Publisher<Sonar>,
    battery: Publisher<Battery>,
    delivered_joints: Option<MessageId>,
    delivered_leds: Option<MessageId>,
}

impl JointBridge {
    pub(super) fn new(hub: &Hub) -> Result<JointBridge, Error> {
        let name = BodyBridge::PUBLISHER;
        Ok(JointBridge {
            joints: hub.publisher(JOINTS, name).map_err(Error::hub)?,
            inertial: hub.publisher(INERTIAL, name).map_err(Error::hub)?,
            contacts: hub.publisher(CONTACTS, name).map_err(Error::hub)?,
            sonar: hub.publisher(SONAR, name).map_err(Error::hub)?,
            battery: hub.publisher(BATTERY, name).map_err(Error::hub)?,
            delivered_joints: None,
            delivered_leds: None,
        })
    }

    /// Publishes what is present.
    pub(super) fn publish(&mut self, percepts: &Percepts, now: Timestamp) {
        publish(&mut self.joints, percepts.joints.as_ref(), now);
        publish(&mut self.inertial, percepts.inertial.as_ref(), now);
        publish(&mut self.contacts, percepts.contacts.as_ref(), now);
        publish(&mut self.sonar, percepts.sonar.as_ref(), now);
        publish(&mut self.battery, percepts.battery.as_ref(), now);
    }

    /// Forwards the newest commands that the body does not have yet. A refused command is logged:
    /// the body keeps the previous one.
    pub(super) fn act(&mut self, commands: &Blackboard, robot: &mut dyn Robot, now: Timestamp) {
        let joints = newest(commands, JOINT_COMMANDS, &mut self.delivered_joints);
        let joints = joints.map_or(Ok(()), |joints| robot.command_joints(now, joints.message));
        let leds = newest(commands, LEDS, &mut self.delivered_leds);
        let leds = leds.map_or(Ok(()), |leds| robot.light(now, leds.message));
        for error in [joints, leds].into_iter().filter_map(Result::err) {
            tracing::error!(robot = %commands.hub().host(), "a command is refused: {error}");
        }
    }
}

/// Publishes a message, if there is one, in memory of an earlier one.
fn publish<M: Message + Clone>(publisher: &mut Publisher<M>, message: Option<&M>, now: Timestamp) {
    if let Some(message) = message {
        publisher.publish_with(|published| published.clone_from(message), now);
    }
}
