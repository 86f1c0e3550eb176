//! Walks to the ball so that the robot arrives behind it, facing the target.
//!
//! The robot has to reach the side of the ball opposite to the target. It walks round the ball on a
//! circle: first along the tangent, then along the arc. In a narrow sector behind the ball it walks
//! straight to it. Only the next point of the path is computed and no state is kept between calls,
//! so that a push only makes the path longer.

use std::f64::consts::TAU;

use nalgebra::{Point2, Vector2};

use super::avoidance::avoid;
use super::geometry::{angle_of, rotation, wrap};
use super::walk::{Walk, stride_to, walk_to};

/// Parameters of the approach.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct Approach {
    /// Distance from the ball at which the path ends, metres.
    pub stand_off: f64,
    /// Radius of the circle on which the robot walks round the ball, metres.
    pub circle: f64,
    /// Half angle of the sector behind the ball in which the robot walks up to it, radians.
    pub sector: f64,
    /// Distance from its end at which the robot faces the target instead of facing ahead, metres.
    pub face_target: f64,
}

impl Default for Approach {
    fn default() -> Approach {
        Approach { stand_off: 0.2, circle: 0.38, sector: 0.3, face_target: 0.45 }
    }
}

impl Approach {
    /// The walk towards a ball to be kicked to `target`, avoiding `obstacles`; all in the robot's
    /// frame.
    pub fn walk(&self, ball: Point2<f64>, target: Point2<f64>, obstacles: &[Point2<f64>]) -> Walk {
        let shot = (target - ball).try_normalize(1e-6).unwrap_or(Vector2::x());
        let (next, distance) = self.next_point(ball, shot);
        let aside = avoid(next, obstacles);
        if aside != next {
            return stride_to(aside, distance.max(aside.coords.norm()));
        }
        if distance > self.face_target {
            return stride_to(next, distance);
        }
        walk_to(next, distance, angle_of(&shot))
    }

    /// The next point of the path, and the length of the remaining path.
    fn next_point(&self, ball: Point2<f64>, shot: Vector2<f64>) -> (Point2<f64>, f64) {
        // Angle of the path round the ball, seen from the ball; positive counterclockwise.
        let round = wrap(angle_of(&-shot) - angle_of(&-ball.coords));
        if round.abs() <= self.sector {
            let behind = ball - shot * self.stand_off;
            return (behind, behind.coords.norm());
        }
        let other = if round > 0.0 { round - TAU } else { round + TAU };
        let walks = [self.round_ball(ball, round), self.round_ball(ball, other)];
        // The cost includes turning, so that a robot that has begun to turn to one side continues
        // despite noise in `round`.
        let cost =
            |distance: &(Point2<f64>, f64)| distance.1 + TURN_COST * angle_of(&distance.0.coords).abs();
        if cost(&walks[1]) < cost(&walks[0]) { walks[1] } else { walks[0] }
    }

    /// The next point of the path round the ball by an angle, and the length of that path.
    fn round_ball(&self, ball: Point2<f64>, round: f64) -> (Point2<f64>, f64) {
        let distance = ball.coords.norm();
        // Angle at which the tangent touches the circle; from within the circle the next point is a
        // step ahead on it.
        let tangent = if distance > self.circle { libm::acos(self.circle / distance) } else { 0.0 };
        let step = (tangent + self.sector).min(round.abs());
        let outward = (-ball.coords).try_normalize(1e-6).unwrap_or(Vector2::x());
        let next = ball + rotation(step.copysign(round)) * outward * self.circle;
        let arc = (round.abs() - step) * self.circle;
        (next, next.coords.norm() + arc + (self.circle - self.stand_off))
    }
}

/// Cost of turning by a radian, in metres of path.
const TURN_COST: f64 = 0.3;

#[cfg(test)]
mod tests {
    use std::f64::consts::PI;

    use nalgebra::Isometry2;
    use proptest::prelude::*;

    use super::*;
    use crate::functionality::geometry::{heading, polar, pose};
    use crate::functionality::walk::GaitLimits;

    const GAIT: GaitLimits = GaitLimits { forward: 0.25, backward: 0.12, sideways: 0.12, turn: 1.0 };
    const DT: f64 = 0.1;

    /// Walks without noise until the ball is within `near`; returns the duration in seconds and the
    /// final pose.
    fn walk_up(
        mut field_from_robot: Isometry2<f64>,
        ball: Point2<f64>,
        target: Point2<f64>,
    ) -> (f64, Isometry2<f64>, f64) {
        let (mut seconds, mut nearest) = (0.0, f64::INFINITY);
        while seconds < 120.0 {
            let robot_from_field = field_from_robot.inverse();
            let (ball, target) = (robot_from_field * ball, robot_from_field * target);
            if ball.coords.norm() <= 0.25 {
                break;
            }
            nearest = f64::min(nearest, ball.coords.norm());
            let walk = GAIT.limit(&Approach::default().walk(ball, target, &[]));
            field_from_robot *= pose(walk.ahead * DT, walk.left * DT, walk.turn * DT);
            seconds += DT;
        }
        (seconds, field_from_robot, nearest)
    }

    proptest! {
        #[test]
        fn it_arrives_behind_the_ball_facing_the_target(
            distance in 0.5..5.0f64, direction in 0.0..TAU, start_heading in -PI..PI
        ) {
            let (ball, target) = (Point2::origin(), Point2::new(3.0, 0.0));
            let position = polar(distance, direction);
            let (seconds, end, _) = walk_up(pose(position.x, position.y, start_heading), ball, target);
            prop_assert!(seconds < 12.0 + distance / 0.2, "took {seconds} s");
            prop_assert!(heading(&end).abs() < 0.4, "arrives with heading {}", heading(&end));
            prop_assert!(end.translation.x < -0.2 && end.translation.y.abs() < 0.12, "arrives at {}", end.translation);
        }
    }

    #[test]
    fn a_ball_in_between_is_not_run_over() {
        let (_, end, nearest) = walk_up(pose(1.0, 0.02, PI), Point2::origin(), Point2::new(3.0, 0.0));
        assert!(nearest > 0.24, "came as near as {nearest}");
        assert!(end.translation.x < -0.2);
    }

    #[test]
    fn a_robot_in_the_way_is_passed() {
        let (ball, target) = (Point2::new(2.0, 0.0), Point2::new(4.0, 0.0));
        let free = Approach::default().walk(ball, target, &[]);
        assert!(free.left.abs() < 1e-9 && free.turn.abs() < 1e-9);
        let blocked = Approach::default().walk(ball, target, &[Point2::new(1.0, 0.05)]);
        assert!(blocked.turn < -0.1);
    }
}
