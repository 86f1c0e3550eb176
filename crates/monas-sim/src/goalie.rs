//! Watching whether goalies come back between their posts after a dive or fall.

use crate::state::Scene;
use crate::{EventKind, FieldSide, STEP};

/// For each robot, the time since its last action, if it has not been back since, s.
#[derive(Debug, Clone)]
pub(crate) struct Returns {
    away: Vec<Option<f64>>,
}

impl Returns {
    pub(crate) fn new(robots: usize) -> Self {
        Self { away: vec![None; robots] }
    }

    /// A goalie acts; its time counts from now.
    pub(crate) fn act(&mut self, robot: usize) {
        self.away[robot] = Some(0.0);
    }

    /// A robot is put somewhere by the referee, so its way back no longer counts.
    pub(crate) fn forget(&mut self, robot: usize) {
        self.away[robot] = None;
    }

    /// Follows the goalies for one step; each team defends the end at its index.
    pub(crate) fn follow(&mut self, defends: [FieldSide; 2], scene: &Scene<'_>, events: &mut Vec<EventKind>) {
        for (robot, away) in self.away.iter_mut().enumerate() {
            let Some(after) = away else { continue };
            *after += STEP;
            let state = &scene.robots[robot];
            let goal = scene.field.goal(defends[state.team]);
            let off = state.pose.position - goal;
            let between =
                off.x.abs() <= scene.field.goal_area_depth && off.y.abs() <= scene.field.goal_width / 2.0;
            if state.phase.is_upright() && between {
                events.push(EventKind::GoalieBack { robot, after: *after });
                *away = None;
            }
        }
    }
}
