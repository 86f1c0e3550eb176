//! The attacker, directly on the robot interface.

use std::time::Duration;

use monas_soccer::Ball;
use monas_soccer::functionality::aim::{kick_target, shot_target};
use monas_soccer::functionality::align::Alignment;
use monas_soccer::functionality::approach::Approach;
use monas_soccer::functionality::avoidance::{avoid, keep_out};
use monas_soccer::functionality::field::Goal;
use monas_soccer::functionality::head::{Gaze, HeadController};
use monas_soccer::functionality::motion::{DesiredMotion, Skill};
use monas_soccer::functionality::support::{DISTANCE_AHEAD, support_position};
use monas_soccer::functionality::walk::{Walk, stride_to, turn_to};
use nalgebra::Point2;
use narukom::Timestamp;

use super::{Behaviour, GazeRequest, SharedMemory};
use crate::thresholds::player::*;

/// Searches for the ball, walks to it, and kicks it towards the goal.
#[derive(Clone, Debug, Default)]
pub struct DirectPlayer {
    head: HeadController,
    approach: Approach,
    alignment: Alignment,
    kicking: Option<u64>,
    turning: Option<(Timestamp, f64)>,
    next_glance_at: Timestamp,
    glancing_until: Option<Timestamp>,
}

impl Behaviour for DirectPlayer {
    const VISION: Duration = Duration::from_millis(100);

    fn decide(&mut self, memory: &mut SharedMemory) {
        if self.kicking.is_some_and(|number| memory.motion_done < number) {
            return;
        }
        self.kicking = None;
        if self.glancing_until.is_some_and(|end| memory.now < end) {
            return;
        }
        let was_glancing = self.glancing_until.take().is_some();
        let ball = memory.ball;
        if !ball.found {
            self.search(memory, &ball);
            return;
        }
        if !was_glancing && self.glance(memory, &ball) {
            return;
        }
        memory.gaze = GazeRequest::At(self.head.look_at(ball.position()));
        self.play(memory, &ball);
    }
}

impl DirectPlayer {
    fn search(&mut self, memory: &mut SharedMemory, ball: &Ball) {
        memory.gaze = GazeRequest::Scan;
        if ball.age < LOOK {
            return;
        }
        let pose = memory.pose.unwrap_or_default();
        if ball.age > WANDER && (pose.x.abs() > CENTRAL || pose.y.abs() > CENTRAL) {
            match memory.ground() {
                Some((field, pose)) => {
                    let centre = pose.inverse_transform_point(&Point2::origin());
                    let walk = stride_to(avoid(centre, &others(memory)), centre.coords.norm());
                    memory.request(DesiredMotion::Walk(keep_out(walk, &field, &pose)));
                }
                None => memory.request(DesiredMotion::Stand),
            }
            return;
        }
        let same = self.turning.filter(|(at, _)| memory.now.since(*at) < Duration::from_secs(1));
        let turn = same.map_or(TURN.copysign(ball.bearing), |(_, turn)| turn);
        self.turning = Some((memory.now, turn));
        request_inside(memory, Walk::turning(turn));
    }

    /// Begins to look up at a goal, if that is due.
    fn glance(&mut self, memory: &mut SharedMemory, ball: &Ball) -> bool {
        let confidence = memory.pose.map_or(0.0, |pose| pose.confidence);
        let is_due = memory.now >= self.next_glance_at && confidence < CERTAIN;
        if !is_due || ball.distance <= QUIET || ball.speed >= STILL || ball.age >= SEEN {
            return false;
        }
        self.next_glance_at = memory.now + GLANCE_EVERY;
        let Some((field, pose)) = memory.ground() else { return false };
        let look = |goal| self.head.look_at(pose.inverse_transform_point(&field.goal(goal)));
        let off = |gaze: &Gaze| (gaze.yaw - ball.bearing).abs();
        let (ahead, back) = (look(Goal::Opponent), look(Goal::Own));
        memory.gaze = GazeRequest::At(if off(&ahead) <= off(&back) { ahead } else { back });
        self.glancing_until = Some(memory.now + GLANCE);
        true
    }

    fn play(&mut self, memory: &mut SharedMemory, ball: &Ball) {
        if ball.distance > NEAR && (ball.mate_lead > NEARER || ball.in_own_area) {
            support(memory, ball);
            return;
        }
        let target = target(memory, ball);
        if ball.distance > NEAR {
            let walk = self.approach.walk(ball.position(), target, &others(memory));
            request_inside(memory, walk);
            return;
        }
        let off = ((ball.x - KICK.0).abs(), (ball.y.abs() - KICK.1).abs());
        if ball.speed >= STILL || off.0 > TOLERANCE || off.1 > TOLERANCE {
            memory.request(DesiredMotion::Walk(self.alignment.walk(ball.position(), target)));
            return;
        }
        let skill = if ball.y >= 0.0 { Skill::KickLeft } else { Skill::KickRight };
        memory.request(DesiredMotion::Skill(skill));
        self.kicking = Some(memory.motion_number);
    }
}

/// Waits ahead of the ball and to its side.
fn support(memory: &mut SharedMemory, ball: &Ball) {
    let Some((field, pose)) = memory.ground() else {
        memory.request(DesiredMotion::Stand);
        return;
    };
    let place = support_position(
        &field,
        pose * ball.position(),
        Point2::from(pose.translation.vector),
        DISTANCE_AHEAD,
    );
    let place = pose.inverse_transform_point(&place);
    let distance = place.coords.norm();
    let walk = if distance < 0.2 {
        Walk::turning(turn_to(ball.bearing))
    } else {
        let mut obstacles = others(memory);
        obstacles.push(ball.position());
        stride_to(avoid(place, &obstacles), distance)
    };
    memory.request(DesiredMotion::Walk(keep_out(walk, &field, &pose)));
}

fn request_inside(memory: &mut SharedMemory, walk: Walk) {
    let walk = memory.ground().map_or(walk, |(field, pose)| keep_out(walk, &field, &pose));
    memory.request(DesiredMotion::Walk(walk));
}

/// The target of a kick in the robot's frame; straight ahead if the pose is unknown.
fn target(memory: &SharedMemory, ball: &Ball) -> Point2<f64> {
    let Some((field, pose)) = memory.ground() else {
        return Point2::new(ball.x + 3.0, ball.y);
    };
    let robots = memory.robots.robots.iter();
    let opponents: Vec<Point2<f64>> =
        robots.filter(|robot| !robot.team_mate).map(|robot| pose * robot.position()).collect();
    let ball = pose * ball.position();
    pose.inverse_transform_point(&kick_target(&field, ball, shot_target(&field, ball, &opponents)))
}

fn others(memory: &SharedMemory) -> Vec<Point2<f64>> {
    memory.robots.robots.iter().map(|robot| robot.position()).collect()
}
