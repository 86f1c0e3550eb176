//! The structure of the chart.

use ::monas::generated::{Diagnostic, NodeKind, SourceDeclaration, TypedChart, TypedChartBuilder};

use super::states::State;
use super::transitions::transitions;
use super::words::{constants, functions, messages, timers, values};

/// The chart, with a function for each of its guards and values.
///
/// # Errors
/// Only if it was edited and is inconsistent.
pub fn chart() -> Result<TypedChart, Vec<Diagnostic>> {
    let mut chart = TypedChartBuilder::new("goalie");
    words(&mut chart);
    states(&mut chart);
    transitions(&mut chart);
    chart.finish()
}

/// The names that guards and actions use.
fn words(chart: &mut TypedChartBuilder) {
    chart.reads(messages::GAME_STATE, SourceDeclaration::own("soccer/game_state", "GameState"));
    chart.reads(messages::BALL, SourceDeclaration::own("soccer/ball", "Ball"));
    chart.starts(timers::robot_timeout, "robot_timeout");
    chart.starts(timers::led_timeout, "led_timeout");
    chart.starts(timers::motion_timeout, "motion_timeout");
    chart.starts(timers::sensors_timeout, "sensors_timeout");
    chart.starts(timers::vision_timeout, "vision_timeout");
    chart.starts(timers::place_timeout, "place_timeout");
    chart.starts(timers::decision_timeout, "decision_timeout");
    chart.calls(functions::abs, "abs");
    chart.means("PlayerState", "PENALIZED", values::PENALIZED);
    chart.means("PlayerState", "PLAYING", values::PLAYING);
    chart.means("PlayerState", "READY", values::READY);
    chart.constant("act_within", constants::act_within);
    chart.constant("fall_from", constants::fall_from);
    chart.constant("dive_from", constants::dive_from);
}

