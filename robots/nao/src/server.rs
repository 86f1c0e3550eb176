//! A LoLA server over a simulated body.
//!
//! The body moves in the plane; the server gives it joints. Motors follow the targets that a client
//! sends. The motion of the body follows from the angles alone, by the kinematics of the legs: the
//! foot on the ground stands still, so that the torso moves; a torso that leans out over its foot
//! falls; a foot that swings back begins a kick; a lying body that folds its legs stands up; a body
//! whose motors have lost their stiffness sits down. The client has no other access to the body.

mod joint_motion;

use std::path::Path;

use monas_robot::{Actuators, Error, Percepts, Posture, Robot, Sensors};
use narukom::Timestamp;

use crate::anatomy::{NaoJoint, limits};
use crate::kinematics::{JointAngles, Side};
use crate::lola::{ActuatorPacket, CYCLE_SECONDS, JOINTS, SensorPacket, Touch};
use crate::motions::stand;
use crate::side_channels::{SimulatedChannels, SimulatedView};
use crate::socket::Socket;
use joint_motion::JointMotion;

/// The fastest motion of a motor, rad/s.
const MOTOR_SPEED: f64 = 7.0;
/// The weight of the robot, kg.
const WEIGHT: f32 = 5.3;
/// The acceleration of gravity, m/s2.
const GRAVITY: f64 = 9.81;

/// A LoLA server whose robot is a simulated body.
pub struct LolaServer {
    body: Box<dyn Robot>,
    lola: Socket,
    channels: SimulatedChannels,
    angles: JointAngles,
    motion: JointMotion,
    actuators: ActuatorPacket,
    sensors: SensorPacket,
    percepts: Percepts,
    bytes: Vec<u8>,
    tilt: [f64; 2],
}

impl LolaServer {
    /// A server that listens at a path, and beside it for the simulated camera, referee and radio.
    ///
    /// # Errors
    /// The path cannot be bound.
    pub fn listen(path: &Path, body: Box<dyn Robot>) -> Result<LolaServer, Error> {
        let channels = SimulatedChannels::listen(path)?;
        Ok(LolaServer::new(body, Socket::listen(path)?, channels))
    }

    pub(crate) fn new(body: Box<dyn Robot>, lola: Socket, channels: SimulatedChannels) -> LolaServer {
        LolaServer {
            body,
            lola,
            channels,
            angles: stand(),
            motion: JointMotion::default(),
            actuators: ActuatorPacket::default(),
            sensors: SensorPacket::default(),
            percepts: Percepts::default(),
            bytes: Vec::new(),
            tilt: [0.0; 2],
        }
    }

    /// The actuators that the client has sent last.
    pub fn actuators(&self) -> &ActuatorPacket {
        &self.actuators
    }

    /// The latest sensor values.
    pub(crate) fn sensors(&self) -> Sensors {
        self.percepts.sensors
    }

    /// Makes the body deliver images in place of sightings, of the given width or of its usual one.
    pub(crate) fn deliver_images(&mut self, width: Option<u32>) -> Result<(), Error> {
        self.body.deliver_images(width)
    }

    /// Continues to send images that were sent partially. Returns whether anything was pending.
    pub(crate) fn send_rest_of_images(&mut self) -> Result<bool, Error> {
        Ok(self.channels.camera.flush()?)
    }

    /// Whether a client is connected.
    pub fn is_connected(&self) -> bool {
        self.lola.is_connected()
    }

    /// The most bytes that the body's radio sends at once.
    pub(crate) fn radio(&self) -> usize {
        self.body.anatomy().radio
    }

    /// One cycle: the body does what the joints do, then its sensors are sent.
    ///
    /// # Errors
    /// The body fails, or a client sends what is not an actuator packet. A client that is not there
    /// is no error: the joints keep their targets.
    pub fn step(&mut self, now: Timestamp) -> Result<(), Error> {
        let LolaServer { lola, actuators, channels, body, .. } = self;
        absent(lola.receive(|bytes| actuators.decode(bytes)).map(drop))?;
        let mut said = None;
        absent(channels.radio.receive(|message| said = Some(message)))?;
        if let Some(said) = said {
            body.say(now, &said.words)?;
        }
        let before = self.angles;
        self.turn_joints();
        self.move_body(now, &before)?;
        self.percepts.clear_news();
        self.body.sense(now, &mut self.percepts)?;
        self.measure();
        self.send(now)
    }

