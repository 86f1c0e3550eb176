//! Conversions between messages and the types of functionalities.

use std::time::Duration;

use monas_robot::{
    Actuators, Announcement, GamePhase, ObjectKind, Posture as BodyPosture, Sighting, Skill as BodySkill,
    SkillResult,
};
use nalgebra::{Isometry2, Point2, Vector2};

use crate::functionality::ball_filter::{BallEstimate, BallSighting};
use crate::functionality::field::{FieldModel, Goal};
use crate::functionality::game;
use crate::functionality::geometry::{self, heading};
use crate::functionality::interception::Crossing;
use crate::functionality::kick_off::kick_off_pose;
use crate::functionality::landmarks::{GoalPost, Landmark, LandmarkSighting};
use crate::functionality::lights;
use crate::functionality::localisation::Localisation;
use crate::functionality::motion::{
    BodyReport, DesiredMotion, MotionCommand, PendingRequest, Posture, Skill, SkillEnd,
};
use crate::functionality::placement;
use crate::functionality::walk::Walk;
use crate::{
    Ball, Colour, GameState, LedRequest, MotionKind, MotionRequest, MotionResult, OtherRobot, Placement,
    PlayerState, Pose, SensorEntry,
};

/// `time_to_cross` of a ball that will not cross, seconds.
const NO_CROSSING: f64 = 1e6;

/// The distance behind the robot of the point from which `crossing_bearing` is measured, metres.
const CROSSING_DEPTH: f64 = 0.6;

impl Ball {
    /// Its position in the robot's frame.
    pub fn position(&self) -> Point2<f64> {
        Point2::new(self.x, self.y)
    }

    /// Its velocity over the ground, in the robot's frame.
    pub fn velocity(&self) -> Vector2<f64> {
        Vector2::new(self.vx, self.vy)
    }

    /// Sets its position and velocity.
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

    /// Sets where it crosses the robot's lateral axis, if it does.
    pub(crate) fn with_crossing(self, crossing: Option<Crossing>) -> Ball {
        let approaching = crossing.is_some();
        let crossing = crossing.unwrap_or(Crossing { time: NO_CROSSING, y: 0.0 });
        let crossing_bearing = if approaching { libm::atan2(crossing.y, CROSSING_DEPTH) } else { 0.0 };
        Ball { approaching, time_to_cross: crossing.time, crossing_y: crossing.y, crossing_bearing, ..self }
    }
}

impl Pose {
    /// The pose as a transformation from the robot's frame to the field frame.
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
    /// The pose of the robot relative to the start of accumulation.
    pub(crate) fn odometry(&self) -> Isometry2<f64> {
        geometry::pose(self.odometry_x, self.odometry_y, self.odometry_heading)
    }
}

impl OtherRobot {
    /// Its position in the robot's frame.
    pub fn position(&self) -> Point2<f64> {
        Point2::new(self.x, self.y)
    }
}

impl GameState {
    /// The model of the field.
    pub fn field(&self) -> FieldModel {
        FieldModel {
            length: self.field_length,
            width: self.field_width,
            goal_width: self.goal_width,
            area_depth: self.area_depth,
            area_width: self.area_width,
            circle_radius: self.circle_radius,
        }
    }

    /// The player's pose for the next kick-off.
    pub fn kick_off_pose(&self) -> Isometry2<f64> {
        geometry::pose(self.place_x, self.place_y, self.place_heading)
    }

    /// The same state with the pose for the next kick-off, which follows from the number.
    pub fn with_kick_off_pose(self) -> GameState {
        let wanted = kick_off_pose(&self.field(), self.number, self.kick_off_own);
        let (place_x, place_y) = (wanted.translation.x, wanted.translation.y);
        GameState { place_x, place_y, place_heading: heading(&wanted), ..self }
    }

    /// The goal of the given colour. Only yellow and blue distinguish the goals: both goals may be
    /// white.
    pub(crate) fn goal_of(&self, colour: i32) -> Option<Goal> {
        let is_distinct = |colour| [Colour::Yellow, Colour::Blue].map(i32::from).contains(&colour);
        let is_known = is_distinct(colour) && is_distinct(self.goal_to_attack);
        let goal = if colour == self.goal_to_attack { Goal::Opponent } else { Goal::Own };
        is_known.then_some(goal)
    }

    /// The player's state as a type of the functionalities.
    pub fn state(&self) -> game::PlayerState {
        match self.player_state() {
            PlayerState::Initial => game::PlayerState::Initial,
            PlayerState::Ready => game::PlayerState::Ready,
            PlayerState::Set => game::PlayerState::Set,
            PlayerState::Playing => game::PlayerState::Playing,
            PlayerState::Penalized => game::PlayerState::Penalized,
            PlayerState::Finished => game::PlayerState::Finished,
        }
    }
}

