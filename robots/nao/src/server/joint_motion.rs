//! Derives the motion of a body from the angles of its joints.

use monas_robot::{Actuators, Posture, Skill};
use nalgebra::{Isometry3, Point3};

use crate::anatomy::NaoJoint;
use crate::kinematics::{HIP, JointAngles, Side, foot_in_torso};
use crate::lola::CYCLE_SECONDS;
use crate::walk::displacement;

/// The centre of mass, in the torso's frame, m.
const CENTRE_OF_MASS: [f64; 3] = [0.0, 0.0, 0.043];
/// From the ankle to the outer edge of the sole, m.
const SOLE_OUTWARDS: f64 = 0.045;
/// A body that falls with its hips lower than this falls from its knees, m.
const KNEELING_HIP: f64 = 0.185;
/// A foot that is lifted this far and is this far behind swings back for a kick, m.
const KICK_LIFT: f64 = 0.03;
const KICK_BACK: f64 = 0.05;
/// Knees that are bent more than this are folded, rad.
const FOLDED_KNEE: f64 = 1.7;
/// Slower than this the body stands, m/s and rad/s: packets have 32 bit floats.
const MIN_SPEED: f64 = 2e-3;
/// Feet whose heights differ by less are both on the ground, m.
const SAME_HEIGHT: f64 = 2e-3;

/// Derives the commands of a body in the plane from the angles of the joints.
#[derive(Debug)]
pub(super) struct JointMotion {
    /// The skill recognised from the present angles.
    observed: Option<Skill>,
    /// The skill that was recognised last.
    skill: Skill,
    skill_number: u64,
    was_stiff: bool,
    support: Option<Side>,
}

impl Default for JointMotion {
    fn default() -> JointMotion {
        JointMotion {
            observed: None,
            skill: Skill::NoSkill,
            skill_number: 0,
            was_stiff: false,
            support: None,
        }
    }
}

impl JointMotion {
    /// Whether the legs have lost their stiffness; not before they have had it.
    pub(super) fn gives_way(&mut self, is_stiff: bool) -> bool {
        self.was_stiff |= is_stiff;
        self.was_stiff && !is_stiff
    }

    /// The foot on the ground; none if both are.
    pub(super) fn support(&self) -> Option<Side> {
        self.support
    }

    /// The commands in the plane that correspond to the change of the angles.
    pub(super) fn observe(&mut self, before: &JointAngles, now: &JointAngles, posture: Posture) -> Actuators {
        let feet = Side::BOTH.map(|side| foot_in_torso(side, now));
        let observed = match posture {
            Posture::Fallen if is_folded(now) => Some(Skill::StandUp),
            Posture::Standing | Posture::Walking => upright_skill(&feet),
            _ => None,
        };
        if observed != self.observed {
            self.observed = observed;
            if let Some(skill) = observed {
                (self.skill, self.skill_number) = (skill, self.skill_number + 1);
            }
        }
        let difference = feet[0].translation.z - feet[1].translation.z;
        self.support = match difference {
            _ if difference.abs() < SAME_HEIGHT => None,
            _ if difference < 0.0 => Some(Side::Left),
            _ => Some(Side::Right),
        };
        let velocity = displacement(before, now).map(|moved| moved / CYCLE_SECONDS);
        let is_still = velocity.iter().all(|part| part.abs() < MIN_SPEED);
        let [walk_x, walk_y, walk_turn] = if is_still || observed.is_some() { [0.0; 3] } else { velocity };
        Actuators {
            walk_x,
            walk_y,
            walk_turn,
            skill: self.skill as i32,
            skill_number: self.skill_number,
            ..Actuators::default()
        }
    }
}

fn is_folded(angles: &JointAngles) -> bool {
    [NaoJoint::LKneePitch, NaoJoint::RKneePitch].iter().all(|&knee| angles[knee as usize] > FOLDED_KNEE)
}

