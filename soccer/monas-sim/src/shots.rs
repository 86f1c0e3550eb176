//! Distinguishes shots and saves from other kicks.

use crate::state::WorldView;
use crate::{EventKind, FieldSide, STEP};

/// A shot in progress.
#[derive(Debug, Clone, Copy)]
struct PendingShot {
    /// The robot that shot, and the index of its team.
    robot: usize,
    team: usize,
    /// The goalie that touched it.
    goalie: Option<usize>,
    /// Time since the kick, s.
    age: f64,
}

/// A shot whose ball is slower than this is over, m/s.
const SPENT_SPEED: f64 = 0.05;

/// A shot older than this is over, s: no kick rolls longer.
const SPENT_AGE: f64 = 10.0;

/// The shot in progress, if any.
#[derive(Debug, Clone, Default)]
pub(crate) struct ShotTracker {
    pending: Option<PendingShot>,
}

impl ShotTracker {
    /// Checks a ball that `robot` has just struck; the robot's team attacks the goal at `attacks`.
    /// Returns whether it is a shot.
    pub(crate) fn strike(
        &mut self,
        robot: usize,
        attacks: FieldSide,
        scene: &WorldView<'_>,
        events: &mut Vec<EventKind>,
    ) -> bool {
        self.resolve(events);
        let is_shot = meets_goal(attacks, scene);
        if is_shot {
            self.pending =
                Some(PendingShot { robot, team: scene.robots[robot].team, goalie: None, age: 0.0 });
            events.push(EventKind::Shot { robot });
        }
        is_shot
    }

    /// Updates the shot for one step.
    pub(crate) fn follow(&mut self, scene: &WorldView<'_>, events: &mut Vec<EventKind>) {
        let Some(shot) = &mut self.pending else { return };
        shot.age += STEP;
        let is_keeper = |robot: &usize| {
            let state = &scene.robots[*robot];
            state.is_goalie() && state.team != shot.team
        };
        if let Some(goalie) = scene.touchers().find(is_keeper) {
            shot.goalie = Some(goalie);
        }
        if scene.ball.velocity.norm() < SPENT_SPEED || shot.age > SPENT_AGE {
            self.resolve(events);
        }
    }

    /// Ends the shot without a goal: a save if the goalie touched it.
    pub(crate) fn resolve(&mut self, events: &mut Vec<EventKind>) {
        if let Some(PendingShot { goalie: Some(robot), .. }) = self.pending.take() {
            events.push(EventKind::Save { robot });
        }
    }

    /// The robot whose shot is in progress.
    pub(crate) fn shooter(&self) -> Option<usize> {
        self.pending.map(|shot| shot.robot)
    }

    /// The ball is in a goal.
    pub(crate) fn goal(&mut self) {
        self.pending = None;
    }
}

/// Whether the line of the ball crosses the mouth of the goal at `side`.
fn meets_goal(side: FieldSide, scene: &WorldView<'_>) -> bool {
    let (position, velocity) = (scene.ball.position, scene.ball.velocity);
    let to_line = scene.field.goal(side).x - position.x;
    if velocity.x * to_line <= 0.0 {
        return false;
    }
    let y = position.y + velocity.y / velocity.x * to_line;
    y.abs() < scene.field.goal_width / 2.0
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{BallState, FieldGeometry, Physics, Vector};

    fn meets(side: FieldSide, position: (f64, f64), velocity: (f64, f64)) -> bool {
        let (field, physics) = (FieldGeometry::default(), Physics::default());
        let ball = BallState {
            position: Vector::new(position.0, position.1),
            velocity: Vector::new(velocity.0, velocity.1),
        };
        let scene = WorldView {
            field: &field,
            physics: &physics,
            ball,
            robots: &[],
            touching_ball: &[],
            contacts: &[],
        };
        meets_goal(side, &scene)
    }

    #[test]
    fn a_line_meets_the_goal_between_the_posts_and_ahead() {
        assert!(meets(FieldSide::Right, (0.0, 0.0), (1.0, 0.2)));
        assert!(!meets(FieldSide::Right, (0.0, 0.0), (1.0, 0.25)), "beside the post");
        assert!(!meets(FieldSide::Right, (0.0, 0.0), (-1.0, 0.0)), "away from it");
        assert!(meets(FieldSide::Left, (0.0, 0.0), (-1.0, 0.0)));
        assert!(!meets(FieldSide::Left, (0.0, 0.0), (0.0, 1.0)), "along the goal line");
    }
}
