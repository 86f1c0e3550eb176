//! Bodies and ball: walking, kicking, rolling, falling and diving.
#![allow(clippy::unwrap_used)] // tests may panic

use crate::common::{clear_field, events, play, playing, run, world};
use monas_sim::{
    BodyPhase, Command, Direction, ErrorKind, EventKind, Motion, Physics, Pose, Senses, Setup, Side,
    Sighting, SimulatedWorld, Vector,
};

#[test]
fn a_ball_rolls_as_far_as_documented() {
    let mut world = playing(1);
    clear_field(&mut world, &[]);
    world.place_ball(Vector::new(-2.0, 0.0), Vector::new(1.0, 0.0)).unwrap();
    run(&mut world, 1.0);
    let deceleration = Physics::default().ball_deceleration;
    assert!((world.ball().velocity.x - (1.0 - deceleration)).abs() < 0.01, "{:?}", world.ball());
    run(&mut world, 4.0);
    let distance = world.ball().position.x + 2.0;
    assert!((distance - 0.5 / deceleration).abs() < 0.03, "{distance}");
    assert_eq!(world.ball().velocity, Vector::zeros());
}

/// Kicks a ball that lies at `ball` in front of the robot; returns its velocity after the strike.
fn kick(seed: u64, ball: Vector, foot: Side) -> Vector {
    kick_with(seed, ball, Command::new(Motion::Kick(foot)))
}

fn kick_with(seed: u64, ball: Vector, command: Command) -> Vector {
    let mut world = playing(seed);
    clear_field(&mut world, &[1]);
    world.place_robot(1, Pose::default()).unwrap();
    world.place_ball(ball, Vector::zeros()).unwrap();
    world.command(1, command).unwrap();
    run(&mut world, 0.82);
    world.ball().velocity
}

#[test]
fn kicks_have_the_documented_speed_direction_and_misses() {
    let physics = Physics::default();
    let kicks: Vec<Vector> = (0..300).map(|seed| kick(seed, Vector::new(0.16, 0.05), Side::Left)).collect();
    let struck: Vec<&Vector> = kicks.iter().filter(|velocity| velocity.norm() > 0.5).collect();
    let misses = kicks.len() - struck.len();
    assert!((1..=25).contains(&misses), "{misses}");
    let mean =
        |value: &dyn Fn(&Vector) -> f64| struck.iter().map(|v| value(v)).sum::<f64>() / struck.len() as f64;
    let speed = mean(&|v| v.norm());
    assert!((speed - physics.kick_speed).abs() < 0.06, "{speed}");
    let direction = mean(&|v| libm::atan2(v.y, v.x));
    let spread = mean(&|v| libm::pow(libm::atan2(v.y, v.x) - direction, 2.0)).sqrt();
    assert!(direction.abs() < 0.03, "{direction}");
    assert!((spread - physics.kick_direction_noise).abs() < 0.02, "{spread}");
}

#[test]
fn a_kick_is_as_soft_as_it_is_wanted_and_no_harder_than_the_body_can() {
    let speed = |seed, ball_speed| {
        let command = Command { ball_speed, ..Command::new(Motion::Kick(Side::Left)) };
        kick_with(seed, Vector::new(0.16, 0.05), command).norm()
    };
    for seed in 0..20 {
        let hardest = speed(seed, 0.0);
        assert_eq!(speed(seed, 50.0), hardest);
        // The noise of the speed is a part of it.
        assert!((speed(seed, 0.5) - 0.25 * hardest).abs() < 0.01, "seed {seed}");
    }
}

#[test]
fn the_wrong_foot_or_a_ball_out_of_reach_is_not_kicked() {
    assert_eq!(kick(1, Vector::new(0.16, -0.07), Side::Left).norm(), 0.0);
    assert!(kick(1, Vector::new(0.16, -0.07), Side::Right).norm() > 1.0);
    assert_eq!(kick(1, Vector::new(0.23, 0.05), Side::Left).norm(), 0.0);
}