/// The skill that a body on its feet begins: a fall to a side, or a kick.
fn upright_skill(feet: &[Isometry3<f64>; 2]) -> Option<Skill> {
    let [left, right] = feet;
    // The lower foot is on the ground.
    let (support, foot, other) = match left.inverse_transform_point(&right.translation.vector.into()).z >= 0.0
    {
        true => (Side::Left, left, right),
        false => (Side::Right, right, left),
    };
    let mass = foot.inverse_transform_point(&Point3::from(CENTRE_OF_MASS));
    if support.sign() * mass.y > SOLE_OUTWARDS {
        let hip = foot.inverse_transform_point(&Point3::new(HIP.x, support.sign() * HIP.y, HIP.z));
        return Some(match (support, hip.coords.norm() < KNEELING_HIP) {
            (Side::Left, true) => Skill::FallLeft,
            (Side::Right, true) => Skill::FallRight,
            (Side::Left, false) => Skill::DiveLeft,
            (Side::Right, false) => Skill::DiveRight,
        });
    }
    let swinging = foot.inverse_transform_point(&other.translation.vector.into());
    if swinging.z > KICK_LIFT && swinging.x < -KICK_BACK {
        return Some(match support {
            Side::Left => Skill::KickRight,
            Side::Right => Skill::KickLeft,
        });
    }
    None
}

#[cfg(test)]
mod tests {
    use std::collections::BTreeMap;

    use super::*;
    use monas_robot::FallDetector;

    use crate::motions::{SpecialActions, stand};
    use crate::walk::{SteppingWalk, WalkEngine, WalkVelocity};

    /// The skills that are recognised from a motion of the joints.
    fn seen(skill: Skill, posture: Posture) -> Vec<Skill> {
        let actions = SpecialActions::of(&BTreeMap::new()).unwrap();
        let (mut motion, mut angles) = (actions.motion(skill, stand()).unwrap(), stand());
        let mut joints = JointMotion::default();
        let (mut found, mut number) = (Vec::new(), 0);
        let mut falls = FallDetector::default();
        falls.measure(1.3, 0.0);
        for _ in 0..600 {
            let before = angles;
            let over = motion.advance(CYCLE_SECONDS, falls, &mut angles);
            let seen = joints.observe(&before, &angles, posture);
            if seen.skill_number != number {
                number = seen.skill_number;
                found.push(seen.skill());
            }
            if over {
                break;
            }
        }
        found
    }

    #[test]
    fn each_skill_is_seen_once_in_the_angles_and_no_other() {
        for skill in [
            Skill::KickLeft,
            Skill::KickRight,
            Skill::FallLeft,
            Skill::FallRight,
            Skill::DiveLeft,
            Skill::DiveRight,
        ] {
            assert_eq!(seen(skill, Posture::Standing), [skill]);
            assert_eq!(seen(skill, Posture::Lifted), []);
        }
        assert_eq!(seen(Skill::StandUp, Posture::Fallen), [Skill::StandUp]);
        assert_eq!(seen(Skill::StandUp, Posture::Standing), []);
    }

    #[test]
    fn a_walk_is_a_velocity_and_no_skill() {
        let mut engine = SteppingWalk::default();
        let mut angles = stand();
        let mut joints = JointMotion::default();
        let wanted = WalkVelocity { x: 0.2, y: 0.05, turn: 0.3 };
        let mut last = Actuators::default();
        for cycle in 0..500 {
            let before = angles;
            engine.advance(wanted, CYCLE_SECONDS, &mut angles);
            last = joints.observe(&before, &angles, Posture::Walking);
            assert_eq!(last.skill_number, 0, "cycle {cycle}");
        }
        assert!((last.walk_x - 0.2).abs() < 0.05 && (last.walk_y - 0.05).abs() < 0.05, "{last:?}");
    }

    #[test]
    fn a_stand_is_still_and_a_seat_is_no_fall() {
        let mut joints = JointMotion::default();
        let felt = joints.observe(&stand(), &stand(), Posture::Standing);
        assert_eq!((felt.walk_x, felt.walk_y, felt.walk_turn, felt.skill_number), (0.0, 0.0, 0.0, 0));
        let mut sitting = stand();
        let mut motion = SpecialActions::of(&BTreeMap::new()).unwrap().sit_down(stand());
        assert!(motion.advance(2.0, FallDetector::default(), &mut sitting));
        assert_eq!(joints.observe(&sitting, &sitting, Posture::Standing).skill_number, 0);
    }

    #[test]
    fn legs_give_way_only_after_they_were_stiff() {
        let mut joints = JointMotion::default();
        assert!(!joints.gives_way(false) && !joints.gives_way(true) && joints.gives_way(false));
    }
}
