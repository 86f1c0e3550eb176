//! The structure of the chart.

use std::time::Duration;

use ::yase_codegen::typed::{Diagnostic, NodeKind, SourceDeclaration, TypedChart, TypedChartBuilder};

use super::guards;
use super::states::State;
use super::transitions::transitions;
use super::words::{constants, functions, messages, timers, values};

/// The chart, with a function for each of its guards and values.
///
/// # Errors
/// Only if it was edited and is inconsistent.
pub fn chart() -> Result<TypedChart, Vec<Diagnostic>> {
    let mut chart = TypedChartBuilder::new("patrol");
    words(&mut chart);
    states(&mut chart);
    transitions(&mut chart);
    chart.finish()
}

/// The names that guards and actions use.
fn words(chart: &mut TypedChartBuilder) {
    chart.reads(messages::BALL, SourceDeclaration::own("soccer/ball", "Ball"));
    chart.reads(messages::VISION_BALL, SourceDeclaration::own("soccer/ball", "Ball").by("Vision"));
    chart.reads(messages::GAME_STATE, SourceDeclaration::own("soccer/game_state", "GameState"));
    chart.starts(timers::watch_timeout, "watch_timeout");
    chart.calls(functions::abs, "abs");
    chart.means("PlayerState", "PLAYING", values::PLAYING);
    chart.constant("far", constants::far);
    chart.constant("word", constants::word);
}

/// The states and connectors, in the order of the document.
fn states(chart: &mut TypedChartBuilder) {
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
