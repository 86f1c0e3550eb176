//! The structure of the chart.

use std::time::Duration;

use yase::typed::{Diagnostic, Draft, NodeKind, Reads, TypedChart};

use super::guards;
use super::states::State;
use super::words::{constants, functions, messages, timers, values};

/// The chart, with a function for each of its guards and values.
///
/// # Errors
/// Only if it was changed by hand and no longer fits together.
pub fn chart() -> Result<TypedChart, Vec<Diagnostic>> {
    let mut chart = Draft::new("patrol");
    words(&mut chart);
    states(&mut chart);
    transitions(&mut chart);
    chart.finish()
}

/// The words of the guards and actions.
fn words(chart: &mut Draft) {
    chart.reads(messages::BALL, Reads::own("soccer/ball", "Ball"));
    chart.reads(messages::VISION_BALL, Reads::own("soccer/ball", "Ball").by("Vision"));
    chart.reads(messages::GAME_STATE, Reads::own("soccer/game_state", "GameState"));
    chart.starts(timers::watch_timeout, "watch_timeout");
    chart.calls(functions::abs, "abs");
    chart.means("PlayerState", "PLAYING", values::PLAYING);
    chart.constant("far", constants::far);
    chart.constant("word", constants::word);
}

/// The states and connectors, in the order of the document.
fn states(chart: &mut Draft) {
    chart.add(State::START__of__patrol, State::patrol, NodeKind::Start, "");
    chart.add(
        State::__open__walk__then__type__then____opt__2nd__end____close____ever____par__watch__more__,
        State::patrol,
        NodeKind::And,
        "(walk.type.[2nd])~||watch+",
    );
    chart.add(State::END__of__patrol, State::patrol, NodeKind::End, "");
    chart.add(
        State::region1,
        State::__open__walk__then__type__then____opt__2nd__end____close____ever____par__watch__more__,
        NodeKind::Or,
        "",
    );
    chart.add(State::START__of__region1, State::region1, NodeKind::Start, "");
    chart.add(
        State::__open__walk__then__type__then____opt__2nd__end____close____ever__,
        State::region1,
        NodeKind::Or,
        "(walk.type.[2nd])~",
    );
    chart.add(State::END__of__region1, State::region1, NodeKind::End, "");
    chart.add(
        State::region2,
        State::__open__walk__then__type__then____opt__2nd__end____close____ever____par__watch__more__,
        NodeKind::Or,
        "",
    );
    chart.add(State::START__of__region2, State::region2, NodeKind::Start, "");
    chart.add(State::watch__more__, State::region2, NodeKind::Or, "watch+");
    chart.add(State::END__of__region2, State::region2, NodeKind::End, "");
    chart.add(
        State::START__of____open__walk__then__type__then____opt__2nd__end____close____ever__,
        State::__open__walk__then__type__then____opt__2nd__end____close____ever__,
        NodeKind::Start,
        "",
    );
    chart.add(
        State::__open__walk__then__type__then____opt__2nd__end____close__,
        State::__open__walk__then__type__then____opt__2nd__end____close____ever__,
        NodeKind::Or,
        "(walk.type.[2nd])",
    );
    chart.add(
        State::START__of____open__walk__then__type__then____opt__2nd__end____close__,
        State::__open__walk__then__type__then____opt__2nd__end____close__,
        NodeKind::Start,
        "",
    );
    chart.add(
        State::walk,
        State::__open__walk__then__type__then____opt__2nd__end____close__,
        NodeKind::Basic,
        "walk",
    );
    chart.activity(State::walk, "walk");
    chart.priority(State::walk, 2);
    chart.duration(State::walk, Duration::from_millis(1500));
    chart.defer(State::walk, &["stop"]);
    chart.entry(State::walk, "GameState.player_state = PLAYING");
    chart.value(
        0,
        messages::GAME_STATE,
        guards::game_state_player_state,
        guards::set_game_state_player_state,
    );
    chart.exit(State::walk, "StartTimeout(t, 5ms)");
    chart.add(
        State::__u74__ype,
        State::__open__walk__then__type__then____opt__2nd__end____close__,
        NodeKind::Basic,
        "type",
    );
    chart.activity(State::__u74__ype, "type");
    chart.add(
        State::__opt__2nd__end__,
        State::__open__walk__then__type__then____opt__2nd__end____close__,
        NodeKind::Or,
        "[2nd]",
    );
    chart.add(
        State::END__of____open__walk__then__type__then____opt__2nd__end____close__,
        State::__open__walk__then__type__then____opt__2nd__end____close__,
        NodeKind::End,
        "",
    );
    chart.add(State::START__of____opt__2nd__end__, State::__opt__2nd__end__, NodeKind::Start, "");
    chart.add(State::CONDITION, State::__opt__2nd__end__, NodeKind::Condition, "");
    chart.add(State::__u32__nd, State::__opt__2nd__end__, NodeKind::Basic, "2nd");
    chart.activity(State::__u32__nd, "2nd");
    chart.add(State::END__of____opt__2nd__end__, State::__opt__2nd__end__, NodeKind::End, "");
    chart.add(State::START__of__watch__more__, State::watch__more__, NodeKind::Start, "");
    chart.add(State::watch, State::watch__more__, NodeKind::Basic, "watch");
    chart.activity(State::watch, "watch");
    chart.add(State::END__of__watch__more__, State::watch__more__, NodeKind::End, "");
}

