//! The control cycle of a Nao: converts commands in the plane and of joints to an actuator packet,
//! and sensor packets to percepts.

use std::collections::BTreeMap;

use monas_robot::{
    Actuators, Anatomy, Battery, Contacts, Error, FallDetector, Inertial, JointCommands, JointTargets,
    Joints, Leds, Percepts, Posture, Sensors, Skill, SkillProgress, SkillResult, Sonar,
};
use narukom::Timestamp;

use crate::anatomy::{NaoJoint, anatomy_of};
use crate::kinematics::JointAngles;
use crate::leds;
use crate::lola::{ActuatorPacket, CYCLE_SECONDS, JOINTS, SensorPacket, Touch};
use crate::motions::{Motion, SpecialActions, stand};
use crate::walk::{SteppingWalk, WalkEngine, WalkVelocity, displacement};

/// Stiffness of the joints in motion.
const STIFFNESS: f64 = 0.8;
/// The time in which the joints become stiff and the robot moves into its stand, s.
const STIFFENING_TIME: f64 = 1.0;
/// The time in which the joints lose their stiffness, s.
const RELAXING_TIME: f64 = 0.5;
/// Largest distance of a joint from the last pose of a skill that has been performed, rad.
const POSE_TOLERANCE: f64 = 0.3;
/// Least weight on both soles of a robot that stands on the ground, kg.
const LEAST_WEIGHT: f64 = 0.5;

/// The motion of the joints.
#[derive(Debug)]
enum BodyState {
    /// Slack until the first sensor packet arrives.
    Waiting,
    /// Becoming stiff on the way to the stand; the elapsed fraction of the time.
    Stiffening { motion: Motion, elapsed: f64 },
    /// Following walk, skill and commands.
    Active { skill: Option<(Skill, Motion)> },
    /// Sitting down.
    SittingDown { motion: Motion },
    /// Losing their stiffness permanently.
    Relaxing { elapsed: f64 },
}

/// The state of a Nao between two cycles.
pub(crate) struct NaoControl {
    anatomy: Anatomy,
    walk: Box<dyn WalkEngine>,
    actions: SpecialActions,
    state: BodyState,
    commands: Actuators,
    skills: SkillProgress,
    falls: FallDetector,
    targets: JointTargets,
    leds: Leds,
    sensors: SensorPacket,
    /// Measured angles, the latest and those before.
    measured: JointAngles,
    measured_before: JointAngles,
    /// The commanded angles, before the commands to single joints.
    angles: JointAngles,
    odometry: [f64; 3],
    packet: ActuatorPacket,
}

impl NaoControl {
    /// Creates the control with the files that the options of a configuration name, otherwise the
    /// built-in ones.
    ///
    /// # Errors
    /// A file cannot be read or has errors; the message has its first one.
    pub(crate) fn of(options: &BTreeMap<String, String>) -> Result<NaoControl, Error> {
        Ok(NaoControl {
            anatomy: anatomy_of(options)?,
            actions: SpecialActions::of(options)?,
            walk: Box::new(SteppingWalk::default()),
            state: BodyState::Waiting,
            commands: Actuators::default(),
            skills: SkillProgress::default(),
            falls: FallDetector::default(),
            targets: JointTargets::default(),
            leds: Leds::default(),
            sensors: SensorPacket::default(),
            measured: stand(),
            measured_before: stand(),
            angles: stand(),
            odometry: [0.0; 3],
            packet: ActuatorPacket::default(),
        })
    }

    pub(crate) fn set_walk(&mut self, walk: Box<dyn WalkEngine>) {
        self.walk = walk;
    }

    pub(crate) fn anatomy(&self) -> &Anatomy {
        &self.anatomy
    }

    pub(crate) fn anatomy_mut(&mut self) -> &mut Anatomy {
        &mut self.anatomy
    }

    /// The measured angles of all joints.
    pub(crate) fn measured(&self) -> &JointAngles {
        &self.measured
    }

