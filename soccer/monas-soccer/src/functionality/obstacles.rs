//! Other robots that were seen recently.

use std::time::Duration;

use nalgebra::{Isometry2, Point2};
use narukom::Timestamp;

/// A robot that was detected.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct Obstacle {
    /// Its position in the robot's frame.
    pub position: Point2<f64>,
    /// Whether it wears the own team's colour.
    pub team_mate: bool,
    /// When it was last seen.
    pub seen_at: Timestamp,
}

/// A short-term memory of other robots, transformed by odometry.
#[derive(Clone, Debug, Default)]
pub struct Obstacles {
    seen: Vec<Obstacle>,
}

/// Distance within which two sightings of one colour are the same robot, metres.
const SAME: f64 = 0.4;
/// How long a robot that is not seen again is remembered.
const MEMORY: Duration = Duration::from_millis(1500);
/// Greatest number of robots on a field.
const MOST: usize = 16;

impl Obstacles {
    /// Moves the robot to `old_from_new`, its new pose in its old frame, and forgets what is too
    /// old.
    pub fn advance(&mut self, now: Timestamp, old_from_new: &Isometry2<f64>) {
        self.seen.retain(|obstacle| now.since(obstacle.seen_at) <= MEMORY);
        for obstacle in &mut self.seen {
            obstacle.position = old_from_new.inverse_transform_point(&obstacle.position);
        }
    }

    /// Adds a sighting; it replaces the nearest robot of its colour if that is near enough to be
    /// the same.
    pub fn see(&mut self, sighting: Obstacle) {
        let distance = |obstacle: &Obstacle| (obstacle.position - sighting.position).norm();
        let full = self.seen.len() >= MOST;
        let same = self
            .seen
            .iter_mut()
            .filter(|known| known.team_mate == sighting.team_mate && distance(known) < SAME);
        match same.min_by(|a, b| distance(a).total_cmp(&distance(b))) {
            Some(known) => *known = sighting,
            None if !full => self.seen.push(sighting),
            None => {}
        }
    }

    /// Removes all robots.
    pub fn forget(&mut self) {
        self.seen.clear();
    }

    /// The remembered robots.
    pub fn iter(&self) -> impl Iterator<Item = &Obstacle> {
        self.seen.iter()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::functionality::geometry::pose;

    fn robot(x: f64, y: f64, team_mate: bool, millis: u64) -> Obstacle {
        let seen_at = Timestamp::from_nanos(millis * 1_000_000);
        Obstacle { position: Point2::new(x, y), team_mate, seen_at }
    }

    #[test]
    fn the_same_robot_is_remembered_once() {
        let mut obstacles = Obstacles::default();
        obstacles.see(robot(1.0, 0.0, false, 0));
        obstacles.see(robot(1.1, 0.1, false, 100));
        obstacles.see(robot(1.1, 0.1, true, 100));
        let seen: Vec<_> = obstacles.iter().copied().collect();
        assert_eq!(seen, [robot(1.1, 0.1, false, 100), robot(1.1, 0.1, true, 100)]);
    }

    #[test]
    fn walking_on_leaves_it_behind_and_time_forgets_it() {
        let mut obstacles = Obstacles::default();
        obstacles.see(robot(1.0, 0.0, false, 0));
        obstacles.advance(Timestamp::from_nanos(100_000_000), &pose(0.2, 0.0, 0.0));
        assert!((obstacles.iter().next().unwrap().position - Point2::new(0.8, 0.0)).norm() < 1e-12);
        obstacles.advance(Timestamp::from_nanos(2_000_000_000), &Isometry2::identity());
        assert_eq!(obstacles.iter().count(), 0);
    }

    #[test]
    fn the_memory_is_bounded() {
        let mut obstacles = Obstacles::default();
        for place in 0..100 {
            obstacles.see(robot(f64::from(place), 0.0, false, 0));
        }
        assert_eq!(obstacles.iter().count(), MOST);
    }
}
