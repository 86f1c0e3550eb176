//! Places of a team for a kick-off, and the walk to them.

use std::time::Duration;

use nalgebra::{Isometry2, Point2};
use narukom::Timestamp;

use super::avoidance::avoid;
use super::field::{FieldModel, Goal};
use super::geometry::{angle_of, heading, pose, wrap};
use super::walk::{Walk, stride_to, walk_to};

/// Number of the goalkeeper.
const GOALKEEPER_NUMBER: u32 = 1;
/// Distance from the ball of the player that kicks off, metres.
const BEFORE_BALL: f64 = 0.3;
/// Distance that the others keep from the centre circle and from the own goal area, metres: the
/// radius of a robot and a margin.
const LINE_CLEARANCE: f64 = 0.21;
/// Distance of the goalkeeper from its goal line, metres.
const BEFORE_LINE: f64 = 0.13;
/// Places of field players, as parts of half the length and half the width towards the own goal.
const PLACES: [(f64, f64); 5] = [(0.35, 0.45), (0.35, -0.45), (0.6, 0.0), (0.55, 0.75), (0.55, -0.75)];
/// Errors of place, metres, and heading, radians, below which a robot stands.
const POSE_TOLERANCE: (f64, f64) = (0.12, 0.2);
/// Confidence of the pose below which a robot turns around for landmarks before it walks.
const MIN_CONFIDENCE: f64 = 0.2;
/// The turn with which it looks around, rad/s, and how long: a whole turn.
const LOOK_AROUND: f64 = 0.6;
const LOOK_TIME: Duration = Duration::from_millis(10_500);
/// Time without a call after which a call begins a new walk.
const CALL_TIMEOUT: Duration = Duration::from_secs(1);
/// Distance below which a robot turns to its final heading while it walks, metres.
const ARRIVAL_DISTANCE: f64 = 0.4;

/// The place of a player for a kick-off: in the own half, facing the centre, and outside the centre
/// circle unless it kicks off, which the field player with the lowest number does.
pub fn kick_off_pose(field: &FieldModel, number: u32, kicks_off: bool) -> Isometry2<f64> {
    let outside = field.circle_radius + LINE_CLEARANCE;
    let own_goal = field.goal(Goal::Own);
    let position = match number {
        GOALKEEPER_NUMBER => Point2::new(own_goal.x + BEFORE_LINE, 0.0),
        2 if kicks_off => Point2::new(-BEFORE_BALL, 0.0),
        2 => Point2::new(-outside, 0.0),
        _ => {
            let (x, y) = PLACES[(number.max(3) - 3) as usize % PLACES.len()];
            let x = (-x * field.length / 2.0).max(field.area_front() + LINE_CLEARANCE);
            let position = Point2::new(x, y * field.width / 2.0);
            position * (outside / position.coords.norm()).max(1.0)
        }
    };
    pose(position.x, position.y, angle_of(&-position.coords))
}

/// A walk to the place for a kick-off. A robot that does not know its pose turns once around to
/// find landmarks, and stands if it has found none.
#[derive(Clone, Copy, Debug, Default)]
pub struct KickOffWalk {
    called_at: Timestamp,
    began_at: Timestamp,
}

impl KickOffWalk {
    /// The walk at a time: from a pose, of which the confidence is known, to a place, past the ball
    /// at the centre and other robots, given in the robot's frame.
    pub fn walk(
        &mut self,
        now: Timestamp,
        pose: Option<(Isometry2<f64>, f64)>,
        field_from_target: &Isometry2<f64>,
        robots: &[Point2<f64>],
    ) -> Walk {
        if now.since(self.called_at) > CALL_TIMEOUT {
            self.began_at = now;
        }
        self.called_at = now;
        match pose {
            Some((field_from_robot, confidence)) if confidence > MIN_CONFIDENCE => {
                walk_to_kick_off(&field_from_robot, field_from_target, robots)
            }
            _ if now.since(self.began_at) < LOOK_TIME => Walk::turning(LOOK_AROUND),
            _ => Walk::STILL,
        }
    }
}