/// The transitions, in the order of the document, each with its guard.
fn transitions(chart: &mut Draft) {
    chart.connect(
        State::START__of__patrol,
        State::__open__walk__then__type__then____opt__2nd__end____close____ever____par__watch__more__,
        "",
    );
    chart.connect(
        State::__open__walk__then__type__then____opt__2nd__end____close____ever____par__watch__more__,
        State::END__of__patrol,
        "",
    );
    chart.connect(
        State::START__of__region1,
        State::__open__walk__then__type__then____opt__2nd__end____close____ever__,
        "",
    );
    chart.connect(
        State::__open__walk__then__type__then____opt__2nd__end____close____ever__,
        State::END__of__region1,
        "",
    );
    chart.connect(State::START__of__region2, State::watch__more__, "");
    chart.connect(State::watch__more__, State::END__of__region2, "");
    chart.connect(
        State::START__of____open__walk__then__type__then____opt__2nd__end____close__,
        State::walk,
        "",
    );
    chart.connect(
        State::walk,
        State::__u74__ype,
        "go | stop [Ball.place.near.x > far + Ball.type / 2 && Ball.colour != word || In(watch)]",
    );
    chart.guard(guards::transition_7);
    chart.prefer(3);
    chart.interrupts();
    chart.connect(
        State::__u74__ype,
        State::__opt__2nd__end__,
        "[Vision.Ball.found] / Ball.place.x = -Ball.time_to_cross; Ball.colour = word; raise(go); publish.Ball",
    );
    chart.guard(guards::transition_8);
    chart.value(0, messages::BALL, guards::ball_place_x, guards::set_ball_place_x);
    chart.value(1, messages::BALL, guards::ball_colour, guards::set_ball_colour);
    chart.connect(
        State::__opt__2nd__end__,
        State::END__of____open__walk__then__type__then____opt__2nd__end____close__,
        "",
    );
    chart.connect(State::START__of____opt__2nd__end__, State::CONDITION, "");
    chart.connect(State::CONDITION, State::__u32__nd, "[abs(Ball.place.x) <= far]");
    chart.guard(guards::transition_11);
    chart.connect(State::CONDITION, State::END__of____opt__2nd__end__, "");
    chart.connect(State::__u32__nd, State::END__of____opt__2nd__end__, "");
    chart.connect(
        State::START__of____open__walk__then__type__then____opt__2nd__end____close____ever__,
        State::__open__walk__then__type__then____opt__2nd__end____close__,
        "",
    );
    chart.connect(
        State::__open__walk__then__type__then____opt__2nd__end____close__,
        State::__open__walk__then__type__then____opt__2nd__end____close__,
        "",
    );
    chart.connect(State::START__of__watch__more__, State::watch, "");
    chart.connect(
        State::watch,
        State::watch,
        "[watch_timeout && Ball == NULL] / StartTimeout(watch_timeout, 100ms)",
    );
    chart.guard(guards::from_watch_to_watch);
    chart.connect(State::watch, State::END__of__watch__more__, "");
}
