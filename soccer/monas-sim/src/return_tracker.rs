//! Tracks whether goalies return between their posts after a dive or fall.

use crate::state::WorldView;
use crate::{EventKind, FieldSide, STEP};

/// For each robot, the time since its last dive or fall, if it has not returned since, s.
#[derive(Debug, Clone)]
pub(crate) struct ReturnTracker {
    away: Vec<Option<f64>>,
}

impl ReturnTracker {
    pub(crate) fn new(robots: usize) -> Self {
        Self { away: vec![None; robots] }
    }

    /// A goalie dives or falls; starts its timer.
    pub(crate) fn act(&mut self, robot: usize) {
        self.away[robot] = Some(0.0);
    }

    /// The referee has placed a robot; drops its timer.
    pub(crate) fn forget(&mut self, robot: usize) {
        self.away[robot] = None;
    }

    /// Updates the timers for one step; each team defends the end at its index.
    pub(crate) fn follow(
        &mut self,
        defends: [FieldSide; 2],
        scene: &WorldView<'_>,
        events: &mut Vec<EventKind>,
    ) {
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
