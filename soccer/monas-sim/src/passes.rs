//! Distinguishes passes from other kicks.
//!
//! A pass is complete when the first robot that touches the ball after the one that kicked it is a
//! team mate. The robot that received it keeps it until an opponent touches the ball, another robot
//! kicks it, or the ball is out of play; a shot in this time is a shot after a pass.

use crate::state::WorldView;
use crate::{EventKind, STEP, Vector};

/// A ball that has rolled less than this from its kick has not left the kicker, m.
const MIN_ROLL: f64 = 0.3;

/// A ball that is received later than this after its kick was found, not passed, s.
const MAX_PASS_TIME: f64 = 10.0;

/// A shot later than this after the reception is none after a pass, s.
const MAX_HOLD_TIME: f64 = 20.0;

/// The kick or the reception that is being followed.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
enum PassPhase {
    #[default]
    None,
    /// A robot has kicked the ball from a place.
    Rolling { from: usize, kicked_at: Vector, age: f64 },
    /// A team mate has received the ball.
    Received { by: usize, age: f64 },
}

/// The pass in progress, if any.
#[derive(Debug, Clone, Default)]
pub(crate) struct PassTracker {
    phase: PassPhase,
}

impl PassTracker {
    /// Notes a ball that `robot` has just struck. Returns whether the robot had received a pass.
    pub(crate) fn strike(&mut self, robot: usize, scene: &WorldView<'_>) -> bool {
        let after_pass = matches!(self.phase, PassPhase::Received { by, .. } if by == robot);
        self.phase = PassPhase::Rolling { from: robot, kicked_at: scene.ball.position, age: 0.0 };
        after_pass
    }

    /// Updates the pass for one step.
    pub(crate) fn follow(&mut self, scene: &WorldView<'_>, events: &mut Vec<EventKind>) {
        let team = |robot: usize| scene.robots[robot].team;
        match &mut self.phase {
            PassPhase::None => {}
            PassPhase::Rolling { from, kicked_at, age } => {
                *age += STEP;
                let length = (scene.ball.position - *kicked_at).norm();
                let (from, after) = (*from, *age);
                let others = || scene.touchers().filter(|robot| *robot != from);
                let is_taken = others().any(|robot| team(robot) != team(from));
                let is_dribbled = length > MIN_ROLL && scene.touchers().any(|robot| robot == from);
                if after > MAX_PASS_TIME || is_taken || is_dribbled {
                    self.phase = PassPhase::None;
                } else if let Some(to) = others().next() {
                    self.phase = PassPhase::None;
                    if length > MIN_ROLL {
                        self.phase = PassPhase::Received { by: to, age: 0.0 };
                        events.push(EventKind::Pass { from, to, after, length });
                    }
                }
            }
            PassPhase::Received { by, age } => {
                *age += STEP;
                let by = *by;
                if *age > MAX_HOLD_TIME || scene.touchers().any(|robot| team(robot) != team(by)) {
                    self.phase = PassPhase::None;
                }
            }
        }
    }

    /// The ball is out of play.
    pub(crate) fn forget(&mut self) {
        self.phase = PassPhase::None;
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{BallState, BodyPhase, FieldGeometry, Physics, Pose, RobotState};

    fn robot(team: usize) -> RobotState {
        RobotState {
            team,
            number: 2,
            pose: Pose::default(),
            velocity: Vector::zeros(),
            intent: Vector::zeros(),
            phase: BodyPhase::Standing,
            head_yaw: 0.0,
            head_pitch: 0.0,
            on_field: true,
        }
    }

    /// Robots 0 and 1 are a team, robot 2 an opponent. Follows a kick of robot 0 from the centre
    /// through moments, each the ball's x and the robots that touch it.
    fn followed(moments: &[(f64, &[usize])]) -> (Vec<EventKind>, bool) {
        let (field, physics) = (FieldGeometry::default(), Physics::default());
        let robots = [robot(0), robot(0), robot(1)];
        let scene = |x: f64, touching_ball| WorldView {
            field: Box::leak(Box::new(field.clone())),
            physics: Box::leak(Box::new(physics.clone())),
            ball: BallState { position: Vector::new(x, 0.0), velocity: Vector::zeros() },
            robots: Box::leak(Box::new(robots)),
            touching_ball,
            contacts: &[],
        };
        let (mut passes, mut events) = (PassTracker::default(), Vec::new());
        assert!(!passes.strike(0, &scene(0.0, &[false; 3])));
        for (x, touchers) in moments {
            let touching: Vec<bool> = (0..3).map(|robot| touchers.contains(&robot)).collect();
            passes.follow(&scene(*x, touching.leak()), &mut events);
        }
        let after_pass = passes.strike(1, &scene(0.0, &[false; 3]));
        (events, after_pass)
    }

    #[test]
    fn a_ball_that_a_team_mate_touches_next_was_passed() {
        let (events, after_pass) = followed(&[(0.1, &[0]), (0.8, &[]), (1.2, &[1]), (1.1, &[])]);
        let [EventKind::Pass { from: 0, to: 1, length, .. }] = events[..] else { panic!("{events:?}") };
        assert!((length - 1.2).abs() < 1e-9 && after_pass);
    }

    #[test]
    fn a_ball_of_an_opponent_or_of_the_kicker_itself_was_not() {
        assert_eq!(followed(&[(0.8, &[2]), (1.2, &[1])]), (vec![], false));
        assert_eq!(followed(&[(0.8, &[1, 2])]), (vec![], false), "both at once");
        assert_eq!(followed(&[(0.8, &[0]), (1.2, &[1])]), (vec![], false), "it ran after the ball");
        assert_eq!(followed(&[(0.1, &[1]), (1.2, &[1])]), (vec![], false), "they stand together");
    }

    #[test]
    fn a_ball_that_an_opponent_takes_is_no_longer_held() {
        let (events, after_pass) = followed(&[(1.2, &[1]), (1.2, &[2])]);
        assert_eq!((events.len(), after_pass), (1, false));
    }
}
