//! Robots on the soccer server, if the program `rcssservermj` is there. The short form tests one
//! robot where the long form (`MONAS_LONG_TESTS=1`) tests all.
#![allow(clippy::unwrap_used)] // tests

use std::collections::BTreeMap;
use std::process::Stdio;

use monas_rcsssmj::monitor::Command;
use monas_rcsssmj::{Booster, Humanoid, K1};
use monas_robot::{Actuators, BodySite, Percepts, Posture, Robot, conformance};
use narukom::Timestamp;

fn is_long() -> bool {
    std::env::var_os("MONAS_LONG_TESTS").is_some()
}

/// Does the same with every robot, each on a server of its own at the same time; in the short form
/// with the first.
fn with_each(test: fn(&Humanoid)) {
    let count = if is_long() { Humanoid::ALL.len() } else { 1 };
    std::thread::scope(|scope| {
        for robot in &Humanoid::ALL[..count] {
            scope.spawn(move || test(robot));
        }
    });
}

/// A robot with its own walk; none, loudly, without the server.
fn start(robot: &Humanoid) -> Option<Booster> {
    let mut help = std::process::Command::new("rcssservermj");
    help.arg("--help").current_dir(std::env::temp_dir()).stdout(Stdio::null()).stderr(Stdio::null());
    if !help.status().is_ok_and(|status| status.success()) {
        eprintln!("\n!! SKIPPED: no rcssservermj in PATH; `pip install rcsssmj==0.2.1` brings it\n");
        return None;
    }
    let options = [("start_x", "-12"), ("robot", robot.name())];
    let options = BTreeMap::from(options.map(|(name, value)| (name.to_owned(), value.to_owned())));
    Some(monas_rcsssmj::open(&BodySite { options, ..BodySite::default() }).unwrap())
}

/// Runs for a time with a command; returns the odometry: x, y and heading.
fn run(robot: &mut Booster, cycle: &mut u64, seconds: f64, command: &Actuators) -> [f64; 3] {
    let (mut percepts, mut moved) = (Percepts::default(), [0.0; 3]);
    for _ in 0..(seconds * 50.0) as usize {
        *cycle += 1;
        let now = Timestamp::from_nanos(*cycle * 20_000_000);
        percepts.clear_news();
        robot.sense(now, &mut percepts).unwrap();
        robot.act(now, command).unwrap();
        let felt = &percepts.sensors;
        let (sin, cos) = libm::sincos(moved[2]);
        moved[0] += cos * felt.odometry_x - sin * felt.odometry_y;
        moved[1] += sin * felt.odometry_x + cos * felt.odometry_y;
        moved[2] += felt.odometry_turn;
        assert_ne!(felt.posture(), Posture::Fallen, "it has fallen in cycle {cycle}");
    }
    moved
}

fn walks_as_commanded(robot: &Humanoid) {
    let Some(mut robot) = start(robot) else { return };
    let mut cycle = 0;
    let ([x, y, _], heading) = (robot.true_position(), robot.true_heading());
    let felt = run(&mut robot, &mut cycle, 12.0, &Actuators { walk_x: 0.42, ..Actuators::default() });
    let [to_x, to_y, _] = robot.true_position();
    println!("true {:.2} {:.2}, felt {felt:.2?}", to_x - x, to_y - y);
    assert!((3.5..6.0).contains(&(to_x - x)) && (to_y - y).abs() < 1.0, "{} {}", to_x - x, to_y - y);
    assert!((felt[0] - (to_x - x)).abs() < 0.8 && (felt[1] - (to_y - y)).abs() < 0.8, "{felt:?}");
    run(&mut robot, &mut cycle, 3.0, &Actuators::default());
    let before = robot.true_heading();
    let felt = run(&mut robot, &mut cycle, 4.0, &Actuators { walk_turn: 0.45, ..Actuators::default() });
    let turned = robot.true_heading() - before;
    println!("turned {turned:.2} from {heading:.2}, felt {:.2}", felt[2]);
    assert!((0.8..2.4).contains(&turned) && (felt[2] - turned).abs() < 0.15, "{turned} {felt:?}");
}

#[test]
fn robots_walk_ahead_and_turn_as_commanded_and_the_odometry_follows() {
    with_each(walks_as_commanded);
}

#[test]
fn robots_are_bodies_like_any_other() {
    with_each(|robot| {
        let Some(mut robot) = start(robot) else { return };
        conformance::check(&mut robot);
    });
}

#[test]
fn the_server_goes_on_when_a_k1_touches_the_ball() {
    let Some(mut robot) = start(&K1) else { return };
    let (mut cycle, [x, y, _]) = (0, robot.true_position());
    robot.instruct(Command::PlaceBall { at: [x + 1.0, y + 0.1, 0.11], velocity: [-2.0, 0.0, 0.0] });
    run(&mut robot, &mut cycle, 4.0, &Actuators::default());
}

/// The sensor values of a robot in a run with falls and placements, bit for bit.
fn felt(robot: &Humanoid) -> Option<Vec<[u64; 4]>> {
    let mut robot = start(robot)?;
    let (mut percepts, mut felt) = (Percepts::default(), Vec::new());
    let (cycles, placed) = if is_long() { (700, 300) } else { (350, 150) };
    for cycle in 1..=cycles {
        let now = Timestamp::from_nanos(cycle * 20_000_000);
        percepts.clear_news();
        robot.sense(now, &mut percepts).unwrap();
        let [x, y, _] = robot.true_position();
        let sensors = &percepts.sensors;
        felt.push([x, y, sensors.odometry_x, sensors.torso_pitch].map(f64::to_bits));
        if cycle == placed {
            // It drops from a height, in front of a rolling ball.
            let team = "Monas".to_owned();
            robot.instruct(Command::PlaceRobot { team, number: 2, at: [-3.0, 1.0, 0.9], heading: 1.0 });
            robot.instruct(Command::PlaceBall { at: [-2.6, 1.4, 0.11], velocity: [-0.5, -0.3, 0.0] });
        }
        robot.act(now, &Actuators { walk_x: 0.6, walk_turn: 0.3, ..Actuators::default() }).unwrap();
    }
    Some(felt)
}

#[test]
fn two_runs_are_equal_bit_for_bit() {
    with_each(|robot| {
        let (Some(one), Some(other)) = (felt(robot), felt(robot)) else { return };
        let first = one.iter().zip(&other).position(|(one, other)| one != other);
        assert_eq!(first, None, "{}: the first cycle that differs", robot.name());
    });
}
