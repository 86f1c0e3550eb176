//! Walking round what is in the way.

use nalgebra::{Point2, Vector2};

use super::geometry::distance_to_segment;

/// How near the middle of another robot may come to the middle of this one on its way, metres: two robots and a hand between.
pub const CLEARANCE: f64 = 0.45;
/// Farther robots are no obstacle yet, metres.
const LOOK_AHEAD: f64 = 1.3;

/// The place to walk to so that a way to `place` passes the nearest obstacle that blocks it: beside the obstacle, on the side nearer
/// to the way. `place` itself when the way is free. All in the robot's frame, the robot at the origin.
pub fn avoid(place: Point2<f64>, obstacles: &[Point2<f64>]) -> Point2<f64> {
    let blocking = obstacles.iter().filter(|obstacle| blocks(obstacle, place));
    let nearest = blocking.min_by(|a, b| a.coords.norm().total_cmp(&b.coords.norm()));
    nearest.map_or(place, |obstacle| beside(*obstacle, place))
}

fn blocks(obstacle: &Point2<f64>, place: Point2<f64>) -> bool {
    let (distance, part) = distance_to_segment(*obstacle, Point2::origin(), place);
    part > 0.0 && distance < CLEARANCE && obstacle.coords.norm() < LOOK_AHEAD
}

fn beside(obstacle: Point2<f64>, place: Point2<f64>) -> Point2<f64> {
    let direction = place.coords.try_normalize(1e-6).unwrap_or(Vector2::x());
    let left = Vector2::new(-direction.y, direction.x);
    let side = if left.dot(&obstacle.coords) > 0.0 { -1.0 } else { 1.0 };
    obstacle + left * (side * CLEARANCE * 1.1)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_free_way_is_kept() {
        let place = Point2::new(2.0, 0.0);
        assert_eq!(avoid(place, &[]), place);
        assert_eq!(
            avoid(place, &[Point2::new(1.0, 0.6), Point2::new(-0.3, 0.0), Point2::new(1.8, 0.0)]),
            place
        );
    }

    #[test]
    fn an_obstacle_is_passed_on_the_nearer_side() {
        let place = Point2::new(2.0, 0.0);
        assert!(avoid(place, &[Point2::new(1.0, 0.1)]).y < -0.3);
        assert!(avoid(place, &[Point2::new(1.0, -0.1)]).y > 0.3);
    }

    #[test]
    fn the_nearest_obstacle_counts() {
        let obstacles = [Point2::new(1.2, 0.1), Point2::new(0.6, -0.1)];
        let aside = avoid(Point2::new(2.0, 0.0), &obstacles);
        assert!((aside.x - 0.6).abs() < 1e-9 && aside.y > 0.3);
    }
}
