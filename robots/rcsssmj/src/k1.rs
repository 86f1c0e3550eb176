//! The Booster K1 of the server.
//!
//! Its anatomy is in the file `k1.urdf`.

use std::sync::LazyLock;

use monas_kinematics::LinkTree;
use nalgebra::Point3;

use crate::humanoid::{Humanoid, read};

/// From the axes of the ankle down to the sole: the middle of the foot's box and half its height.
const SOLE_HEIGHT: f64 = 0.038;

/// The Booster K1: 22 joints, 1 m, 20 kg. It has no waist.
pub static K1: Humanoid = Humanoid {
    name: "K1",
    anatomy: LazyLock::new(|| read("k1.urdf", include_str!("../k1.urdf"))),
    links: LazyLock::new(|| LinkTree::new(&K1.anatomy)),
    waist: None,
    left_leg: 10,
    right_leg: 16,
    straight_height: 0.551_69,
    placed_height: 1.0,
    sole: SOLE_HEIGHT,
    corners: [
        Point3::new(0.116, 0.035, -SOLE_HEIGHT),
        Point3::new(0.116, -0.035, -SOLE_HEIGHT),
        Point3::new(-0.064, 0.035, -SOLE_HEIGHT),
        Point3::new(-0.064, -0.035, -SOLE_HEIGHT),
    ],
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
