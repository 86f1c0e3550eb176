//! The guards of transitions and the values of assignments.

#![allow(non_snake_case)] // the names are those of states

use ::monas::generated::{
    GuardResult, World, all, any, at_least, at_most, equal, given, holds, less, minus, more,
};

use super::words::{constants, functions, messages, timers, values};

/// From `RobotController` to `RobotController`: `[robot_timeout]`
pub(crate) fn from_RobotController_to_RobotController(world: &World<'_>) -> GuardResult {
    Ok(world.is_over(timers::robot_timeout))
}

/// From `LedHandler` to `LedHandler`: `[led_timeout]`
pub(crate) fn from_LedHandler_to_LedHandler(world: &World<'_>) -> GuardResult {
    Ok(world.is_over(timers::led_timeout))
}

/// From `MotionController` to `MotionController`: `[motion_timeout]`
pub(crate) fn from_MotionController_to_MotionController(world: &World<'_>) -> GuardResult {
    Ok(world.is_over(timers::motion_timeout))
}

/// From `START` in `Sensors~` to `Sensors`: `[GameState.player_state == PLAYING]`
pub(crate) fn from_START_to_Sensors(world: &World<'_>) -> GuardResult {
    equal(world.latest(messages::GAME_STATE)?.player_state, values::PLAYING)
}

/// From `Sensors` to `Sensors`: `[sensors_timeout && GameState.player_state == PLAYING]`
pub(crate) fn from_Sensors_to_Sensors(world: &World<'_>) -> GuardResult {
    all!(
        world.is_over(timers::sensors_timeout),
        equal(world.latest(messages::GAME_STATE)?.player_state, values::PLAYING)?,
    )
}

/// From `START` in `Vision~` to `Vision`: `[GameState.player_state == PLAYING]`
pub(crate) fn from_START_to_Vision(world: &World<'_>) -> GuardResult {
    equal(world.latest(messages::GAME_STATE)?.player_state, values::PLAYING)
}

/// From `Vision` to `Vision`: `[vision_timeout && GameState.player_state == PLAYING]`
pub(crate) fn from_Vision_to_Vision(world: &World<'_>) -> GuardResult {
    all!(
        world.is_over(timers::vision_timeout),
        equal(world.latest(messages::GAME_STATE)?.player_state, values::PLAYING)?,
    )
}

/// From `CONDITION` in `(search|takeAction)` to `search`: `[!Ball.found]`
pub(crate) fn from_CONDITION_to_search(world: &World<'_>) -> GuardResult {
    Ok(!holds(world.latest(messages::BALL)?.found)?)
}

/// From `CONDITION` in `(search|takeAction)` to `takeAction`: `[Ball.found]`
pub(crate) fn from_CONDITION_to_takeAction(world: &World<'_>) -> GuardResult {
    holds(world.latest(messages::BALL)?.found)
}

/// From `CONDITION` in `roam` to `WalkTowardsCentre`: `[Ball.age > wander && (abs(Pose.x) > central || abs(Pose.y) > central)]`
pub(crate) fn from_CONDITION_to_WalkTowardsCentre(world: &World<'_>) -> GuardResult {
    all!(
        more(world.latest(messages::BALL)?.age, constants::wander)?,
        any!(
            more(
                world.call(functions::abs, &[given(world.latest(messages::POSE)?.x)?])?,
                constants::central,
            )?,
            more(
                world.call(functions::abs, &[given(world.latest(messages::POSE)?.y)?])?,
                constants::central,
            )?,
        )?,
    )
}

/// From `CONDITION` in `roam` to `TurnToReport`: `[Attack.mate_sees_ball]`
pub(crate) fn from_CONDITION_to_TurnToReport(world: &World<'_>) -> GuardResult {
    holds(world.latest(messages::ATTACK)?.mate_sees_ball)
}

/// From `CONDITION` in `[roam]` to `roam`: `[Ball.age >= look || Attack.mate_sees_ball]`
pub(crate) fn from_CONDITION_to_roam(world: &World<'_>) -> GuardResult {
    any!(
        at_least(world.latest(messages::BALL)?.age, constants::look)?,
        holds(world.latest(messages::ATTACK)?.mate_sees_ball)?,
    )
}

/// From `CONDITION` in `(TrackBall|LookAtGoal)` to `LookAtGoal`: `[glance_timeout && Pose.confidence < certain && Ball.distance > quiet && Ball.speed < still && Ball.age < seen]`
pub(crate) fn from_CONDITION_to_LookAtGoal(world: &World<'_>) -> GuardResult {
    all!(
        world.is_over(timers::glance_timeout),
        less(world.latest(messages::POSE)?.confidence, constants::certain)?,
        more(world.latest(messages::BALL)?.distance, constants::quiet)?,
        less(world.latest(messages::BALL)?.speed, constants::still)?,
        less(world.latest(messages::BALL)?.age, constants::seen)?,
    )
}

