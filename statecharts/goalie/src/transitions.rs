//! The transitions of the chart.

use ::monas::generated::TypedChartBuilder;

use super::guards;
use super::states::State;

/// The transitions, in the order of the document, each with its guard.
pub(crate) fn transitions(chart: &mut TypedChartBuilder) {
    chart.connect(
        State::START__of__goalie,
        State::RobotController__ever____par__LedHandler__ever____par__MotionController__ever____par____open__Stand__then__SendCalibration__then__active__close__,
        "",
    );
    chart.connect(
        State::RobotController__ever____par__LedHandler__ever____par__MotionController__ever____par____open__Stand__then__SendCalibration__then__active__close__,
        State::END__of__goalie,
        "[false]",
    );
    chart.connect(
        State::START__of__region1__of__RobotController__ever____par__LedHandler__ever____par__MotionController__ever____par____open__Stand__then__SendCalibration__then__active__close__,
        State::RobotController__ever__,
        "",
    );
    chart.connect(
        State::RobotController__ever__,
        State::END__of__region1__of__RobotController__ever____par__LedHandler__ever____par__MotionController__ever____par____open__Stand__then__SendCalibration__then__active__close__,
        "[false]",
    );
    chart.connect(
        State::START__of__region2__of__RobotController__ever____par__LedHandler__ever____par__MotionController__ever____par____open__Stand__then__SendCalibration__then__active__close__,
        State::LedHandler__ever__,
        "",
    );
    chart.connect(
        State::LedHandler__ever__,
        State::END__of__region2__of__RobotController__ever____par__LedHandler__ever____par__MotionController__ever____par____open__Stand__then__SendCalibration__then__active__close__,
        "[false]",
    );
    chart.connect(
        State::START__of__region3__of__RobotController__ever____par__LedHandler__ever____par__MotionController__ever____par____open__Stand__then__SendCalibration__then__active__close__,
        State::MotionController__ever__,
        "",
    );
    chart.connect(
        State::MotionController__ever__,
        State::END__of__region3__of__RobotController__ever____par__LedHandler__ever____par__MotionController__ever____par____open__Stand__then__SendCalibration__then__active__close__,
        "[false]",
    );
    chart.connect(
        State::START__of__region4__of__RobotController__ever____par__LedHandler__ever____par__MotionController__ever____par____open__Stand__then__SendCalibration__then__active__close__,
        State::__open__Stand__then__SendCalibration__then__active__close__,
        "",
    );
    chart.connect(
        State::__open__Stand__then__SendCalibration__then__active__close__,
        State::END__of__region4__of__RobotController__ever____par__LedHandler__ever____par__MotionController__ever____par____open__Stand__then__SendCalibration__then__active__close__,
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
    chart.connect(
        State::START__of____open__Stand__then__SendCalibration__then__active__close__,
        State::Stand,
        "",
    );
    chart.connect(State::Stand, State::SendCalibration, "");
    chart.connect(State::SendCalibration, State::active, "");
    chart.connect(
        State::active,
        State::END__of____open__Stand__then__SendCalibration__then__active__close__,
        "[false]",
    );
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
        "[vision_timeout && GameState.player_state != PENALIZED] / StartTimeout(vision_timeout, 200ms)",
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
    chart.connect(State::SearchBall, State::ReturnToGoal, "");
    chart.connect(State::ReturnToGoal, State::END__of__search, "");
    chart.connect(State::START__of__takeAction, State::CONDITION__of__takeAction, "");
    chart.connect(
        State::CONDITION__of__takeAction,
        State::guardGoal,
        "[!(Ball.approaching && Ball.time_to_cross <= act_within && abs(Ball.crossing_bearing) >= fall_from)]",
    );
    chart.guard(guards::from_CONDITION_to_guardGoal);
    chart.connect(
        State::CONDITION__of__takeAction,
        State::action,
        "[Ball.approaching && Ball.time_to_cross <= act_within && abs(Ball.crossing_bearing) >= fall_from]",
    );
    chart.guard(guards::from_CONDITION_to_action);
    chart.connect(State::action, State::END__of__takeAction, "");
    chart.connect(State::guardGoal, State::END__of__takeAction, "");
    chart.connect(State::START__of__guardGoal, State::TrackBall, "");
    chart.connect(State::TrackBall, State::__open__KeepGoal__or__StepAside__close__, "");
    chart.connect(State::__open__KeepGoal__or__StepAside__close__, State::END__of__guardGoal, "");
    chart.connect(
        State::START__of____open__KeepGoal__or__StepAside__close__,
        State::CONDITION__of____open__KeepGoal__or__StepAside__close__,
        "",
    );
    chart.connect(
        State::CONDITION__of____open__KeepGoal__or__StepAside__close__,
        State::KeepGoal,
        "[!Ball.approaching]",
    );
    chart.guard(guards::from_CONDITION_to_KeepGoal);
    chart.connect(
        State::CONDITION__of____open__KeepGoal__or__StepAside__close__,
        State::StepAside,
        "[Ball.approaching]",
    );
    chart.guard(guards::from_CONDITION_to_StepAside);
    chart.connect(State::StepAside, State::END__of____open__KeepGoal__or__StepAside__close__, "");
    chart.connect(State::KeepGoal, State::END__of____open__KeepGoal__or__StepAside__close__, "");
    chart.connect(State::START__of__action, State::CONDITION__of__action, "");
    chart.connect(
        State::CONDITION__of__action,
        State::RightFall,
        "[Ball.crossing_bearing < 0 && Ball.crossing_bearing >= -dive_from]",
    );
    chart.guard(guards::from_CONDITION_to_RightFall);
    chart.connect(
        State::CONDITION__of__action,
        State::LeftFall,
        "[Ball.crossing_bearing >= 0 && Ball.crossing_bearing <= dive_from]",
    );
    chart.guard(guards::from_CONDITION_to_LeftFall);
    chart.connect(State::CONDITION__of__action, State::RightDive, "[Ball.crossing_bearing < -dive_from]");
    chart.guard(guards::from_CONDITION_to_RightDive);
    chart.connect(State::CONDITION__of__action, State::LeftDive, "[Ball.crossing_bearing > dive_from]");
    chart.guard(guards::from_CONDITION_to_LeftDive);
    chart.connect(State::LeftDive, State::END__of__action, "");
    chart.connect(State::RightDive, State::END__of__action, "");
    chart.connect(State::LeftFall, State::END__of__action, "");
    chart.connect(State::RightFall, State::END__of__action, "");
    chart.connect(State::START__of__decision__ever__, State::decision, "[GameState.player_state == PLAYING]");
    chart.guard(guards::from_START_to_decision);
    chart.connect(
        State::decision,
        State::decision,
        "[decision_timeout && GameState.player_state == PLAYING] / StartTimeout(decision_timeout, 100ms)",
    );
    chart.guard(guards::from_decision_to_decision);
}
