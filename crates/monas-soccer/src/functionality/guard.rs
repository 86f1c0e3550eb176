//! Where the goalkeeper stands, and how it gets there.

use nalgebra::{Isometry2, Point2};

use super::field::{Field, Goal};
use super::geometry::heading;
use super::walk::{Walk, stride_to, walk_to};

/// How the goal is kept.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct Guard {
    /// Distance before the goal line, metres.
    pub before_line: f64,
    /// Distance from the posts that is kept, metres.
    pub from_post: f64,
    /// How far off its place the keeper stays where it is, metres, and how far off its heading, radians.
    pub content: (f64, f64),
}

impl Default for Guard {
    fn default() -> Guard {
        Guard { before_line: 0.25, from_post: 0.3, content: (0.06, 0.15) }
    }
}

impl Guard {
    /// The place between the posts from which the ball is on the way to the middle of the goal; without a ball, the middle. In the
    /// field frame; the keeper faces the field there, so that the line through its shoulders is parallel to the goal line.
    pub fn place(&self, field: &Field, ball: Option<Point2<f64>>) -> Point2<f64> {
        let goal = field.goal(Goal::Own);
        let x = goal.x + self.before_line;
        let reach = (field.goal_width / 2.0 - self.from_post).max(0.0);
        let y = ball.map_or(0.0, |ball| {
            let depth = (ball.x - goal.x).max(self.before_line);
            ball.y * self.before_line / depth
        });
        // The nearer the ball, the more the keeper has to come towards its side: the bare line to the goal's middle is too timid.
        Point2::new(x, (1.5 * y).clamp(-reach, reach))
    }

    /// The walk to a place of the field, to face the field there.
    pub fn walk(&self, field_from_robot: &Isometry2<f64>, place: Point2<f64>) -> Walk {
        let place_in_robot = field_from_robot.inverse_transform_point(&place);
        let way = place_in_robot.coords.norm();
        let off = -heading(field_from_robot);
        if way > 0.6 {
            return stride_to(place_in_robot, way);
        }
        if way <= self.content.0 && off.abs() <= self.content.1 {
            return Walk::STILL;
        }
        walk_to(place_in_robot, way, off)
    }
}

#[cfg(test)]
mod tests {
    use std::f64::consts::PI;

    use super::*;
    use crate::functionality::geometry::pose;
    use crate::functionality::walk::Gait;

    const FIELD: Field = Field::LEAGUE_2010;

    #[test]
    fn the_place_is_between_the_posts_on_the_balls_side() {
        let guard = Guard::default();
        assert_eq!(guard.place(&FIELD, None), Point2::new(-2.75, 0.0));
        let left = guard.place(&FIELD, Some(Point2::new(-2.0, 1.0)));
        assert!(left.y > 0.2 && left.y <= 0.4 + 1e-12, "{left}");
        let corner = guard.place(&FIELD, Some(Point2::new(-2.99, -2.0)));
        assert!((corner.y + 0.4).abs() < 1e-12, "{corner}");
    }

    #[test]
    fn it_comes_back_between_the_posts_and_then_stands() {
        let gait = Gait { forward: 0.25, backward: 0.12, sideways: 0.12, turn: 1.0 };
        let guard = Guard::default();
        let place = guard.place(&FIELD, None);
        for start in [pose(-1.0, 1.5, PI), pose(-2.7, -0.6, -1.5), pose(-3.2, 0.3, 3.0)] {
            let mut field_from_robot = start;
            for _ in 0..300 {
                let walk = gait.limit(&guard.walk(&field_from_robot, place));
                field_from_robot *= pose(walk.ahead * 0.1, walk.left * 0.1, walk.turn * 0.1);
            }
            assert_eq!(guard.walk(&field_from_robot, place), Walk::STILL);
            assert!((field_from_robot.translation.vector - place.coords).norm() < 0.07);
        }
    }
}
