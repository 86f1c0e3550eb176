//! Between messages and what functionalities work with.

use std::time::Duration;

use monas_robot::{Actuators, GamePhase, ObjectKind, Posture as BodyPosture, Sighting, Skill as BodySkill};
use nalgebra::{Isometry2, Point2, Vector2};

use crate::functionality::ball_filter::BallEstimate;
use crate::functionality::field::{Field, Goal};
use crate::functionality::game::{Phase, State};
use crate::functionality::geometry::{self, heading};
use crate::functionality::interception::Crossing;
use crate::functionality::localisation::{Localisation, Post, PostSighting};
use crate::functionality::motion::{Order, Posture, Report, Request, Skill, Wish};
use crate::functionality::walk::Walk;
use crate::{
    Ball, GameState, LedRequest, MotionKind, MotionRequest, OtherRobot, PlayerState, Pose, SensorEntry,
};

/// `time_to_cross` of a ball that will not cross, seconds.
const NEVER: f64 = 1e6;

/// The distance behind the robot from which `crossing_bearing` is seen, metres.
const CROSSING_DEPTH: f64 = 0.6;

impl Ball {
    /// Where it is, in the robot's frame.
    pub fn position(&self) -> Point2<f64> {
        Point2::new(self.x, self.y)
    }

    /// How it rolls over the ground, in the robot's frame.
    pub fn velocity(&self) -> Vector2<f64> {
        Vector2::new(self.vx, self.vy)
    }

    /// Fills in where it is and how it rolls.
    pub(crate) fn with_estimate(self, ball: &BallEstimate) -> Ball {
        Ball {
            distance: ball.position.coords.norm(),
            x: ball.position.x,
            y: ball.position.y,
            bearing: geometry::angle_of(&ball.position.coords),
            vx: ball.velocity.x,
            vy: ball.velocity.y,
            speed: ball.velocity.norm(),
            ..self
        }
    }

    /// Fills in where it crosses the line through the robot's shoulders, if it does.
    pub(crate) fn with_crossing(self, crossing: Option<Crossing>) -> Ball {
        let approaching = crossing.is_some();
        let crossing = crossing.unwrap_or(Crossing { time: NEVER, y: 0.0 });
        let crossing_bearing = if approaching { libm::atan2(crossing.y, CROSSING_DEPTH) } else { 0.0 };
        Ball { approaching, time_to_cross: crossing.time, crossing_y: crossing.y, crossing_bearing, ..self }
    }
}

impl Pose {
    /// The same as a transformation: it maps points of the robot's frame into the field's.
    pub fn field_from_robot(&self) -> Isometry2<f64> {
        geometry::pose(self.x, self.y, self.heading)
    }

    pub(crate) fn from_filter(filter: &Localisation) -> Pose {
        let pose = filter.field_from_robot();
        Pose {
            x: pose.translation.x,
            y: pose.translation.y,
            heading: heading(&pose),
            confidence: filter.confidence(),
        }
    }
}

impl SensorEntry {
    /// Where the robot is in the frame in which counting began.
    pub(crate) fn odometry(&self) -> Isometry2<f64> {
        geometry::pose(self.odometry_x, self.odometry_y, self.odometry_heading)
    }
}

impl OtherRobot {
    /// Where it is, in the robot's frame.
    pub fn position(&self) -> Point2<f64> {
        Point2::new(self.x, self.y)
    }
}

impl GameState {
    /// The field that is played on.
    pub fn field(&self) -> Field {
        Field {
            length: self.field_length,
            width: self.field_width,
            goal_width: self.goal_width,
            area_depth: self.area_depth,
            area_width: self.area_width,
        }
    }

    /// The goal of a colour.
    pub(crate) fn goal_of(&self, colour: i32) -> Goal {
        if colour == self.goal_to_attack { Goal::Opponent } else { Goal::Own }
    }

    pub(crate) fn state(&self) -> State {
        match self.player_state() {
            PlayerState::Initial => State::Initial,
            PlayerState::Ready => State::Ready,
            PlayerState::Set => State::Set,
            PlayerState::Playing => State::Playing,
            PlayerState::Penalized => State::Penalized,
            PlayerState::Finished => State::Finished,
        }
    }
}

impl From<State> for PlayerState {
    fn from(state: State) -> PlayerState {
        match state {
            State::Initial => PlayerState::Initial,
            State::Ready => PlayerState::Ready,
            State::Set => PlayerState::Set,
            State::Playing => PlayerState::Playing,
            State::Penalized => PlayerState::Penalized,
            State::Finished => PlayerState::Finished,
        }
    }
}

