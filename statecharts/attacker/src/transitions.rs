//! The transitions of the chart.

use ::monas::generated::TypedChartBuilder;

use super::guards;
use super::states::State;

/// The transitions, in the order of the document, each with its guard.
pub(crate) fn transitions(chart: &mut TypedChartBuilder) {
    chart.connect(
        State::START__of__player,
        State::RobotController__ever____par__LedHandler__ever____par__MotionController__ever____par____open__initialize__then__active__close__,
        "",
    );
    chart.connect(
        State::RobotController__ever____par__LedHandler__ever____par__MotionController__ever____par____open__initialize__then__active__close__,
        State::END__of__player,
        "[false]",
    );
    chart.connect(
        State::START__of__region1__of__RobotController__ever____par__LedHandler__ever____par__MotionController__ever____par____open__initialize__then__active__close__,
        State::RobotController__ever__,
        "",
    );
    chart.connect(
        State::RobotController__ever__,
        State::END__of__region1__of__RobotController__ever____par__LedHandler__ever____par__MotionController__ever____par____open__initialize__then__active__close__,
        "[false]",
    );
    chart.connect(
        State::START__of__region2__of__RobotController__ever____par__LedHandler__ever____par__MotionController__ever____par____open__initialize__then__active__close__,
        State::LedHandler__ever__,
        "",
    );
    chart.connect(
        State::LedHandler__ever__,
        State::END__of__region2__of__RobotController__ever____par__LedHandler__ever____par__MotionController__ever____par____open__initialize__then__active__close__,
        "[false]",
    );
    chart.connect(
        State::START__of__region3__of__RobotController__ever____par__LedHandler__ever____par__MotionController__ever____par____open__initialize__then__active__close__,
        State::MotionController__ever__,
        "",
    );
    chart.connect(
        State::MotionController__ever__,
        State::END__of__region3__of__RobotController__ever____par__LedHandler__ever____par__MotionController__ever____par____open__initialize__then__active__close__,
        "[false]",
    );
    chart.connect(
        State::START__of__region4__of__RobotController__ever____par__LedHandler__ever____par__MotionController__ever____par____open__initialize__then__active__close__,
        State::__open__initialize__then__active__close__,
        "",
    );
    chart.connect(
        State::__open__initialize__then__active__close__,
        State::END__of__region4__of__RobotController__ever____par__LedHandler__ever____par__MotionController__ever____par____open__initialize__then__active__close__,
        "[false]",
    );
    chart.connect(State::START__of__RobotController__ever__, State::RobotController, "");
    chart.connect(
        State::RobotController,
        State::RobotController,
        "[robot_timeout] / StartTimeout(robot_timeout, 100ms)",
    );
    chart.guard(guards::from_RobotController_to_RobotController);
    chart.connect(State::START__of__LedHandler__ever__, State::LedHandler, "");
    chart.connect(State::LedHandler, State::LedHandler, "[led_timeout] / StartTimeout(led_timeout, 100ms)");
    chart.guard(guards::from_LedHandler_to_LedHandler);
    chart.connect(State::START__of__MotionController__ever__, State::MotionController, "");
    chart.connect(
        State::MotionController,
        State::MotionController,
        "[motion_timeout] / StartTimeout(motion_timeout, 100ms)",
    );
    chart.guard(guards::from_MotionController_to_MotionController);
    chart.connect(State::START__of____open__initialize__then__active__close__, State::initialize, "");
    chart.connect(State::initialize, State::active, "");
    chart.connect(State::active, State::END__of____open__initialize__then__active__close__, "[false]");
    chart.connect(State::START__of__initialize, State::Stand, "");
    chart.connect(State::Stand, State::SendCalibration, "");
    chart.connect(State::SendCalibration, State::END__of__initialize, "");
    chart.connect(
        State::START__of__active,
        State::Sensors__ever____par__Vision__ever____par__WalkToKickOff__ever____par__decision__ever__,
        "",
    );
    chart.connect(
        State::Sensors__ever____par__Vision__ever____par__WalkToKickOff__ever____par__decision__ever__,
        State::END__of__active,
        "[false]",
    );
    chart.connect(
        State::START__of__region1__of__Sensors__ever____par__Vision__ever____par__WalkToKickOff__ever____par__decision__ever__,
        State::Sensors__ever__,
        "",
    );
    chart.connect(
        State::Sensors__ever__,
        State::END__of__region1__of__Sensors__ever____par__Vision__ever____par__WalkToKickOff__ever____par__decision__ever__,
        "[false]",
    );
    chart.connect(
        State::START__of__region2__of__Sensors__ever____par__Vision__ever____par__WalkToKickOff__ever____par__decision__ever__,
        State::Vision__ever__,
        "",
    );
    chart.connect(
        State::Vision__ever__,
        State::END__of__region2__of__Sensors__ever____par__Vision__ever____par__WalkToKickOff__ever____par__decision__ever__,
        "[false]",
    );
    chart.connect(
        State::START__of__region3__of__Sensors__ever____par__Vision__ever____par__WalkToKickOff__ever____par__decision__ever__,
        State::WalkToKickOff__ever__,
        "",
    );
    chart.connect(
        State::WalkToKickOff__ever__,
        State::END__of__region3__of__Sensors__ever____par__Vision__ever____par__WalkToKickOff__ever____par__decision__ever__,
        "[false]",
    );
    chart.connect(
        State::START__of__region4__of__Sensors__ever____par__Vision__ever____par__WalkToKickOff__ever____par__decision__ever__,
        State::decision__ever__,
        "",
    );
    chart.connect(
        State::decision__ever__,
        State::END__of__region4__of__Sensors__ever____par__Vision__ever____par__WalkToKickOff__ever____par__decision__ever__,
        "[false]",
    );
    chart.connect(State::START__of__Sensors__ever__, State::Sensors, "[GameState.player_state != PENALIZED]");
    chart.guard(guards::from_START_to_Sensors);
    chart.connect(
        State::Sensors,
        State::Sensors,
        "[sensors_timeout && GameState.player_state != PENALIZED] / StartTimeout(sensors_timeout, 100ms)",
    );
    chart.guard(guards::from_Sensors_to_Sensors);
    chart.connect(State::START__of__Vision__ever__, State::Vision, "[GameState.player_state != PENALIZED]");
    chart.guard(guards::from_START_to_Vision);
    chart.connect(
        State::Vision,
        State::Vision,
        "[vision_timeout && GameState.player_state != PENALIZED] / StartTimeout(vision_timeout, 100ms)",
    );
    chart.guard(guards::from_Vision_to_Vision);
    chart.connect(
        State::START__of__WalkToKickOff__ever__,
        State::WalkToKickOff,
        "[GameState.player_state == READY]",
    );
    chart.guard(guards::from_START_to_WalkToKickOff);
    chart.connect(
        State::WalkToKickOff,
        State::WalkToKickOff,
        "[place_timeout && GameState.player_state == READY] / StartTimeout(place_timeout, 100ms)",
    );
    chart.guard(guards::from_WalkToKickOff_to_WalkToKickOff);
    chart.connect(State::START__of__decision, State::WaitForBallMessage, "");
    chart.connect(State::WaitForBallMessage, State::__open__search__or__takeAction__close__, "");
    chart.connect(State::__open__search__or__takeAction__close__, State::END__of__decision, "");
    chart.connect(
        State::START__of____open__search__or__takeAction__close__,
        State::CONDITION__of____open__search__or__takeAction__close__,
        "",
    );
    chart.connect(
        State::CONDITION__of____open__search__or__takeAction__close__,
        State::search,
        "[!Ball.found]",
    );
    chart.guard(guards::from_CONDITION_to_search);
    chart.connect(
        State::CONDITION__of____open__search__or__takeAction__close__,
        State::takeAction,
        "[Ball.found]",
    );
    chart.guard(guards::from_CONDITION_to_takeAction);
    chart.connect(State::takeAction, State::END__of____open__search__or__takeAction__close__, "");
    chart.connect(State::search, State::END__of____open__search__or__takeAction__close__, "");
    chart.connect(State::START__of__search, State::SearchBall, "");
    chart.connect(State::SearchBall, State::__opt__roam__end__, "");
    chart.connect(State::__opt__roam__end__, State::END__of__search, "");
    chart.connect(State::START__of__roam, State::CONDITION__of__roam, "");
    chart.connect(State::CONDITION__of__roam, State::TurnAround, "");
    chart.connect(
        State::CONDITION__of__roam,
        State::WalkTowardsCentre,
        "[Ball.age > wander && (abs(Pose.x) > central || abs(Pose.y) > central)]",
    );
    chart.guard(guards::from_CONDITION_to_WalkTowardsCentre);
    chart.connect(State::WalkTowardsCentre, State::END__of__roam, "");
    chart.connect(State::TurnAround, State::END__of__roam, "");
    chart.connect(State::START__of____opt__roam__end__, State::CONDITION__of____opt__roam__end__, "");
    chart.connect(State::CONDITION__of____opt__roam__end__, State::roam, "[Ball.age >= look]");
    chart.guard(guards::from_CONDITION_to_roam);
    chart.connect(State::CONDITION__of____opt__roam__end__, State::END__of____opt__roam__end__, "");
    chart.connect(State::roam, State::END__of____opt__roam__end__, "");
    chart.connect(State::START__of__takeAction, State::__open__TrackBall__or__LookAtGoal__close__, "");
    chart.connect(
        State::__open__TrackBall__or__LookAtGoal__close__,
        State::__open__WalkTowardsBall__or__AlignWithBall__or__kickBall__or__SupportMate__close__,
        "",
    );
    chart.connect(
        State::__open__WalkTowardsBall__or__AlignWithBall__or__kickBall__or__SupportMate__close__,
        State::END__of__takeAction,
        "",
    );
    chart.connect(
        State::START__of____open__TrackBall__or__LookAtGoal__close__,
        State::CONDITION__of____open__TrackBall__or__LookAtGoal__close__,
        "",
    );
    chart.connect(State::CONDITION__of____open__TrackBall__or__LookAtGoal__close__, State::TrackBall, "");
    chart.connect(
        State::CONDITION__of____open__TrackBall__or__LookAtGoal__close__,
        State::LookAtGoal,
        "[glance_timeout && Pose.confidence < certain && Ball.distance > quiet && Ball.speed < still && Ball.age < seen] / StartTimeout(glance_timeout, 3000ms)",
    );
    chart.guard(guards::from_CONDITION_to_LookAtGoal);
    chart.connect(State::LookAtGoal, State::END__of____open__TrackBall__or__LookAtGoal__close__, "");
    chart.connect(State::TrackBall, State::END__of____open__TrackBall__or__LookAtGoal__close__, "");
    chart.connect(
        State::START__of____open__WalkTowardsBall__or__AlignWithBall__or__kickBall__or__SupportMate__close__,
        State::CONDITION__of____open__WalkTowardsBall__or__AlignWithBall__or__kickBall__or__SupportMate__close__,
        "",
    );
    chart.connect(
        State::CONDITION__of____open__WalkTowardsBall__or__AlignWithBall__or__kickBall__or__SupportMate__close__,
        State::WalkTowardsBall,
        "[Ball.distance > near && Ball.mate_lead <= nearer && !Ball.in_own_area]",
    );
    chart.guard(guards::from_CONDITION_to_WalkTowardsBall);
    chart.connect(
        State::CONDITION__of____open__WalkTowardsBall__or__AlignWithBall__or__kickBall__or__SupportMate__close__,
        State::AlignWithBall,
        "[Ball.distance <= near && (Ball.speed >= still || abs(Ball.x - kick_x) > tolerance || abs(abs(Ball.y) - kick_y) > tolerance)]",
    );
    chart.guard(guards::from_CONDITION_to_AlignWithBall);
    chart.connect(
        State::CONDITION__of____open__WalkTowardsBall__or__AlignWithBall__or__kickBall__or__SupportMate__close__,
        State::kickBall,
        "[Ball.distance <= near && Ball.speed < still && abs(Ball.x - kick_x) <= tolerance && abs(abs(Ball.y) - kick_y) <= tolerance]",
    );
    chart.guard(guards::from_CONDITION_to_kickBall);
    chart.connect(
        State::CONDITION__of____open__WalkTowardsBall__or__AlignWithBall__or__kickBall__or__SupportMate__close__,
        State::SupportMate,
        "[Ball.distance > near && (Ball.mate_lead > nearer || Ball.in_own_area)]",
    );
    chart.guard(guards::from_CONDITION_to_SupportMate);
    chart.connect(
        State::SupportMate,
        State::END__of____open__WalkTowardsBall__or__AlignWithBall__or__kickBall__or__SupportMate__close__,
        "",
    );
    chart.connect(
        State::kickBall,
        State::END__of____open__WalkTowardsBall__or__AlignWithBall__or__kickBall__or__SupportMate__close__,
        "",
    );
    chart.connect(
        State::AlignWithBall,
        State::END__of____open__WalkTowardsBall__or__AlignWithBall__or__kickBall__or__SupportMate__close__,
        "",
    );
    chart.connect(
        State::WalkTowardsBall,
        State::END__of____open__WalkTowardsBall__or__AlignWithBall__or__kickBall__or__SupportMate__close__,
        "",
    );
    chart.connect(State::START__of__kickBall, State::CONDITION__of__kickBall, "");
    chart.connect(State::CONDITION__of__kickBall, State::LeftKick, "[Ball.y >= 0]");
    chart.guard(guards::from_CONDITION_to_LeftKick);
    chart.connect(State::CONDITION__of__kickBall, State::RightKick, "[Ball.y < 0]");
    chart.guard(guards::from_CONDITION_to_RightKick);
    chart.connect(State::RightKick, State::END__of__kickBall, "");
    chart.connect(State::LeftKick, State::END__of__kickBall, "");
    chart.connect(State::START__of__decision__ever__, State::decision, "[GameState.player_state == PLAYING]");
    chart.guard(guards::from_START_to_decision);
    chart.connect(
        State::decision,
        State::decision,
        "[decision_timeout && GameState.player_state == PLAYING] / StartTimeout(decision_timeout, 100ms)",
    );
    chart.guard(guards::from_decision_to_decision);
}
