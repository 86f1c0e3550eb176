//! The structure of the chart.

use std::time::Duration;

use yase::typed::{Diagnostic, Draft, NodeKind, Reads, TypedChart};

use super::guards;
use super::states::State;
use super::words::{constants, messages, values};

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
    chart.means("PlayerState", "PLAYING", values::PLAYING);
    chart.constant("far", constants::far);
    chart.constant("word", constants::word);
}

/// The states and connectors, in the order of the document.
fn states(chart: &mut Draft) {
    chart.add(State::START__of__patrol, State::patrol, NodeKind::Start, "");
    chart.add(
        State::__open__walk__then__type__close____ever____par__watch__more__,
        State::patrol,
        NodeKind::And,
        "(walk.type)~||watch+",
    );
    chart.add(State::END__of__patrol, State::patrol, NodeKind::End, "");
    chart.add(
        State::region1,
        State::__open__walk__then__type__close____ever____par__watch__more__,
        NodeKind::Or,
        "",
    );
    chart.add(State::START__of__region1, State::region1, NodeKind::Start, "");
    chart.add(State::__open__walk__then__type__close____ever__, State::region1, NodeKind::Or, "(walk.type)~");
    chart.add(State::END__of__region1, State::region1, NodeKind::End, "");
    chart.add(
        State::region2,
        State::__open__walk__then__type__close____ever____par__watch__more__,
        NodeKind::Or,
        "",
    );
    chart.add(State::START__of__region2, State::region2, NodeKind::Start, "");
    chart.add(State::watch__more__, State::region2, NodeKind::Or, "watch+");
    chart.add(State::END__of__region2, State::region2, NodeKind::End, "");
    chart.add(
        State::START__of____open__walk__then__type__close____ever__,
        State::__open__walk__then__type__close____ever__,
        NodeKind::Start,
        "",
    );
    chart.add(
        State::__open__walk__then__type__close__,
        State::__open__walk__then__type__close____ever__,
        NodeKind::Or,
        "(walk.type)",
    );
    chart.add(
        State::START__of____open__walk__then__type__close__,
        State::__open__walk__then__type__close__,
        NodeKind::Start,
        "",
    );
    chart.add(State::walk, State::__open__walk__then__type__close__, NodeKind::Basic, "walk");
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
    chart.add(State::__u74__ype, State::__open__walk__then__type__close__, NodeKind::Basic, "type");
    chart.activity(State::__u74__ype, "type");
    chart.add(
        State::END__of____open__walk__then__type__close__,
        State::__open__walk__then__type__close__,
        NodeKind::End,
        "",
    );
    chart.add(State::START__of__watch__more__, State::watch__more__, NodeKind::Start, "");
    chart.add(State::watch, State::watch__more__, NodeKind::Basic, "watch");
    chart.activity(State::watch, "watch");
    chart.add(State::END__of__watch__more__, State::watch__more__, NodeKind::End, "");
}

/// The transitions, in the order of the document, each with its guard.
fn transitions(chart: &mut Draft) {
    chart.connect(
        State::START__of__patrol,
        State::__open__walk__then__type__close____ever____par__watch__more__,
        "",
    );
    chart.connect(
        State::__open__walk__then__type__close____ever____par__watch__more__,
        State::END__of__patrol,
        "",
    );
    chart.connect(State::START__of__region1, State::__open__walk__then__type__close____ever__, "");
    chart.connect(State::__open__walk__then__type__close____ever__, State::END__of__region1, "");
    chart.connect(State::START__of__region2, State::watch__more__, "");
    chart.connect(State::watch__more__, State::END__of__region2, "");
    chart.connect(State::START__of____open__walk__then__type__close__, State::walk, "");
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
        State::END__of____open__walk__then__type__close__,
        "[Vision.Ball.found] / Ball.place.x = -Ball.time_to_cross; Ball.colour = word; raise(go); publish.Ball",
    );
    chart.guard(guards::transition_8);
    chart.value(0, messages::BALL, guards::ball_place_x, guards::set_ball_place_x);
    chart.value(1, messages::BALL, guards::ball_colour, guards::set_ball_colour);
    chart.connect(
        State::START__of____open__walk__then__type__close____ever__,
        State::__open__walk__then__type__close__,
        "",
    );
    chart.connect(State::__open__walk__then__type__close__, State::__open__walk__then__type__close__, "");
    chart.connect(State::START__of__watch__more__, State::watch, "");
    chart.connect(State::watch, State::watch, "[Ball == NULL]");
    chart.guard(guards::from_watch_to_watch);
    chart.connect(State::watch, State::END__of__watch__more__, "");
}
