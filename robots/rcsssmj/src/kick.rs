//! A kick from a stand: the weight goes onto one leg, and the other swings.

use nalgebra::{Isometry3, UnitQuaternion, Vector3};

use crate::effector::MotorCommand;
use crate::humanoid::{CYCLE_SECONDS, Humanoid, JOINTS, JointValues};
use crate::kinematics::{Foot, inclination};
use crate::parameters::parameters;
use crate::walk::{Motion, Motors};

parameters! {
    /// The parameters of a kick, as its file names them.
    KickParameters, kick;
    ball_x: 0.1, 0.6, "where the ball lies ahead of the robot, m";
    ball_y: 0.0, 0.3, "the same to the side of the foot that kicks, m";
    still: 0.0, 3.0, "how long the robot stands first, s";
    height: 0.3, 0.55, "of the hips above the sole that stands, m";
    foot: -0.15, 0.15, "where the soles are ahead of the hips, m";
    lean: -0.4, 0.4, "pitch of the torso over the feet, forwards, rad";
    shift: 0.0, 0.2, "of the hips towards the foot that stands, m";
    tilt: -0.4, 0.4, "roll of the torso towards that foot, rad";
    lift: 0.0, 0.2, "of the foot that kicks, m";
    raise: -0.1, 0.2, "by how much it is higher after the swing, m";
    inward: -0.1, 0.1, "of the foot that kicks from its place beside the other, m";
    back: 0.0, 0.3, "of the foot that kicks, before the swing, m";
    ahead: 0.0, 0.4, "the same, after the swing, m";
    toes: -0.6, 0.6, "pitch of the foot that kicks, toes downwards, rad";
    twist: -0.8, 0.8, "turn of the waist in the swing, towards the foot that kicks, rad";
    shifting: 0.1, 2.0, "time for the shift of the weight, s";
    lifting: 0.1, 2.0, "time to lift the foot, s";
    swinging: 0.02, 1.0, "time of the swing, s";
    holding: 0.0, 1.0, "time in which the foot stays ahead, s";
    returning: 0.1, 2.0, "time to put the foot down, s";
    unshifting: 0.1, 2.0, "time to put the weight on both feet, s";
    blending: 0.05, 1.0, "time between the stand of the walk and that of the kick, s";
    ankle_pitch: -1.0, 3.0, "ankle pitch for each rad of the torso's pitch";
    ankle_pitch_rate: -0.3, 0.5, "ankle pitch for each rad/s of it, s";
    hip_pitch: -1.0, 3.0, "hip pitch for each rad of the torso's pitch";
    hip_pitch_rate: -0.3, 0.5, "hip pitch for each rad/s of it, s";
    ankle_roll: -1.0, 3.0, "ankle roll for each rad of the torso's roll";
    ankle_roll_rate: -0.3, 0.5, "ankle roll for each rad/s of it, s";
    hip_roll: -1.0, 3.0, "hip roll for each rad of the torso's roll";
    hip_roll_rate: -0.3, 0.5, "hip roll for each rad/s of it, s";
    stiffness: 0.0, 1000.0, "torque per angle of the legs, Nm/rad";
    damping: 0.0, 50.0, "torque per angular velocity of the legs, Nm s/rad";
}

/// A kick in progress.
///
/// It starts from the motor commands of a walk that stands and returns to them. Inclination and
/// angular velocity of the torso move ankle and hip of the leg that stands.
#[derive(Clone, Debug)]
pub struct Kick {
    robot: &'static Humanoid,
    parameters: KickParameters,
    foot: Foot,
    /// Time since the start, s.
    time: f64,
}

/// The progress of the phases of a kick, each from 0 to 1.
struct Progress {
    /// The weight of the kick's motor commands against those of the walk.
    kick_weight: f64,
    shift: f64,
    lift: f64,
    swing: f64,
    /// The return from the swing to a stand.
    back: f64,
}

impl Kick {
    /// A kick of a robot with a foot.
    pub fn new(robot: &'static Humanoid, parameters: KickParameters, foot: Foot) -> Kick {
        Kick { robot, parameters, foot, time: 0.0 }
    }

    /// Advances by a cycle of 20 ms. The motors hold the commands of a walk that stands. Returns
    /// false when the kick is over.
    pub fn advance(&mut self, motion: &Motion, motors: &mut Motors) -> bool {
        self.time += CYCLE_SECONDS;
        let Some(progress) = self.progress() else { return false };
        let angles = self.angles(motion, &progress);
        let KickParameters { stiffness, damping, .. } = self.parameters;
        let robot = self.robot;
        let moved = robot.waist.unwrap_or(robot.left_leg)..robot.joint_count();
        for (joint, motor) in motors.iter_mut().enumerate().take(moved.end).skip(moved.start) {
            let mix = |from: f64, to: f64| from + (to - from) * progress.kick_weight;
            let (stiffness, damping) = match joint < robot.left_leg {
                true => (motor.stiffness, motor.damping),
                false => (mix(motor.stiffness, stiffness), mix(motor.damping, damping)),
            };
            let angle = mix(motor.angle, robot.limits(joint).clamp(angles[joint]));
            *motor = MotorCommand { angle, stiffness, damping, ..*motor };
        }
        true
    }

