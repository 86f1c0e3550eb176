//! Skills as motions of the joints: sequences of poses, from files.
//!
//! The files are [special actions](monas_config::poses). Those of a skill that has sides are for
//! the left one: the right one is the mirror image. When a motion is over, and whether it was
//! successful, follows from the skill and not from the file.

use std::collections::BTreeMap;
use std::path::Path;

use monas_config::poses::{self, JointPose};
use monas_robot::{Error, ErrorKind, FallDetector, Skill};
use nalgebra::Isometry3;
use yase::{Diagnostic, Source};

use crate::anatomy::{NaoJoint, anatomy, mirrored};
use crate::kinematics::{self, JointAngles, Side};
use crate::lola::JOINTS;
use crate::walk::TORSO_HEIGHT;

/// The options that name files of poses in place of the built-in ones.
pub(crate) const KICK: &str = "kick";
pub(crate) const FALL: &str = "fall";
pub(crate) const DIVE: &str = "dive";
pub(crate) const STAND_UP: &str = "stand_up";

/// The special actions of a body.
#[derive(Debug)]
pub(crate) struct SpecialActions {
    kick: Vec<JointPose>,
    fall: Vec<JointPose>,
    dive: Vec<JointPose>,
    stand_up: Vec<JointPose>,
    sit_down: Vec<JointPose>,
}

impl SpecialActions {
    /// Reads the files that the options of a configuration name, otherwise the built-in ones.
    ///
    /// # Errors
    /// A file cannot be read or has errors; the message has its first one.
    pub(crate) fn of(options: &BTreeMap<String, String>) -> Result<SpecialActions, Error> {
        let action = |option: &str, built_in| match options.get(option) {
            Some(path) => checked(poses::load(Path::new(path), anatomy())),
            None => checked(poses::read(&Source::new(format!("{option}.xml"), built_in), anatomy())),
        };
        Ok(SpecialActions {
            kick: action(KICK, include_str!("../motions/kick.xml"))?,
            fall: action(FALL, include_str!("../motions/fall.xml"))?,
            dive: action(DIVE, include_str!("../motions/dive.xml"))?,
            stand_up: action(STAND_UP, include_str!("../motions/stand_up.xml"))?,
            sit_down: action("sit_down", include_str!("../motions/sit_down.xml"))?,
        })
    }

    /// The motion of a skill, from the present angles; none for no skill.
    pub(crate) fn motion(&self, skill: Skill, from: JointAngles) -> Option<Motion> {
        let (poses, end) = match skill {
            Skill::NoSkill => return None,
            Skill::KickLeft | Skill::KickRight => (&self.kick, MotionEnd::AtLastPose),
            Skill::FallLeft | Skill::FallRight => (&self.fall, MotionEnd::WhenLying { at_most: 1.0 }),
            Skill::DiveLeft | Skill::DiveRight => (&self.dive, MotionEnd::WhenLying { at_most: 1.0 }),
            Skill::StandUp => (&self.stand_up, MotionEnd::WhenUpright { at_most: 5.0 }),
        };
        let is_right = matches!(skill, Skill::KickRight | Skill::FallRight | Skill::DiveRight);
        Some(Motion::through(poses, is_right, end, from))
    }

    /// Sits down.
    pub(crate) fn sit_down(&self, from: JointAngles) -> Motion {
        Motion::through(&self.sit_down, false, MotionEnd::AtLastPose, from)
    }
}

fn checked((poses, diagnostics): (Option<Vec<JointPose>>, Vec<Diagnostic>)) -> Result<Vec<JointPose>, Error> {
    let message = || diagnostics.iter().find(|found| found.is_error()).map(ToString::to_string);
    poses.ok_or_else(|| Error::new(ErrorKind::Configuration, message().unwrap_or_default()))
}

/// A pose of all joints, the duration of the motion to it, s, and the stiffness during this motion.
#[derive(Clone, Copy, Debug)]
struct KeyFrame {
    seconds: f64,
    stiffness: Option<f64>,
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

/// A motion in progress.
#[derive(Clone, Debug)]
pub(crate) struct Motion {
    frames: Vec<KeyFrame>,
    end: MotionEnd,
    /// The joints that it moves; the others follow the walk and the head commands.
    moves: [bool; JOINTS],
    from: JointAngles,
    frame: usize,
    elapsed: f64,
    stiffness: Option<f64>,
}

/// The pose of the left arm while standing and walking: shoulder pitch and roll, elbow yaw and
/// roll.
const LEFT_ARM: [f64; 4] = [1.5, 0.2, -1.2, -0.4];

/// The pose in which the robot stands: both feet below the hips, the torso upright.
pub(crate) fn stand() -> JointAngles {
    let mut angles = [0.0; JOINTS];
    for side in Side::BOTH {
        let foot = Isometry3::translation(0.0, side.sign() * 0.05, -TORSO_HEIGHT);
        kinematics::place_foot(side, &foot, 0.0, &mut angles);
        let arm = side.arm();
        let [pitch, roll, yaw, elbow] = LEFT_ARM;
        angles[arm] = pitch;
        angles[arm + 1] = side.sign() * roll;
        angles[arm + 2] = side.sign() * yaw;
        angles[arm + 3] = side.sign() * elbow;
    }
    angles
}

impl Motion {
    /// A motion through poses, or through their mirror images.
    fn through(poses: &[JointPose], is_mirrored: bool, end: MotionEnd, from: JointAngles) -> Motion {
        let (mut angles, mut moves, mut stiffness) = (from, [false; JOINTS], None);
        let frames = poses.iter().map(|pose| {
            for &(joint, angle) in &pose.angles {
                let (joint, angle) = if is_mirrored { mirrored(joint, angle) } else { (joint, angle) };
                (angles[joint], moves[joint]) = (angle, true);
            }
            stiffness = pose.stiffness.or(stiffness);
            KeyFrame { seconds: pose.seconds, stiffness, angles }
        });
        let frames: Vec<KeyFrame> = frames.collect();
        let stiffness = frames.first().and_then(|frame| frame.stiffness);
        Motion { frames, end, moves, from, frame: 0, elapsed: 0.0, stiffness }
    }

