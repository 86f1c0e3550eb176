//! The control cycle of a robot: converts commands in the plane and of joints to commands to
//! motors, and percepts of the server to percepts of the body.

use monas_robot::{
    Actuators, Anatomy, Error, FallDetector, Inertial, JointCommands, JointTargets, Joints, ObjectKind,
    Percepts, Posture, Sensors, Sighting, Sightings, Skill, SkillProgress, SkillResult,
};
use narukom::Timestamp;

use crate::effector::{Effectors, MotorCommand};
use crate::humanoid::{CYCLE_SECONDS, HEAD_PITCH, HEAD_YAW, Humanoid, JOINTS};
use crate::inclination_filter::InclinationFilter;
use crate::kick::{Kick, KickParameters};
use crate::kinematics::{Foot, Stance, inclination};
use crate::match_rules::MatchRules;
use crate::percept::{CameraObject, Percept};
use crate::walk::{Gait, Motion, Motors, Ramp, WalkEngine, WalkVelocity};

/// The motion of the robot.
#[derive(Clone, Copy, PartialEq, Debug)]
enum BodyState {
    /// Following the commanded walk.
    Walking,
    /// Kicking.
    Kicking,
    /// Lying, waiting to be put on its feet.
    Waiting,
    /// At rest, permanently.
    Resting,
}

/// The state of a robot between two cycles.
pub(crate) struct BoosterControl {
    robot: &'static Humanoid,
    anatomy: Anatomy,
    gait: Gait,
    walk: Box<dyn WalkEngine>,
    ramp: Ramp,
    kick_parameters: KickParameters,
    kick: Option<Kick>,
    state: BodyState,
    commands: Actuators,
    skills: SkillProgress,
    targets: JointTargets,
    inclination: InclinationFilter,
    stance: Stance,
    percept: Percept,
    falls: FallDetector,
    odometry: [f64; 3],
    motors: Motors,
    sightings: Sightings,
    sighted: bool,
}

impl BoosterControl {
    pub(crate) fn new(
        robot: &'static Humanoid,
        walk: Box<dyn WalkEngine>,
        kick_parameters: KickParameters,
    ) -> BoosterControl {
        let gait = walk.gait();
        let inclination = InclinationFilter::default();
        BoosterControl {
            robot,
            anatomy: robot.anatomy(gait.x, gait.y, gait.turn),
            gait,
            walk,
            ramp: Ramp::default(),
            kick_parameters,
            kick: None,
            state: BodyState::Walking,
            commands: Actuators::default(),
            skills: SkillProgress::default(),
            targets: JointTargets::default(),
            stance: Stance::new(robot, &[0.0; JOINTS], &inclination.down()),
            inclination,
            percept: Percept::default(),
            falls: FallDetector::default(),
            odometry: [0.0; 3],
            motors: [MotorCommand::default(); JOINTS],
            sightings: Sightings::default(),
            sighted: false,
        }
    }

    pub(crate) fn anatomy(&self) -> &Anatomy {
        &self.anatomy
    }

    /// The percepts of the last message.
    pub(crate) fn percept(&self) -> &Percept {
        &self.percept
    }

    /// Takes a message of the server.
    pub(crate) fn receive(&mut self, message: &[u8], rules: &MatchRules) -> Result<(), crate::Error> {
        self.percept.decode(message, self.robot)?;
        self.inclination.advance(self.percept.gyro, self.percept.acceleration, CYCLE_SECONDS);
        let before = std::mem::replace(
            &mut self.stance,
            Stance::new(self.robot, &self.percept.positions, &self.inclination.down()),
        );
        let (roll, pitch) = inclination(&self.inclination.down());
        self.falls.measure(roll, pitch);
        if !self.falls.is_inclined() {
            self.measure_step(&before);
        }
        if self.percept.has_vision {
            self.look(rules);
        }
        Ok(())
    }

    /// The robot was placed upright elsewhere: resets the state of its motion.
    pub(crate) fn placed(&mut self) {
        self.inclination = InclinationFilter::default();
        self.stance = Stance::new(self.robot, &self.percept.positions, &self.inclination.down());
        self.falls = FallDetector::default();
        self.ramp.reset();
        self.walk.reset();
        match self.state {
            BodyState::Resting | BodyState::Walking => {}
            BodyState::Kicking => self.end_skill(SkillResult::Interrupted),
            BodyState::Waiting => self.end_skill(SkillResult::Performed),
        }
    }

    /// Adds the motion of the torso over the foot on the ground to the odometry.
    fn measure_step(&mut self, before: &Stance) {
        let turned = self.inclination.turn(self.percept.gyro) * CYCLE_SECONDS;
        let corner = self.stance.contact();
        let (from, to) = (before.hips_from(corner), self.stance.hips_from(corner));
        let (sin, cos) = libm::sincos(turned);
        let (x, y) = (cos * to.x - sin * to.y - from.x, sin * to.x + cos * to.y - from.y);
        let [all_x, all_y, heading] = self.odometry;
        let (sin, cos) = libm::sincos(heading);
        self.odometry = [all_x + cos * x - sin * y, all_y + sin * x + cos * y, heading + turned];
    }