fn walk_to_kick_off(
    field_from_robot: &Isometry2<f64>,
    field_from_target: &Isometry2<f64>,
    robots: &[Point2<f64>],
) -> Walk {
    let robot_from_target = field_from_robot.inverse() * field_from_target;
    let position = Point2::from(robot_from_target.translation.vector);
    let (distance, off) = (position.coords.norm(), wrap(heading(&robot_from_target)));
    if distance <= POSE_TOLERANCE.0 {
        return if off.abs() <= POSE_TOLERANCE.1 { Walk::STILL } else { walk_to(Point2::origin(), 0.0, off) };
    }
    if distance < ARRIVAL_DISTANCE {
        return walk_to(position, distance, off);
    }
    let ball = field_from_robot.inverse_transform_point(&Point2::origin());
    let mut obstacles = robots.to_vec();
    obstacles.push(ball);
    stride_to(avoid(position, &obstacles), distance)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::functionality::walk::GaitLimits;

    const FIELD: FieldModel = FieldModel::LEAGUE_2010;

    #[test]
    fn places_are_legal_and_apart() {
        for kicks_off in [false, true] {
            let poses: Vec<_> = (1..=7).map(|number| kick_off_pose(&FIELD, number, kicks_off)).collect();
            for (index, wanted) in poses.iter().enumerate() {
                let at = Point2::from(wanted.translation.vector);
                assert!(at.x < -0.2 && at.x > -3.0 && at.y.abs() < 2.0, "{at}");
                assert!(index == 0 || !FIELD.in_own_area(at, 0.15), "{at}");
                assert!(at.coords.norm() > 0.75 || (kicks_off && index == 1), "{at}");
                for other in &poses[..index] {
                    assert!((other.translation.vector - wanted.translation.vector).norm() > 0.4);
                }
            }
        }
    }

    #[test]
    fn a_robot_that_finds_no_landmark_turns_once_around_and_stands() {
        let mut walk = KickOffWalk::default();
        let mut turned = 0.0;
        for cycle in 0..150 {
            let now = Timestamp::from_nanos(5_000_000_000 + cycle * 100_000_000);
            turned += 0.1 * walk.walk(now, Some((pose(0.0, 0.0, 0.0), 0.1)), &pose(-1.0, 0.0, 0.0), &[]).turn;
        }
        assert!((6.2..6.5).contains(&turned), "{turned}");
        let next = Timestamp::from_nanos(60_000_000_000);
        assert!(walk.walk(next, None, &pose(-1.0, 0.0, 0.0), &[]).turn > 0.0, "before the next kick-off");
    }

    #[test]
    fn a_robot_comes_to_its_place_from_everywhere_and_stands() {
        let gait = GaitLimits { forward: 0.3, backward: 0.15, sideways: 0.15, turn: 1.2 };
        let wanted = kick_off_pose(&FIELD, 2, true);
        for start in [pose(2.5, 0.05, 0.0), pose(-2.9, 1.9, -1.5), pose(0.5, 0.0, 3.0), pose(-0.3, 0.1, 3.0)]
        {
            let mut robot = start;
            let mut nearest_ball = f64::INFINITY;
            let mut time = 0.0;
            while walk_to_kick_off(&robot, &wanted, &[]) != Walk::STILL {
                let walk = gait.limit(&walk_to_kick_off(&robot, &wanted, &[]));
                robot *= pose(walk.ahead * 0.1, walk.left * 0.1, walk.turn * 0.1);
                nearest_ball = nearest_ball.min(robot.translation.vector.norm());
                time += 0.1;
                assert!(time < 25.0, "it does not arrive from {start}");
            }
            assert!(nearest_ball > 0.17, "it pushes the ball: {nearest_ball}");
        }
    }
}
