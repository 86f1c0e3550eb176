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
    let mut chart = TypedChartBuilder::new("player");
    words(&mut chart);
    states(&mut chart);
    transitions(&mut chart);
    chart.finish()
}

/// The names that guards and actions use.
fn words(chart: &mut TypedChartBuilder) {
    chart.reads(messages::GAME_STATE, SourceDeclaration::own("soccer/game_state", "GameState"));
    chart.reads(messages::BALL, SourceDeclaration::own("soccer/ball", "Ball"));
    chart.reads(messages::POSE, SourceDeclaration::own("soccer/pose", "Pose"));
    chart.starts(timers::robot_timeout, "robot_timeout");
    chart.starts(timers::led_timeout, "led_timeout");
    chart.starts(timers::motion_timeout, "motion_timeout");
    chart.starts(timers::sensors_timeout, "sensors_timeout");
    chart.starts(timers::vision_timeout, "vision_timeout");
    chart.starts(timers::place_timeout, "place_timeout");
    chart.starts(timers::glance_timeout, "glance_timeout");
    chart.starts(timers::decision_timeout, "decision_timeout");
    chart.calls(functions::abs, "abs");
    chart.means("PlayerState", "PENALIZED", values::PENALIZED);
    chart.means("PlayerState", "PLAYING", values::PLAYING);
    chart.means("PlayerState", "READY", values::READY);
    chart.constant("near", constants::near);
    chart.constant("kick_x", constants::kick_x);
    chart.constant("kick_y", constants::kick_y);
    chart.constant("tolerance", constants::tolerance);
    chart.constant("nearer", constants::nearer);
    chart.constant("look", constants::look);
    chart.constant("wander", constants::wander);
    chart.constant("central", constants::central);
    chart.constant("certain", constants::certain);
    chart.constant("quiet", constants::quiet);
    chart.constant("still", constants::still);
    chart.constant("seen", constants::seen);
}

