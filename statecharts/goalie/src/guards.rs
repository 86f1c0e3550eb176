//! The guards of transitions and the values of assignments.

#![allow(non_snake_case)] // the names are those of states

use ::monas::generated::{
    GuardInput, GuardResult, all, at_least, at_most, differ, equal, given, holds, less, more,
};

use super::words::{constants, functions, messages, timers, values};

/// From `RobotController` to `RobotController`: `[robot_timeout]`
pub(crate) fn from_RobotController_to_RobotController(input: &GuardInput<'_>) -> GuardResult {
    Ok(input.is_over(timers::robot_timeout))
}

/// From `LedHandler` to `LedHandler`: `[led_timeout]`
pub(crate) fn from_LedHandler_to_LedHandler(input: &GuardInput<'_>) -> GuardResult {
    Ok(input.is_over(timers::led_timeout))
}

/// From `MotionController` to `MotionController`: `[motion_timeout]`
pub(crate) fn from_MotionController_to_MotionController(input: &GuardInput<'_>) -> GuardResult {
    Ok(input.is_over(timers::motion_timeout))
}

/// From `START` in `Sensors~` to `Sensors`: `[GameState.player_state != PENALIZED]`
pub(crate) fn from_START_to_Sensors(input: &GuardInput<'_>) -> GuardResult {
    differ(input.latest(messages::GAME_STATE)?.player_state, values::PENALIZED)
}

/// From `Sensors` to `Sensors`: `[sensors_timeout && GameState.player_state != PENALIZED]`
pub(crate) fn from_Sensors_to_Sensors(input: &GuardInput<'_>) -> GuardResult {
    all!(
        input.is_over(timers::sensors_timeout),
        differ(input.latest(messages::GAME_STATE)?.player_state, values::PENALIZED)?,
    )
}

/// From `START` in `Vision~` to `Vision`: `[GameState.player_state != PENALIZED]`
pub(crate) fn from_START_to_Vision(input: &GuardInput<'_>) -> GuardResult {
    differ(input.latest(messages::GAME_STATE)?.player_state, values::PENALIZED)
}

/// From `Vision` to `Vision`: `[vision_timeout && GameState.player_state != PENALIZED]`
pub(crate) fn from_Vision_to_Vision(input: &GuardInput<'_>) -> GuardResult {
    all!(
        input.is_over(timers::vision_timeout),
        differ(input.latest(messages::GAME_STATE)?.player_state, values::PENALIZED)?,
    )
}

/// From `START` in `WalkToKickOff~` to `WalkToKickOff`: `[GameState.player_state == READY]`
pub(crate) fn from_START_to_WalkToKickOff(input: &GuardInput<'_>) -> GuardResult {
    equal(input.latest(messages::GAME_STATE)?.player_state, values::READY)
}

/// From `WalkToKickOff` to `WalkToKickOff`: `[place_timeout && GameState.player_state == READY]`
pub(crate) fn from_WalkToKickOff_to_WalkToKickOff(input: &GuardInput<'_>) -> GuardResult {
    all!(
        input.is_over(timers::place_timeout),
        equal(input.latest(messages::GAME_STATE)?.player_state, values::READY)?,
    )
}

/// From `CONDITION` in `(search|takeAction)` to `search`: `[!Ball.found]`
pub(crate) fn from_CONDITION_to_search(input: &GuardInput<'_>) -> GuardResult {
    Ok(!holds(input.latest(messages::BALL)?.found)?)
}

/// From `CONDITION` in `(search|takeAction)` to `takeAction`: `[Ball.found]`
pub(crate) fn from_CONDITION_to_takeAction(input: &GuardInput<'_>) -> GuardResult {
    holds(input.latest(messages::BALL)?.found)
}

