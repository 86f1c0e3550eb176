//! The kinematics of the robots against the physics model of the server, if Python has it.
#![allow(clippy::unwrap_used)] // tests

use std::fmt::Write as _;
use std::io::Write as _;
use std::process::{Command, Stdio};

use monas_rcsssmj::kinematics::Foot;
use monas_rcsssmj::{Humanoid, JOINTS, JointValues};
use monas_robot::Limits;
use nalgebra::Point3;
use rand_core::{Rng, SeedableRng};
use rand_pcg::Pcg32;

/// Random postures, and the number of points of each.
const POSTURES: usize = 500;
const POINTS: usize = 5;
/// The points.
const NAMES: [&str; POINTS] = ["left sole", "right sole", "camera", "left elbow", "centre of mass"];
/// The greatest error, m, of each.
const BOUND: f64 = 1e-7;
/// The joint before the left lower arm.
const LEFT_ELBOW: usize = 5;

/// The points according to the server's physics; none, with a note, without its model.
fn truth(robot: &Humanoid, postures: &[JointValues]) -> Option<Vec<[Point3<f64>; POINTS]>> {
    let mut text = String::new();
    for angles in postures {
        angles[..robot.joint_count()].iter().for_each(|angle| write!(text, "{angle} ").unwrap());
        text.push('\n');
    }
    let mut command = Command::new("python3");
    command.args(["-c", include_str!("poses.py"), robot.name()]).current_dir(std::env::temp_dir());
    let process = command.stdin(Stdio::piped()).stdout(Stdio::piped()).stderr(Stdio::null()).spawn();
    let answer = process.and_then(|mut process| {
        // A program that ends at once, without the packages, does not read.
        let _ = process.stdin.take().map(|mut input| input.write_all(text.as_bytes()));
        process.wait_with_output()
    });
    let Some(answer) = answer.ok().filter(|answer| answer.status.success()) else {
        eprintln!("\n!! SKIPPED: Python has no rcsssmj; `pip install rcsssmj==0.2.1` brings it\n");
        return None;
    };
    let line = |line: &str| {
        let numbers: Vec<f64> = line.split(' ').map(|number| number.parse().unwrap()).collect();
        std::array::from_fn(|point| Point3::from_slice(&numbers[3 * point..3 * point + 3]))
    };
    Some(String::from_utf8(answer.stdout).unwrap().lines().map(line).collect())
}

#[test]
fn points_of_the_body_are_where_the_servers_physics_has_them() {
    for robot in Humanoid::ALL {
        compare(robot);
    }
}

fn compare(robot: &Humanoid) {
    let mut chance = Pcg32::seed_from_u64(1);
    let posture = |_| {
        std::array::from_fn::<f64, JOINTS, _>(|joint| {
            let share = f64::from(chance.next_u32()) / f64::from(u32::MAX);
            let has_joint = joint < robot.joint_count();
            let limits = if has_joint { robot.limits(joint) } else { Limits::symmetric(0.0) };
            limits.low + share * (limits.high - limits.low)
        })
    };
    let postures: Vec<JointValues> = (0..POSTURES).map(posture).collect();
    let Some(truth) = truth(robot, &postures) else { return };
    assert_eq!(truth.len(), POSTURES);
    println!("{}:\n| point | mean error, µm | greatest error, µm |\n|---|---|---|", robot.name());
    for (point, name) in NAMES.into_iter().enumerate() {
        let errors = postures.iter().zip(&truth).map(|(angles, truth)| {
            let own = [
                robot.sole(Foot::Left, angles),
                robot.sole(Foot::Right, angles),
                robot.camera(angles),
                robot.joint_origin(LEFT_ELBOW, angles),
                robot.centre_of_mass(angles),
            ];
            (own[point] - truth[point]).norm()
        });
        let (sum, greatest) = errors.fold((0.0, 0.0_f64), |(sum, max), error| (sum + error, max.max(error)));
        println!("| {name} | {:.4} | {:.4} |", 1e6 * sum / POSTURES as f64, 1e6 * greatest);
        assert!(greatest < BOUND, "{} {name}: {greatest} m", robot.name());
    }
}
