//! The anatomy of the Booster T1 of the server: joints in the order of its perceptors.
//!
//! Offsets, axes, ranges and torques are those of the file `resources/robots/T1/robot.xml` of
//! rcsssmj 0.2.1, lengths in metres.

use std::time::Duration;

use monas_robot::{Anatomy, Camera, Joint, Limits, Skill};

/// The number of joints.
pub const JOINTS: usize = 23;

/// A value for each joint.
pub type JointValues = [f64; JOINTS];

/// The period of the server: four steps of its physics.
pub(crate) const CYCLE: Duration = Duration::from_millis(20);
/// The same in seconds.
pub(crate) const CYCLE_SECONDS: f64 = 0.02;

/// The head's yaw.
pub(crate) const HEAD_YAW: usize = 0;
/// The head's pitch.
pub(crate) const HEAD_PITCH: usize = 1;
/// The roll of the left shoulder.
pub(crate) const LEFT_SHOULDER_ROLL: usize = 3;
/// The roll of the right shoulder.
pub(crate) const RIGHT_SHOULDER_ROLL: usize = 7;
/// The waist.
pub(crate) const WAIST: usize = 10;
/// The first joint of the left leg: pitch, roll and yaw of the hip, knee, pitch and roll of the
/// ankle.
pub(crate) const LEFT_LEG: usize = 11;
/// The first joint of the right leg.
pub(crate) const RIGHT_LEG: usize = 17;

/// The height of the torso's origin above the soles with straight knees, m.
pub(crate) const STRAIGHT_HEIGHT: f64 = 0.6735;
/// From the ankle's roll joint down to the sole, m: half the height of the foot's box, below its
/// middle.
pub(crate) const SOLE: f64 = 0.03;

const ROLL: [f64; 3] = [1.0, 0.0, 0.0];
const PITCH: [f64; 3] = [0.0, 1.0, 0.0];
const YAW: [f64; 3] = [0.0, 0.0, 1.0];

/// A row of [`TABLE`].
struct JointRow {
    name: &'static str,
    motor: &'static str,
    perceptor: &'static str,
    low: f64,
    high: f64,
    parent: Option<usize>,
    offset: [f64; 3],
    axis: [f64; 3],
}

#[allow(clippy::too_many_arguments)] // a row of a table
const fn row(
    name: &'static str,
    motor: &'static str,
    perceptor: &'static str,
    range: (f64, f64),
    parent: Option<usize>,
    offset: [f64; 3],
    axis: [f64; 3],
) -> JointRow {
    JointRow { name, motor, perceptor, low: range.0, high: range.1, parent, offset, axis }
}

#[rustfmt::skip]
const TABLE: [JointRow; JOINTS] = [
    row("HeadYaw", "he1", "q_hj1", (-1.57, 1.57), None, [0.0625, 0.0, 0.243], YAW),
    row("HeadPitch", "he2", "q_hj2", (-0.35, 1.22), Some(0), [0.0, 0.0, 0.06185], PITCH),
    row("LShoulderPitch", "lae1", "q_laj1", (-3.31, 1.22), None, [0.0575, 0.1063, 0.219], PITCH),
    row("LShoulderRoll", "lae2", "q_laj2", (-1.74, 1.57), Some(2), [0.0, 0.047, 0.0], ROLL),
    row("LElbowPitch", "lae3", "q_laj3", (-2.27, 2.27), Some(3), [0.00025, 0.0605, 0.0], PITCH),
    row("LElbowYaw", "lae4", "q_laj4", (-2.44, 0.0), Some(4), [0.0, 0.1471, 0.0], YAW),
    row("RShoulderPitch", "rae1", "q_raj1", (-3.31, 1.22), None, [0.0575, -0.1063, 0.219], PITCH),
    row("RShoulderRoll", "rae2", "q_raj2", (-1.57, 1.74), Some(6), [0.0, -0.047, 0.0], ROLL),
    row("RElbowPitch", "rae3", "q_raj3", (-2.27, 2.27), Some(7), [0.00025, -0.0605, 0.0], PITCH),
    row("RElbowYaw", "rae4", "q_raj4", (0.0, 2.44), Some(8), [0.0, -0.1471, 0.0], YAW),
    row("Waist", "te1", "q_tj1", (-1.57, 1.57), None, [0.0625, 0.0, -0.1155], YAW),
    row("LHipPitch", "lle1", "q_llj1", (-1.8, 1.57), Some(10), [0.0, 0.106, 0.0], PITCH),
    row("LHipRoll", "lle2", "q_llj2", (-0.2, 1.57), Some(11), [0.0, 0.0, -0.02], ROLL),
    row("LHipYaw", "lle3", "q_llj3", (-1.0, 1.0), Some(12), [0.0, 0.0, -0.081854], YAW),
    row("LKneePitch", "lle4", "q_llj4", (0.0, 2.34), Some(13), [-0.014, 0.0, -0.134], PITCH),
    row("LAnklePitch", "lle5", "q_llj5", (-0.87, 0.35), Some(14), [0.0, 0.0, -0.28], PITCH),
    row("LAnkleRoll", "lle6", "q_llj6", (-0.44, 0.44), Some(15), [0.0, 0.00025, -0.012], ROLL),
    row("RHipPitch", "rle1", "q_rlj1", (-1.8, 1.57), Some(10), [0.0, -0.106, 0.0], PITCH),
    row("RHipRoll", "rle2", "q_rlj2", (-1.57, 0.2), Some(17), [0.0, 0.0, -0.02], ROLL),
    row("RHipYaw", "rle3", "q_rlj3", (-1.0, 1.0), Some(18), [0.0, 0.0, -0.081854], YAW),
    row("RKneePitch", "rle4", "q_rlj4", (0.0, 2.34), Some(19), [-0.014, 0.0, -0.134], PITCH),
    row("RAnklePitch", "rle5", "q_rlj5", (-0.87, 0.35), Some(20), [0.0, 0.0, -0.28], PITCH),
    row("RAnkleRoll", "rle6", "q_rlj6", (-0.44, 0.44), Some(21), [0.0, -0.00025, -0.012], ROLL),
];

