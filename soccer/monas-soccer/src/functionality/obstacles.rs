//! Other robots that were seen recently.

use std::time::Duration;

use nalgebra::{Isometry2, Point2};
use narukom::Timestamp;

use super::opponent_motion::OpponentMotion;

/// A robot that was detected.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct Obstacle {
    /// Its position in the robot's frame.
    pub position: Point2<f64>,
    /// Whether it wears the own team's colour.
    pub team_mate: bool,
    /// When it was last seen.
    pub seen_at: Timestamp,
    /// Whether it is an opponent whose motion is evidence that its team plays.
    pub is_evidence: bool,
}

/// A short-term memory of other robots, transformed by odometry. A robot counts once it was seen
/// twice within a few pictures in the same colour, so that single false sightings and confused
/// colours change nothing.
#[derive(Clone, Debug, Default)]
pub struct Obstacles {
    seen: Vec<Track>,
    motion: OpponentMotion,
}

#[derive(Clone, Debug)]
struct Track {
    obstacle: Obstacle,
    is_confirmed: bool,
    /// Number of pictures since it was last seen.
    unseen: u32,
    /// The position at the beginning of the window in which its motion is judged, with its time.
    window_position: Point2<f64>,
    window_start: Timestamp,
}

/// Distance within which two sightings of one colour are the same robot, metres.
const MATCHING_DISTANCE: f64 = 0.4;
/// Time for which a robot that is not seen again is remembered.
const MAX_UNSEEN_TIME: Duration = Duration::from_millis(1500);
/// Number of pictures in which a robot must be seen again.
const CONFIRMING_PICTURES: u32 = 4;
/// The time in which a robot that plays moves farther than `MIN_MOTION`.
pub const MOTION_WINDOW: Duration = Duration::from_secs(2);
/// Displacement that no error of a measured position explains, metres.
const MIN_MOTION: f64 = 0.4;
/// Greatest number of robots on a field.
const MAX_ROBOTS: usize = 16;

impl Obstacles {
    /// Moves the robot to `old_from_new`, its new pose in its old frame, and forgets what is too
    /// old.
    pub fn advance(&mut self, now: Timestamp, old_from_new: &Isometry2<f64>) {
        self.seen.retain(|track| now.since(track.obstacle.seen_at) <= MAX_UNSEEN_TIME);
        for Track { obstacle, window_position, .. } in &mut self.seen {
            obstacle.position = old_from_new.inverse_transform_point(&obstacle.position);
            *window_position = old_from_new.inverse_transform_point(window_position);
        }
    }

    /// Adds the robots in a picture. Each replaces the nearest known robot of its colour if that is
    /// near enough to be the same.
    pub fn see(&mut self, picture: impl Iterator<Item = Obstacle>) {
        self.seen.iter_mut().for_each(|track| track.unseen += 1);
        self.seen.retain(|track| track.is_confirmed || track.unseen <= CONFIRMING_PICTURES);
        picture.for_each(|sighting| self.add(sighting));
    }

    fn add(&mut self, sighting: Obstacle) {
        let distance = |track: &Track| (track.obstacle.position - sighting.position).norm();
        let full = self.seen.len() >= MAX_ROBOTS;
        let is_same = |known: &&mut Track| {
            known.obstacle.team_mate == sighting.team_mate && distance(known) < MATCHING_DISTANCE
        };
        let same = self.seen.iter_mut().filter(is_same);
        match same.min_by(|a, b| distance(a).total_cmp(&distance(b))) {
            Some(known) => {
                if let Some(moved) = known.update(sighting) {
                    self.motion.observe(moved);
                }
            }
            None if !full => self.seen.push(Track::new(sighting)),
            None => {}
        }
    }

    /// Whether the opponents that were watched in play nearly never moved.
    pub fn opponents_stand(&self) -> bool {
        self.motion.stand()
    }

    /// Removes all robots.
    pub fn forget(&mut self) {
        self.seen.clear();
    }

    /// The remembered robots that were seen twice.
    pub fn iter(&self) -> impl Iterator<Item = &Obstacle> {
        self.seen.iter().filter(|track| track.is_confirmed).map(|track| &track.obstacle)
    }
}

impl Track {
    fn new(obstacle: Obstacle) -> Track {
        Track {
            obstacle,
            is_confirmed: false,
            unseen: 0,
            window_position: obstacle.position,
            window_start: obstacle.seen_at,
        }
    }

