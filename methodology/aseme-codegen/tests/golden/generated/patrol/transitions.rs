//! The transitions of the chart.

use ::yase_codegen::typed::TypedChartBuilder;

use super::guards;
use super::states::State;
use super::words::messages;

/// The transitions, in the order of the document, each with its guard.
pub(crate) fn transitions(chart: &mut TypedChartBuilder) {
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
