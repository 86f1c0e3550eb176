//! The Booster T1 of the server.
//!
//! Offsets, axes, ranges, masses and their places are those of the file
//! `resources/robots/T1/robot.xml` of rcsssmj 0.2.1.

use nalgebra::{Point3, Vector3};

use crate::humanoid::{Humanoid, JOINTS, JointRow, Link, PITCH, ROLL, YAW, row};

/// From the ankle's roll joint down to the sole: half the height of the foot's box, below its
/// middle.
const SOLE: f64 = 0.03;

/// The Booster T1: 23 joints, 1.2 m, 32 kg.
pub static T1: Humanoid = Humanoid {
    name: "T1",
    full_name: "booster t1",
    joints: &TABLE,
    torso: (11.7, [0.055_136_5, -1.4e-6, 0.105_062]),
    links: &LINKS,
    waist: Some(10),
    left_leg: 11,
    right_leg: 17,
    straight_height: 0.6735,
    placed_height: 0.6735,
    sole: SOLE,
    corners: [
        Point3::new(0.1215, 0.05, -SOLE),
        Point3::new(0.1215, -0.05, -SOLE),
        Point3::new(-0.1015, 0.05, -SOLE),
        Point3::new(-0.1015, -0.05, -SOLE),
    ],
    camera: Vector3::new(0.05, 0.0, 0.12),
    hips: Point3::new(0.0625, 0.0, -0.1155),
    beside: 0.106,
    thigh: 0.236_269_1,
    shank: 0.28,
    knee_at_straight: 0.059_289_2,
    leg_gains: (200.0, 5.0),
    other_gains: (20.0, 1.0),
    slack: 2.0,
    walk: include_str!("../walk.toml"),
    kick: include_str!("../kick.toml"),
};

#[rustfmt::skip]
static TABLE: [JointRow; JOINTS] = [
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

#[rustfmt::skip]
static LINKS: [Link; JOINTS] = [
    (0.44391, [-0.000508, -0.001403, 0.057432]),
    (0.631019, [0.007802, 0.001262, 0.098631]),
    (0.53, [-0.000677, 0.044974, 0.0]),
    (0.16, [0.003862, 0.037976, 0.0]),
    (1.02, [0.0, 0.085353, -9.9e-05]),
    (0.327214, [-0.000108, 0.109573, 0.000591]),
    (0.53, [-0.000677, -0.044974, 0.0]),
    (0.16, [0.003862, -0.037976, 0.0]),
    (1.02, [0.0, -0.085353, -9.9e-05]),
    (0.327214, [-0.000108, -0.109573, 0.000591]),
    (2.581, [0.002284, 3e-06, 0.007301]),
    (1.021, [0.000534, -0.007296, -0.018083]),
    (0.385, [0.001101, 2.4e-05, -0.05375]),
    (2.166, [-0.007233, 0.000206, -0.089184]),
    (1.73, [-0.006012, 0.000259, -0.124318]),
    (0.073, [-0.003722, 0.0, -0.007981]),
    (0.685, [-0.000249, 0.0, -0.00914]),
    (1.021, [0.000534, 0.007514, -0.018082]),
    (0.385, [0.001099, 2.4e-05, -0.053748]),
    (2.17, [-0.007191, -0.000149, -0.08922]),
    (1.79, [-0.005741, -0.000541, -0.122602]),
    (0.073, [-0.003722, 0.0, -0.007981]),
    (0.685, [-0.000248, 0.0, -0.00914]),
];
