//! Test support: the decisions that every methodology has to take.
//!
//! Each case has the name and the inputs of a scenario in `tests/scenarios`, which tests the roles;
//! the tests of `direct` and `agents` play all of them, so that the three are tested equally.

use monas_soccer::functionality::aim::{kick_target, shot_target};
use monas_soccer::functionality::align::Alignment;
use monas_soccer::functionality::approach::Approach;
use monas_soccer::functionality::avoidance::{avoid, keep_out};
use monas_soccer::functionality::field::{FieldModel, Goal};
use monas_soccer::functionality::geometry::angle_of;
use monas_soccer::functionality::guard::GoalPositioning;
use monas_soccer::functionality::head::{Gaze, HeadController};
use monas_soccer::functionality::motion::{DesiredMotion, Skill};
use monas_soccer::functionality::support::{DISTANCE_AHEAD, support_position};
use monas_soccer::functionality::walk::{Walk, stride_to};
use monas_soccer::{Ball, GameState, PlayerState, Pose};
use nalgebra::{Point2, Vector2};

use crate::thresholds::goalie::{ACT_WITHIN, DIVE_FROM, FALL_FROM};
use crate::thresholds::player::*;

/// The target of the head.
#[derive(Clone, Copy, PartialEq, Debug)]
pub(crate) enum GazeTarget {
    Scan,
    At(Gaze),
}

/// The requests of a behaviour in one decision; none if it did not decide.
pub(crate) type Requests = (Option<GazeTarget>, Option<DesiredMotion>);

/// A decision, by the name of the state in which the role ends.
#[derive(Clone, Copy, PartialEq, Debug)]
pub(crate) enum Decision {
    ReturnToGoal,
    KeepGoal,
    StepAside,
    SearchBall,
    TurnAround,
    WalkTowardsCentre,
    LookAtGoal,
    WalkTowardsBall,
    AlignWithBall,
    SupportMate,
    Skill(Skill),
}

/// The inputs of a decision, and the decision.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Case {
    pub(crate) scenario: &'static str,
    pub(crate) ball: Ball,
    pub(crate) pose: Pose,
    pub(crate) decision: Decision,
}

/// The game of all cases.
pub(crate) fn game() -> GameState {
    let FieldModel { length, width, goal_width, area_depth, area_width, circle_radius } =
        FieldModel::LEAGUE_2010;
    GameState {
        player_state: PlayerState::Playing.into(),
        field_length: length,
        field_width: width,
        goal_width,
        area_depth,
        area_width,
        circle_radius,
        ..GameState::default()
    }
}

/// The cases of the goalie.
pub(crate) fn goalie_cases() -> Vec<Case> {
    let pose = Pose { x: -2.7, confidence: 0.9, ..Pose::default() };
    let case = |scenario, found, approaching, time_to_cross, crossing_bearing, decision| {
        let (bearing, distance) = (0.05, 1.0);
        let ball =
            Ball { found, approaching, time_to_cross, crossing_bearing, bearing, distance, ..at(1.0, 0.05) };
        Case { scenario, ball: Ball { crossing_y: 0.1, ..ball }, pose, decision }
    };
    vec![
        case("acts_in_time", true, true, ACT_WITHIN, -0.3, Decision::Skill(Skill::FallRight)),
        case("dive_left", true, true, 0.5, 0.45, Decision::Skill(Skill::DiveLeft)),
        case("dive_right", true, true, 0.5, -0.45, Decision::Skill(Skill::DiveRight)),
        case("fall_left", true, true, 0.5, 0.3, Decision::Skill(Skill::FallLeft)),
        case("fall_right", true, true, 0.5, -0.3, Decision::Skill(Skill::FallRight)),
        case("farthest_fall_left", true, true, 0.5, DIVE_FROM, Decision::Skill(Skill::FallLeft)),
        case("farthest_fall_right", true, true, 0.5, -DIVE_FROM, Decision::Skill(Skill::FallRight)),
        case("nearest_fall", true, true, 0.5, FALL_FROM, Decision::Skill(Skill::FallLeft)),
        case("search", false, true, 0.5, 0.3, Decision::ReturnToGoal),
        case("stays_for_a_ball_at_the_body", true, true, 0.5, 0.24, Decision::StepAside),
        case("stays_for_a_ball_that_leaves", true, false, 0.5, 0.3, Decision::KeepGoal),
        case("stays_for_a_slow_ball", true, true, 1.05, 0.3, Decision::StepAside),
    ]
}