    /// Takes the next sighting. At the end of a window in which the robot was watched, returns
    /// whether it has moved.
    fn update(&mut self, sighting: Obstacle) -> Option<bool> {
        // A second sighting in the same picture confirms nothing.
        self.is_confirmed |= self.unseen > 0;
        (self.obstacle, self.unseen) = (sighting, 0);
        let moved = (sighting.position - self.window_position).norm() > MIN_MOTION;
        let is_judged = moved || sighting.seen_at.since(self.window_start) > MOTION_WINDOW;
        if is_judged || !sighting.is_evidence {
            (self.window_position, self.window_start) = (sighting.position, sighting.seen_at);
        }
        (is_judged && sighting.is_evidence && self.is_confirmed).then_some(moved)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::functionality::geometry::pose;

    fn robot(x: f64, y: f64, team_mate: bool, millis: u64) -> Obstacle {
        let seen_at = Timestamp::from_nanos(millis * 1_000_000);
        Obstacle { position: Point2::new(x, y), team_mate, seen_at, is_evidence: !team_mate }
    }

    /// Shows the same robots in two pictures.
    fn show_twice(obstacles: &mut Obstacles, robots: &[Obstacle]) {
        (0..2).for_each(|_| obstacles.see(robots.iter().copied()));
    }

    #[test]
    fn the_same_robot_is_remembered_once() {
        let mut obstacles = Obstacles::default();
        obstacles.see([robot(1.0, 0.0, false, 0)].into_iter());
        let both = [robot(1.1, 0.1, false, 100), robot(1.1, 0.1, true, 100)];
        show_twice(&mut obstacles, &both);
        let seen: Vec<_> = obstacles.iter().copied().collect();
        assert_eq!(seen, both);
    }

    #[test]
    fn a_single_false_sighting_or_colour_is_no_robot() {
        let (mate, ghost) = (robot(1.0, 0.0, true, 0), robot(0.5, 1.0, false, 0));
        let confused = Obstacle { team_mate: false, ..mate };
        let mut obstacles = Obstacles::default();
        obstacles.see([ghost, ghost].into_iter());
        assert_eq!(obstacles.iter().count(), 0, "one picture confirms nothing");
        (0..=CONFIRMING_PICTURES).for_each(|_| obstacles.see([mate].into_iter()));
        obstacles.see([confused, ghost].into_iter());
        obstacles.see([mate].into_iter());
        assert_eq!(obstacles.iter().copied().collect::<Vec<_>>(), [mate]);
        obstacles.see([ghost].into_iter());
        assert_eq!(obstacles.iter().copied().collect::<Vec<_>>(), [mate, ghost], "seen again");
    }

    #[test]
    fn walking_on_leaves_it_behind_and_time_forgets_it() {
        let mut obstacles = Obstacles::default();
        show_twice(&mut obstacles, &[robot(1.0, 0.0, false, 0)]);
        obstacles.advance(Timestamp::from_nanos(100_000_000), &pose(0.2, 0.0, 0.0));
        assert!((obstacles.iter().next().unwrap().position - Point2::new(0.8, 0.0)).norm() < 1e-12);
        obstacles.advance(Timestamp::from_nanos(2_000_000_000), &Isometry2::identity());
        assert_eq!(obstacles.iter().count(), 0);
    }

    /// Whether opponents stand, one of which is seen for 20 s ten times a second.
    fn stands(position: impl Fn(f64) -> (f64, f64), is_evidence: bool) -> bool {
        let mut obstacles = Obstacles::default();
        for picture in 0..200_u32 {
            let (x, y) = position(f64::from(picture) * 0.1);
            let sighting = Obstacle { is_evidence, ..robot(x, y, false, u64::from(picture) * 100) };
            obstacles.see([sighting].into_iter());
        }
        obstacles.opponents_stand()
    }

    #[test]
    fn opponents_stand_if_the_one_in_sight_does_not_move() {
        let noise = |time: f64| 0.1 * libm::sin(time * 7.0);
        assert!(stands(|time| (1.0 + noise(time), 0.3), true));
        assert!(!stands(|time| (1.0 + noise(time), 0.25 * time), true), "it walks");
        assert!(!stands(|time| (1.0 + noise(time), 0.3), false), "a goalkeeper");
    }

    #[test]
    fn a_robot_that_is_walked_past_stands() {
        let mut obstacles = Obstacles::default();
        for picture in 0..200_u32 {
            let x = 3.0 - 0.02 * f64::from(picture);
            obstacles.advance(Timestamp::from_nanos(u64::from(picture) * 100_000_000), &pose(0.02, 0.0, 0.0));
            obstacles.see([robot(x, 0.5, false, u64::from(picture) * 100)].into_iter());
        }
        assert!(obstacles.opponents_stand());
    }

    #[test]
    fn the_memory_is_bounded() {
        let mut obstacles = Obstacles::default();
        let robots: Vec<_> = (0..100).map(|position| robot(f64::from(position), 0.0, false, 0)).collect();
        show_twice(&mut obstacles, &robots);
        assert_eq!(obstacles.iter().count(), MAX_ROBOTS);
    }
}
