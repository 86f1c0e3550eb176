//! Integration tests of the attacker, alone with a ball: chart, activities and functionalities.

use monas_robot::{GamePhase, Skill};
use monas_soccer as _;
use nalgebra::{Isometry2, Point2, Vector2};

use crate::toy::{Shared, World};

fn at(x: f64, y: f64, heading: f64) -> Isometry2<f64> {
    Isometry2::new(Vector2::new(x, y), heading)
}

fn is_goal(world: &World) -> bool {
    world.ball.x > 3.0 && world.ball.y.abs() < 0.7
}

#[test]
fn it_scores_wherever_robot_and_ball_are() {
    let cases = [
        (at(-1.0, 0.0, 0.0), Point2::new(0.0, 0.0)),
        (at(1.0, 0.1, 0.0), Point2::new(0.0, 0.0)),
        (at(0.0, 1.5, 3.0), Point2::new(1.0, -1.2)),
        (at(2.5, 0.0, 0.0), Point2::new(-1.0, 1.0)),
    ];
    for (robot, ball) in cases {
        let world = Shared::new(2, robot, ball);
        let mut simulation = world.play("attacker.xml");
        let scored = world.until(&mut simulation, 90.0, is_goal);
        let kicks = world.lock().performed.clone();
        assert!(scored.is_some(), "from {robot} with the ball at {ball}: {kicks:?}");
        assert!(kicks.iter().all(|skill| matches!(skill, Skill::KickLeft | Skill::KickRight)), "{kicks:?}");
        assert!(kicks.len() <= 6, "it took {} kicks", kicks.len());
    }
}

#[test]
fn before_ready_and_outside_play_it_does_not_move() {
    for phase in [GamePhase::Initial, GamePhase::Set, GamePhase::Finished] {
        let world = Shared::new(2, at(-1.0, 0.0, 0.0), Point2::origin());
        world.lock().phase = phase;
        let mut simulation = world.play("attacker.xml");
        assert_eq!(
            world.until(&mut simulation, 5.0, |world| world.field_from_robot != at(-1.0, 0.0, 0.0)),
            None
        );
        let statistics = simulation.statistics();
        assert_eq!(statistics.calls("robot", "WalkToKickOff"), 0, "{phase:?}");
        assert_eq!(statistics.calls("robot", "WalkTowardsBall"), 0, "{phase:?}");
        assert!(statistics.calls("robot", "MotionController") >= 49, "{phase:?}");
    }
}

#[test]
fn in_ready_it_walks_to_its_place_and_stands_there() {
    let world = Shared::new(2, at(-2.0, 1.0, 0.0), Point2::origin());
    world.lock().phase = GamePhase::Ready;
    let mut simulation = world.play("attacker.xml");
    world.until(&mut simulation, 20.0, |_| false);
    let position = world.lock().field_from_robot;
    // outside the centre circle: the others kick off
    assert!((position.translation.vector - Vector2::new(-0.81, 0.0)).norm() < 0.15, "{position}");
    world.until(&mut simulation, 21.0, |_| false);
    assert_eq!(world.lock().field_from_robot, position);
}

#[test]
fn it_stops_when_play_does() {
    let world = Shared::new(2, at(-2.0, 0.0, 0.0), Point2::new(2.0, 0.0));
    let mut simulation = world.play("attacker.xml");
    let start = world.lock().field_from_robot;
    assert!(world.until(&mut simulation, 5.0, |world| world.field_from_robot.translation.x > -1.5).is_some());
    world.lock().phase = GamePhase::Set;
    world.until(&mut simulation, 6.0, |_| false);
    let stopped = world.lock().field_from_robot;
    world.until(&mut simulation, 9.0, |_| false);
    assert_ne!(start, stopped);
    assert_eq!(stopped, world.lock().field_from_robot);
}