/// The cases of the attacker.
pub(crate) fn player_cases() -> Vec<Case> {
    use Decision::{AlignWithBall, LookAtGoal, SearchBall, SupportMate, TurnAround, WalkTowardsBall};
    let certain = Pose { x: -1.0, confidence: 0.95, ..Pose::default() };
    let seen = |scenario, distance, x, y, decision| {
        let ball = Ball { found: true, distance, ..at(x, y) };
        Case { scenario, ball, pose: certain, decision }
    };
    let lost = |scenario, age, (x, y), decision| {
        let ball = Ball { age, distance: 0.5, ..at(0.4, 0.3) };
        Case { scenario, ball, pose: Pose { x, y, ..certain }, decision }
    };
    let rolls = |case: Case, speed| Case { ball: Ball { speed, ..case.ball }, ..case };
    let led = |case: Case, mate_lead, in_own_area| Case {
        ball: Ball { mate_lead, in_own_area, ..case.ball },
        ..case
    };
    let looks = |scenario, distance, speed, age, confidence, decision| {
        let ball = Ball { found: true, distance, speed, age, ..at(0.6, 0.4) };
        Case { scenario, ball, pose: Pose { confidence, ..certain }, decision }
    };
    let (left, right) = (Decision::Skill(Skill::KickLeft), Decision::Skill(Skill::KickRight));
    let (just, aside) = (0.001, Decision::WalkTowardsCentre);
    vec![
        seen("align", NEAR, 0.24, 0.0, AlignWithBall),
        seen("align_ahead", 0.2, 0.176, KICK.1, AlignWithBall),
        seen("align_aside", 0.16, KICK.0, 0.02, AlignWithBall),
        lost("head_searches_first", LOOK - just, (0.0, 0.0), SearchBall),
        seen("kick_close", 0.14, 0.13, KICK.1 - TOLERANCE, left),
        seen("kick_from_near", NEAR, KICK.0, -KICK.1, right),
        seen("kick_left", 0.16, KICK.0, KICK.1, left),
        seen("kick_right", 0.16, KICK.0, -KICK.1, right),
        seen("kick_stretched", 0.19, 0.17, 0.074, left),
        looks("look_at_goal", QUIET + just, STILL - just, SEEN - just, CERTAIN - just, LookAtGoal),
        led(seen("near_beats_support", NEAR, 0.24, 0.05, AlignWithBall), 1.0, true),
        looks("no_look_certain", QUIET + just, STILL - just, SEEN - just, CERTAIN, WalkTowardsBall),
        looks("no_look_near", QUIET, STILL - just, SEEN - just, CERTAIN - just, WalkTowardsBall),
        looks("no_look_rolling", QUIET + just, STILL, SEEN - just, CERTAIN - just, WalkTowardsBall),
        looks("no_look_unseen", QUIET + just, STILL - just, SEEN, CERTAIN - just, WalkTowardsBall),
        led(seen("no_support", 1.0, 0.9, 0.3, WalkTowardsBall), NEARER, false),
        led(seen("own_area", 1.0, 0.9, 0.3, SupportMate), 0.0, true),
        rolls(seen("rolling_ball", 0.16, KICK.0, KICK.1, AlignWithBall), STILL),
        lost("search", 0.0, (0.0, 0.0), SearchBall),
        led(seen("support", 1.0, 0.9, 0.3, SupportMate), NEARER + just, false),
        lost("to_centre", WANDER + just, (CENTRAL + just, 0.0), aside),
        lost("to_centre_behind", WANDER + just, (-CENTRAL - just, 0.0), aside),
        lost("to_centre_left", WANDER + just, (0.0, CENTRAL + just), aside),
        lost("to_centre_right", WANDER + just, (0.0, -CENTRAL - just), aside),
        lost("turn", LOOK, (0.0, 0.0), TurnAround),
        lost("turn_before_centre", WANDER, (2.0, 1.0), TurnAround),
        lost("turn_in_centre", WANDER + just, (CENTRAL, CENTRAL), TurnAround),
        seen("walk", 1.0, 0.9, 0.3, WalkTowardsBall),
        seen("walk_the_last_steps", 0.26, KICK.0, KICK.1, WalkTowardsBall),
    ]
}