    /// Takes a sensor packet.
    pub(crate) fn receive(&mut self, packet: &SensorPacket) {
        self.sensors.clone_from(packet);
        let measured = packet.position.map(f64::from);
        if matches!(self.state, BodyState::Waiting) {
            (self.measured, self.angles) = (measured, measured);
            self.state =
                BodyState::Stiffening { motion: Motion::stand(measured, STIFFENING_TIME), elapsed: 0.0 };
        }
        self.measured_before = std::mem::replace(&mut self.measured, measured);
        let [roll, pitch] = packet.angles.map(f64::from);
        self.falls.measure(roll, pitch);
        // Only steps carry the robot: the legs of a skill move without it.
        let walks = matches!(self.state, BodyState::Active { skill: None });
        if walks && self.has_weight() && !self.falls.is_inclined() {
            let [x, y, turn] = displacement(&self.measured_before, &self.measured);
            let [before_x, before_y, heading] = self.odometry;
            let (sin, cos) = libm::sincos(heading);
            self.odometry = [before_x + cos * x - sin * y, before_y + sin * x + cos * y, heading + turn];
        }
    }

    /// Computes the actuators of one cycle.
    pub(crate) fn actuators(&mut self) -> &ActuatorPacket {
        let (stiffness, is_echo) = self.advance();
        for joint in 0..JOINTS {
            let command = self.targets.of(joint).filter(|_| matches!(self.state, BodyState::Active { .. }));
            let (target, stiffness) = command.unwrap_or_else(|| {
                let limits = self.anatomy.joints[joint].limits;
                (limits.clamp(self.angles[joint]), stiffness)
            });
            // The target of a joint without stiffness is its measured angle.
            self.packet.position[joint] = if is_echo { self.sensors.position[joint] } else { target as f32 };
            self.packet.stiffness[joint] = stiffness as f32;
        }
        leds::set(&mut self.packet, &self.commands, &self.leds);
        &self.packet
    }

    /// Advances the motion by one cycle; returns the stiffness, and whether the joints hold their
    /// measured angles.
    fn advance(&mut self) -> (f64, bool) {
        let falls = self.falls;
        let seconds = CYCLE_SECONDS;
        match &mut self.state {
            BodyState::Waiting => (0.0, true),
            BodyState::Stiffening { motion, elapsed } => {
                *elapsed += seconds;
                let part = (*elapsed / STIFFENING_TIME).min(1.0);
                if motion.advance(seconds, falls, &mut self.angles) {
                    self.state = BodyState::Active { skill: None };
                }
                (part * STIFFNESS, false)
            }
            BodyState::Active { skill: None } => {
                self.move_head();
                let Actuators { walk_x, walk_y, walk_turn, .. } = self.commands;
                let mut velocity = WalkVelocity {
                    x: self.anatomy.walk_x.clamp(walk_x),
                    y: self.anatomy.walk_y.clamp(walk_y),
                    turn: self.anatomy.walk_turn.clamp(walk_turn),
                };
                if falls.is_inclined() {
                    self.walk.stop();
                    velocity = WalkVelocity::STILL;
                }
                self.walk.advance(velocity, seconds, &mut self.angles);
                (STIFFNESS, false)
            }
            BodyState::Active { skill: Some(_) } => (self.perform().unwrap_or(STIFFNESS), false),
            BodyState::SittingDown { motion } => {
                if motion.advance(seconds, falls, &mut self.angles) || falls.is_inclined() {
                    self.state = BodyState::Relaxing { elapsed: 0.0 };
                }
                (STIFFNESS, false)
            }
            BodyState::Relaxing { elapsed } => {
                *elapsed += seconds;
                let part = 1.0 - *elapsed / RELAXING_TIME;
                (part.max(0.0) * STIFFNESS, part <= 0.0)
            }
        }
    }

    /// Advances the skill; returns its own stiffness, if it has one.
    fn perform(&mut self) -> Option<f64> {
        // A skill may move the head too.
        self.move_head();
        let BodyState::Active { skill: Some((_, motion)) } = &mut self.state else { return None };
        let is_over = motion.advance(CYCLE_SECONDS, self.falls, &mut self.angles);
        let stiffness = motion.stiffness();
        if is_over {
            let mut joints = motion.joints();
            let is_in_pose =
                joints.all(|joint| (self.measured[joint] - self.angles[joint]).abs() < POSE_TOLERANCE);
            let is_performed = motion.is_performed(self.falls) && is_in_pose;
            self.end_skill(match is_performed {
                true => SkillResult::Performed,
                false => SkillResult::Interrupted,
            });
        }
        stiffness
    }