impl From<game::PlayerState> for PlayerState {
    fn from(state: game::PlayerState) -> PlayerState {
        match state {
            game::PlayerState::Initial => PlayerState::Initial,
            game::PlayerState::Ready => PlayerState::Ready,
            game::PlayerState::Set => PlayerState::Set,
            game::PlayerState::Playing => PlayerState::Playing,
            game::PlayerState::Penalized => PlayerState::Penalized,
            game::PlayerState::Finished => PlayerState::Finished,
        }
    }
}

impl From<placement::Placement> for Placement {
    fn from(placement: placement::Placement) -> Placement {
        match placement {
            placement::Placement::OwnHalf => Placement::OwnHalf,
            placement::Placement::HalfwayLine => Placement::HalfwayLine,
        }
    }
}

impl MotionRequest {
    /// The motion that is requested.
    pub fn desired(&self) -> DesiredMotion {
        match self.kind() {
            MotionKind::Stand => DesiredMotion::Stand,
            MotionKind::Walk => DesiredMotion::Walk(Walk { ahead: self.vx, left: self.vy, turn: self.wz }),
            MotionKind::KickLeft => DesiredMotion::Skill(Skill::KickLeft),
            MotionKind::KickRight => DesiredMotion::Skill(Skill::KickRight),
            MotionKind::FallLeft => DesiredMotion::Skill(Skill::FallLeft),
            MotionKind::FallRight => DesiredMotion::Skill(Skill::FallRight),
            MotionKind::DiveLeft => DesiredMotion::Skill(Skill::DiveLeft),
            MotionKind::DiveRight => DesiredMotion::Skill(Skill::DiveRight),
            MotionKind::StandUp => DesiredMotion::Skill(Skill::StandUp),
        }
    }

    /// The request as input of the motion arbiter.
    pub(crate) fn request(&self, age: Duration) -> PendingRequest {
        PendingRequest { motion: self.desired(), ball_speed: self.ball_speed, number: self.number, age }
    }
}

/// The phase of the game. Robots that must stand still while the game goes on wait as in SET.
pub fn phase(announced: &Announcement) -> game::GamePhase {
    match announced.phase() {
        GamePhase::Ready | GamePhase::Playing if announced.halted => game::GamePhase::Set,
        GamePhase::Initial => game::GamePhase::Initial,
        GamePhase::Ready => game::GamePhase::Ready,
        GamePhase::Set => game::GamePhase::Set,
        GamePhase::Playing => game::GamePhase::Playing,
        GamePhase::Finished => game::GamePhase::Finished,
    }
}

/// The state of a body, for the arbiter of motions.
pub fn report(sensors: &monas_robot::Sensors) -> BodyReport {
    let posture = match sensors.posture() {
        BodyPosture::Standing | BodyPosture::Walking => Posture::Upright,
        BodyPosture::Busy | BodyPosture::StandingUp | BodyPosture::Sitting | BodyPosture::Unknown => {
            Posture::Busy
        }
        BodyPosture::Fallen => Posture::Fallen,
        BodyPosture::Lifted => Posture::Lifted,
    };
    BodyReport { posture, skill_done: sensors.skill_done, skill_end: skill_end(sensors.skill_result()) }
}

fn skill_end(result: SkillResult) -> Option<SkillEnd> {
    match result {
        SkillResult::NoResult => None,
        SkillResult::Performed => Some(SkillEnd::Performed),
        SkillResult::Refused => Some(SkillEnd::Refused),
        SkillResult::Interrupted => Some(SkillEnd::Interrupted),
    }
}

/// The result of the last request for a skill, as a message.
pub fn motion_result(end: Option<SkillEnd>) -> MotionResult {
    match end {
        None => MotionResult::NoResult,
        Some(SkillEnd::Performed) => MotionResult::Performed,
        Some(SkillEnd::Refused) => MotionResult::Refused,
        Some(SkillEnd::Interrupted) => MotionResult::Interrupted,
    }
}

/// The motion since the sensors' previous message: the new pose in the old frame.
pub fn odometry(sensors: &monas_robot::Sensors) -> Isometry2<f64> {
    geometry::pose(sensors.odometry_x, sensors.odometry_y, sensors.odometry_turn)
}

/// The position of a sighted object in the robot's frame.
pub(crate) fn position(sighting: &Sighting) -> Point2<f64> {
    geometry::polar(sighting.distance, sighting.bearing).into()
}

/// A sighting, as seen from the robot's pose now; it was made in the frame `then`.
pub(crate) fn moved(sighting: &Sighting, then_from_now: &Isometry2<f64>) -> Sighting {
    let now = then_from_now.inverse_transform_point(&position(sighting)).coords;
    Sighting { distance: now.norm(), bearing: geometry::angle_of(&now), ..*sighting }
}

