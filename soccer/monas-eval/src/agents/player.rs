//! The attacker as one activity.

use std::time::Duration;

use monas::{Activity, Blackboard, BoxError, Progress, Topics};
use monas_soccer::activities::motion_requests::{
    KickStyle, request_gaze, request_scan, request_skill, request_stand, request_walk,
};
use monas_soccer::activities::shot::{RobotAndField, ground, others, target};
use monas_soccer::functionality::align::Alignment;
use monas_soccer::functionality::approach::Approach;
use monas_soccer::functionality::avoidance::{avoid, keep_out};
use monas_soccer::functionality::field::Goal;
use monas_soccer::functionality::head::{Gaze, HeadController};
use monas_soccer::functionality::support::{DISTANCE_AHEAD, support_position};
use monas_soccer::functionality::walk::{Walk, stride_to, turn_to};
use monas_soccer::{Ball, MotionKind, topics};
use nalgebra::Point2;
use narukom::Timestamp;

use super::{StartUp, is_executing};
use crate::thresholds::player::*;

/// Searches for the ball, walks to it, and kicks it towards the goal.
#[derive(Clone, Debug, Default)]
pub struct BehaviorPlayer {
    head: HeadController,
    approach: Approach,
    alignment: Alignment,
    start_up: StartUp,
    kicking: Option<u64>,
    turning: Option<(Timestamp, f64)>,
    next_glance_at: Timestamp,
    glancing_until: Option<Timestamp>,
}

impl Activity for BehaviorPlayer {
    fn execute(&mut self, blackboard: &mut Blackboard) -> Result<Progress, BoxError> {
        if self.start_up.is_ready(blackboard)? && !is_executing(blackboard, self.kicking) {
            self.kicking = None;
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

impl BehaviorPlayer {
    fn decide(&mut self, blackboard: &mut Blackboard) -> Result<(), BoxError> {
        let now = blackboard.now();
        if self.glancing_until.is_some_and(|end| now < end) {
            return Ok(());
        }
        let was_glancing = self.glancing_until.take().is_some();
        let ball = blackboard.read(topics::BALL).copied().unwrap_or_default();
        if !ball.found {
            return self.search(blackboard, &ball);
        }
        if !was_glancing && self.glance(blackboard, &ball)? {
            return Ok(());
        }
        request_gaze(blackboard, self.head.look_at(ball.position()))?;
        self.play(blackboard, &ball)
    }

    fn search(&mut self, blackboard: &mut Blackboard, ball: &Ball) -> Result<(), BoxError> {
        request_scan(blackboard)?;
        if ball.age < LOOK {
            return Ok(());
        }
        let pose = blackboard.read(topics::POSE).copied().unwrap_or_default();
        if ball.age > WANDER && (pose.x.abs() > CENTRAL || pose.y.abs() > CENTRAL) {
            let Some(ground) = ground(blackboard) else { return request_stand(blackboard) };
            let centre = ground.field_from_robot.inverse_transform_point(&Point2::origin());
            let walk = stride_to(avoid(centre, &obstacles(blackboard)), centre.coords.norm());
            return request_walk(blackboard, keep_out(walk, &ground.field, &ground.field_from_robot));
        }
        let now = blackboard.now();
        let same = self.turning.filter(|(at, _)| now.since(*at) < Duration::from_secs(1));
        let turn = same.map_or(TURN.copysign(ball.bearing), |(_, turn)| turn);
        self.turning = Some((now, turn));
        request_inside(blackboard, Walk::turning(turn))
    }

    /// Begins to look up at a goal, if that is due.
    fn glance(&mut self, blackboard: &mut Blackboard, ball: &Ball) -> Result<bool, BoxError> {
        let now = blackboard.now();
        let confidence = blackboard.read(topics::POSE).map_or(0.0, |pose| pose.confidence);
        let is_due = now >= self.next_glance_at && confidence < CERTAIN;
        if !is_due || ball.distance <= QUIET || ball.speed >= STILL || ball.age >= SEEN {
            return Ok(false);
        }
        self.next_glance_at = now + GLANCE_EVERY;
        let Some(RobotAndField { field, field_from_robot }) = ground(blackboard) else { return Ok(false) };
        let look = |goal| self.head.look_at(field_from_robot.inverse_transform_point(&field.goal(goal)));
        let off = |gaze: &Gaze| (gaze.yaw - ball.bearing).abs();
        let (ahead, back) = (look(Goal::Opponent), look(Goal::Own));
        request_gaze(blackboard, if off(&ahead) <= off(&back) { ahead } else { back })?;
        self.glancing_until = Some(now + GLANCE);
        Ok(true)
    }

    fn play(&mut self, blackboard: &mut Blackboard, ball: &Ball) -> Result<(), BoxError> {
        if ball.distance > NEAR && (ball.mate_lead > NEARER || ball.in_own_area) {
            return support(blackboard, ball);
        }
        let target = target(blackboard, ball, ground(blackboard).as_ref());
        if ball.distance > NEAR {
            let walk = self.approach.walk(ball.position(), target, &obstacles(blackboard));
            return request_inside(blackboard, walk);
        }
        let off = ((ball.x - KICK.0).abs(), (ball.y.abs() - KICK.1).abs());
        if ball.speed >= STILL || off.0 > TOLERANCE || off.1 > TOLERANCE {
            return request_walk(blackboard, self.alignment.walk(ball.position(), target));
        }
        let kind = if ball.y >= 0.0 { MotionKind::KickLeft } else { MotionKind::KickRight };
        self.kicking = Some(request_skill(blackboard, kind, KickStyle::default())?);
        Ok(())
    }
}

/// Waits ahead of the ball and to its side.
fn support(blackboard: &mut Blackboard, ball: &Ball) -> Result<(), BoxError> {
    let Some(RobotAndField { field, field_from_robot }) = ground(blackboard) else {
        return request_stand(blackboard);
    };
    let here = Point2::from(field_from_robot.translation.vector);
    let place = support_position(&field, field_from_robot * ball.position(), here, DISTANCE_AHEAD);
    let place = field_from_robot.inverse_transform_point(&place);
    let distance = place.coords.norm();
    let walk = if distance < 0.2 {
        Walk::turning(turn_to(ball.bearing))
    } else {
        let mut obstacles = obstacles(blackboard);
        obstacles.push(ball.position());
        stride_to(avoid(place, &obstacles), distance)
    };
    request_walk(blackboard, keep_out(walk, &field, &field_from_robot))
}

fn request_inside(blackboard: &mut Blackboard, walk: Walk) -> Result<(), BoxError> {
    let ground = ground(blackboard);
    let walk = ground.map_or(walk, |ground| keep_out(walk, &ground.field, &ground.field_from_robot));
    request_walk(blackboard, walk)
}

fn obstacles(blackboard: &Blackboard) -> Vec<Point2<f64>> {
    others(blackboard).map(|robot| robot.position()).collect()
}

monas::activity!(BehaviorPlayer);
