//! The Booster K1 of the server.
//!
//! Offsets, axes, ranges, masses and their places are those of the file
//! `resources/robots/K1/robot.xml` of rcsssmj 0.2.1.

use nalgebra::{Point3, Vector3};

use crate::humanoid::{Humanoid, JointRow, Link, PITCH, ROLL, YAW, row};

/// From the axes of the ankle down to the sole: the middle of the foot's box and half its height.
const SOLE: f64 = 0.038;

/// The Booster K1: 22 joints, 1 m, 20 kg. It has no waist.
pub static K1: Humanoid = Humanoid {
    name: "K1",
    full_name: "booster k1",
    joints: &TABLE,
    torso: (6.5, [-0.0043392, -0.00065534, 0.065686]),
    links: &LINKS,
    waist: None,
    left_leg: 10,
    right_leg: 16,
    straight_height: 0.551_69,
    placed_height: 1.0,
    sole: SOLE,
    corners: [
        Point3::new(0.116, 0.035, -SOLE),
        Point3::new(0.116, -0.035, -SOLE),
        Point3::new(-0.064, 0.035, -SOLE),
        Point3::new(-0.064, -0.035, -SOLE),
    ],
    camera: Vector3::new(0.06, 0.0, 0.08),
    hips: Point3::new(0.0, 0.0, -0.077),
    beside: 0.096,
    thigh: 0.191_510_4,
    shank: 0.245_190_1,
    knee_at_straight: 0.011_247_2,
    leg_gains: (200.0, 5.0),
    // With a damping of 1 the light forearms vibrate in the steps of the server's physics, 5 ms.
    other_gains: (20.0, 0.4),
    slack: 0.4,
    walk: include_str!("../walk_k1.toml"),
    kick: include_str!("../kick_k1.toml"),
};

#[rustfmt::skip]
static TABLE: [JointRow; 22] = [
    row("HeadYaw", "he1", "q_hj1", (-1.0, 1.0), None, [0.0056, 0.0, 0.2149], YAW),
    row("HeadPitch", "he2", "q_hj2", (-0.349, 0.855), Some(0), [0.0, 0.0, 0.033], PITCH),
    row("LShoulderPitch", "lae1", "q_laj1", (-3.316, 1.22), None, [0.0, 0.077, 0.1845], PITCH),
    row("LShoulderRoll", "lae2", "q_laj2", (-1.74, 1.57), Some(2), [0.0025, 0.068, -0.0135], ROLL),
    row("LElbowPitch", "lae3", "q_laj3", (-2.27, 2.27), Some(3), [0.0, 0.044428, 0.0], PITCH),
    row("LElbowYaw", "lae4", "q_laj4", (-2.44, 0.0), Some(4), [0.0, 0.1215, 0.0], YAW),
    row("RShoulderPitch", "rae1", "q_raj1", (-3.316, 1.22), None, [0.0, -0.077, 0.1845], PITCH),
    row("RShoulderRoll", "rae2", "q_raj2", (-1.57, 1.74), Some(6), [0.0025, -0.068, -0.0135], ROLL),
    row("RElbowPitch", "rae3", "q_raj3", (-2.27, 2.27), Some(7), [0.0, -0.044428, 0.0], PITCH),
    row("RElbowYaw", "rae4", "q_raj4", (0.0, 2.44), Some(8), [0.0, -0.1215, 0.0], YAW),
    row("LHipPitch", "lle1", "q_llj1", (-3.0, 2.21), None, [0.0, 0.096, -0.077], PITCH),
    row("LHipRoll", "lle2", "q_llj2", (-0.4, 1.57), Some(10), [0.0, 0.0, -0.026], ROLL),
    row("LHipYaw", "lle3", "q_llj3", (-1.0, 1.0), Some(11), [0.012, 0.0, -0.0485], YAW),
    row("LKneePitch", "lle4", "q_llj4", (0.0, 2.23), Some(12), [-0.014, 0.0, -0.117], PITCH),
    row("LAnklePitch", "lle5", "q_llj5", (-0.87, 0.345), Some(13), [0.00019706, 0.0002, -0.24519], PITCH),
    row("LAnkleRoll", "lle6", "q_llj6", (-0.345, 0.345), Some(14), [0.0, 0.0, 0.0], ROLL),
    row("RHipPitch", "rle1", "q_rlj1", (-3.0, 2.21), None, [0.0, -0.096, -0.077], PITCH),
    row("RHipRoll", "rle2", "q_rlj2", (-1.57, 0.4), Some(16), [0.0, 0.0, -0.026], ROLL),
    row("RHipYaw", "rle3", "q_rlj3", (-1.0, 1.0), Some(17), [0.012, 0.0, -0.0485], YAW),
    row("RKneePitch", "rle4", "q_rlj4", (0.0, 2.23), Some(18), [-0.014, 0.0, -0.117], PITCH),
    row("RAnklePitch", "rle5", "q_rlj5", (-0.87, 0.345), Some(19), [0.00019706, -0.0002, -0.24519], PITCH),
    row("RAnkleRoll", "rle6", "q_rlj6", (-0.345, 0.345), Some(20), [0.0, 0.0, 0.0], ROLL),
];

#[rustfmt::skip]
static LINKS: [Link; 22] = [
    (0.3, [-0.00069503, -0.00038527, 0.031688]),
    (0.7, [0.011042, -0.00092871, 0.080698]),
    (0.5, [-0.002701, 0.062383, -0.011965]),
    (0.09, [0.01729, 0.018221, -4.329e-05]),
    (0.8, [-0.0003979, 0.072617, -0.00066218]),
    (0.19, [-0.0015751, 0.084637, 0.0087033]),
    (0.5, [-0.0026302, -0.06251, -0.01199]),
    (0.09, [0.017229, -0.018428, 4.3784e-05]),
    (0.8, [-0.00039919, -0.072601, -0.00065629]),
    (0.19, [-0.0015177, -0.084536, 0.0086733]),
    (0.69, [-0.010093, -0.0019934, -0.024713]),
    (0.13, [0.023585, 4.9e-05, -0.024996]),
    (1.65, [-0.0084744, -0.0040494, -0.087906]),
    (1.5, [-0.00081083, 0.0031459, -0.10922]),
    (0.039, [0.0, 0.0, 0.0]),
    (0.494, [0.011662, 0.000244, -0.014364]),
    (0.69, [-0.010065, 0.0020086, -0.024739]),
    (0.13, [0.023585, 4.9e-05, -0.024996]),
    (1.65, [-0.008475, 0.0040392, -0.087906]),
    (1.5, [-0.000805, -0.003146, -0.109215]),
    (0.039, [0.0, 0.0, 0.0]),
    (0.494, [0.011662, -0.000244, -0.014364]),
];