/// A sighting of a ball.
pub(crate) fn ball_sighting(sighting: Sighting) -> BallSighting {
    BallSighting { distance: sighting.distance, bearing: sighting.bearing }
}

/// A sighting of a landmark; none for other objects, and for a coloured post while the sides are
/// not known.
pub(crate) fn landmark(sighting: &Sighting, game: &GameState) -> Option<LandmarkSighting> {
    let post = |post| match sighting.colour() {
        monas_robot::Colour::White => Some(Landmark::PostOfEitherGoal(post)),
        _ => Some(Landmark::Post(game.goal_of(sighting.colour)?, post)),
    };
    let landmark = match sighting.kind() {
        ObjectKind::LeftPost => post(GoalPost::Left)?,
        ObjectKind::RightPost => post(GoalPost::Right)?,
        ObjectKind::SomePost => post(GoalPost::Either)?,
        ObjectKind::LineCorner => Landmark::Corner,
        ObjectKind::LineJunction => Landmark::Junction,
        ObjectKind::CentreCircle => Landmark::CentreCircle,
        ObjectKind::ObjectUnknown | ObjectKind::Ball | ObjectKind::Robot => return None,
    };
    Some(LandmarkSighting { landmark, distance: sighting.distance, bearing: sighting.bearing })
}

/// The commands to the body: motion, head (yaw, pitch) and LEDs.
pub fn actuators(order: &MotionCommand, (head_yaw, head_pitch): (f64, f64), lights: LedRequest) -> Actuators {
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
        left_foot: lights.left_foot,
        right_foot: lights.right_foot,
        ball_speed: order.ball_speed,
    }
}

/// The colours that show the state of a player: its game, if it knows it, whether it has found the
/// ball, and the confidence of its pose.
pub fn lights(game: Option<&GameState>, has_ball: bool, confidence: f64) -> LedRequest {
    let eyes = LedRequest {
        left_eye: lights::ball_eye(has_ball),
        right_eye: lights::pose_eye(confidence),
        ..LedRequest::default()
    };
    let Some(game) = game else { return eyes };
    LedRequest {
        chest: lights::chest(game.state()),
        left_foot: team_light(game.team_colour()),
        right_foot: lights::kick_off_foot(game.state(), game.kick_off_own),
        ..eyes
    }
}

/// The light of a team's colour; dark for one that is unknown, and for black.
fn team_light(colour: Colour) -> lights::Rgb {
    match colour {
        Colour::NoColour | Colour::Black => lights::OFF,
        Colour::Blue => 0x0000ff,
        Colour::Red => 0xff0000,
        Colour::Yellow => 0xffff00,
        Colour::Green => 0x00ff00,
        Colour::White => 0xffffff,
        Colour::Orange => 0xff8000,
        Colour::Purple => 0x8000ff,
        Colour::Brown => 0x804000,
        Colour::Gray => 0x808080,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn colours_have_the_same_numbers_on_both_sides() {
        for number in 0..=11 {
            let body = monas_robot::Colour::try_from(number).map(|colour| colour.as_str_name().to_owned());
            let soccer = Colour::try_from(number).map(|colour| colour.as_str_name().to_owned());
            assert_eq!(body.ok(), soccer.ok(), "colour {number}");
        }
    }

    #[test]
    fn set_plays_have_the_same_numbers_on_both_sides() {
        for number in 0..=7 {
            let body = monas_robot::SetPlay::try_from(number).map(|play| play.as_str_name().to_owned());
            let soccer = crate::SetPlay::try_from(number).map(|play| play.as_str_name().to_owned());
            assert_eq!(body.ok(), soccer.ok(), "set play {number}");
        }
    }

    #[test]
    fn a_post_is_of_the_goal_of_its_colour_and_a_white_one_of_either() {
        let post = |seen: Colour, attacked: Colour| {
            let game = GameState { goal_to_attack: attacked.into(), ..GameState::default() };
            let kind = ObjectKind::LeftPost.into();
            let sighting = Sighting { kind, colour: seen.into(), distance: 2.0, ..Sighting::default() };
            landmark(&sighting, &game).map(|seen| seen.landmark)
        };
        let left = |goal| Some(Landmark::Post(goal, GoalPost::Left));
        assert_eq!(post(Colour::Yellow, Colour::Yellow), left(Goal::Opponent));
        assert_eq!(post(Colour::Blue, Colour::Yellow), left(Goal::Own));
        assert_eq!(post(Colour::Yellow, Colour::Blue), left(Goal::Own));
        let either = Some(Landmark::PostOfEitherGoal(GoalPost::Left));
        for attacked in [Colour::Yellow, Colour::Blue, Colour::White, Colour::NoColour] {
            assert_eq!(post(Colour::White, attacked), either, "attacked: {attacked:?}");
        }
        assert_eq!(post(Colour::Yellow, Colour::NoColour), None, "the sides are not known");
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
