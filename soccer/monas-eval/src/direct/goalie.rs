//! The goalie, directly on the robot interface.

use std::time::Duration;

use monas_soccer::functionality::guard::GoalPositioning;
use monas_soccer::functionality::head::HeadController;
use monas_soccer::functionality::motion::{DesiredMotion, Skill};

use super::{Behaviour, GazeRequest, SharedMemory};
use crate::thresholds::goalie::*;

/// Tracks the ball, stays between ball and goal, and falls or dives before a shot.
#[derive(Clone, Debug, Default)]
pub struct DirectGoalie {
    head: HeadController,
    guard: GoalPositioning,
    diving: Option<u64>,
}

impl Behaviour for DirectGoalie {
    const VISION: Duration = Duration::from_millis(200);

    fn decide(&mut self, memory: &mut SharedMemory) {
        if self.diving.is_some_and(|number| memory.motion_done < number) {
            return;
        }
        self.diving = None;
        let ball = memory.ball;
        if !ball.found {
            memory.gaze = GazeRequest::Scan;
            if let Some((field, pose)) = memory.ground() {
                let place = self.guard.keeper_pose(&field, None);
                memory.request(DesiredMotion::Walk(self.guard.walk(&pose, &place)));
            }
        } else if ball.approaching
            && ball.time_to_cross <= ACT_WITHIN
            && ball.crossing_bearing.abs() >= FALL_FROM
        {
            let skill = match ball.crossing_bearing {
                bearing if bearing < -DIVE_FROM => Skill::DiveRight,
                bearing if bearing < 0.0 => Skill::FallRight,
                bearing if bearing <= DIVE_FROM => Skill::FallLeft,
                _ => Skill::DiveLeft,
            };
            memory.request(DesiredMotion::Skill(skill));
            self.diving = Some(memory.motion_number);
        } else {
            memory.gaze = GazeRequest::At(self.head.look_at(ball.position()));
            if ball.approaching {
                memory.request(DesiredMotion::Walk(self.guard.step_before(ball.crossing_y)));
            } else if let Some((field, pose)) = memory.ground() {
                let place = self.guard.keeper_pose(&field, Some(pose * ball.position()));
                memory.request(DesiredMotion::Walk(self.guard.walk(&pose, &place)));
            }
        }
    }
}