/// The states and connectors, in the order of the document.
fn states(chart: &mut TypedChartBuilder) {
    chart.add(State::START__of__goalie, State::goalie, NodeKind::Start, "");
    chart.add(
        State::RobotController__ever____par__LedHandler__ever____par__MotionController__ever____par____open__Stand__then__SendCalibration__then__active__close__,
        State::goalie,
        NodeKind::And,
        "RobotController~||LedHandler~||MotionController~||(Stand.SendCalibration.active)",
    );
    chart.add(State::END__of__goalie, State::goalie, NodeKind::End, "");
    chart.add(
        State::region1__of__RobotController__ever____par__LedHandler__ever____par__MotionController__ever____par____open__Stand__then__SendCalibration__then__active__close__,
        State::RobotController__ever____par__LedHandler__ever____par__MotionController__ever____par____open__Stand__then__SendCalibration__then__active__close__,
        NodeKind::Or,
        "",
    );
    chart.add(
        State::START__of__region1__of__RobotController__ever____par__LedHandler__ever____par__MotionController__ever____par____open__Stand__then__SendCalibration__then__active__close__,
        State::region1__of__RobotController__ever____par__LedHandler__ever____par__MotionController__ever____par____open__Stand__then__SendCalibration__then__active__close__,
        NodeKind::Start,
        "",
    );
    chart.add(
        State::RobotController__ever__,
        State::region1__of__RobotController__ever____par__LedHandler__ever____par__MotionController__ever____par____open__Stand__then__SendCalibration__then__active__close__,
        NodeKind::Or,
        "RobotController~",
    );
    chart.add(
        State::END__of__region1__of__RobotController__ever____par__LedHandler__ever____par__MotionController__ever____par____open__Stand__then__SendCalibration__then__active__close__,
        State::region1__of__RobotController__ever____par__LedHandler__ever____par__MotionController__ever____par____open__Stand__then__SendCalibration__then__active__close__,
        NodeKind::End,
        "",
    );
    chart.add(
        State::region2__of__RobotController__ever____par__LedHandler__ever____par__MotionController__ever____par____open__Stand__then__SendCalibration__then__active__close__,
        State::RobotController__ever____par__LedHandler__ever____par__MotionController__ever____par____open__Stand__then__SendCalibration__then__active__close__,
        NodeKind::Or,
        "",
    );
    chart.add(
        State::START__of__region2__of__RobotController__ever____par__LedHandler__ever____par__MotionController__ever____par____open__Stand__then__SendCalibration__then__active__close__,
        State::region2__of__RobotController__ever____par__LedHandler__ever____par__MotionController__ever____par____open__Stand__then__SendCalibration__then__active__close__,
        NodeKind::Start,
        "",
    );
    chart.add(
        State::LedHandler__ever__,
        State::region2__of__RobotController__ever____par__LedHandler__ever____par__MotionController__ever____par____open__Stand__then__SendCalibration__then__active__close__,
        NodeKind::Or,
        "LedHandler~",
    );
    chart.add(
        State::END__of__region2__of__RobotController__ever____par__LedHandler__ever____par__MotionController__ever____par____open__Stand__then__SendCalibration__then__active__close__,
        State::region2__of__RobotController__ever____par__LedHandler__ever____par__MotionController__ever____par____open__Stand__then__SendCalibration__then__active__close__,
        NodeKind::End,
        "",
    );
    chart.add(
        State::region3__of__RobotController__ever____par__LedHandler__ever____par__MotionController__ever____par____open__Stand__then__SendCalibration__then__active__close__,
        State::RobotController__ever____par__LedHandler__ever____par__MotionController__ever____par____open__Stand__then__SendCalibration__then__active__close__,
        NodeKind::Or,
        "",
    );
    chart.add(
        State::START__of__region3__of__RobotController__ever____par__LedHandler__ever____par__MotionController__ever____par____open__Stand__then__SendCalibration__then__active__close__,
        State::region3__of__RobotController__ever____par__LedHandler__ever____par__MotionController__ever____par____open__Stand__then__SendCalibration__then__active__close__,
        NodeKind::Start,
        "",
    );
    chart.add(
        State::MotionController__ever__,
        State::region3__of__RobotController__ever____par__LedHandler__ever____par__MotionController__ever____par____open__Stand__then__SendCalibration__then__active__close__,
        NodeKind::Or,
        "MotionController~",
    );
    chart.add(
        State::END__of__region3__of__RobotController__ever____par__LedHandler__ever____par__MotionController__ever____par____open__Stand__then__SendCalibration__then__active__close__,
        State::region3__of__RobotController__ever____par__LedHandler__ever____par__MotionController__ever____par____open__Stand__then__SendCalibration__then__active__close__,
        NodeKind::End,
        "",
    );
    chart.add(
        State::region4__of__RobotController__ever____par__LedHandler__ever____par__MotionController__ever____par____open__Stand__then__SendCalibration__then__active__close__,
        State::RobotController__ever____par__LedHandler__ever____par__MotionController__ever____par____open__Stand__then__SendCalibration__then__active__close__,
        NodeKind::Or,
        "",
    );
    chart.add(
        State::START__of__region4__of__RobotController__ever____par__LedHandler__ever____par__MotionController__ever____par____open__Stand__then__SendCalibration__then__active__close__,
        State::region4__of__RobotController__ever____par__LedHandler__ever____par__MotionController__ever____par____open__Stand__then__SendCalibration__then__active__close__,
        NodeKind::Start,
        "",
    );
    chart.add(
        State::__open__Stand__then__SendCalibration__then__active__close__,
        State::region4__of__RobotController__ever____par__LedHandler__ever____par__MotionController__ever____par____open__Stand__then__SendCalibration__then__active__close__,
        NodeKind::Or,
        "(Stand.SendCalibration.active)",
    );
    chart.add(
        State::END__of__region4__of__RobotController__ever____par__LedHandler__ever____par__MotionController__ever____par____open__Stand__then__SendCalibration__then__active__close__,
        State::region4__of__RobotController__ever____par__LedHandler__ever____par__MotionController__ever____par____open__Stand__then__SendCalibration__then__active__close__,
        NodeKind::End,
        "",
    );
    chart.add(State::START__of__RobotController__ever__, State::RobotController__ever__, NodeKind::Start, "");
    chart.add(State::RobotController, State::RobotController__ever__, NodeKind::Basic, "RobotController");
    chart.activity(State::RobotController, "RobotController");
    chart.add(State::START__of__LedHandler__ever__, State::LedHandler__ever__, NodeKind::Start, "");
    chart.add(State::LedHandler, State::LedHandler__ever__, NodeKind::Basic, "LedHandler");
    chart.activity(State::LedHandler, "LedHandler");
    chart.add(
        State::START__of__MotionController__ever__,
        State::MotionController__ever__,
        NodeKind::Start,
        "",
    );
    chart.add(State::MotionController, State::MotionController__ever__, NodeKind::Basic, "MotionController");
    chart.activity(State::MotionController, "MotionController");
    chart.add(
        State::START__of____open__Stand__then__SendCalibration__then__active__close__,
        State::__open__Stand__then__SendCalibration__then__active__close__,
        NodeKind::Start,
        "",
    );
    chart.add(
        State::Stand,
        State::__open__Stand__then__SendCalibration__then__active__close__,
        NodeKind::Basic,
        "Stand",
    );
    chart.activity(State::Stand, "Stand");
    chart.add(
        State::SendCalibration,
        State::__open__Stand__then__SendCalibration__then__active__close__,
        NodeKind::Basic,
        "SendCalibration",
    );
    chart.activity(State::SendCalibration, "SendCalibration");
    chart.add(
        State::active,
        State::__open__Stand__then__SendCalibration__then__active__close__,
        NodeKind::Or,
        "active",
    );
    chart.add(
        State::END__of____open__Stand__then__SendCalibration__then__active__close__,
        State::__open__Stand__then__SendCalibration__then__active__close__,
        NodeKind::End,
        "",
    );
    chart.add(State::START__of__active, State::active, NodeKind::Start, "");
    chart.add(
        State::Sensors__ever____par__Vision__ever____par__WalkToKickOff__ever____par__decision__ever__,
        State::active,
        NodeKind::And,
        "Sensors~||Vision~||WalkToKickOff~||decision~",
    );
    chart.add(State::END__of__active, State::active, NodeKind::End, "");
    chart.add(
        State::region1__of__Sensors__ever____par__Vision__ever____par__WalkToKickOff__ever____par__decision__ever__,
        State::Sensors__ever____par__Vision__ever____par__WalkToKickOff__ever____par__decision__ever__,
        NodeKind::Or,
        "",
    );
    chart.add(
        State::START__of__region1__of__Sensors__ever____par__Vision__ever____par__WalkToKickOff__ever____par__decision__ever__,
        State::region1__of__Sensors__ever____par__Vision__ever____par__WalkToKickOff__ever____par__decision__ever__,
        NodeKind::Start,
        "",
    );
    chart.add(
        State::Sensors__ever__,
        State::region1__of__Sensors__ever____par__Vision__ever____par__WalkToKickOff__ever____par__decision__ever__,
        NodeKind::Or,
        "Sensors~",
    );
    chart.add(
        State::END__of__region1__of__Sensors__ever____par__Vision__ever____par__WalkToKickOff__ever____par__decision__ever__,
        State::region1__of__Sensors__ever____par__Vision__ever____par__WalkToKickOff__ever____par__decision__ever__,
        NodeKind::End,
        "",
    );
    chart.add(
        State::region2__of__Sensors__ever____par__Vision__ever____par__WalkToKickOff__ever____par__decision__ever__,
        State::Sensors__ever____par__Vision__ever____par__WalkToKickOff__ever____par__decision__ever__,
        NodeKind::Or,
        "",
    );
    chart.add(
        State::START__of__region2__of__Sensors__ever____par__Vision__ever____par__WalkToKickOff__ever____par__decision__ever__,
        State::region2__of__Sensors__ever____par__Vision__ever____par__WalkToKickOff__ever____par__decision__ever__,
        NodeKind::Start,
        "",
    );
    chart.add(
        State::Vision__ever__,
        State::region2__of__Sensors__ever____par__Vision__ever____par__WalkToKickOff__ever____par__decision__ever__,
        NodeKind::Or,
        "Vision~",
    );
    chart.add(
        State::END__of__region2__of__Sensors__ever____par__Vision__ever____par__WalkToKickOff__ever____par__decision__ever__,
        State::region2__of__Sensors__ever____par__Vision__ever____par__WalkToKickOff__ever____par__decision__ever__,
        NodeKind::End,
        "",
    );
    chart.add(
        State::region3__of__Sensors__ever____par__Vision__ever____par__WalkToKickOff__ever____par__decision__ever__,
        State::Sensors__ever____par__Vision__ever____par__WalkToKickOff__ever____par__decision__ever__,
        NodeKind::Or,
        "",
    );
    chart.add(
        State::START__of__region3__of__Sensors__ever____par__Vision__ever____par__WalkToKickOff__ever____par__decision__ever__,
        State::region3__of__Sensors__ever____par__Vision__ever____par__WalkToKickOff__ever____par__decision__ever__,
        NodeKind::Start,
        "",
    );
    chart.add(
        State::WalkToKickOff__ever__,
        State::region3__of__Sensors__ever____par__Vision__ever____par__WalkToKickOff__ever____par__decision__ever__,
        NodeKind::Or,
        "WalkToKickOff~",
    );
    chart.add(
        State::END__of__region3__of__Sensors__ever____par__Vision__ever____par__WalkToKickOff__ever____par__decision__ever__,
        State::region3__of__Sensors__ever____par__Vision__ever____par__WalkToKickOff__ever____par__decision__ever__,
        NodeKind::End,
        "",
    );
    chart.add(
        State::region4__of__Sensors__ever____par__Vision__ever____par__WalkToKickOff__ever____par__decision__ever__,
        State::Sensors__ever____par__Vision__ever____par__WalkToKickOff__ever____par__decision__ever__,
        NodeKind::Or,
        "",
    );
    chart.add(
        State::START__of__region4__of__Sensors__ever____par__Vision__ever____par__WalkToKickOff__ever____par__decision__ever__,
        State::region4__of__Sensors__ever____par__Vision__ever____par__WalkToKickOff__ever____par__decision__ever__,
        NodeKind::Start,
        "",
    );
    chart.add(
        State::decision__ever__,
        State::region4__of__Sensors__ever____par__Vision__ever____par__WalkToKickOff__ever____par__decision__ever__,
        NodeKind::Or,
        "decision~",
    );
    chart.add(
        State::END__of__region4__of__Sensors__ever____par__Vision__ever____par__WalkToKickOff__ever____par__decision__ever__,
        State::region4__of__Sensors__ever____par__Vision__ever____par__WalkToKickOff__ever____par__decision__ever__,
        NodeKind::End,
        "",
    );
    chart.add(State::START__of__Sensors__ever__, State::Sensors__ever__, NodeKind::Start, "");
    chart.add(State::Sensors, State::Sensors__ever__, NodeKind::Basic, "Sensors");
    chart.activity(State::Sensors, "Sensors");
    chart.add(State::START__of__Vision__ever__, State::Vision__ever__, NodeKind::Start, "");
    chart.add(State::Vision, State::Vision__ever__, NodeKind::Basic, "Vision");
    chart.activity(State::Vision, "Vision");
    chart.add(State::START__of__WalkToKickOff__ever__, State::WalkToKickOff__ever__, NodeKind::Start, "");
    chart.add(State::WalkToKickOff, State::WalkToKickOff__ever__, NodeKind::Basic, "WalkToKickOff");
    chart.activity(State::WalkToKickOff, "WalkToKickOff");
    chart.add(State::START__of__decision__ever__, State::decision__ever__, NodeKind::Start, "");
    chart.add(State::decision, State::decision__ever__, NodeKind::Or, "decision");
    chart.add(State::START__of__decision, State::decision, NodeKind::Start, "");
    chart.add(State::WaitForBallMessage, State::decision, NodeKind::Basic, "WaitForBallMessage");
    chart.activity(State::WaitForBallMessage, "WaitForBallMessage");
    chart.add(
        State::__open__search__or__takeAction__close__,
        State::decision,
        NodeKind::Or,
        "(search|takeAction)",
    );
    chart.add(State::END__of__decision, State::decision, NodeKind::End, "");
    chart.add(
        State::START__of____open__search__or__takeAction__close__,
        State::__open__search__or__takeAction__close__,
        NodeKind::Start,
        "",
    );
    chart.add(
        State::CONDITION__of____open__search__or__takeAction__close__,
        State::__open__search__or__takeAction__close__,
        NodeKind::Condition,
        "",
    );
    chart.add(State::search, State::__open__search__or__takeAction__close__, NodeKind::Or, "search");
    chart.add(State::takeAction, State::__open__search__or__takeAction__close__, NodeKind::Or, "takeAction");
    chart.add(
        State::END__of____open__search__or__takeAction__close__,
        State::__open__search__or__takeAction__close__,
        NodeKind::End,
        "",
    );
    chart.add(State::START__of__search, State::search, NodeKind::Start, "");
    chart.add(State::SearchBall, State::search, NodeKind::Basic, "SearchBall");
    chart.activity(State::SearchBall, "SearchBall");
    chart.add(State::ReturnToGoal, State::search, NodeKind::Basic, "ReturnToGoal");
    chart.activity(State::ReturnToGoal, "ReturnToGoal");
    chart.add(State::END__of__search, State::search, NodeKind::End, "");
    chart.add(State::START__of__takeAction, State::takeAction, NodeKind::Start, "");
    chart.add(State::CONDITION__of__takeAction, State::takeAction, NodeKind::Condition, "");
    chart.add(State::guardGoal, State::takeAction, NodeKind::Or, "guardGoal");
    chart.add(State::action, State::takeAction, NodeKind::Or, "action");
    chart.add(State::END__of__takeAction, State::takeAction, NodeKind::End, "");
    chart.add(State::START__of__guardGoal, State::guardGoal, NodeKind::Start, "");
    chart.add(State::TrackBall, State::guardGoal, NodeKind::Basic, "TrackBall");
    chart.activity(State::TrackBall, "TrackBall");
    chart.add(
        State::__open__KeepGoal__or__StepAside__close__,
        State::guardGoal,
        NodeKind::Or,
        "(KeepGoal|StepAside)",
    );
    chart.add(State::END__of__guardGoal, State::guardGoal, NodeKind::End, "");
    chart.add(
        State::START__of____open__KeepGoal__or__StepAside__close__,
        State::__open__KeepGoal__or__StepAside__close__,
        NodeKind::Start,
        "",
    );
    chart.add(
        State::CONDITION__of____open__KeepGoal__or__StepAside__close__,
        State::__open__KeepGoal__or__StepAside__close__,
        NodeKind::Condition,
        "",
    );
    chart.add(State::KeepGoal, State::__open__KeepGoal__or__StepAside__close__, NodeKind::Basic, "KeepGoal");
    chart.activity(State::KeepGoal, "KeepGoal");
    chart.add(
        State::StepAside,
        State::__open__KeepGoal__or__StepAside__close__,
        NodeKind::Basic,
        "StepAside",
    );
    chart.activity(State::StepAside, "StepAside");
    chart.add(
        State::END__of____open__KeepGoal__or__StepAside__close__,
        State::__open__KeepGoal__or__StepAside__close__,
        NodeKind::End,
        "",
    );
    chart.add(State::START__of__action, State::action, NodeKind::Start, "");
    chart.add(State::CONDITION__of__action, State::action, NodeKind::Condition, "");
    chart.add(State::RightFall, State::action, NodeKind::Basic, "RightFall");
    chart.activity(State::RightFall, "RightFall");
    chart.add(State::LeftFall, State::action, NodeKind::Basic, "LeftFall");
    chart.activity(State::LeftFall, "LeftFall");
    chart.add(State::RightDive, State::action, NodeKind::Basic, "RightDive");
    chart.activity(State::RightDive, "RightDive");
    chart.add(State::LeftDive, State::action, NodeKind::Basic, "LeftDive");
    chart.activity(State::LeftDive, "LeftDive");
    chart.add(State::END__of__action, State::action, NodeKind::End, "");
}