/// The name of the motor of a joint.
pub(crate) fn motor(joint: usize) -> &'static str {
    TABLE[joint].motor
}

/// The joint of a perceptor.
pub(crate) fn of_perceptor(name: &[u8]) -> Option<usize> {
    TABLE.iter().position(|row| row.perceptor.as_bytes() == name)
}

/// The limits of a joint, rad.
pub(crate) fn limits(joint: usize) -> Limits {
    Limits::new(TABLE[joint].low, TABLE[joint].high)
}

/// Offset and axis of a joint, and the joint that carries it.
pub(crate) fn link(joint: usize) -> ([f64; 3], [f64; 3], Option<usize>) {
    let JointRow { offset, axis, parent, .. } = TABLE[joint];
    (offset, axis, parent)
}

/// The anatomy of a T1 that walks within limits: ahead, to a side, turning.
pub(crate) fn anatomy(walk_x: Limits, walk_y: Limits, walk_turn: Limits) -> Anatomy {
    let joint = |row: &JointRow| Joint {
        name: row.name,
        limits: Limits::new(row.low, row.high),
        parent: row.parent,
        offset: row.offset,
        axis: row.axis,
    };
    // The server shows what lies within 60 degrees of the camera's axis, horizontally and
    // vertically.
    let view = 2.0 * std::f64::consts::FRAC_PI_3;
    Anatomy {
        head_yaw: limits(HEAD_YAW),
        head_pitch: limits(HEAD_PITCH),
        walk_x,
        walk_y,
        walk_turn,
        camera: Some(Camera { horizontal: view, vertical: view, height: STRAIGHT_HEIGHT + 0.42485 }),
        skills: vec![Skill::KickLeft, Skill::KickRight, Skill::StandUp],
        joints: TABLE.iter().map(joint).collect(),
        ..Anatomy::new("booster t1", CYCLE)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_right_side_mirrors_the_left() {
        let still = Limits::symmetric(0.0);
        let anatomy = anatomy(still, still, still);
        for (index, left) in
            anatomy.joints.iter().enumerate().filter(|(_, joint)| joint.name.starts_with('L'))
        {
            let right = anatomy.joint(&left.name.replacen('L', "R", 1)).unwrap();
            assert_eq!(right - index, if index < LEFT_LEG { 4 } else { 6 }, "{}", left.name);
            let (joint, [x, y, z]) = (&anatomy.joints[right], left.offset);
            assert_eq!(joint.offset, [x, -y, z]);
            let Limits { low, high } = left.limits;
            let is_mirrored = left.axis != PITCH;
            assert_eq!(joint.limits, if is_mirrored { Limits::new(-high, -low) } else { left.limits });
        }
    }

    #[test]
    fn every_perceptor_and_motor_has_one_joint() {
        for (index, row) in TABLE.iter().enumerate() {
            assert_eq!(of_perceptor(row.perceptor.as_bytes()), Some(index));
            assert_eq!(TABLE.iter().filter(|other| other.motor == row.motor).count(), 1);
        }
        assert_eq!(of_perceptor(b"q_l4j1"), None);
    }
}