    /// Turns what the camera sees into objects in the robot frame.
    fn look(&mut self, rules: &MatchRules) {
        self.sighted = true;
        let image = &mut self.sightings;
        image.objects.clear();
        image.head_yaw = self.percept.positions[HEAD_YAW];
        image.head_pitch = self.percept.positions[HEAD_PITCH];
        for object in &self.percept.objects {
            let (kind, colour, at) = match object {
                CameraObject::Ball(at) => (ObjectKind::Ball, monas_robot::Colour::NoColour, at),
                CameraObject::Post { goal, is_upper, at } => {
                    let (kind, colour) = rules.post(*goal, *is_upper);
                    (kind, colour, at)
                }
                CameraObject::Robot { team, number, at } => match rules.robot(team, *number) {
                    Some(colour) => (ObjectKind::Robot, colour, at),
                    None => continue,
                },
                // Bodies report no marks of the lines.
                CameraObject::Mark { .. } => continue,
            };
            let position = self.stance.on_ground(&self.robot.seen_in_torso(at, &self.percept.positions));
            image.objects.push(Sighting {
                kind: kind as i32,
                bearing: libm::atan2(position.y, position.x),
                distance: libm::hypot(position.x, position.y),
                colour: colour as i32,
            });
        }
    }

    /// Advances the motion by one cycle and writes the commands to the motors.
    pub(crate) fn advance(&mut self, message: &mut Effectors) {
        match self.wanted() {
            Some(velocity) => {
                let velocity = self.ramp.advance(velocity, &self.gait, CYCLE_SECONDS);
                let motion = Motion {
                    positions: self.percept.positions,
                    velocities: self.percept.velocities,
                    gyro: self.percept.gyro,
                    down: self.inclination.down(),
                };
                self.walk.advance(velocity, &motion, &mut self.motors);
                if let Some(kick) = &mut self.kick
                    && !kick.advance(&motion, &mut self.motors)
                {
                    self.end_skill(SkillResult::Performed);
                }
                self.move_head();
                self.move_joints();
            }
            None => {
                self.ramp.reset();
                let slack = MotorCommand { damping: self.robot.slack, ..MotorCommand::default() };
                self.motors = [slack; JOINTS];
            }
        }
        for (joint, motor) in self.motors.iter().enumerate().take(self.robot.joint_count()) {
            message.motor(self.robot, joint, motor);
        }
    }

    /// The velocity to walk with; none for a robot whose joints are slack.
    fn wanted(&self) -> Option<WalkVelocity> {
        match self.state {
            BodyState::Resting | BodyState::Waiting => None,
            _ if self.is_fallen() => None,
            BodyState::Walking => {
                let Actuators { walk_x, walk_y, walk_turn, .. } = self.commands;
                Some(WalkVelocity { x: walk_x, y: walk_y, turn: walk_turn })
            }
            BodyState::Kicking => Some(WalkVelocity::default()),
        }
    }

    /// Ends a kick, or the time in which the robot waits.
    fn end_skill(&mut self, result: SkillResult) {
        self.kick = None;
        self.skills.end(result);
        self.state = BodyState::Walking;
    }

    fn move_head(&mut self) {
        let (stiffness, damping) = self.robot.other_gains;
        let Actuators { head_yaw, head_pitch, .. } = self.commands;
        for (joint, angle) in [
            (HEAD_YAW, self.anatomy.head_yaw.clamp(head_yaw)),
            (HEAD_PITCH, self.anatomy.head_pitch.clamp(head_pitch)),
        ] {
            self.motors[joint] = MotorCommand { angle, stiffness, damping, ..MotorCommand::default() };
        }
    }

    fn move_joints(&mut self) {
        let robot = self.robot;
        for (joint, motor) in self.motors.iter_mut().enumerate().take(robot.joint_count()) {
            if let Some((angle, stiffness)) = self.targets.of(joint) {
                let (max, damping) = robot.gains(joint);
                *motor =
                    MotorCommand { angle, stiffness: stiffness * max, damping, ..MotorCommand::default() };
            }
        }
    }

    /// Sets the commands in the plane. A skill begins if its number is new and no other is active.
    pub(crate) fn act(&mut self, actuators: &Actuators) {
        if self.state == BodyState::Resting {
            return;
        }
        self.commands = *actuators;
        if !self.skills.command(actuators.skill_number) {
            return;
        }
        let skill = actuators.skill();
        self.state = match (self.state, skill) {
            (BodyState::Walking, Skill::KickLeft | Skill::KickRight) if !self.is_fallen() => {
                let foot = if skill == Skill::KickLeft { Foot::Left } else { Foot::Right };
                self.kick = Some(Kick::new(self.robot, self.kick_parameters, foot));
                BodyState::Kicking
            }
            (BodyState::Walking, Skill::StandUp) if self.is_fallen() => BodyState::Waiting,
            (state, _) => {
                self.skills.end(SkillResult::Refused);
                state
            }
        };
    }

