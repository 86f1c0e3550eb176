//! Skills as motions of the joints: poses at times.

use monas_robot::{FallDetector, Skill};
use nalgebra::Isometry3;

use crate::anatomy::NaoJoint;
use crate::kinematics::{self, JointAngles, Side};
use crate::lola::JOINTS;
use crate::walk::TORSO_HEIGHT;

/// A pose of all joints except the head, and the time that the way to it takes, s.
#[derive(Clone, Copy, Debug)]
struct KeyFrame {
    seconds: f64,
    angles: JointAngles,
}

/// When a motion that has reached its last pose is over.
#[derive(Clone, Copy, PartialEq, Debug)]
enum MotionEnd {
    /// At once.
    AtLastPose,
    /// When the torso is upright, or after this time, s.
    WhenUpright { at_most: f64 },
    /// When the body lies, or after this time, s.
    WhenLying { at_most: f64 },
}

/// A motion that is under way.
#[derive(Clone, Debug)]
pub(crate) struct Motion {
    frames: Vec<KeyFrame>,
    end: MotionEnd,
    from: JointAngles,
    frame: usize,
    elapsed: f64,
}

/// How the arms hang while standing and walking: shoulder pitch and roll, elbow yaw and roll of the
/// left arm.
const LEFT_ARM: [f64; 4] = [1.5, 0.2, -1.2, -0.4];

/// The pose in which the robot stands.
pub(crate) fn stand() -> JointAngles {
    standing([(0.0, 0.05, 0.0), (0.0, -0.05, 0.0)])
}

/// A pose with the left and the right foot at x, y and above the ground, the torso upright.
fn standing(feet: [(f64, f64, f64); 2]) -> JointAngles {
    let mut angles = [0.0; JOINTS];
    for (side, (x, y, lift)) in Side::BOTH.into_iter().zip(feet) {
        kinematics::place_foot(side, &Isometry3::translation(x, y, lift - TORSO_HEIGHT), 0.0, &mut angles);
        let arm = side.arm();
        let [pitch, roll, yaw, elbow] = LEFT_ARM;
        angles[arm] = pitch;
        angles[arm + 1] = side.sign() * roll;
        angles[arm + 2] = side.sign() * yaw;
        angles[arm + 3] = side.sign() * elbow;
    }
    angles
}

/// A pose with folded legs: hips, knees and ankles bent.
fn folded(hip: f64, knee: f64, ankle: f64) -> JointAngles {
    let mut angles = stand();
    for side in Side::BOTH {
        let leg = side.leg();
        angles[leg] = 0.0;
        angles[leg + 1] = hip;
        angles[leg + 2] = knee;
        angles[leg + 3] = ankle;
        angles[leg + 4] = 0.0;
    }
    angles
}

/// The pose in which the robot sits on its heels.
pub(crate) fn sitting() -> JointAngles {
    folded(-0.9, 2.1, -1.18)
}

/// A pose that leans to a side, from the ankles and the hips.
fn leaning(side: Side, mut angles: JointAngles) -> JointAngles {
    for leg in Side::BOTH.map(Side::leg) {
        angles[leg] = side.sign() * 0.15;
        angles[leg + 4] = side.sign() * 0.38;
    }
    angles[side.arm() + 1] = side.sign() * 1.2;
    angles
}

impl Motion {
    fn new(from: JointAngles, frames: &[(f64, JointAngles)], end: MotionEnd) -> Motion {
        let frames = frames.iter().map(|&(seconds, angles)| KeyFrame { seconds, angles }).collect();
        Motion { frames, end, from, frame: 0, elapsed: 0.0 }
    }

    /// The motion of a skill, from the present angles; none for no skill.
    pub(crate) fn of(skill: Skill, from: JointAngles) -> Option<Motion> {
        let side = match skill {
            Skill::KickLeft | Skill::FallLeft | Skill::DiveLeft => Side::Left,
            _ => Side::Right,
        };
        let lies = MotionEnd::WhenLying { at_most: 1.0 };
        Some(match skill {
            Skill::NoSkill => return None,
            Skill::KickLeft | Skill::KickRight => kick(side, from),
            Skill::DiveLeft | Skill::DiveRight => Motion::new(from, &[(0.06, leaning(side, stand()))], lies),
            Skill::FallLeft | Skill::FallRight => {
                // It leans while its motors still lower the hips, which takes them 0.14 s.
                let kneeling = folded(-0.75, 1.6, -0.85);
                Motion::new(from, &[(0.06, kneeling), (0.06, leaning(side, kneeling))], lies)
            }
            Skill::StandUp => {
                let upright = MotionEnd::WhenUpright { at_most: 5.0 };
                // The legs are in the stand again before the torso is upright.
                let folded = folded(-1.5, 2.0, -1.1);
                Motion::new(from, &[(0.2, folded), (0.1, folded), (0.5, stand())], upright)
            }
        })
    }

