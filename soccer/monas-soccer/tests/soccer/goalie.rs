//! Integration tests of the goalie against shots.

use monas_robot::{Posture, Skill};
use monas_soccer as _;
use nalgebra::{Isometry2, Point2, Vector2};

use crate::toy::Shared;

/// A goalie in its position, and a resting ball that is then shot so that it crosses the keeper's
/// lateral axis `offset` metres to its left.
fn shoot(offset: f64) -> (Shared, Vec<Skill>, Option<f64>) {
    let keeper = Isometry2::new(Vector2::new(-2.65, 0.0), 0.0);
    let world = Shared::new(1, keeper, Point2::new(-0.5, 0.0));
    let mut simulation = world.play("goalie.xml");
    world.until(&mut simulation, 3.0, |_| false);
    let keeper = world.lock().field_from_robot;
    let aim = keeper * Point2::new(0.0, offset);
    {
        let mut world = world.lock();
        world.ball_velocity = (aim - world.ball).normalize() * 1.8;
    }
    world.until(&mut simulation, 5.0, |_| false);
    let performed = world.lock().performed.clone();
    let back = world.until(&mut simulation, 25.0, |world| {
        let position = world.field_from_robot.translation.vector;
        world.posture == Posture::Standing && position.y.abs() < 0.7 && (-3.0..=-2.4).contains(&position.x)
    });
    (world, performed, back)
}

#[test]
fn it_dives_to_the_side_of_the_shot_and_returns() {
    for (offset, skills) in [
        (0.22, [Skill::FallLeft, Skill::DiveLeft]),
        (0.45, [Skill::DiveLeft, Skill::DiveLeft]),
        (-0.22, [Skill::FallRight, Skill::DiveRight]),
        (-0.45, [Skill::DiveRight, Skill::DiveRight]),
    ] {
        let (world, performed, back) = shoot(offset);
        assert!(performed.first().is_some_and(|skill| skills.contains(skill)), "{offset}: {performed:?}");
        assert!(back.is_some(), "{offset}: it ends at {}", world.lock().field_from_robot);
        assert_eq!(
            world.lock().performed.get(1),
            Some(&Skill::StandUp),
            "it got up once: {:?}",
            world.lock().performed
        );
    }
}

#[test]
fn a_shot_at_its_middle_is_met_standing() {
    assert_eq!(shoot(0.0).1, []);
}

#[test]
fn it_follows_the_ball_between_its_posts() {
    let world = Shared::new(1, Isometry2::new(Vector2::new(-2.65, 0.0), 0.0), Point2::new(-1.8, 1.0));
    let mut simulation = world.play("goalie.xml");
    let on_side = world.until(&mut simulation, 10.0, |world| world.field_from_robot.translation.y > 0.25);
    assert!(on_side.is_some(), "{}", world.lock().field_from_robot);
    assert!(world.lock().performed.is_empty());
}