/// The states and connectors, in the order of the document.
fn states(chart: &mut TypedChartBuilder) {
    chart.add(State::START__of__player, State::player, NodeKind::Start, "");
    chart.add(
        State::RobotController__ever____par__LedHandler__ever____par__MotionController__ever____par____open__initialize__then__active__close__,
        State::player,
        NodeKind::And,
        "RobotController~||LedHandler~||MotionController~||(initialize.active)",
    );
    chart.add(State::END__of__player, State::player, NodeKind::End, "");
    chart.add(
        State::region1__of__RobotController__ever____par__LedHandler__ever____par__MotionController__ever____par____open__initialize__then__active__close__,
        State::RobotController__ever____par__LedHandler__ever____par__MotionController__ever____par____open__initialize__then__active__close__,
        NodeKind::Or,
        "",
    );
    chart.add(
        State::START__of__region1__of__RobotController__ever____par__LedHandler__ever____par__MotionController__ever____par____open__initialize__then__active__close__,
        State::region1__of__RobotController__ever____par__LedHandler__ever____par__MotionController__ever____par____open__initialize__then__active__close__,
        NodeKind::Start,
        "",
    );
    chart.add(
        State::RobotController__ever__,
        State::region1__of__RobotController__ever____par__LedHandler__ever____par__MotionController__ever____par____open__initialize__then__active__close__,
        NodeKind::Or,
        "RobotController~",
    );
    chart.add(
        State::END__of__region1__of__RobotController__ever____par__LedHandler__ever____par__MotionController__ever____par____open__initialize__then__active__close__,
        State::region1__of__RobotController__ever____par__LedHandler__ever____par__MotionController__ever____par____open__initialize__then__active__close__,
        NodeKind::End,
        "",
    );
    chart.add(
        State::region2__of__RobotController__ever____par__LedHandler__ever____par__MotionController__ever____par____open__initialize__then__active__close__,
        State::RobotController__ever____par__LedHandler__ever____par__MotionController__ever____par____open__initialize__then__active__close__,
        NodeKind::Or,
        "",
    );
    chart.add(
        State::START__of__region2__of__RobotController__ever____par__LedHandler__ever____par__MotionController__ever____par____open__initialize__then__active__close__,
        State::region2__of__RobotController__ever____par__LedHandler__ever____par__MotionController__ever____par____open__initialize__then__active__close__,
        NodeKind::Start,
        "",
    );
    chart.add(
        State::LedHandler__ever__,
        State::region2__of__RobotController__ever____par__LedHandler__ever____par__MotionController__ever____par____open__initialize__then__active__close__,
        NodeKind::Or,
        "LedHandler~",
    );
    chart.add(
        State::END__of__region2__of__RobotController__ever____par__LedHandler__ever____par__MotionController__ever____par____open__initialize__then__active__close__,
        State::region2__of__RobotController__ever____par__LedHandler__ever____par__MotionController__ever____par____open__initialize__then__active__close__,
        NodeKind::End,
        "",
    );
    chart.add(
        State::region3__of__RobotController__ever____par__LedHandler__ever____par__MotionController__ever____par____open__initialize__then__active__close__,
        State::RobotController__ever____par__LedHandler__ever____par__MotionController__ever____par____open__initialize__then__active__close__,
        NodeKind::Or,
        "",
    );
    chart.add(
        State::START__of__region3__of__RobotController__ever____par__LedHandler__ever____par__MotionController__ever____par____open__initialize__then__active__close__,
        State::region3__of__RobotController__ever____par__LedHandler__ever____par__MotionController__ever____par____open__initialize__then__active__close__,
        NodeKind::Start,
        "",
    );
    chart.add(
        State::MotionController__ever__,
        State::region3__of__RobotController__ever____par__LedHandler__ever____par__MotionController__ever____par____open__initialize__then__active__close__,
        NodeKind::Or,
        "MotionController~",
    );
    chart.add(
        State::END__of__region3__of__RobotController__ever____par__LedHandler__ever____par__MotionController__ever____par____open__initialize__then__active__close__,
        State::region3__of__RobotController__ever____par__LedHandler__ever____par__MotionController__ever____par____open__initialize__then__active__close__,
        NodeKind::End,
        "",
    );
    chart.add(
        State::region4__of__RobotController__ever____par__LedHandler__ever____par__MotionController__ever____par____open__initialize__then__active__close__,
        State::RobotController__ever____par__LedHandler__ever____par__MotionController__ever____par____open__initialize__then__active__close__,
        NodeKind::Or,
        "",
    );
    chart.add(
        State::START__of__region4__of__RobotController__ever____par__LedHandler__ever____par__MotionController__ever____par____open__initialize__then__active__close__,
        State::region4__of__RobotController__ever____par__LedHandler__ever____par__MotionController__ever____par____open__initialize__then__active__close__,
        NodeKind::Start,
        "",
    );
    chart.add(
        State::__open__initialize__then__active__close__,
        State::region4__of__RobotController__ever____par__LedHandler__ever____par__MotionController__ever____par____open__initialize__then__active__close__,
        NodeKind::Or,
        "(initialize.active)",
    );
    chart.add(
        State::END__of__region4__of__RobotController__ever____par__LedHandler__ever____par__MotionController__ever____par____open__initialize__then__active__close__,
        State::region4__of__RobotController__ever____par__LedHandler__ever____par__MotionController__ever____par____open__initialize__then__active__close__,
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
        State::START__of____open__initialize__then__active__close__,
        State::__open__initialize__then__active__close__,
        NodeKind::Start,
        "",
    );
    chart.add(
        State::initialize,
        State::__open__initialize__then__active__close__,
        NodeKind::Or,
        "initialize",
    );
    chart.add(State::active, State::__open__initialize__then__active__close__, NodeKind::Or, "active");
    chart.add(
        State::END__of____open__initialize__then__active__close__,
        State::__open__initialize__then__active__close__,
        NodeKind::End,
        "",
    );
    chart.add(State::START__of__initialize, State::initialize, NodeKind::Start, "");
    chart.add(State::Stand, State::initialize, NodeKind::Basic, "Stand");
    chart.activity(State::Stand, "Stand");
    chart.add(State::SendCalibration, State::initialize, NodeKind::Basic, "SendCalibration");
    chart.activity(State::SendCalibration, "SendCalibration");
    chart.add(State::END__of__initialize, State::initialize, NodeKind::End, "");
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
    chart.add(State::__opt__roam__end__, State::search, NodeKind::Or, "[roam]");
    chart.add(State::END__of__search, State::search, NodeKind::End, "");
    chart.add(State::START__of____opt__roam__end__, State::__opt__roam__end__, NodeKind::Start, "");
    chart.add(State::CONDITION__of____opt__roam__end__, State::__opt__roam__end__, NodeKind::Condition, "");
    chart.add(State::roam, State::__opt__roam__end__, NodeKind::Or, "roam");
    chart.add(State::START__of__roam, State::roam, NodeKind::Start, "");
    chart.add(State::CONDITION__of__roam, State::roam, NodeKind::Condition, "");
    chart.add(State::TurnAround, State::roam, NodeKind::Basic, "TurnAround");
    chart.activity(State::TurnAround, "TurnAround");
    chart.add(State::WalkTowardsCentre, State::roam, NodeKind::Basic, "WalkTowardsCentre");
    chart.activity(State::WalkTowardsCentre, "WalkTowardsCentre");
    chart.add(State::END__of__roam, State::roam, NodeKind::End, "");
    chart.add(State::END__of____opt__roam__end__, State::__opt__roam__end__, NodeKind::End, "");
    chart.add(State::START__of__takeAction, State::takeAction, NodeKind::Start, "");
    chart.add(
        State::__open__TrackBall__or__LookAtGoal__close__,
        State::takeAction,
        NodeKind::Or,
        "(TrackBall|LookAtGoal)",
    );
    chart.add(
        State::__open__WalkTowardsBall__or__AlignWithBall__or__kickBall__or__SupportMate__close__,
        State::takeAction,
        NodeKind::Or,
        "(WalkTowardsBall|AlignWithBall|kickBall|SupportMate)",
    );
    chart.add(State::END__of__takeAction, State::takeAction, NodeKind::End, "");
    chart.add(
        State::START__of____open__TrackBall__or__LookAtGoal__close__,
        State::__open__TrackBall__or__LookAtGoal__close__,
        NodeKind::Start,
        "",
    );
    chart.add(
        State::CONDITION__of____open__TrackBall__or__LookAtGoal__close__,
        State::__open__TrackBall__or__LookAtGoal__close__,
        NodeKind::Condition,
        "",
    );
    chart.add(
        State::TrackBall,
        State::__open__TrackBall__or__LookAtGoal__close__,
        NodeKind::Basic,
        "TrackBall",
    );
    chart.activity(State::TrackBall, "TrackBall");
    chart.add(
        State::LookAtGoal,
        State::__open__TrackBall__or__LookAtGoal__close__,
        NodeKind::Basic,
        "LookAtGoal",
    );
    chart.activity(State::LookAtGoal, "LookAtGoal");
    chart.add(
        State::END__of____open__TrackBall__or__LookAtGoal__close__,
        State::__open__TrackBall__or__LookAtGoal__close__,
        NodeKind::End,
        "",
    );
    chart.add(
        State::START__of____open__WalkTowardsBall__or__AlignWithBall__or__kickBall__or__SupportMate__close__,
        State::__open__WalkTowardsBall__or__AlignWithBall__or__kickBall__or__SupportMate__close__,
        NodeKind::Start,
        "",
    );
    chart.add(
        State::CONDITION__of____open__WalkTowardsBall__or__AlignWithBall__or__kickBall__or__SupportMate__close__,
        State::__open__WalkTowardsBall__or__AlignWithBall__or__kickBall__or__SupportMate__close__,
        NodeKind::Condition,
        "",
    );
    chart.add(
        State::WalkTowardsBall,
        State::__open__WalkTowardsBall__or__AlignWithBall__or__kickBall__or__SupportMate__close__,
        NodeKind::Basic,
        "WalkTowardsBall",
    );
    chart.activity(State::WalkTowardsBall, "WalkTowardsBall");
    chart.add(
        State::AlignWithBall,
        State::__open__WalkTowardsBall__or__AlignWithBall__or__kickBall__or__SupportMate__close__,
        NodeKind::Basic,
        "AlignWithBall",
    );
    chart.activity(State::AlignWithBall, "AlignWithBall");
    chart.add(
        State::kickBall,
        State::__open__WalkTowardsBall__or__AlignWithBall__or__kickBall__or__SupportMate__close__,
        NodeKind::Or,
        "kickBall",
    );
    chart.add(
        State::SupportMate,
        State::__open__WalkTowardsBall__or__AlignWithBall__or__kickBall__or__SupportMate__close__,
        NodeKind::Basic,
        "SupportMate",
    );
    chart.activity(State::SupportMate, "SupportMate");
    chart.add(
        State::END__of____open__WalkTowardsBall__or__AlignWithBall__or__kickBall__or__SupportMate__close__,
        State::__open__WalkTowardsBall__or__AlignWithBall__or__kickBall__or__SupportMate__close__,
        NodeKind::End,
        "",
    );
    chart.add(State::START__of__kickBall, State::kickBall, NodeKind::Start, "");
    chart.add(State::CONDITION__of__kickBall, State::kickBall, NodeKind::Condition, "");
    chart.add(State::LeftKick, State::kickBall, NodeKind::Basic, "LeftKick");
    chart.activity(State::LeftKick, "LeftKick");
    chart.add(State::RightKick, State::kickBall, NodeKind::Basic, "RightKick");
    chart.activity(State::RightKick, "RightKick");
    chart.add(State::END__of__kickBall, State::kickBall, NodeKind::End, "");
}