/// From `CONDITION` in `(WalkTowardsBall|AlignWithBall|kickBall|SupportMate|CoverGoal|center|center_for)` to `AlignWithBall`: `[Ball.distance <= near && (Ball.speed >= still || abs(Ball.x - kick_x) > tolerance || abs(abs(Ball.y) - kick_y) > tolerance)]`
pub(crate) fn from_CONDITION_to_AlignWithBall(world: &World<'_>) -> GuardResult {
    all!(
        at_most(world.latest(messages::BALL)?.distance, constants::near)?,
        any!(
            at_least(world.latest(messages::BALL)?.speed, constants::still)?,
            more(
                world.call(functions::abs, &[minus(world.latest(messages::BALL)?.x, constants::kick_x)?])?,
                constants::tolerance,
            )?,
            more(
                world.call(
                    functions::abs,
                    &[minus(
                        world.call(functions::abs, &[given(world.latest(messages::BALL)?.y)?])?,
                        constants::kick_y,
                    )?],
                )?,
                constants::tolerance,
            )?,
        )?,
    )
}

/// From `CONDITION` in `(WalkTowardsBall|AlignWithBall|kickBall|SupportMate|CoverGoal|center|center_for)` to `kickBall`: `[Ball.distance <= near && Ball.speed < still && abs(Ball.x - kick_x) <= tolerance && abs(abs(Ball.y) - kick_y) <= tolerance]`
pub(crate) fn from_CONDITION_to_kickBall(world: &World<'_>) -> GuardResult {
    all!(
        at_most(world.latest(messages::BALL)?.distance, constants::near)?,
        less(world.latest(messages::BALL)?.speed, constants::still)?,
        at_most(
            world.call(functions::abs, &[minus(world.latest(messages::BALL)?.x, constants::kick_x)?])?,
            constants::tolerance,
        )?,
        at_most(
            world.call(
                functions::abs,
                &[minus(
                    world.call(functions::abs, &[given(world.latest(messages::BALL)?.y)?])?,
                    constants::kick_y,
                )?],
            )?,
            constants::tolerance,
        )?,
    )
}

/// From `CONDITION` in `(WalkTowardsBall|AlignWithBall|kickBall|SupportMate|CoverGoal|center|center_for)` to `SupportMate`: `[Ball.distance > near && (Attack.mate_lead > nearer || Ball.in_own_area) && !Attack.opponent_leads]`
pub(crate) fn from_CONDITION_to_SupportMate(world: &World<'_>) -> GuardResult {
    all!(
        more(world.latest(messages::BALL)?.distance, constants::near)?,
        any!(
            more(world.latest(messages::ATTACK)?.mate_lead, constants::nearer)?,
            holds(world.latest(messages::BALL)?.in_own_area)?,
        )?,
        !holds(world.latest(messages::ATTACK)?.opponent_leads)?,
    )
}

/// From `CONDITION` in `(WalkTowardsBall|AlignWithBall|kickBall|SupportMate|CoverGoal|center|center_for)` to `CoverGoal`: `[Ball.distance > near && (Attack.mate_lead > nearer || Ball.in_own_area) && Attack.opponent_leads]`
pub(crate) fn from_CONDITION_to_CoverGoal(world: &World<'_>) -> GuardResult {
    all!(
        more(world.latest(messages::BALL)?.distance, constants::near)?,
        any!(
            more(world.latest(messages::ATTACK)?.mate_lead, constants::nearer)?,
            holds(world.latest(messages::BALL)?.in_own_area)?,
        )?,
        holds(world.latest(messages::ATTACK)?.opponent_leads)?,
    )
}

/// From `CONDITION` in `(WalkTowardsBall|AlignWithBall|kickBall|SupportMate|CoverGoal|center|center_for)` to `center`: `[Attack.ball_is_free && Attack.center_is_closest && Attack.center_for_is_farthest && Attack.part == CENTER]`
pub(crate) fn from_CONDITION_to_center(world: &World<'_>) -> GuardResult {
    all!(
        holds(world.latest(messages::ATTACK)?.ball_is_free)?,
        holds(world.latest(messages::ATTACK)?.center_is_closest)?,
        holds(world.latest(messages::ATTACK)?.center_for_is_farthest)?,
        equal(world.latest(messages::ATTACK)?.part, values::CENTER)?,
    )
}

/// From `CONDITION` in `(WalkTowardsBall|AlignWithBall|kickBall|SupportMate|CoverGoal|center|center_for)` to `center_for`: `[Attack.ball_is_free && Attack.center_is_closest && Attack.center_for_is_farthest && Attack.part == CENTER_FOR]`
pub(crate) fn from_CONDITION_to_center_for(world: &World<'_>) -> GuardResult {
    all!(
        holds(world.latest(messages::ATTACK)?.ball_is_free)?,
        holds(world.latest(messages::ATTACK)?.center_is_closest)?,
        holds(world.latest(messages::ATTACK)?.center_for_is_farthest)?,
        equal(world.latest(messages::ATTACK)?.part, values::CENTER_FOR)?,
    )
}

