//! When and where a rolling ball crosses the robot's lateral axis, and where a robot meets it.

use nalgebra::{Point2, Vector2};

/// The point at which a ball crosses the line x = 0 of the robot's frame.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct Crossing {
    /// Seconds from now.
    pub time: f64,
    /// Position on the axis, metres to the left of the robot.
    pub y: f64,
}

/// The crossing of the robot's lateral axis by a ball ahead of it; none if friction stops it
/// before.
///
/// It rolls straight and decelerates by `deceleration` m/s², so the time for a distance `s` is the
/// smaller root of `s = v t - a t²/2`.
pub fn crossing(position: Point2<f64>, velocity: Vector2<f64>, deceleration: f64) -> Option<Crossing> {
    let speed = velocity.norm();
    if position.x <= 0.0 || velocity.x >= 0.0 {
        return None;
    }
    let distance = position.x * speed / -velocity.x;
    let root = speed * speed - 2.0 * deceleration * distance;
    if root < 0.0 {
        return None;
    }
    // The smaller root, in a form that also holds without friction.
    let time = 2.0 * distance / (speed + root.sqrt());
    let y = position.y + velocity.y * position.x / -velocity.x;
    (time.is_finite() && y.is_finite()).then_some(Crossing { time, y })
}

/// Speed from which on a ball rolls, m/s: a slower one may be noise.
const MIN_ROLLING_SPEED: f64 = 0.7;
/// Interval of the search for the place at which a ball is met, seconds.
const SEARCH_INTERVAL: f64 = 0.1;

/// The first point at which a robot that walks with `walk` m/s meets a rolling ball, in the robot's
/// frame; the position of the ball when it stops, or after `foresight` seconds, if it is not met
/// before. A ball that hardly rolls is met at its position.
///
/// The ball rolls straight and decelerates by `deceleration` m/s².
pub fn meeting_point(
    position: Point2<f64>,
    velocity: Vector2<f64>,
    deceleration: f64,
    walk: f64,
    foresight: f64,
) -> Point2<f64> {
    let speed = velocity.norm();
    if speed < MIN_ROLLING_SPEED {
        return position;
    }
    let last = if deceleration > 0.0 { foresight.min(speed / deceleration) } else { foresight };
    let at = |time: f64| position + velocity * (time - deceleration * time * time / (2.0 * speed));
    let mut time = 0.0;
    while time < last && at(time).coords.norm() > walk * time {
        time += SEARCH_INTERVAL;
    }
    at(time.min(last))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn without_friction_it_takes_the_way_over_the_speed() {
        let crossing = crossing(Point2::new(2.0, 0.5), Vector2::new(-1.0, -0.5), 0.0).unwrap();
        assert!((crossing.time - 2.0).abs() < 1e-12);
        assert!((crossing.y - -0.5).abs() < 1e-12);
    }

    #[test]
    fn friction_delays_it_and_may_stop_it() {
        let late = crossing(Point2::new(1.5, 0.0), Vector2::new(-1.0, 0.0), 0.25).unwrap();
        assert!((late.time - 2.0).abs() < 1e-12, "1.5 = t - t²/8 at t = 2: {late:?}");
        assert_eq!(crossing(Point2::new(2.1, 0.0), Vector2::new(-1.0, 0.0), 0.25), None);
    }

    #[test]
    fn a_ball_is_met_where_robot_and_ball_come_at_the_same_time_or_where_it_stops() {
        let met = |velocity, foresight| meeting_point(Point2::new(2.0, -2.0), velocity, 0.0, 1.0, foresight);
        assert!((met(Vector2::new(0.0, 1.0), 9.0) - Point2::new(2.0, 0.0)).norm() < 0.11, "after 2 s");
        assert_eq!(met(Vector2::new(0.0, 1.0), 1.0), Point2::new(2.0, -1.0), "it looks no farther ahead");
        assert_eq!(met(Vector2::new(0.0, 0.2), 9.0), Point2::new(2.0, -2.0), "it hardly rolls");
        let stopped = meeting_point(Point2::new(1.0, 0.0), Vector2::new(1.0, 0.0), 0.5, 0.1, 9.0);
        assert!((stopped - Point2::new(2.0, 0.0)).norm() < 1e-9, "v²/2a from where it is: {stopped}");
    }

    #[test]
    fn a_ball_behind_or_leaving_does_not_cross() {
        assert_eq!(crossing(Point2::new(-1.0, 0.0), Vector2::new(-1.0, 0.0), 0.25), None);
        assert_eq!(crossing(Point2::new(1.0, 0.0), Vector2::new(0.5, 0.0), 0.25), None);
        assert_eq!(crossing(Point2::new(1.0, 0.0), Vector2::zeros(), 0.25), None);
    }
}
