//! The guards of transitions and the values of assignments.

#![allow(non_snake_case)] // the names are those of states

use ::monas::generated::{
    GuardInput, GuardResult, all, any, at_least, at_most, differ, equal, given, holds, less, minus, more,
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

/// From `CONDITION` in `roam` to `WalkTowardsCentre`: `[Ball.age > wander && (abs(Pose.x) > central || abs(Pose.y) > central)]`
pub(crate) fn from_CONDITION_to_WalkTowardsCentre(input: &GuardInput<'_>) -> GuardResult {
    all!(
        more(input.latest(messages::BALL)?.age, constants::wander)?,
        any!(
            more(
                input.call(functions::abs, &[given(input.latest(messages::POSE)?.x)?])?,
                constants::central,
            )?,
            more(
                input.call(functions::abs, &[given(input.latest(messages::POSE)?.y)?])?,
                constants::central,
            )?,
        )?,
    )
}

/// From `CONDITION` in `roam` to `TurnToReport`: `[Attack.mate_sees_ball]`
pub(crate) fn from_CONDITION_to_TurnToReport(input: &GuardInput<'_>) -> GuardResult {
    holds(input.latest(messages::ATTACK)?.mate_sees_ball)
}

/// From `CONDITION` in `[roam]` to `roam`: `[Ball.age >= look || Attack.mate_sees_ball]`
pub(crate) fn from_CONDITION_to_roam(input: &GuardInput<'_>) -> GuardResult {
    any!(
        at_least(input.latest(messages::BALL)?.age, constants::look)?,
        holds(input.latest(messages::ATTACK)?.mate_sees_ball)?,
    )
}

/// From `CONDITION` in `(TrackBall|LookAtGoal)` to `LookAtGoal`: `[glance_timeout && Pose.confidence < certain && Ball.distance > quiet && Ball.speed < still && Ball.age < seen]`
pub(crate) fn from_CONDITION_to_LookAtGoal(input: &GuardInput<'_>) -> GuardResult {
    all!(
        input.is_over(timers::glance_timeout),
        less(input.latest(messages::POSE)?.confidence, constants::certain)?,
        more(input.latest(messages::BALL)?.distance, constants::quiet)?,
        less(input.latest(messages::BALL)?.speed, constants::still)?,
        less(input.latest(messages::BALL)?.age, constants::seen)?,
    )
}

/// From `CONDITION` in `(WalkTowardsBall|AlignWithBall|kickBall|SupportMate|CoverGoal|center|center_for)` to `AlignWithBall`: `[Ball.distance <= near && (Ball.speed >= still || abs(Ball.x - kick_x) > tolerance || abs(abs(Ball.y) - kick_y) > tolerance)]`
pub(crate) fn from_CONDITION_to_AlignWithBall(input: &GuardInput<'_>) -> GuardResult {
    all!(
        at_most(input.latest(messages::BALL)?.distance, constants::near)?,
        any!(
            at_least(input.latest(messages::BALL)?.speed, constants::still)?,
            more(
                input.call(functions::abs, &[minus(input.latest(messages::BALL)?.x, constants::kick_x)?])?,
                constants::tolerance,
            )?,
            more(
                input.call(
                    functions::abs,
                    &[minus(
                        input.call(functions::abs, &[given(input.latest(messages::BALL)?.y)?])?,
                        constants::kick_y,
                    )?],
                )?,
                constants::tolerance,
            )?,
        )?,
    )
}

/// From `CONDITION` in `(WalkTowardsBall|AlignWithBall|kickBall|SupportMate|CoverGoal|center|center_for)` to `kickBall`: `[Ball.distance <= near && Ball.speed < still && abs(Ball.x - kick_x) <= tolerance && abs(abs(Ball.y) - kick_y) <= tolerance]`
pub(crate) fn from_CONDITION_to_kickBall(input: &GuardInput<'_>) -> GuardResult {
    all!(
        at_most(input.latest(messages::BALL)?.distance, constants::near)?,
        less(input.latest(messages::BALL)?.speed, constants::still)?,
        at_most(
            input.call(functions::abs, &[minus(input.latest(messages::BALL)?.x, constants::kick_x)?])?,
            constants::tolerance,
        )?,
        at_most(
            input.call(
                functions::abs,
                &[minus(
                    input.call(functions::abs, &[given(input.latest(messages::BALL)?.y)?])?,
                    constants::kick_y,
                )?],
            )?,
            constants::tolerance,
        )?,
    )
}

/// From `CONDITION` in `(WalkTowardsBall|AlignWithBall|kickBall|SupportMate|CoverGoal|center|center_for)` to `SupportMate`: `[Ball.distance > near && (Attack.mate_lead > nearer || Ball.in_own_area) && !Attack.opponent_leads]`
pub(crate) fn from_CONDITION_to_SupportMate(input: &GuardInput<'_>) -> GuardResult {
    all!(
        more(input.latest(messages::BALL)?.distance, constants::near)?,
        any!(
            more(input.latest(messages::ATTACK)?.mate_lead, constants::nearer)?,
            holds(input.latest(messages::BALL)?.in_own_area)?,
        )?,
        !holds(input.latest(messages::ATTACK)?.opponent_leads)?,
    )
}

/// From `CONDITION` in `(WalkTowardsBall|AlignWithBall|kickBall|SupportMate|CoverGoal|center|center_for)` to `CoverGoal`: `[Ball.distance > near && (Attack.mate_lead > nearer || Ball.in_own_area) && Attack.opponent_leads]`
pub(crate) fn from_CONDITION_to_CoverGoal(input: &GuardInput<'_>) -> GuardResult {
    all!(
        more(input.latest(messages::BALL)?.distance, constants::near)?,
        any!(
            more(input.latest(messages::ATTACK)?.mate_lead, constants::nearer)?,
            holds(input.latest(messages::BALL)?.in_own_area)?,
        )?,
        holds(input.latest(messages::ATTACK)?.opponent_leads)?,
    )
}

/// From `CONDITION` in `(WalkTowardsBall|AlignWithBall|kickBall|SupportMate|CoverGoal|center|center_for)` to `center`: `[Attack.ball_is_free && Attack.center_is_closest && Attack.center_for_is_farthest && Attack.part == CENTER]`
pub(crate) fn from_CONDITION_to_center(input: &GuardInput<'_>) -> GuardResult {
    all!(
        holds(input.latest(messages::ATTACK)?.ball_is_free)?,
        holds(input.latest(messages::ATTACK)?.center_is_closest)?,
        holds(input.latest(messages::ATTACK)?.center_for_is_farthest)?,
        equal(input.latest(messages::ATTACK)?.part, values::CENTER)?,
    )
}

/// From `CONDITION` in `(WalkTowardsBall|AlignWithBall|kickBall|SupportMate|CoverGoal|center|center_for)` to `center_for`: `[Attack.ball_is_free && Attack.center_is_closest && Attack.center_for_is_farthest && Attack.part == CENTER_FOR]`
pub(crate) fn from_CONDITION_to_center_for(input: &GuardInput<'_>) -> GuardResult {
    all!(
        holds(input.latest(messages::ATTACK)?.ball_is_free)?,
        holds(input.latest(messages::ATTACK)?.center_is_closest)?,
        holds(input.latest(messages::ATTACK)?.center_for_is_farthest)?,
        equal(input.latest(messages::ATTACK)?.part, values::CENTER_FOR)?,
    )
}

/// From `CONDITION` in `kickBall` to `LeftKick`: `[Ball.y >= 0]`
pub(crate) fn from_CONDITION_to_LeftKick(input: &GuardInput<'_>) -> GuardResult {
    at_least(input.latest(messages::BALL)?.y, 0)
}

/// From `CONDITION` in `kickBall` to `RightKick`: `[Ball.y < 0]`
pub(crate) fn from_CONDITION_to_RightKick(input: &GuardInput<'_>) -> GuardResult {
    less(input.latest(messages::BALL)?.y, 0)
}

/// From `CONDITION` in `[passBall]` to `passBall`: `[Attack.pass_is_open]`
pub(crate) fn from_CONDITION_to_passBall(input: &GuardInput<'_>) -> GuardResult {
    holds(input.latest(messages::ATTACK)?.pass_is_open)
}

/// From `CONDITION` in `kickBall` to `LeftKick`: `[Ball.y >= 0]`
pub(crate) fn from_CONDITION_to_LeftKick_2(input: &GuardInput<'_>) -> GuardResult {
    at_least(input.latest(messages::BALL)?.y, 0)
}

/// From `CONDITION` in `kickBall` to `RightKick`: `[Ball.y < 0]`
pub(crate) fn from_CONDITION_to_RightKick_2(input: &GuardInput<'_>) -> GuardResult {
    less(input.latest(messages::BALL)?.y, 0)
}

/// From `CONDITION` in `[kickBall]` to `kickBall`: `[Attack.path_is_clear]`
pub(crate) fn from_CONDITION_to_kickBall_2(input: &GuardInput<'_>) -> GuardResult {
    holds(input.latest(messages::ATTACK)?.path_is_clear)
}

/// From `CONDITION` in `[WalkTowardsBall.AssessAttack.[kickBall]]` to `WalkTowardsBall.AssessAttack.[kickBall]`: `[Attack.ball_is_passed]`
pub(crate) fn transition_115(input: &GuardInput<'_>) -> GuardResult {
    holds(input.latest(messages::ATTACK)?.ball_is_passed)
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

/// From `center` to `END` in `(WalkTowardsBall|AlignWithBall|kickBall|SupportMate|CoverGoal|center|center_for)`: `[Attack.shot_at_goal]`
pub(crate) fn from_center_to_END(input: &GuardInput<'_>) -> GuardResult {
    holds(input.latest(messages::ATTACK)?.shot_at_goal)
}

/// From `center` to `END` in `(WalkTowardsBall|AlignWithBall|kickBall|SupportMate|CoverGoal|center|center_for)`: `[Attack.opponent_has_ball]`
pub(crate) fn from_center_to_END_2(input: &GuardInput<'_>) -> GuardResult {
    holds(input.latest(messages::ATTACK)?.opponent_has_ball)
}

/// From `center` to `END` in `(WalkTowardsBall|AlignWithBall|kickBall|SupportMate|CoverGoal|center|center_for)`: `[Attack.ball_is_out]`
pub(crate) fn from_center_to_END_3(input: &GuardInput<'_>) -> GuardResult {
    holds(input.latest(messages::ATTACK)?.ball_is_out)
}

/// From `center_for` to `END` in `(WalkTowardsBall|AlignWithBall|kickBall|SupportMate|CoverGoal|center|center_for)`: `[Attack.shot_at_goal]`
pub(crate) fn from_center_for_to_END(input: &GuardInput<'_>) -> GuardResult {
    holds(input.latest(messages::ATTACK)?.shot_at_goal)
}

/// From `center_for` to `END` in `(WalkTowardsBall|AlignWithBall|kickBall|SupportMate|CoverGoal|center|center_for)`: `[Attack.opponent_has_ball]`
pub(crate) fn from_center_for_to_END_2(input: &GuardInput<'_>) -> GuardResult {
    holds(input.latest(messages::ATTACK)?.opponent_has_ball)
}

/// From `center_for` to `END` in `(WalkTowardsBall|AlignWithBall|kickBall|SupportMate|CoverGoal|center|center_for)`: `[Attack.ball_is_out]`
pub(crate) fn from_center_for_to_END_3(input: &GuardInput<'_>) -> GuardResult {
    holds(input.latest(messages::ATTACK)?.ball_is_out)
}
