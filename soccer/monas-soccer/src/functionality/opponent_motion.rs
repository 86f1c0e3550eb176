//! Whether the opponents move in play.

use nalgebra::Point2;

use super::field::FieldModel;

/// Evidence from watched opponents: did each move within
/// [`MOTION_WINDOW`](super::obstacles::MOTION_WINDOW)?
///
/// Opponents that play often stand for a while, too: at the ball, after a fall, or where they cover
/// the goal. Over three matches each way, plain attackers moved in 24 % of the windows, and players
/// that stand still in 5 %, by collisions and errors of odometry. So a motion outweighs several
/// windows without one, and opponents count as moving until there is strong evidence to the
/// contrary.
#[derive(Clone, Copy, PartialEq, Eq, Debug, Default)]
pub struct OpponentMotion {
    /// Windows without motion less the weight of windows with motion.
    still: i32,
}

/// The weight of a window with motion, in windows without.
const MOTION_WEIGHT: i32 = 10;
/// Limits of the evidence, so that opponents that begin or cease to play are recognised.
const EVIDENCE_LIMITS: (i32, i32) = (-20, 30);
/// Least evidence with which the opponents count as standing.
const STANDING_EVIDENCE: i32 = 5;

impl OpponentMotion {
    /// Adds a window of time in which an opponent was watched.
    pub fn observe(&mut self, moved: bool) {
        let change = if moved { -MOTION_WEIGHT } else { 1 };
        self.still = (self.still + change).clamp(EVIDENCE_LIMITS.0, EVIDENCE_LIMITS.1);
    }

    /// Whether the opponents nearly never moved.
    pub fn stand(self) -> bool {
        self.still >= STANDING_EVIDENCE
    }
}

/// Distance up to which a robot's position is known well enough to judge its motion, metres.
const MAX_DISTANCE: f64 = 2.0;
/// Margin ahead of and beside the opponents' goal in which a robot may be a goalkeeper, metres.
const AT_GOAL: f64 = 0.9;
const BESIDE_GOAL: f64 = 0.6;

/// Whether the motion of an opponent is evidence: it is near, and not at its goal, where a keeper
/// stands. Its position is in the robot's frame and in the field frame.
pub fn is_evidence(field: &FieldModel, in_robot: Point2<f64>, in_field: Point2<f64>) -> bool {
    let is_at_goal =
        in_field.x > field.length / 2.0 - AT_GOAL && in_field.y.abs() < field.goal_width / 2.0 + BESIDE_GOAL;
    in_robot.coords.norm() <= MAX_DISTANCE && !is_at_goal
}

#[cfg(test)]
mod tests {
    use super::*;

    fn after(windows: &[(usize, bool)]) -> bool {
        let mut motion = OpponentMotion::default();
        for &(times, moved) in windows {
            (0..times).for_each(|_| motion.observe(moved));
        }
        motion.stand()
    }

    #[test]
    fn opponents_stand_after_several_windows_without_motion() {
        assert!(!after(&[]) && !after(&[(4, false)]));
        assert!(after(&[(5, false)]));
    }

    #[test]
    fn a_motion_outweighs_many_windows_without() {
        assert!(!after(&[(9, false), (1, true)]));
        assert!(!after(&[(1, true), (14, false)]) && after(&[(1, true), (15, false)]));
    }

    #[test]
    fn a_collision_after_a_long_time_changes_nothing() {
        assert!(after(&[(100, false), (2, true)]));
        assert!(!after(&[(100, false), (3, true)]), "but opponents that begin to play do");
        assert!(after(&[(100, true), (25, false)]), "and opponents that cease to");
    }

    #[test]
    fn goalkeepers_and_far_robots_are_no_evidence() {
        let counts = |robot: (f64, f64), field: (f64, f64)| {
            is_evidence(
                &FieldModel::LEAGUE_2010,
                Point2::new(robot.0, robot.1),
                Point2::new(field.0, field.1),
            )
        };
        assert!(counts((1.0, 1.0), (0.0, 0.0)) && !counts((2.0, 0.5), (0.0, 0.0)), "far");
        assert!(!counts((1.0, 0.0), (2.8, 0.5)) && counts((1.0, 0.0), (2.8, 1.5)), "beside the goal");
        assert!(counts((1.0, 0.0), (-2.8, 0.0)), "at the other goal");
    }
}