    pub(crate) fn command_joints(&mut self, commands: &JointCommands) -> Result<(), Error> {
        self.targets.set(commands, &self.anatomy)
    }

    /// Stands still permanently; the joints of a robot that lies become slack. There is no motion
    /// for sitting down.
    pub(crate) fn rest(&mut self) {
        self.commands = Actuators::default();
        self.targets = JointTargets::default();
        self.state = BodyState::Resting;
    }

    /// Whether the robot lies.
    pub(crate) fn is_fallen(&self) -> bool {
        self.falls.is_fallen()
    }

    fn posture(&self) -> Posture {
        match self.state {
            BodyState::Waiting => Posture::StandingUp,
            _ if self.is_fallen() => Posture::Fallen,
            BodyState::Resting => Posture::Sitting,
            BodyState::Kicking => Posture::Busy,
            BodyState::Walking if self.falls.is_inclined() => Posture::Busy,
            BodyState::Walking if self.ramp.velocity() != WalkVelocity::default() => Posture::Walking,
            BodyState::Walking => Posture::Standing,
        }
    }

    /// Writes the measurements, with the odometry since the last call.
    pub(crate) fn percepts(&mut self, measured_at: Timestamp, percepts: &mut Percepts) {
        let measured_at = measured_at.as_nanos();
        let [odometry_x, odometry_y, odometry_turn] = std::mem::take(&mut self.odometry);
        let (torso_roll, torso_pitch) = inclination(&self.inclination.down());
        let positions = &self.percept.positions;
        let (skill_done, skill_result) = self.skills.done();
        percepts.sensors = Sensors {
            measured_at,
            head_yaw: self.anatomy.head_yaw.clamp(positions[HEAD_YAW]),
            head_pitch: self.anatomy.head_pitch.clamp(positions[HEAD_PITCH]),
            torso_roll,
            torso_pitch,
            odometry_x,
            odometry_y,
            odometry_turn,
            posture: self.posture() as i32,
            skill_done,
            skill_result: skill_result as i32,
            battery: 1.0,
            relaxed: self.motors.iter().all(|motor| motor.stiffness <= 0.0),
            ..Sensors::default()
        };
        if std::mem::take(&mut self.sighted) {
            self.sightings.taken_at = measured_at;
            percepts.sightings = Some(self.sightings.clone());
        }
        self.write_joints(measured_at, percepts.joints.get_or_insert_default());
        let ([gyro_x, gyro_y, gyro_z], [acceleration_x, acceleration_y, acceleration_z]) =
            (self.percept.gyro, self.percept.acceleration);
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
    }

    fn write_joints(&self, measured_at: u64, joints: &mut Joints) {
        joints.measured_at = measured_at;
        // The stops of the server's joints give way by some hundredths under load.
        let (robot, count) = (self.robot, self.robot.joint_count());
        let within = |(joint, angle): (usize, &f64)| robot.limits(joint).clamp(*angle);
        refill(&mut joints.positions, self.percept.positions[..count].iter().enumerate().map(within));
        refill(&mut joints.velocities, self.percept.velocities[..count].iter().copied());
        // The server simulates neither temperature nor current of motors.
        refill(&mut joints.temperatures, std::iter::repeat_n(0.0, count));
        refill(&mut joints.currents, std::iter::repeat_n(0.0, count));
        let stiffness =
            |(joint, motor): (usize, &MotorCommand)| (motor.stiffness / robot.gains(joint).0).clamp(0.0, 1.0);
        refill(&mut joints.stiffnesses, self.motors[..count].iter().enumerate().map(stiffness));
        joints.clamped = self.targets.clamped();
    }
}

/// Replaces the values of a list in its memory.
fn refill(list: &mut Vec<f64>, values: impl IntoIterator<Item = f64>) {
    list.clear();
    list.extend(values);
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::sine_parameters::SineParameters;
    use crate::sine_walk::SineWalk;
    use crate::t1::T1;

    #[test]
    fn a_skill_during_another_is_refused_and_the_other_is_reported_by_its_own_number() {
        let walk = SineWalk::new(&T1, SineParameters::own(&T1).unwrap());
        let mut control = BoosterControl::new(&T1, Box::new(walk), KickParameters::own(&T1).unwrap());
        let mut percepts = Percepts::default();
        let mut done = |control: &mut BoosterControl| {
            control.percepts(Timestamp::ZERO, &mut percepts);
            (percepts.sensors.skill_done, percepts.sensors.skill_result())
        };
        let kick = |skill: Skill, skill_number| Actuators {
            skill: skill as i32,
            skill_number,
            ..Actuators::default()
        };
        control.act(&kick(Skill::KickLeft, 1));
        assert_eq!(done(&mut control), (0, SkillResult::NoResult));
        control.act(&kick(Skill::KickRight, 2));
        assert_eq!(done(&mut control), (2, SkillResult::Refused));
        // The kick ends when the referee places the robot elsewhere.
        control.placed();
        assert_eq!(done(&mut control), (1, SkillResult::Interrupted));
    }
}