#[test]
fn a_robot_walks_no_faster_than_documented() {
    let physics =
        Physics { gait_noise: 0.0, gait_turn_noise: 0.0, fall_rate_walking: 0.0, ..Physics::default() };
    let setup = Setup { physics, ..Setup::three_against_three(1) };
    let mut world = play(SimulatedWorld::new(setup).unwrap());
    clear_field(&mut world, &[1]);
    world.place_robot(1, Pose::new(-2.0, -1.0, 0.0)).unwrap();
    world.command(1, Command::walk(5.0, 0.0, 0.0)).unwrap();
    run(&mut world, 1.0);
    let start = world.robots()[1].pose.position.x;
    run(&mut world, 5.0);
    let distance = world.robots()[1].pose.position.x - start;
    assert!((distance - 5.0 * world.physics().walk_forward).abs() < 0.01, "{distance}");
}

#[test]
fn robots_do_not_leave_the_carpet() {
    let mut world = playing(2);
    clear_field(&mut world, &[1]);
    world.place_robot(1, Pose::new(-2.0, -1.9, -1.5)).unwrap();
    for _ in 0..40 {
        world.command(1, Command::walk(0.3, 0.0, 0.0)).unwrap();
        run(&mut world, 0.5);
    }
    let y = world.robots()[1].pose.position.y;
    assert!((-2.6..-2.4).contains(&y), "{y}");
    let falls = world.statistics().robot(1).unwrap().falls;
    assert!(falls <= 1, "the edge is no blow: {falls} falls");
}

#[test]
fn two_robots_that_run_into_each_other_fall() {
    let mut fallen = 0;
    for seed in 0..20 {
        let mut world = playing(seed);
        clear_field(&mut world, &[1, 4]);
        world.place_robot(1, Pose::new(-0.8, -1.0, 0.0)).unwrap();
        world.place_robot(4, Pose::new(0.8, -1.0, std::f64::consts::PI)).unwrap();
        for robot in [1, 4] {
            world.command(robot, Command::walk(0.3, 0.0, 0.0)).unwrap();
        }
        run(&mut world, 4.0);
        fallen += events(&world, |kind| matches!(kind, EventKind::Fall { .. })).len();
    }
    assert!(fallen >= 20, "{fallen}");
}

#[test]
fn a_fallen_robot_stands_up_on_command() {
    let mut world = playing(3);
    clear_field(&mut world, &[0]);
    world.place_robot(0, Pose::new(-2.8, 0.0, 0.0)).unwrap();
    world.command(0, Command::new(Motion::Dive(Side::Left))).unwrap();
    run(&mut world, 2.0);
    assert_eq!(world.robots()[0].phase, BodyPhase::Fallen(Direction::Left));
    let mut senses = Senses::default();
    world.sense(0, &mut senses).unwrap();
    assert!(senses.is_fallen() && senses.torso_roll < -1.4 && senses.sightings.is_empty());
    for _ in 0..10 {
        world.command(0, Command::new(Motion::StandUp)).unwrap();
        run(&mut world, 4.0);
    }
    assert_eq!(world.robots()[0].phase, BodyPhase::Standing);
    let tally = *world.statistics().robot(0).unwrap();
    assert_eq!((tally.actions, tally.falls, tally.returns), (1, 0, 1));
}

#[test]
fn a_dive_stops_a_ball_that_would_pass() {
    let goal_with = |motion| {
        let mut world = playing(5);
        clear_field(&mut world, &[0]);
        world.place_robot(0, Pose::new(-2.85, 0.0, 0.0)).unwrap();
        world.place_ball(Vector::new(-1.2, 0.4), Vector::new(-2.0, 0.0)).unwrap();
        world.command(0, Command::new(motion)).unwrap();
        run(&mut world, 2.0);
        assert_eq!(
            world.statistics().robot(0).unwrap().actions_to_ball,
            u32::from(motion == Motion::Dive(Side::Left))
        );
        world.referee().score()[1] == 1
    };
    assert!(goal_with(Motion::Stand));
    assert!(!goal_with(Motion::Dive(Side::Left)));
    assert!(goal_with(Motion::Dive(Side::Right)));
}

