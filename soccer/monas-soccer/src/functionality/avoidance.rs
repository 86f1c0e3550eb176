//! Avoids obstacles and areas that the rules forbid.

use nalgebra::{Isometry2, Point2, Vector2};

use super::field::FieldModel;
use super::geometry::distance_to_segment;
use super::walk::Walk;

/// Least distance between the centres of two robots, metres: two radii and a margin.
pub const CLEARANCE: f64 = 0.45;
/// Distance beyond which robots are not yet obstacles, metres.
const LOOK_AHEAD: f64 = 1.3;

/// The next point of a path to `position` that avoids the nearest blocking obstacle: beside the
/// obstacle, on the side nearer to the straight line; `position` itself if the line is free. All in
/// the robot's frame, the robot at the origin.
pub fn avoid(position: Point2<f64>, obstacles: &[Point2<f64>]) -> Point2<f64> {
    let blocking = obstacles.iter().filter(|obstacle| blocks(obstacle, position));
    let nearest = blocking.min_by(|a, b| a.coords.norm().total_cmp(&b.coords.norm()));
    nearest.map_or(position, |obstacle| beside(*obstacle, position))
}

fn blocks(obstacle: &Point2<f64>, position: Point2<f64>) -> bool {
    let (distance, part) = distance_to_segment(*obstacle, Point2::origin(), position);
    part > 0.0 && distance < CLEARANCE && obstacle.coords.norm() < LOOK_AHEAD
}

fn beside(obstacle: Point2<f64>, position: Point2<f64>) -> Point2<f64> {
    let direction = position.coords.try_normalize(1e-6).unwrap_or(Vector2::x());
    let left = Vector2::new(-direction.y, direction.x);
    let side = if left.dot(&obstacle.coords) > 0.0 { -1.0 } else { 1.0 };
    obstacle + left * (side * CLEARANCE * 1.1)
}

/// Distance that a field player keeps from the area, metres.
const AREA_MARGIN: f64 = 0.05;
const AREA_FORESIGHT: f64 = 0.4;

/// Limits a walk so that it does not enter the own goal area: along its border instead, and out of
/// it from inside.
pub fn keep_out(walk: Walk, field: &FieldModel, field_from_robot: &Isometry2<f64>) -> Walk {
    let here = Point2::from(field_from_robot.translation.vector);
    let mut velocity = field_from_robot.rotation * walk.velocity();
    if !field.in_own_area(here + velocity * AREA_FORESIGHT, AREA_MARGIN) {
        return walk;
    }
    if here.x >= field.area_front() + AREA_MARGIN {
        velocity.x = 0.0;
    } else if here.y.abs() >= field.area_width / 2.0 + AREA_MARGIN {
        velocity.y = 0.0;
    } else {
        velocity = Vector2::new(LEAVING_SPEED, 0.0);
    }
    Walk::along(field_from_robot.rotation.inverse() * velocity, walk.turn)
}

/// Speed with which the area is left, m/s.
const LEAVING_SPEED: f64 = 0.3;

#[cfg(test)]
mod tests {
    use super::*;
    use crate::functionality::geometry::pose;

    #[test]
    fn the_own_area_is_not_walked_into() {
        let field = FieldModel::LEAGUE_2010;
        let ahead = Walk { ahead: 0.3, left: 0.1, turn: 0.2 };
        let outside = pose(-1.0, 0.0, std::f64::consts::PI);
        assert_eq!(keep_out(ahead, &field, &outside), ahead);
        let before = pose(-2.3, 0.0, std::f64::consts::PI);
        let along = keep_out(ahead, &field, &before);
        assert!(
            along.ahead.abs() < 1e-9 && (along.left - 0.1).abs() < 1e-9 && along.turn == 0.2,
            "{along:?}"
        );
        let beside = pose(-2.8, 1.2, -std::f64::consts::FRAC_PI_2);
        assert!(keep_out(ahead, &field, &beside).ahead.abs() < 1e-9);
        let within = pose(-2.6, 0.0, std::f64::consts::PI);
        assert!(keep_out(Walk::STILL, &field, &within).ahead < -0.2, "backwards out of it");
    }

    #[test]
    fn a_free_way_is_kept() {
        let position = Point2::new(2.0, 0.0);
        assert_eq!(avoid(position, &[]), position);
        assert_eq!(
            avoid(position, &[Point2::new(1.0, 0.6), Point2::new(-0.3, 0.0), Point2::new(1.8, 0.0)]),
            position
        );
    }

    #[test]
    fn an_obstacle_is_passed_on_the_nearer_side() {
        let position = Point2::new(2.0, 0.0);
        assert!(avoid(position, &[Point2::new(1.0, 0.1)]).y < -0.3);
        assert!(avoid(position, &[Point2::new(1.0, -0.1)]).y > 0.3);
    }

    #[test]
    fn the_nearest_obstacle_counts() {
        let obstacles = [Point2::new(1.2, 0.1), Point2::new(0.6, -0.1)];
        let aside = avoid(Point2::new(2.0, 0.0), &obstacles);
        assert!((aside.x - 0.6).abs() < 1e-9 && aside.y > 0.3);
    }
}