    /// Goes to the pose in which the robot stands.
    pub(crate) fn stand(from: JointAngles, seconds: f64) -> Motion {
        let body = NaoJoint::LShoulderPitch as usize..JOINTS;
        let angles = body.zip(stand().into_iter().skip(NaoJoint::LShoulderPitch as usize)).collect();
        Motion::through(&[JointPose { seconds, stiffness: None, angles }], false, MotionEnd::AtLastPose, from)
    }

    /// Advances by one cycle and sets the joints that it moves. Returns whether it is over.
    pub(crate) fn advance(&mut self, seconds: f64, falls: FallDetector, angles: &mut JointAngles) -> bool {
        self.elapsed += seconds;
        while let Some(frame) = self.frames.get(self.frame)
            && self.elapsed >= frame.seconds
        {
            (self.from, self.elapsed) = (frame.angles, self.elapsed - frame.seconds);
            self.frame += 1;
        }
        let (to, part) = match self.frames.get(self.frame) {
            Some(frame) => {
                self.stiffness = frame.stiffness;
                (&frame.angles, self.elapsed / frame.seconds)
            }
            None => (&self.from, 0.0),
        };
        for joint in self.joints() {
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

    /// The joints that it moves.
    pub(crate) fn joints(&self) -> impl Iterator<Item = usize> + use<> {
        let moves = self.moves;
        (0..JOINTS).filter(move |&joint| moves[joint])
    }

    /// The stiffness of all joints, if the motion has one of its own.
    pub(crate) fn stiffness(&self) -> Option<f64> {
        self.stiffness
    }

    /// Whether the torso is inclined as after the whole motion.
    pub(crate) fn is_performed(&self, falls: FallDetector) -> bool {
        match self.end {
            MotionEnd::WhenLying { .. } => falls.is_fallen(),
            MotionEnd::AtLastPose | MotionEnd::WhenUpright { .. } => !falls.is_inclined(),
        }
    }
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

    fn built_in() -> SpecialActions {
        SpecialActions::of(&BTreeMap::new()).unwrap()
    }

    fn joint(name: &str) -> usize {
        anatomy().joint(name).unwrap()
    }

    #[test]
    fn motions_stay_within_the_limits_and_end() {
        let mut falls = FallDetector::default();
        falls.measure(0.0, 0.5);
        let actions = built_in();
        let mut sitting = stand();
        actions.sit_down(stand()).advance(2.0, falls, &mut sitting);
        let mut motions: Vec<Motion> =
            SKILLS.iter().filter_map(|&skill| actions.motion(skill, stand())).collect();
        motions.extend([actions.sit_down(stand()), Motion::stand(sitting, 1.0)]);
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
        assert!(actions.motion(Skill::NoSkill, stand()).is_none());
    }

    #[test]
    fn the_built_in_actions_move_all_but_the_head_and_return_to_the_stand() {
        let actions = built_in();
        for skill in SKILLS {
            let motion = actions.motion(skill, [0.1; JOINTS]).unwrap();
            assert!(motion.joints().eq(NaoJoint::LShoulderPitch as usize..JOINTS), "{skill:?}");
            if [Skill::KickLeft, Skill::KickRight, Skill::StandUp].contains(&skill) {
                let last = motion.frames.last().unwrap();
                assert_eq!(last.angles[2..], stand()[2..], "{skill:?}");
            }
        }
    }

    #[test]
    fn joints_that_a_pose_does_not_name_keep_their_angle() {
        let pose = |seconds, stiffness, angles: &[(&str, f64)]| {
            let angles = angles.iter().map(|&(name, angle)| (joint(name), angle)).collect();
            JointPose { seconds, stiffness, angles }
        };
        let poses = [
            pose(0.5, None, &[("LElbowYaw", 1.0), ("HeadYaw", -0.4)]),
            pose(0.5, Some(0.3), &[("LShoulderRoll", 0.5)]),
            pose(0.5, None, &[]),
        ];
        for (is_mirrored, side, sign) in [(false, "L", 1.0), (true, "R", -1.0)] {
            let [yaw, roll] = ["ElbowYaw", "ShoulderRoll"].map(|name| joint(&format!("{side}{name}")));
            let mut motion = Motion::through(&poses, is_mirrored, MotionEnd::AtLastPose, [0.0; JOINTS]);
            let mut angles = [0.0; JOINTS];
            let falls = FallDetector::default();
            for (yaws, rolls, stiffness, is_over) in [
                (0.5, 0.0, None, false),
                (1.0, 0.0, Some(0.3), false),
                (1.0, 0.25, Some(0.3), false),
                (1.0, 0.5, Some(0.3), false),
                (1.0, 0.5, Some(0.3), false),
                (1.0, 0.5, Some(0.3), true),
            ] {
                assert_eq!(motion.advance(0.25, falls, &mut angles), is_over);
                assert_eq!((angles[yaw], angles[roll]), (sign * yaws, sign * rolls));
                assert_eq!(motion.stiffness(), stiffness);
                // The commands of walk and head have the joints that no pose names.
                angles[joint("HeadPitch")] = 0.2;
            }
            assert_eq!((angles[joint("HeadYaw")], angles[joint("HeadPitch")]), (sign * -0.4, 0.2));
        }
    }
}
