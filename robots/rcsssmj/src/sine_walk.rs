//! The project's own walk: steps by sines of one clock, and feedback of balance.

use std::f64::consts::{PI, TAU};

use monas_robot::Limits;
use nalgebra::{Isometry3, UnitQuaternion, Vector3};

use crate::effector::MotorCommand;
use crate::humanoid::{
    CYCLE_SECONDS, Humanoid, JOINTS, JointValues, LEFT_SHOULDER_ROLL, RIGHT_SHOULDER_ROLL,
};
use crate::kinematics::{Foot, inclination};
use crate::sine_parameters::SineParameters;
use crate::walk::{Gait, Motion, Motors, WalkEngine, WalkVelocity};

/// A walk in which the ankles follow sines of one clock relative to the hips.
///
/// The angles of a leg follow from the place of its ankle. Inclination and angular velocity of the
/// torso move ankles and hips, and lengthen the strides to the side to which the robot falls.
#[derive(Clone, Debug)]
pub struct SineWalk {
    robot: &'static Humanoid,
    parameters: SineParameters,
    /// The phase in a pair of steps, rad; the left foot swings in the first half.
    clock: f64,
    /// The progress into the crouch, and the growth of the steps, from 0 to 1.
    crouched: f64,
    stepping: f64,
    velocity: WalkVelocity,
    /// Seconds since the last command other than standing.
    still: f64,
}

/// The duration of the motion into the crouch, s.
const CROUCH_TIME: f64 = 0.4;
/// Duration of stepping on the spot before standing, s, in which the robot loses its speed.
const SLOWDOWN_TIME: f64 = 1.2;
/// Roll of the shoulders beside the body, rad: the arms hang.
const SHOULDER_ROLL: f64 = 1.35;
/// The greatest correction of the speed by the feedback of balance, m/s.
const MAX_BALANCE_CORRECTION: f64 = 0.5;

impl SineWalk {
    /// A walk with parameters, for a robot that stands.
    pub fn new(robot: &'static Humanoid, parameters: SineParameters) -> SineWalk {
        SineWalk {
            robot,
            parameters,
            clock: 0.0,
            crouched: 0.0,
            stepping: 0.0,
            velocity: WalkVelocity::default(),
            still: SLOWDOWN_TIME,
        }
    }

    fn step(&mut self, wanted: WalkVelocity) {
        let walk = &self.parameters;
        self.crouched = (self.crouched + CYCLE_SECONDS / CROUCH_TIME).min(1.0);
        let moves = wanted != WalkVelocity::default();
        self.still = if moves { 0.0 } else { self.still + CYCLE_SECONDS };
        let steps = self.crouched >= 1.0 && self.still < SLOWDOWN_TIME;
        let change = CYCLE_SECONDS / walk.starting;
        self.stepping = (self.stepping + if steps { change } else { -change }).clamp(0.0, 1.0);
        self.clock = match self.stepping > 0.0 {
            true => libm::fmod(self.clock + TAU * walk.frequency * CYCLE_SECONDS, TAU),
            false => 0.0,
        };
        // Strides grow after the steps have grown, and end before the steps do.
        let wanted = if self.stepping >= 1.0 { wanted } else { WalkVelocity::default() };
        let linear = walk.acceleration * CYCLE_SECONDS;
        let angular = walk.turn_acceleration * CYCLE_SECONDS;
        let WalkVelocity { x, y, turn } = &mut self.velocity;
        *x += (wanted.x - *x).clamp(-linear, linear);
        *y += (wanted.y - *y).clamp(-linear, linear);
        *turn += (wanted.turn - *turn).clamp(-angular, angular);
    }

    fn angles(&self, motion: &Motion) -> JointValues {
        let (robot, walk) = (self.robot, &self.parameters);
        let (roll, pitch) = inclination(&motion.down);
        let [roll_rate, pitch_rate, _] = motion.gyro;
        let pitch = pitch - walk.lean;
        let mut angles = [0.0; JOINTS];
        (angles[LEFT_SHOULDER_ROLL], angles[RIGHT_SHOULDER_ROLL]) = (-SHOULDER_ROLL, SHOULDER_ROLL);

        // A foot goes ahead and back by twice its amplitude in each pair of steps.
        let per_speed = self.stepping / (4.0 * walk.frequency);
        let ahead = (walk.step_pitch * pitch + walk.step_pitch_rate * pitch_rate)
            .clamp(-MAX_BALANCE_CORRECTION, MAX_BALANCE_CORRECTION);
        let right = (walk.step_roll * roll + walk.step_roll_rate * roll_rate)
            .clamp(-MAX_BALANCE_CORRECTION, MAX_BALANCE_CORRECTION);
        let ahead = walk.stride * (self.velocity.x + ahead - walk.drift) * per_speed;
        let left = walk.side_stride * (self.velocity.y - right) * per_speed;
        let yaw = walk.turn_stride * self.velocity.turn * per_speed;
        let sway = walk.sway * libm::sin(self.clock + walk.sway_phase) * self.stepping;
        let ankle_sway = walk.ankle_sway * libm::sin(self.clock) * self.stepping;
        for (foot, side) in [(Foot::Left, 1.0), (Foot::Right, -1.0)] {
            let leg = robot.leg(foot);
            let clock = if foot == Foot::Left { self.clock } else { self.clock + PI };
            let lift = (libm::sin(clock) - walk.support) / (1.0 - walk.support);
            let lift = walk.lift * lift.max(0.0) * self.stepping;
            let swing = swing(clock + walk.phase, walk.linear);
            let position = Vector3::new(
                walk.foot + ahead * swing,
                side * (robot.beside + walk.spread) + left * swing + sway,
                lift - walk.height,
            );
            let turned = UnitQuaternion::new(Vector3::new(0.0, 0.0, yaw * swing))
                * UnitQuaternion::new(Vector3::new(0.0, -walk.lean, 0.0));
            let sole = Isometry3::from_parts((robot.hips + position).into(), turned);
            angles[leg..leg + 6].copy_from_slice(&robot.leg_angles(foot, &sole));
            angles[leg] += walk.hip_pitch * pitch + walk.hip_pitch_rate * pitch_rate;
            angles[leg + 1] += walk.hip_roll * roll + walk.hip_roll_rate * roll_rate;
            angles[leg + 4] += walk.ankle_pitch * pitch + walk.ankle_pitch_rate * pitch_rate;
            angles[leg + 5] += walk.ankle_roll * roll + walk.ankle_roll_rate * roll_rate - ankle_sway;
        }
        // From the straight stand in which a robot is placed.
        angles.map(|angle| angle * self.crouched)
    }
}