impl MotionRequest {
    /// The request as the arbiter of motions takes it.
    pub(crate) fn request(&self, age: Duration) -> Request {
        let wish = match self.kind() {
            MotionKind::Stand => Wish::Stand,
            MotionKind::Walk => Wish::Walk(Walk { ahead: self.vx, left: self.vy, turn: self.wz }),
            MotionKind::KickLeft => Wish::Skill(Skill::KickLeft),
            MotionKind::KickRight => Wish::Skill(Skill::KickRight),
            MotionKind::FallLeft => Wish::Skill(Skill::FallLeft),
            MotionKind::FallRight => Wish::Skill(Skill::FallRight),
            MotionKind::DiveLeft => Wish::Skill(Skill::DiveLeft),
            MotionKind::DiveRight => Wish::Skill(Skill::DiveRight),
            MotionKind::StandUp => Wish::Skill(Skill::StandUp),
        };
        Request { wish, number: self.number, age }
    }
}

pub(crate) fn phase(phase: GamePhase) -> Phase {
    match phase {
        GamePhase::Initial => Phase::Initial,
        GamePhase::Ready => Phase::Ready,
        GamePhase::Set => Phase::Set,
        GamePhase::Playing => Phase::Playing,
        GamePhase::Finished => Phase::Finished,
    }
}

pub(crate) fn report(sensors: &monas_robot::Sensors) -> Report {
    let posture = match sensors.posture() {
        BodyPosture::Standing | BodyPosture::Walking => Posture::Upright,
        BodyPosture::Busy | BodyPosture::StandingUp | BodyPosture::Sitting | BodyPosture::Unknown => {
            Posture::Busy
        }
        BodyPosture::Fallen => Posture::Fallen,
        BodyPosture::Lifted => Posture::Lifted,
    };
    Report { posture, skill_done: sensors.skill_done }
}

/// The motion since the sensors' previous message: the new pose in the old frame.
pub(crate) fn odometry(sensors: &monas_robot::Sensors) -> Isometry2<f64> {
    geometry::pose(sensors.odometry_x, sensors.odometry_y, sensors.odometry_turn)
}

/// Where a sighted object is, in the robot's frame.
pub(crate) fn position(sighting: &Sighting) -> Point2<f64> {
    geometry::polar(sighting.distance, sighting.bearing).into()
}

/// A sighting of a goal post; nothing if it is of something else.
pub(crate) fn post(sighting: &Sighting, game: &GameState) -> Option<PostSighting> {
    let post = match sighting.kind() {
        ObjectKind::LeftPost => Post::Left,
        ObjectKind::RightPost => Post::Right,
        ObjectKind::SomePost => Post::Either,
        _ => return None,
    };
    let goal = game.goal_of(sighting.colour);
    Some(PostSighting { goal, post, distance: sighting.distance, bearing: sighting.bearing })
}

/// What the body is told: motion, head (yaw, pitch) and lights.
pub(crate) fn actuators(order: &Order, (head_yaw, head_pitch): (f64, f64), lights: LedRequest) -> Actuators {
    let skill = match order.skill {
        None => BodySkill::NoSkill,
        Some(Skill::KickLeft) => BodySkill::KickLeft,
        Some(Skill::KickRight) => BodySkill::KickRight,
        Some(Skill::FallLeft) => BodySkill::FallLeft,
        Some(Skill::FallRight) => BodySkill::FallRight,
        Some(Skill::DiveLeft) => BodySkill::DiveLeft,
        Some(Skill::DiveRight) => BodySkill::DiveRight,
        Some(Skill::StandUp) => BodySkill::StandUp,
    };
    Actuators {
        walk_x: order.walk.ahead,
        walk_y: order.walk.left,
        walk_turn: order.walk.turn,
        head_yaw,
        head_pitch,
        skill: skill.into(),
        skill_number: order.skill_number,
        left_eye: lights.left_eye,
        right_eye: lights.right_eye,
        chest: lights.chest,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn colours_have_the_same_numbers_on_both_sides() {
        for number in 0..=9 {
            let body = monas_robot::Colour::try_from(number).map(|colour| colour.as_str_name().to_owned());
            let soccer = crate::Colour::try_from(number).map(|colour| colour.as_str_name().to_owned());
            assert_eq!(body.ok(), soccer.ok(), "colour {number}");
        }
    }

    #[test]
    fn a_ball_that_does_not_cross_has_no_crossing() {
        let ball = Ball { x: 1.0, ..Ball::default() };
        let far = ball.with_crossing(None);
        assert!(!far.approaching && far.time_to_cross >= 1e6 && far.crossing_bearing == 0.0);
        let near = far.with_crossing(Some(Crossing { time: 0.5, y: -0.6 }));
        assert!(near.approaching && near.time_to_cross == 0.5);
        assert!((near.crossing_bearing + std::f64::consts::FRAC_PI_4).abs() < 1e-12);
    }
}
