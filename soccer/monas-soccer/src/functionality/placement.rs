//! Placements of the robot by a person: that it was put down, and where that can be.
//!
//! The robot detects that it is lifted, but not the pose at which it is put down. The rules leave
//! few places: the own half, before a half and for a kick-off, and the ends of the halfway line
//! after a penalty.

use std::f64::consts::FRAC_PI_2;

use super::field::FieldModel;
use super::game::GamePhase;
use super::geometry::pose;
use super::localisation::PoseEstimate;

/// The kind of a placement.
#[derive(Clone, Copy, PartialEq, Eq, Debug, Default)]
pub enum Placement {
    /// Into its own half, before a half or for a kick-off.
    #[default]
    OwnHalf,
    /// To the halfway line, after a penalty.
    HalfwayLine,
}

/// Counts the placements by a person, from the contacts of the feet.
#[derive(Clone, Copy, Debug, Default)]
pub struct PlacementTracker {
    count: u32,
    last: Placement,
    is_lifted: bool,
    was_penalized: bool,
}

impl PlacementTracker {
    /// Processes a reading of the body: whether it is lifted, in a phase of the game, while the
    /// robot is penalised or not.
    pub fn feel(&mut self, is_lifted: bool, phase: GamePhase, is_penalized: bool) {
        self.was_penalized |= is_penalized;
        let is_put_down = self.is_lifted && !is_lifted;
        self.is_lifted = is_lifted;
        if !is_put_down {
            return;
        }
        self.count += 1;
        self.last = match phase {
            GamePhase::Playing if self.was_penalized => Placement::HalfwayLine,
            _ => Placement::OwnHalf,
        };
        self.was_penalized = is_penalized;
    }

    /// The number of placements so far, and the last.
    pub fn placements(&self) -> (u32, Placement) {
        (self.count, self.last)
    }
}

impl Placement {
    /// The poses that the rules allow. Robots are put down with a view of the field: to the middle
    /// from the lines, and towards the opponents from the own half.
    pub fn poses(self, field: &FieldModel) -> Vec<PoseEstimate> {
        let estimate = |x, y, heading, place_deviation, turn_deviation| PoseEstimate {
            field_from_robot: pose(x, y, heading),
            place_deviation,
            turn_deviation,
        };
        let side = field.width / 2.0;
        match self {
            Placement::HalfwayLine => [(side, -FRAC_PI_2), (-side, FRAC_PI_2)]
                .map(|(y, turn)| estimate(0.0, y, turn, 0.3, 0.3))
                .to_vec(),
            Placement::OwnHalf => {
                let part = |x: f64| -x * field.length / 2.0;
                let mut poses: Vec<PoseEstimate> = Vec::new();
                for (x, y) in [(0.15, 0.0), (0.4, 0.25), (0.4, -0.25), (0.9, 0.0)] {
                    poses.push(estimate(part(x), y * field.width, 0.0, 0.4, 0.5));
                }
                for x in [0.25, 0.55, 0.85] {
                    poses.push(estimate(part(x), side, -FRAC_PI_2, 0.4, 0.5));
                    poses.push(estimate(part(x), -side, FRAC_PI_2, 0.4, 0.5));
                }
                poses
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn each_time_it_is_put_down_counts_once() {
        let mut tracker = PlacementTracker::default();
        assert_eq!(tracker.placements(), (0, Placement::OwnHalf));
        for lifted in [false, true, true, false, false] {
            tracker.feel(lifted, GamePhase::Set, false);
        }
        assert_eq!(tracker.placements(), (1, Placement::OwnHalf));
    }

    #[test]
    fn after_a_penalty_it_returns_at_the_halfway_line_and_for_a_kick_off_to_its_half() {
        let mut tracker = PlacementTracker::default();
        tracker.feel(false, GamePhase::Playing, false);
        tracker.feel(true, GamePhase::Playing, true);
        tracker.feel(true, GamePhase::Playing, false);
        tracker.feel(false, GamePhase::Playing, false);
        assert_eq!(tracker.placements(), (1, Placement::HalfwayLine));
        tracker.feel(true, GamePhase::Playing, true);
        tracker.feel(false, GamePhase::Ready, false);
        assert_eq!(tracker.placements(), (2, Placement::OwnHalf));
    }

    #[test]
    fn the_places_are_on_or_beside_the_own_half() {
        let field = FieldModel::LEAGUE_2010;
        for estimate in Placement::OwnHalf.poses(&field) {
            let position = estimate.field_from_robot.translation.vector;
            assert!((-3.0..0.0).contains(&position.x) && position.y.abs() <= 2.0, "{position:?}");
        }
        assert_eq!(Placement::HalfwayLine.poses(&field).len(), 2);
    }
}
