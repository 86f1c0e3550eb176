//! The Booster T1 of the server.
//!
//! Its anatomy is in the file `t1.urdf`.

use std::sync::LazyLock;

use monas_kinematics::LinkTree;
use nalgebra::Point3;

use crate::humanoid::{Humanoid, read};

/// From the ankle's roll joint down to the sole: half the height of the foot's box, below its
/// middle.
const SOLE_HEIGHT: f64 = 0.03;

/// The Booster T1: 23 joints, 1.2 m, 32 kg.
pub static T1: Humanoid = Humanoid {
    name: "T1",
    anatomy: LazyLock::new(|| read("t1.urdf", include_str!("../t1.urdf"))),
    links: LazyLock::new(|| LinkTree::new(&T1.anatomy)),
    waist: Some(10),
    left_leg: 11,
    right_leg: 17,
    straight_height: 0.6735,
    placed_height: 0.6735,
    sole: SOLE_HEIGHT,
    corners: [
        Point3::new(0.1215, 0.05, -SOLE_HEIGHT),
        Point3::new(0.1215, -0.05, -SOLE_HEIGHT),
        Point3::new(-0.1015, 0.05, -SOLE_HEIGHT),
        Point3::new(-0.1015, -0.05, -SOLE_HEIGHT),
    ],
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