    fn move_head(&mut self) {
        let Actuators { head_yaw, head_pitch, .. } = self.commands;
        self.angles[NaoJoint::HeadYaw as usize] = self.anatomy.head_yaw.clamp(head_yaw);
        self.angles[NaoJoint::HeadPitch as usize] = self.anatomy.head_pitch.clamp(head_pitch);
    }

    /// Sets the commands in the plane. A skill begins if its number is new and no other is active.
    pub(crate) fn act(&mut self, actuators: &Actuators) {
        if self.rests() {
            return;
        }
        self.commands = *actuators;
        if !self.skills.command(actuators.skill_number) {
            return;
        }
        let wanted = actuators.skill();
        match (&mut self.state, self.actions.motion(wanted, self.angles)) {
            (BodyState::Active { skill: skill @ None }, Some(motion)) => *skill = Some((wanted, motion)),
            _ => self.skills.end(SkillResult::Refused),
        }
    }

    fn end_skill(&mut self, result: SkillResult) {
        self.skills.end(result);
        self.walk.stop();
        self.state = BodyState::Active { skill: None };
    }

    pub(crate) fn command_joints(&mut self, commands: &JointCommands) -> Result<(), Error> {
        self.targets.set(commands, &self.anatomy)
    }

    pub(crate) fn light(&mut self, leds: &Leds) {
        leds::merge(&mut self.leds, leds);
    }

    /// Sits down and switches off the stiffness permanently.
    pub(crate) fn rest(&mut self) {
        if self.rests() {
            return;
        }
        self.commands = Actuators::default();
        self.walk.stop();
        self.state = match self.state {
            BodyState::Waiting | BodyState::Stiffening { .. } => BodyState::Relaxing { elapsed: 0.0 },
            _ => BodyState::SittingDown { motion: self.actions.sit_down(self.angles) },
        };
    }

    fn rests(&self) -> bool {
        matches!(self.state, BodyState::SittingDown { .. } | BodyState::Relaxing { .. })
    }

    /// Whether the robot rests and its joints have lost their stiffness.
    pub(crate) fn is_relaxed(&self) -> bool {
        matches!(self.state, BodyState::Relaxing { elapsed } if elapsed >= RELAXING_TIME)
    }

    fn has_weight(&self) -> bool {
        self.sensors.fsr.iter().copied().map(f64::from).sum::<f64>() >= LEAST_WEIGHT
    }

    fn posture(&self) -> Posture {
        match &self.state {
            BodyState::Waiting => Posture::Unknown,
            BodyState::Active { skill: Some((Skill::StandUp, _)) } => Posture::StandingUp,
            BodyState::Active { skill: Some(_) } => Posture::Busy,
            _ if self.falls.is_fallen() => Posture::Fallen,
            BodyState::SittingDown { .. } | BodyState::Relaxing { .. } => Posture::Sitting,
            _ if self.falls.is_inclined() => Posture::Busy,
            _ if !self.has_weight() => Posture::Lifted,
            BodyState::Stiffening { .. } => Posture::Busy,
            BodyState::Active { skill: None } if self.walk.is_moving() => Posture::Walking,
            BodyState::Active { skill: None } => Posture::Standing,
        }
    }