fn at(x: f64, y: f64) -> Ball {
    Ball { x, y, bearing: angle_of(&Vector2::new(x, y)), ..Ball::default() }
}

impl Case {
    /// Panics unless the requests are those of the decision.
    pub(crate) fn assert(&self, (look, motion): Requests) {
        let (expected_look, expected_motion) = self.requests();
        assert_eq!(look, expected_look, "{}: {:?} looks so", self.scenario, self.decision);
        assert_eq!(motion, expected_motion, "{}: {:?} moves so", self.scenario, self.decision);
    }

    /// The requests of the skills in the decision's states.
    fn requests(&self) -> Requests {
        let (field, pose, ball) = (game().field(), self.pose.field_from_robot(), self.ball.position());
        let watch = Some(GazeTarget::At(HeadController::default().look_at(ball)));
        let inside = |walk: Walk| Some(DesiredMotion::Walk(keep_out(walk, &field, &pose)));
        let guard = GoalPositioning::default();
        let stand_at = |place| Some(DesiredMotion::Walk(guard.walk(&pose, &place)));
        let target = kick_target(&field, pose * ball, shot_target(&field, pose * ball, &[]));
        let target = pose.inverse_transform_point(&target);
        match self.decision {
            Decision::ReturnToGoal => (Some(GazeTarget::Scan), stand_at(guard.keeper_pose(&field, None))),
            Decision::KeepGoal => (watch, stand_at(guard.keeper_pose(&field, Some(pose * ball)))),
            Decision::StepAside => {
                (watch, Some(DesiredMotion::Walk(guard.step_before(self.ball.crossing_y))))
            }
            Decision::SearchBall => (Some(GazeTarget::Scan), None),
            Decision::TurnAround => {
                (Some(GazeTarget::Scan), inside(Walk::turning(TURN.copysign(self.ball.bearing))))
            }
            Decision::WalkTowardsCentre => {
                let centre = pose.inverse_transform_point(&Point2::origin());
                (Some(GazeTarget::Scan), inside(stride_to(centre, centre.coords.norm())))
            }
            Decision::LookAtGoal => {
                let goal = pose.inverse_transform_point(&field.goal(Goal::Opponent));
                (Some(GazeTarget::At(HeadController::default().look_at(goal))), None)
            }
            Decision::WalkTowardsBall => (watch, inside(Approach::default().walk(ball, target, &[]))),
            Decision::AlignWithBall => {
                (watch, Some(DesiredMotion::Walk(Alignment::default().walk(ball, target))))
            }
            Decision::SupportMate => {
                let here = Point2::from(pose.translation.vector);
                let place = pose.inverse_transform_point(&support_position(
                    &field,
                    pose * ball,
                    here,
                    DISTANCE_AHEAD,
                ));
                (watch, inside(stride_to(avoid(place, &[ball]), place.coords.norm())))
            }
            // A kick follows a look at the ball; before a dive the head stays.
            Decision::Skill(skill @ (Skill::KickLeft | Skill::KickRight)) => {
                (watch, Some(DesiredMotion::Skill(skill)))
            }
            Decision::Skill(skill) => (None, Some(DesiredMotion::Skill(skill))),
        }
    }
}

/// Scenarios of more than one decision: `play` in the tests of each methodology corresponds.
const OF_TIME: [&str; 12] = [
    "at_rest",
    "decides_in_time",
    "kick_off",
    "led_keeps_time",
    "motion_keeps_time",
    "no_message",
    "penalized",
    "playing",
    "ready",
    "robot_keeps_time",
    "sensors_keep_time",
    "vision_keeps_time",
];

#[test]
fn every_scenario_of_a_decision_is_a_case() {
    let folder = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("../../tests/scenarios");
    for (player, cases) in [("goalie", goalie_cases()), ("attacker", player_cases())] {
        let mut names: Vec<&str> = cases.iter().map(|case| case.scenario).chain(OF_TIME).collect();
        names.sort_unstable();
        let files = std::fs::read_dir(folder.join(player)).unwrap();
        let mut files: Vec<String> = files
            .map(|file| file.unwrap().path().file_stem().unwrap().to_string_lossy().into_owned())
            .collect();
        files.sort_unstable();
        assert_eq!(names, files, "cases of the {player}, and scenarios");
    }
}