/// From `CONDITION` in `takeAction` to `guardGoal`: `[!(Ball.approaching && Ball.time_to_cross <= act_within && abs(Ball.crossing_bearing) >= fall_from)]`
pub(crate) fn from_CONDITION_to_guardGoal(input: &GuardInput<'_>) -> GuardResult {
    Ok(!all!(
        holds(input.latest(messages::BALL)?.approaching)?,
        at_most(input.latest(messages::BALL)?.time_to_cross, constants::act_within)?,
        at_least(
            input.call(functions::abs, &[given(input.latest(messages::BALL)?.crossing_bearing)?])?,
            constants::fall_from,
        )?,
    )?)
}

/// From `CONDITION` in `takeAction` to `action`: `[Ball.approaching && Ball.time_to_cross <= act_within && abs(Ball.crossing_bearing) >= fall_from]`
pub(crate) fn from_CONDITION_to_action(input: &GuardInput<'_>) -> GuardResult {
    all!(
        holds(input.latest(messages::BALL)?.approaching)?,
        at_most(input.latest(messages::BALL)?.time_to_cross, constants::act_within)?,
        at_least(
            input.call(functions::abs, &[given(input.latest(messages::BALL)?.crossing_bearing)?])?,
            constants::fall_from,
        )?,
    )
}

/// From `CONDITION` in `(KeepGoal|StepAside)` to `KeepGoal`: `[!Ball.approaching]`
pub(crate) fn from_CONDITION_to_KeepGoal(input: &GuardInput<'_>) -> GuardResult {
    Ok(!holds(input.latest(messages::BALL)?.approaching)?)
}

/// From `CONDITION` in `(KeepGoal|StepAside)` to `StepAside`: `[Ball.approaching]`
pub(crate) fn from_CONDITION_to_StepAside(input: &GuardInput<'_>) -> GuardResult {
    holds(input.latest(messages::BALL)?.approaching)
}

/// From `CONDITION` in `action` to `RightFall`: `[Ball.crossing_bearing < 0 && Ball.crossing_bearing >= -dive_from]`
pub(crate) fn from_CONDITION_to_RightFall(input: &GuardInput<'_>) -> GuardResult {
    all!(
        less(input.latest(messages::BALL)?.crossing_bearing, 0)?,
        at_least(input.latest(messages::BALL)?.crossing_bearing, -constants::dive_from)?,
    )
}

/// From `CONDITION` in `action` to `LeftFall`: `[Ball.crossing_bearing >= 0 && Ball.crossing_bearing <= dive_from]`
pub(crate) fn from_CONDITION_to_LeftFall(input: &GuardInput<'_>) -> GuardResult {
    all!(
        at_least(input.latest(messages::BALL)?.crossing_bearing, 0)?,
        at_most(input.latest(messages::BALL)?.crossing_bearing, constants::dive_from)?,
    )
}

/// From `CONDITION` in `action` to `RightDive`: `[Ball.crossing_bearing < -dive_from]`
pub(crate) fn from_CONDITION_to_RightDive(input: &GuardInput<'_>) -> GuardResult {
    less(input.latest(messages::BALL)?.crossing_bearing, -constants::dive_from)
}

/// From `CONDITION` in `action` to `LeftDive`: `[Ball.crossing_bearing > dive_from]`
pub(crate) fn from_CONDITION_to_LeftDive(input: &GuardInput<'_>) -> GuardResult {
    more(input.latest(messages::BALL)?.crossing_bearing, constants::dive_from)
}

/// From `START` in `decision~` to `decision`: `[GameState.player_state == PLAYING]`
pub(crate) fn from_START_to_decision(input: &GuardInput<'_>) -> GuardResult {
    equal(input.latest(messages::GAME_STATE)?.player_state, values::PLAYING)
}

/// From `decision` to `decision`: `[decision_timeout && GameState.player_state == PLAYING]`
pub(crate) fn from_decision_to_decision(input: &GuardInput<'_>) -> GuardResult {
    all!(
        input.is_over(timers::decision_timeout),
        equal(input.latest(messages::GAME_STATE)?.player_state, values::PLAYING)?,
    )
}
