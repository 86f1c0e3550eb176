//! The goalie as one activity.

use monas::{Activity, Blackboard, BoxError, Progress, Topics};
use monas_soccer::activities::motion_requests::{
    KickStyle, request_gaze, request_scan, request_skill, request_walk,
};
use monas_soccer::activities::shot::ground;
use monas_soccer::functionality::guard::GoalPositioning;
use monas_soccer::functionality::head::HeadController;
use monas_soccer::{MotionKind, topics};

use super::{StartUp, is_executing};
use crate::thresholds::goalie::*;

/// Tracks the ball, stays between ball and goal, and falls or dives before a shot.
#[derive(Clone, Debug, Default)]
pub struct BehaviorGoalie {
    head: HeadController,
    guard: GoalPositioning,
    start_up: StartUp,
    diving: Option<u64>,
}

impl Activity for BehaviorGoalie {
    fn execute(&mut self, blackboard: &mut Blackboard) -> Result<Progress, BoxError> {
        if self.start_up.is_ready(blackboard)? && !is_executing(blackboard, self.diving) {
            self.decide(blackboard)?;
        }
        Ok(Progress::Done)
    }

    fn topics(&self) -> Topics {
        let topics = Topics::declared().reads(topics::BALL).reads(topics::GAME_STATE).reads(topics::POSE);
        let topics = topics.reads(topics::ROBOTS).reads(topics::MOTION).reads(topics::MOTION_STATE);
        topics.publishes(topics::MOTION).publishes(topics::HEAD)
    }
}

impl BehaviorGoalie {
    fn decide(&mut self, blackboard: &mut Blackboard) -> Result<(), BoxError> {
        self.diving = None;
        let ball = blackboard.read(topics::BALL).copied().unwrap_or_default();
        let ground = ground(blackboard);
        if !ball.found {
            request_scan(blackboard)?;
            if let Some(ground) = ground {
                let place = self.guard.keeper_pose(&ground.field, None);
                request_walk(blackboard, self.guard.walk(&ground.field_from_robot, &place))?;
            }
        } else if ball.approaching
            && ball.time_to_cross <= ACT_WITHIN
            && ball.crossing_bearing.abs() >= FALL_FROM
        {
            let kind = match ball.crossing_bearing {
                bearing if bearing < -DIVE_FROM => MotionKind::DiveRight,
                bearing if bearing < 0.0 => MotionKind::FallRight,
                bearing if bearing <= DIVE_FROM => MotionKind::FallLeft,
                _ => MotionKind::DiveLeft,
            };
            self.diving = Some(request_skill(blackboard, kind, KickStyle::default())?);
        } else {
            request_gaze(blackboard, self.head.look_at(ball.position()))?;
            if ball.approaching {
                request_walk(blackboard, self.guard.step_before(ball.crossing_y))?;
            } else if let Some(ground) = ground {
                let ball_in_field = ground.field_from_robot * ball.position();
                let place = self.guard.keeper_pose(&ground.field, Some(ball_in_field));
                request_walk(blackboard, self.guard.walk(&ground.field_from_robot, &place))?;
            }
        }
        Ok(())
    }
}

monas::activity!(BehaviorGoalie);
