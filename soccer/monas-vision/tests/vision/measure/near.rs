//! Views of robots that are near the camera, most of them cut off by an edge of the image.

use monas_vision::Jersey;
use monas_vision::render::{FieldMarkings, RobotFigure, Scene};
use nalgebra::{Isometry2, Point2, Vector2};
use rand_core::Rng;

use super::{Random, Sequence, View};

/// A view with one or two robots 0.4 to 1.5 m away. In half of the views a goal is in the direction
/// of the camera, and in half of them there is a ball.
pub(super) fn choose(random: &mut Random, sequence: &Sequence) -> View {
    let (head, _) = random.head();
    let position = Vector2::new(random.uniform(-2.2, 2.2), random.uniform(-1.6, 1.6));
    let mut turn = random.uniform(-3.1, 3.1);
    if random.uniform(0.0, 1.0) < 0.5 {
        let goal = Vector2::new(if position.x < 0.0 { 3.0 } else { -3.0 }, random.uniform(-0.9, 0.9));
        let to_goal = goal - position;
        turn = libm::atan2(to_goal.y, to_goal.x) - head.yaw + random.uniform(-0.3, 0.3);
    }
    let field_from_robot = Isometry2::new(position, turn);
    let mut position_between = |near: f64, far: f64| {
        let (sin, cos) = libm::sincos(head.yaw + random.uniform(-0.5, 0.5));
        let distance = random.uniform(near, far);
        field_from_robot * Point2::new(distance * cos, distance * sin)
    };
    let positions = [position_between(0.4, 1.5), position_between(0.4, 1.5)];
    let ball = position_between(0.3, 2.5);
    let count = if random.uniform(0.0, 1.0) < 0.7 { 1 } else { 2 };
    let mut robots: Vec<RobotFigure> = Vec::new();
    for position in positions.into_iter().take(count) {
        let jersey = match random.uniform(0.0, 3.0) as u32 {
            0 => Jersey::Blue,
            1 => Jersey::Red,
            _ => Jersey::Unknown,
        };
        let (heading, lies) = (random.uniform(-3.1, 3.1), random.uniform(0.0, 1.0) < 0.1);
        let is_beside = |other: &RobotFigure| (other.position - position).norm() < 0.3;
        if !robots.iter().any(is_beside) {
            robots.push(RobotFigure { position, heading, jersey, lies });
        }
    }
    let is_free = robots.iter().all(|robot| (robot.position - ball).norm() > 0.35);
    let has_ball = random.uniform(0.0, 1.0) < 0.5 && is_free && ball.x.abs() < 3.4 && ball.y.abs() < 2.4;
    let scene = Scene {
        markings: FieldMarkings::default(),
        objects: sequence.objects,
        ball: has_ball.then_some(ball),
        robots,
        variant: random.0.next_u64(),
    };
    View { scene, field_from_robot, head }
}
