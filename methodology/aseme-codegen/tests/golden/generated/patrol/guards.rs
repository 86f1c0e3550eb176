//! The guards of transitions and the values of assignments.

#![allow(non_snake_case)] // the names are those of states

use ::yase_codegen::typed::{
    CallError, Computed, GuardInput, GuardResult, Value, all, any, at_most, attempt, differ, given, holds,
    inside, inside_mut, more, negative, over, plus, set,
};

use super::states::State;
use super::words::{constants, functions, messages, timers, values};

/// From `walk` to `type`: `[Ball.place.near.x > far + Ball.type / 2 && Ball.colour != word || In(watch)]`
pub(crate) fn transition_7(input: &GuardInput<'_>) -> GuardResult {
    any!(
        all!(
            more(
                attempt(|| Ok(inside(&inside(&input.latest(messages::BALL)?.place)?.near)?.x))?,
                plus(constants::far, over(input.latest(messages::BALL)?.r#type, 2)?)?,
            )?,
            differ(&input.latest(messages::BALL)?.colour, constants::word)?,
        )?,
        input.is_in(State::watch),
    )
}

/// From `type` to `[2nd]`: `[Vision.Ball.found]`
pub(crate) fn transition_8(input: &GuardInput<'_>) -> GuardResult {
    holds(input.latest(messages::VISION_BALL)?.found)
}

/// From `CONDITION` in `[2nd]` to `2nd`: `[abs(Ball.place.x) <= far]`
pub(crate) fn transition_11(input: &GuardInput<'_>) -> GuardResult {
    at_most(
        input.call(functions::abs, &[given(inside(&input.latest(messages::BALL)?.place)?.x)?])?,
        constants::far,
    )
}

/// From `watch` to `watch`: `[watch_timeout && Ball == NULL]`
pub(crate) fn from_watch_to_watch(input: &GuardInput<'_>) -> GuardResult {
    all!(input.is_over(timers::watch_timeout), input.is_absent(messages::BALL))
}

/// From `type` to `[2nd]`: `Ball.place.x = -Ball.time_to_cross`
pub(crate) fn ball_place_x<'a>(input: &GuardInput<'a>) -> Computed<'a> {
    negative(input.latest(messages::BALL)?.time_to_cross)
}

/// Sets `soccer::Ball.place_x`.
pub(crate) fn set_ball_place_x(message: &mut ::soccer::Ball, value: Value<'_>) -> Result<(), CallError> {
    set(&mut inside_mut(&mut message.place).x, value, "x")
}

/// From `type` to `[2nd]`: `Ball.colour = word`
pub(crate) fn ball_colour<'a>(_: &GuardInput<'a>) -> Computed<'a> {
    given(constants::word)
}

/// Sets `soccer::Ball.colour`.
pub(crate) fn set_ball_colour(message: &mut ::soccer::Ball, value: Value<'_>) -> Result<(), CallError> {
    set(&mut message.colour, value, "colour")
}

/// On the entry of `walk`: `GameState.player_state = PLAYING`
pub(crate) fn game_state_player_state<'a>(_: &GuardInput<'a>) -> Computed<'a> {
    given(values::PLAYING)
}

/// Sets `soccer::GameState.player_state`.
pub(crate) fn set_game_state_player_state(
    message: &mut ::soccer::GameState,
    value: Value<'_>,
) -> Result<(), CallError> {
    set(&mut message.player_state, value, "player_state")
}