#[test]
fn senses_follow_the_body() {
    let mut world = playing(6);
    clear_field(&mut world, &[1]);
    world.place_robot(1, Pose::new(-2.0, 0.0, 0.0)).unwrap();
    world.place_ball(Vector::new(-1.0, 0.0), Vector::zeros()).unwrap();
    world.command(1, Command { head_yaw: 0.2, ..Command::walk(0.2, 0.0, 0.3) }).unwrap();
    let mut senses = Senses::default();
    world.sense(1, &mut senses).unwrap();
    let (mut odometry, mut pictures, mut balls) = (Pose::default(), 0, 0);
    let mut turn = 0.0;
    let start = world.robots()[1].pose;
    for _ in 0..100 {
        world.step();
        world.sense(1, &mut senses).unwrap();
        odometry = odometry.compose(&senses.odometry);
        pictures += u32::from(senses.new_picture);
        assert!(senses.new_picture || senses.sightings.is_empty());
        balls += senses.sightings.iter().filter(|s| matches!(s, Sighting::Ball(_))).count();
        turn += senses.gyro[2] * monas_sim::STEP;
    }
    let end = world.robots()[1].pose;
    assert!((start.compose(&odometry).position - end.position).norm() < 0.05);
    assert!((turn - end.heading).abs() < 0.05, "{turn} {}", end.heading);
    assert_eq!(pictures, 30);
    assert!(balls > 15, "{balls}");
    assert!((senses.head_yaw - 0.2).abs() < 1e-9);
    assert_eq!(senses.phase, BodyPhase::Walking);
    assert!(senses.support.is_some());
}

#[test]
fn buttons_are_felt() {
    let mut world = world(7);
    let mut senses = Senses::default();
    world.press_chest_button(2, true).unwrap();
    world.sense(2, &mut senses).unwrap();
    assert!(senses.buttons.chest);
    world.press_chest_button(2, false).unwrap();
    world.sense(2, &mut senses).unwrap();
    assert!(!senses.buttons.chest);
}

#[test]
fn wrong_calls_are_answered() {
    let mut world = world(8);
    let robots = world.robots().len();
    let mut senses = Senses::default();
    let kind = |result: Result<(), monas_sim::Error>| result.unwrap_err().kind();
    assert_eq!(kind(world.command(robots, Command::default())), ErrorKind::UnknownRobot);
    assert_eq!(kind(world.sense(robots, &mut senses)), ErrorKind::UnknownRobot);
    assert_eq!(kind(world.announcement(robots).map(|_| ())), ErrorKind::UnknownRobot);
    assert_eq!(kind(world.command(0, Command::walk(f64::NAN, 0.0, 0.0))), ErrorKind::OutOfRange);
    assert_eq!(kind(world.place_ball(Vector::new(f64::NAN, 0.0), Vector::zeros())), ErrorKind::OutOfRange);
    assert_eq!(kind(world.place_ball(Vector::new(9.0, 0.0), Vector::zeros())), ErrorKind::OutOfRange);
    assert_eq!(kind(world.place_robot(0, Pose::new(99.0, 0.0, 0.0))), ErrorKind::OutOfRange);
}

#[test]
fn walls_keep_the_ball_in_but_not_out_of_the_goal() {
    let mut setup = Setup::three_against_three(9);
    setup.field.walls = 1.0;
    let mut world = play(SimulatedWorld::new(setup).unwrap());
    clear_field(&mut world, &[]);
    world.place_ball(Vector::new(0.0, 0.0), Vector::new(2.0, 3.0)).unwrap();
    run(&mut world, 5.0);
    assert!(world.field().contains(world.ball().position), "{:?}", world.ball());
    assert!(events(&world, |kind| matches!(kind, EventKind::ThrowIn { .. })).is_empty());
    crate::common::roll_into_goal(&mut world, 1.0);
    assert_eq!(world.referee().score(), [1, 0]);
}