    /// Sits down.
    pub(crate) fn sit_down(from: JointAngles) -> Motion {
        Motion::new(from, &[(1.5, sitting())], MotionEnd::AtLastPose)
    }

    /// Goes to the pose in which the robot stands.
    pub(crate) fn stand(from: JointAngles, seconds: f64) -> Motion {
        Motion::new(from, &[(seconds, stand())], MotionEnd::AtLastPose)
    }

    /// Advances by one cycle and sets all joints except the head's. Returns whether it is over.
    pub(crate) fn advance(&mut self, seconds: f64, falls: FallDetector, angles: &mut JointAngles) -> bool {
        self.elapsed += seconds;
        while let Some(frame) = self.frames.get(self.frame)
            && self.elapsed >= frame.seconds
        {
            (self.from, self.elapsed) = (frame.angles, self.elapsed - frame.seconds);
            self.frame += 1;
        }
        let (to, part) = match self.frames.get(self.frame) {
            Some(frame) => (&frame.angles, self.elapsed / frame.seconds),
            None => (&self.from, 0.0),
        };
        for joint in NaoJoint::LShoulderPitch as usize..JOINTS {
            angles[joint] = self.from[joint] + (to[joint] - self.from[joint]) * part;
        }
        self.frame == self.frames.len()
            && match self.end {
                MotionEnd::AtLastPose => true,
                MotionEnd::WhenUpright { at_most } | MotionEnd::WhenLying { at_most } => {
                    self.is_performed(falls) || self.elapsed >= at_most
                }
            }
    }

    /// Whether the torso is inclined as after the whole motion.
    pub(crate) fn is_performed(&self, falls: FallDetector) -> bool {
        match self.end {
            MotionEnd::WhenLying { .. } => falls.is_fallen(),
            MotionEnd::AtLastPose | MotionEnd::WhenUpright { .. } => !falls.is_inclined(),
        }
    }
}

/// Swings a foot back, then ahead through the ball. The field counts a kick from the swing back on
/// and has it meet the ball 0.8 s later, so the motion waits in between.
fn kick(side: Side, from: JointAngles) -> Motion {
    let pose = |x: f64, lift: f64| {
        let mut feet = [(0.0, 0.05, 0.0), (0.0, -0.05, 0.0)];
        let foot = &mut feet[side as usize];
        (foot.0, foot.2) = (x, lift);
        standing(feet)
    };
    let (back, ahead) = (pose(-0.07, 0.04), pose(0.1, 0.03));
    let frames =
        [(0.12, pose(0.0, 0.04)), (0.1, back), (0.7, back), (0.1, ahead), (0.3, stand()), (0.4, stand())];
    Motion::new(from, &frames, MotionEnd::AtLastPose)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::anatomy::limits;
    use crate::lola::CYCLE_SECONDS;

    const SKILLS: [Skill; 7] = [
        Skill::KickLeft,
        Skill::KickRight,
        Skill::FallLeft,
        Skill::FallRight,
        Skill::DiveLeft,
        Skill::DiveRight,
        Skill::StandUp,
    ];

    #[test]
    fn motions_stay_within_the_limits_and_end() {
        let mut falls = FallDetector::default();
        falls.measure(0.0, 0.5);
        let mut motions: Vec<Motion> =
            SKILLS.iter().filter_map(|&skill| Motion::of(skill, stand())).collect();
        motions.extend([Motion::sit_down(stand()), Motion::stand(sitting(), 1.0)]);
        for mut motion in motions {
            let mut angles = stand();
            let mut cycles = 0;
            while !motion.advance(CYCLE_SECONDS, falls, &mut angles) {
                cycles += 1;
                assert!(cycles < 600, "{motion:?} does not end");
                for (joint, &angle) in angles.iter().enumerate().skip(2) {
                    assert!(limits(joint).contains(angle), "joint {joint}: {angle}");
                }
            }
        }
        assert!(Motion::of(Skill::NoSkill, stand()).is_none());
    }
}