    /// Each motor turns its joint towards the target, as fast as it can and if it is stiff.
    fn turn_joints(&mut self) {
        for joint in 0..JOINTS {
            if self.actuators.stiffness[joint] > 0.0 {
                let target = limits(joint).clamp(self.actuators.position[joint].into());
                let max = MOTOR_SPEED * CYCLE_SECONDS;
                self.angles[joint] += (target - self.angles[joint]).clamp(-max, max);
            }
        }
    }

    fn move_body(&mut self, now: Timestamp, before: &JointAngles) -> Result<(), Error> {
        let posture = self.percepts.sensors.posture();
        let legs = NaoJoint::LHipYawPitch as usize..=NaoJoint::RAnkleRoll as usize;
        let is_stiff = self.actuators.stiffness[legs].iter().any(|&stiffness| stiffness > 0.0);
        if self.motion.gives_way(is_stiff) {
            return self.body.rest(now);
        }
        let legs = self.motion.observe(before, &self.angles, posture);
        let head = [NaoJoint::HeadYaw, NaoJoint::HeadPitch].map(|joint| joint as usize);
        let [head_yaw, head_pitch] = head.map(|joint| match self.actuators.stiffness[joint] > 0.0 {
            true => limits(joint).clamp(self.actuators.position[joint].into()),
            false => self.angles[joint],
        });
        self.body.act(now, &Actuators { head_yaw, head_pitch, ..legs })
    }

    /// Writes the sensors.
    fn measure(&mut self) {
        let felt = &self.percepts.sensors;
        // The simulated body has a head of its own.
        self.angles[NaoJoint::HeadYaw as usize] = felt.head_yaw;
        self.angles[NaoJoint::HeadPitch as usize] = felt.head_pitch;
        let packet = &mut self.sensors;
        packet.position = self.angles.map(|angle| angle as f32);
        packet.stiffness = self.actuators.stiffness;
        let tilt = [felt.torso_roll, felt.torso_pitch];
        let (roll, pitch) = (tilt[0], tilt[1]);
        let rates = [(roll - self.tilt[0]) / CYCLE_SECONDS, (pitch - self.tilt[1]) / CYCLE_SECONDS];
        self.tilt = tilt;
        packet.angles = [roll as f32, pitch as f32];
        packet.gyroscope = [rates[0] as f32, rates[1] as f32, (felt.odometry_turn / CYCLE_SECONDS) as f32];
        let down =
            [libm::sin(pitch), -libm::sin(roll) * libm::cos(pitch), -libm::cos(roll) * libm::cos(pitch)];
        packet.accelerometer = down.map(|part| (GRAVITY * part) as f32);
        packet.battery[0] = felt.battery as f32;
        packet.fsr = weights(felt.posture(), self.motion.support());
        packet.touch = [0.0; 14];
        let pressed = |is_pressed: bool| f32::from(u8::from(is_pressed));
        packet.touch[Touch::Chest as usize] = pressed(felt.chest_button);
        packet.touch[Touch::LeftFootLeft as usize] = pressed(felt.left_bumper);
        packet.touch[Touch::RightFootRight as usize] = pressed(felt.right_bumper);
    }

    fn send(&mut self, now: Timestamp) -> Result<(), Error> {
        self.sensors.encode(&mut self.bytes);
        absent(self.lola.send(&self.bytes))?;
        let SimulatedChannels { camera, referee, radio } = &mut self.channels;
        let (sightings, images) = (self.percepts.sightings.take(), self.percepts.images.take());
        if sightings.is_some() || images.is_some() {
            let sent_at = now.as_nanos();
            absent(camera.send(&SimulatedView { sightings, images, sent_at }))?;
        }
        // Images do not fit into the buffer of a socket.
        absent(camera.flush().map(drop))?;
        if let Some(announcement) = &self.percepts.announcement {
            absent(referee.send(announcement))?;
        }
        for heard in &self.percepts.heard {
            absent(radio.send(heard))?;
        }
        Ok(())
    }
}

/// The weights on the soles: all on the foot on the ground, or half on each.
fn weights(posture: Posture, support: Option<Side>) -> [f32; 8] {
    if matches!(posture, Posture::Fallen | Posture::Lifted | Posture::Sitting | Posture::Unknown) {
        return [0.0; 8];
    }
    let part = |side| match support {
        None => WEIGHT / 8.0,
        Some(support) if support == side => WEIGHT / 4.0,
        Some(_) => 0.0,
    };
    let (left, right) = (part(Side::Left), part(Side::Right));
    [left, left, left, left, right, right, right, right]
}

/// A client that is not there is no error.
fn absent(result: Result<(), crate::Error>) -> Result<(), Error> {
    match result {
        Err(error) if error.kind() == crate::ErrorKind::Disconnected => Ok(()),
        other => Ok(other?),
    }
}