    /// Writes the measurements, with the odometry since the last call.
    pub(crate) fn percepts(&mut self, measured_at: Timestamp, percepts: &mut Percepts) {
        let measured_at = measured_at.as_nanos();
        let packet = &self.sensors;
        let [odometry_x, odometry_y, odometry_turn] = std::mem::take(&mut self.odometry);
        let [torso_roll, torso_pitch] = packet.angles.map(f64::from);
        let (skill_done, skill_result) = self.skills.done();
        let touched = |touch| packet.is_touched(touch);
        let left_bumper = touched(Touch::LeftFootLeft) || touched(Touch::LeftFootRight);
        let right_bumper = touched(Touch::RightFootLeft) || touched(Touch::RightFootRight);
        percepts.sensors = Sensors {
            measured_at,
            head_yaw: self.anatomy.head_yaw.clamp(self.measured[NaoJoint::HeadYaw as usize]),
            head_pitch: self.anatomy.head_pitch.clamp(self.measured[NaoJoint::HeadPitch as usize]),
            torso_roll,
            torso_pitch,
            odometry_x,
            odometry_y,
            odometry_turn,
            chest_button: touched(Touch::Chest),
            left_bumper,
            right_bumper,
            posture: self.posture() as i32,
            skill_done,
            skill_result: skill_result as i32,
            battery: packet.battery[0].into(),
            relaxed: packet.stiffness.iter().all(|&stiffness| stiffness <= 0.0),
        };
        self.write_joints(measured_at, percepts.joints.get_or_insert_default());
        let packet = &self.sensors;
        let [gyro_x, gyro_y, gyro_z] = packet.gyroscope.map(f64::from);
        // The robot reports gravity, the message the specific force that supports it: the sign
        // differs.
        let [acceleration_x, acceleration_y, acceleration_z] =
            packet.accelerometer.map(|value| -f64::from(value));
        percepts.inertial = Some(Inertial {
            measured_at,
            gyro_x,
            gyro_y,
            gyro_z,
            acceleration_x,
            acceleration_y,
            acceleration_z,
            roll: torso_roll,
            pitch: torso_pitch,
        });
        let contacts = percepts.contacts.get_or_insert_default();
        refill(&mut contacts.foot_pressures, packet.fsr.iter().copied().map(f64::from));
        *contacts = Contacts {
            measured_at,
            foot_pressures: std::mem::take(&mut contacts.foot_pressures),
            left_bumper,
            right_bumper,
            chest_button: packet.is_touched(Touch::Chest),
            head_front: packet.is_touched(Touch::HeadFront),
            head_middle: packet.is_touched(Touch::HeadMiddle),
            head_rear: packet.is_touched(Touch::HeadRear),
            left_hand: packet.is_touched(Touch::LeftHandBack),
            right_hand: packet.is_touched(Touch::RightHandBack),
        };
        let [left, right] = packet.sonar.map(f64::from);
        percepts.sonar = Some(Sonar { measured_at, left, right });
        let [charge, status, current, temperature] = packet.battery.map(f64::from);
        percepts.battery = Some(Battery {
            measured_at,
            charge,
            current,
            temperature,
            charging: (status as i32) & CHARGING_BIT != 0,
        });
    }

    fn write_joints(&self, measured_at: u64, joints: &mut Joints) {
        let packet = &self.sensors;
        joints.measured_at = measured_at;
        refill(&mut joints.positions, self.measured);
        let speeds = self
            .measured
            .iter()
            .zip(&self.measured_before)
            .map(|(now, before)| (now - before) / CYCLE_SECONDS);
        refill(&mut joints.velocities, speeds);
        refill(&mut joints.temperatures, packet.temperature.iter().copied().map(f64::from));
        refill(&mut joints.currents, packet.current.iter().copied().map(f64::from));
        refill(&mut joints.stiffnesses, packet.stiffness.iter().copied().map(f64::from));
        joints.clamped = self.targets.clamped();
    }
}

/// The bit in the status of the battery that says it is charging.
const CHARGING_BIT: i32 = 0x80;

/// Replaces the values of a list in its memory.
fn refill(list: &mut Vec<f64>, values: impl IntoIterator<Item = f64>) {
    list.clear();
    list.extend(values);
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_skill_during_another_is_refused_and_the_other_is_reported_by_its_own_number() {
        let mut control = NaoControl::of(&BTreeMap::new()).unwrap();
        let mut percepts = Percepts::default();
        let mut packet = SensorPacket::default();
        let mut cycle = |control: &mut NaoControl| {
            control.receive(&packet);
            packet.position = control.actuators().position;
            control.percepts(Timestamp::ZERO, &mut percepts);
            (percepts.sensors.skill_done, percepts.sensors.skill_result())
        };
        let kick = |skill: Skill, skill_number| Actuators {
            skill: skill as i32,
            skill_number,
            ..Actuators::default()
        };
        // The joints become stiff.
        assert_eq!((0..100).map(|_| cycle(&mut control)).last(), Some((0, SkillResult::NoResult)));
        control.act(&kick(Skill::KickLeft, 1));
        cycle(&mut control);
        control.act(&kick(Skill::KickRight, 2));
        assert_eq!(cycle(&mut control), (2, SkillResult::Refused));
        let ended = (0..1000).map(|_| cycle(&mut control)).find(|(done, _)| *done != 2);
        assert_eq!(ended, Some((1, SkillResult::Performed)));
    }
}