/// The position of a foot in its stride at a phase, from -1 to 1: it swings ahead in the first
/// half, and returns in the second at constant speed for the fraction `linear`, otherwise by a
/// sine.
fn swing(clock: f64, linear: f64) -> f64 {
    let clock = libm::fmod(clock + 2.0 * TAU, TAU);
    let sine = -libm::cos(clock);
    match clock < PI {
        true => sine,
        false => sine + linear * (1.0 - 2.0 * (clock - PI) / PI - sine),
    }
}

impl WalkEngine for SineWalk {
    fn gait(&self) -> Gait {
        let SineParameters { forwards, backwards, sideways, turning, .. } = self.parameters;
        Gait {
            x: Limits::new(-backwards, forwards),
            y: Limits::symmetric(sideways),
            turn: Limits::symmetric(turning),
        }
    }

    fn advance(&mut self, velocity: WalkVelocity, motion: &Motion, motors: &mut Motors) {
        self.step(velocity);
        let angles = self.angles(motion);
        let SineParameters { leg_stiffness, leg_damping, other_stiffness, other_damping, .. } =
            self.parameters;
        for (joint, motor) in motors.iter_mut().enumerate().take(self.robot.joint_count()) {
            let (stiffness, damping) = match joint < self.robot.left_leg {
                true => (other_stiffness, other_damping),
                false => (leg_stiffness, leg_damping),
            };
            let angle = self.robot.limits(joint).clamp(angles[joint]);
            *motor = MotorCommand { angle, stiffness, damping, ..MotorCommand::default() };
        }
    }

    fn reset(&mut self) {
        *self = SineWalk::new(self.robot, self.parameters);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{K1, T1};

    fn run(walk: &mut SineWalk, velocity: WalkVelocity, cycles: usize) -> Vec<JointValues> {
        let mut motors = [MotorCommand::default(); JOINTS];
        let mut cycle = || {
            walk.advance(velocity, &Motion::STILL, &mut motors);
            motors.map(|motor| motor.angle)
        };
        (0..cycles).map(|_| cycle()).collect()
    }

    #[test]
    fn it_crouches_without_a_jump_and_stands_until_a_command_to_walk() {
        for robot in Humanoid::ALL {
            let mut walk = SineWalk::new(robot, SineParameters::own(robot).unwrap());
            let angles = run(&mut walk, WalkVelocity::default(), 100);
            let knees = |angles: &JointValues| (angles[robot.left_leg + 3], angles[robot.right_leg + 3]);
            assert!(knees(&angles[0]).0 < 0.1);
            assert_eq!(knees(&angles[99]), knees(&angles[60]));
            assert!(knees(&angles[99]).0 > 0.5 && knees(&angles[99]).0 == knees(&angles[99]).1);
        }
    }

    #[test]
    fn the_legs_step_in_turn_and_stop_after_the_command() {
        for robot in Humanoid::ALL {
            let (left, right) = (robot.left_leg, robot.right_leg);
            let mut walk = SineWalk::new(robot, SineParameters::own(robot).unwrap());
            run(&mut walk, WalkVelocity::default(), 50);
            let ahead = run(&mut walk, WalkVelocity { x: 0.2, ..WalkVelocity::default() }, 200);
            let is_lifted = |angles: &&JointValues, leg: usize| angles[leg + 3] > ahead[0][leg + 3] + 0.2;
            let lifted = |leg| ahead[100..].iter().filter(|angles| is_lifted(angles, leg)).count();
            assert!(lifted(left) > 20 && lifted(right) > 20);
            assert!(ahead.iter().all(|angles| (angles[left + 3] - angles[right + 3]).abs() < 0.5));
            let stand = run(&mut walk, WalkVelocity::default(), 150);
            assert_eq!(stand[149], stand[140]);
        }
    }

    #[test]
    fn joints_that_a_robot_does_not_have_are_left_alone() {
        let mut walk = SineWalk::new(&K1, SineParameters::own(&T1).unwrap());
        let mut motors = [MotorCommand::default(); JOINTS];
        walk.advance(WalkVelocity::default(), &Motion::STILL, &mut motors);
        let commanded = motors.iter().filter(|motor| motor.stiffness > 0.0).count();
        assert_eq!((commanded, motors[22]), (22, MotorCommand::default()));
    }
}