/// From `CONDITION` in `kickBall` to `LeftKick`: `[Ball.y >= 0]`
pub(crate) fn from_CONDITION_to_LeftKick(world: &World<'_>) -> GuardResult {
    at_least(world.latest(messages::BALL)?.y, 0)
}

/// From `CONDITION` in `kickBall` to `RightKick`: `[Ball.y < 0]`
pub(crate) fn from_CONDITION_to_RightKick(world: &World<'_>) -> GuardResult {
    less(world.latest(messages::BALL)?.y, 0)
}

/// From `CONDITION` in `[passBall]` to `passBall`: `[Attack.pass_is_open]`
pub(crate) fn from_CONDITION_to_passBall(world: &World<'_>) -> GuardResult {
    holds(world.latest(messages::ATTACK)?.pass_is_open)
}

/// From `CONDITION` in `kickBall` to `LeftKick`: `[Ball.y >= 0]`
pub(crate) fn from_CONDITION_to_LeftKick_2(world: &World<'_>) -> GuardResult {
    at_least(world.latest(messages::BALL)?.y, 0)
}

/// From `CONDITION` in `kickBall` to `RightKick`: `[Ball.y < 0]`
pub(crate) fn from_CONDITION_to_RightKick_2(world: &World<'_>) -> GuardResult {
    less(world.latest(messages::BALL)?.y, 0)
}

/// From `CONDITION` in `[kickBall]` to `kickBall`: `[Attack.path_is_clear]`
pub(crate) fn from_CONDITION_to_kickBall_2(world: &World<'_>) -> GuardResult {
    holds(world.latest(messages::ATTACK)?.path_is_clear)
}

/// From `CONDITION` in `[WalkTowardsBall.AssessAttack.[kickBall]]` to `WalkTowardsBall.AssessAttack.[kickBall]`: `[Attack.ball_is_passed]`
pub(crate) fn transition_111(world: &World<'_>) -> GuardResult {
    holds(world.latest(messages::ATTACK)?.ball_is_passed)
}

/// From `START` in `decision~` to `decision`: `[GameState.player_state == PLAYING]`
pub(crate) fn from_START_to_decision(world: &World<'_>) -> GuardResult {
    equal(world.latest(messages::GAME_STATE)?.player_state, values::PLAYING)
}

/// From `decision` to `decision`: `[decision_timeout && GameState.player_state == PLAYING]`
pub(crate) fn from_decision_to_decision(world: &World<'_>) -> GuardResult {
    all!(
        world.is_over(timers::decision_timeout),
        equal(world.latest(messages::GAME_STATE)?.player_state, values::PLAYING)?,
    )
}

/// From `center` to `END` in `(WalkTowardsBall|AlignWithBall|kickBall|SupportMate|CoverGoal|center|center_for)`: `[Attack.shot_at_goal]`
pub(crate) fn from_center_to_END(world: &World<'_>) -> GuardResult {
    holds(world.latest(messages::ATTACK)?.shot_at_goal)
}

/// From `center` to `END` in `(WalkTowardsBall|AlignWithBall|kickBall|SupportMate|CoverGoal|center|center_for)`: `[Attack.opponent_has_ball]`
pub(crate) fn from_center_to_END_2(world: &World<'_>) -> GuardResult {
    holds(world.latest(messages::ATTACK)?.opponent_has_ball)
}

/// From `center` to `END` in `(WalkTowardsBall|AlignWithBall|kickBall|SupportMate|CoverGoal|center|center_for)`: `[Attack.ball_is_out]`
pub(crate) fn from_center_to_END_3(world: &World<'_>) -> GuardResult {
    holds(world.latest(messages::ATTACK)?.ball_is_out)
}

/// From `center_for` to `END` in `(WalkTowardsBall|AlignWithBall|kickBall|SupportMate|CoverGoal|center|center_for)`: `[Attack.shot_at_goal]`
pub(crate) fn from_center_for_to_END(world: &World<'_>) -> GuardResult {
    holds(world.latest(messages::ATTACK)?.shot_at_goal)
}

/// From `center_for` to `END` in `(WalkTowardsBall|AlignWithBall|kickBall|SupportMate|CoverGoal|center|center_for)`: `[Attack.opponent_has_ball]`
pub(crate) fn from_center_for_to_END_2(world: &World<'_>) -> GuardResult {
    holds(world.latest(messages::ATTACK)?.opponent_has_ball)
}

/// From `center_for` to `END` in `(WalkTowardsBall|AlignWithBall|kickBall|SupportMate|CoverGoal|center|center_for)`: `[Attack.ball_is_out]`
pub(crate) fn from_center_for_to_END_3(world: &World<'_>) -> GuardResult {
    holds(world.latest(messages::ATTACK)?.ball_is_out)
}