    fn progress(&self) -> Option<Progress> {
        let kick = &self.parameters;
        let mut begin = kick.still;
        let mut part = |length: f64| {
            let done = ((self.time - begin) / length).clamp(0.0, 1.0);
            begin += length;
            done
        };
        let taken = part(kick.blending);
        let shifted = part(kick.shifting);
        let lifted = part(kick.lifting);
        let swung = part(kick.swinging);
        part(kick.holding.max(CYCLE_SECONDS));
        let returned = part(kick.returning);
        let unshifted = part(kick.unshifting);
        let given = part(kick.blending);
        (given < 1.0).then(|| Progress {
            kick_weight: smooth(taken) - smooth(given),
            shift: smooth(shifted) - smooth(unshifted),
            lift: smooth(lifted),
            swing: swung,
            back: smooth(returned),
        })
    }

    fn angles(&self, motion: &Motion, progress: &Progress) -> JointValues {
        let (robot, kick) = (self.robot, &self.parameters);
        let side = if self.foot == Foot::Left { 1.0 } else { -1.0 };
        let Progress { shift, lift, swing, back, .. } = *progress;
        // Positive to the right, as the left foot kicks.
        let tilt = side * kick.tilt * shift;
        let shift = side * kick.shift * shift;
        let (ahead, up) = (
            (-kick.back * lift + (kick.back + kick.ahead) * swing) * (1.0 - back),
            (kick.lift * lift + kick.raise * swing) * (1.0 - back),
        );
        let inward = side * kick.inward * lift * (1.0 - back);
        let stands = Vector3::new(kick.foot, -side * robot.beside + shift, -kick.height);
        let kicks = Vector3::new(kick.foot + ahead, side * robot.beside + shift - inward, up - kick.height);
        let turned = UnitQuaternion::from_euler_angles(-tilt, -kick.lean, 0.0);
        let toes = UnitQuaternion::from_euler_angles(0.0, kick.toes * lift * (1.0 - back), 0.0);

        let (roll, pitch) = inclination(&motion.down);
        let (roll, pitch) = (roll - tilt, pitch - kick.lean);
        let [roll_rate, pitch_rate, _] = motion.gyro;
        let mut angles = [0.0; JOINTS];
        if let Some(waist) = robot.waist {
            angles[waist] = side * kick.twist * swing * (1.0 - back);
        }
        for foot in [Foot::Left, Foot::Right] {
            let leg = robot.leg(foot);
            let sole = match foot == self.foot {
                true => Isometry3::from_parts((robot.hips + kicks).into(), turned * toes),
                false => Isometry3::from_parts((robot.hips + stands).into(), turned),
            };
            angles[leg..leg + 6].copy_from_slice(&robot.leg_angles(foot, &sole));
            // Both feet stand until one is lifted, and after it is put down.
            if foot != self.foot || lift <= 0.0 || back >= 1.0 {
                angles[leg] += kick.hip_pitch * pitch + kick.hip_pitch_rate * pitch_rate;
                angles[leg + 1] += kick.hip_roll * roll + kick.hip_roll_rate * roll_rate;
                angles[leg + 4] += kick.ankle_pitch * pitch + kick.ankle_pitch_rate * pitch_rate;
                angles[leg + 5] += kick.ankle_roll * roll + kick.ankle_roll_rate * roll_rate;
            }
        }
        angles
    }
}

/// From 0 to 1 with continuous velocity.
fn smooth(part: f64) -> f64 {
    part * part * (3.0 - 2.0 * part)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn run(robot: &'static Humanoid, foot: Foot) -> Vec<JointValues> {
        let mut kick = Kick::new(robot, KickParameters::own(robot).unwrap(), foot);
        let mut angles = Vec::new();
        let mut motors = [MotorCommand::default(); JOINTS];
        while kick.advance(&Motion::STILL, &mut motors) {
            angles.push(motors.map(|motor| motor.angle));
            motors = [MotorCommand::default(); JOINTS];
        }
        angles
    }

    #[test]
    fn it_begins_and_ends_with_the_commands_of_the_walk_and_is_fast_in_lift_and_swing_only() {
        for robot in Humanoid::ALL {
            let kick = KickParameters::own(robot).unwrap();
            let angles = run(robot, Foot::Left);
            assert!(angles[0].iter().all(|angle| *angle == 0.0));
            let steps: Vec<f64> = angles
                .windows(2)
                .map(|pair| (0..JOINTS).map(|joint| (pair[1][joint] - pair[0][joint]).abs()))
                .map(|steps| steps.fold(0.0, f64::max))
                .collect();
            let fast = steps.iter().filter(|step| **step > 0.15).count() as f64 * CYCLE_SECONDS;
            assert!(fast <= kick.lifting + kick.swinging + 3.0 * CYCLE_SECONDS, "{fast} s of fast motion");
            assert!(angles.last().unwrap().iter().all(|angle| angle.abs() < 0.2));
            assert!(angles.len() > 50 && angles.len() < 400, "{} cycles", angles.len());
        }
    }

    #[test]
    fn the_other_foot_kicks_in_a_mirror() {
        for robot in Humanoid::ALL {
            let (left_leg, right_leg) = (robot.left_leg, robot.right_leg);
            let (left, right) = (run(robot, Foot::Left), run(robot, Foot::Right));
            assert_eq!(left.len(), right.len());
            for (left, right) in left.iter().zip(&right) {
                for joint in 0..6 {
                    let sign = if matches!(joint, 1 | 2 | 5) { -1.0 } else { 1.0 };
                    assert!((left[left_leg + joint] - sign * right[right_leg + joint]).abs() < 1e-3);
                    assert!((left[right_leg + joint] - sign * right[left_leg + joint]).abs() < 1e-3);
                }
                if let Some(waist) = robot.waist {
                    assert_eq!(left[waist], -right[waist]);
                }
            }
        }
    }
}
