//! Evaluation of compiled expressions.

use super::test_context::{ABS, BALL, COLOUR, DISTANCE, FOUND, GAME, NEAR, TestContext, guard};
use crate::vocabulary::{FieldId, Value};
use crate::{CallError, GuardError, TimerState};

/// `Ball.found` is the first operand, `GameState.score > 0` the second; `None` is unknown.
fn context(first: Option<bool>, second: Option<bool>) -> TestContext {
    let mut context = TestContext::new();
    if let Some(first) = first {
        context = context.with(BALL, &[FOUND], Value::Bool(first));
    }
    if let Some(second) = second {
        context = context.with(GAME, &[FieldId(2)], Value::Int(second.into()));
    }
    context
}

/// The truth value of a condition: unknown if neither it nor its negation holds.
fn truth(context: &TestContext, condition: &str) -> Option<bool> {
    let holds = context.holds(condition).unwrap();
    let fails = context.holds(&format!("!({condition})")).unwrap();
    assert!(!(holds && fails), "{condition}");
    (holds || fails).then_some(holds)
}

#[test]
fn conjunction_disjunction_and_negation_are_kleenes() {
    const T: Option<bool> = Some(true);
    const F: Option<bool> = Some(false);
    const U: Option<bool> = None;
    for (a, b, and, or) in [
        (T, T, T, T),
        (T, F, F, T),
        (T, U, U, T),
        (F, T, F, T),
        (F, F, F, F),
        (F, U, F, U),
        (U, T, U, T),
        (U, F, F, U),
        (U, U, U, U),
    ] {
        let context = context(a, b);
        assert_eq!(truth(&context, "Ball.found && GameState.score > 0"), and, "{a:?} and {b:?}");
        assert_eq!(truth(&context, "Ball.found || GameState.score > 0"), or, "{a:?} or {b:?}");
        assert_eq!(truth(&context, "Ball.found"), a);
        assert_eq!(truth(&context, "!Ball.found"), a.map(|a| !a));
    }
}

#[test]
fn expressions_of_missing_messages_are_unknown() {
    let context = TestContext::new();
    for condition in [
        "Ball.distance > 0",
        "Ball.distance == Ball.distance",
        "0 != Ball.distance",
        "Ball.distance * 0 == 0",
        "1 / Ball.distance > 0",
        "-Ball.distance < 1",
        "abs(Ball.distance) >= 0",
        "near(Ball, 1)",
        "(Ball.found && true) == true",
        "Ball.colour == \"\"",
    ] {
        assert_eq!(truth(&context, condition), None, "{condition}");
    }
    assert!(context.calls.borrow().is_empty());
}

#[test]
fn absence_is_never_unknown() {
    let (with, without) = (context(Some(false), None), context(None, None));
    for (condition, present, absent) in [
        ("Ball == NULL", false, true),
        ("ball.State.Ball != NULL", true, false),
        ("Ball == NULL || Ball.found", false, true),
    ] {
        assert_eq!(truth(&with, condition), Some(present), "{condition}");
        assert_eq!(truth(&without, condition), Some(absent), "{condition}");
    }
    assert_eq!(truth(&with, "striker.ball.State.Ball == NULL"), Some(true));
}

/// Only the form decides the value of a timer that was never started.
#[test]
fn timers_in_both_forms() {
    for (state, bare, checked) in [
        (TimerState::Unset, true, false),
        (TimerState::Running, false, false),
        (TimerState::Over, true, true),
    ] {
        let context = TestContext::new().with_timer(1, state).with_timer(0, TimerState::Running);
        assert_eq!(truth(&context, "robot.period"), Some(bare), "{state:?}");
        assert_eq!(truth(&context, "TimeoutCheck(robot.period)"), Some(checked), "{state:?}");
        assert_eq!(truth(&context, "motion_timeout"), Some(false), "{state:?}");
    }
    assert_eq!(truth(&TestContext::new(), "TimeoutCheck(never_started)"), Some(false));
}

#[test]
fn states_are_active_or_not() {
    let context = TestContext::new().with_active(7);
    assert_eq!(truth(&context, "In( play / (a|b)ω )"), Some(true));
    assert_eq!(truth(&context, "In(stand)"), Some(false));
}

#[test]
fn numbers_of_all_widths_compare_by_value() {
    for (left, comparison, right, expected) in [
        (Value::Int(2), "==", "2", true),
        (Value::Uint(2), "==", "2.0", true),
        (Value::Float(2.0), "==", "2", true),
        (Value::Float(2.5), ">", "2", true),
        (Value::Float(-2.5), "<", "-2", true),
        (Value::Float(-2.5), ">", "-3", true),
        (Value::Int(-1), "<", "18446744073709551615", true),
        (Value::Uint(u64::MAX), "==", "18446744073709551615", true),
        (Value::Uint(u64::MAX), "<", "18446744073709551616.0", true),
        (Value::Int(9_007_199_254_740_993), "==", "9007199254740992.0", false),
        (Value::Int(i64::MIN), "==", "-9223372036854775808", true),
        (Value::Float(f64::INFINITY), ">", "18446744073709551615", true),
        (Value::Float(f64::NEG_INFINITY), "<", "0", true),
        (Value::Float(-0.0), "==", "0", true),
        (Value::Int(1), "!=", "1.5", true),
        (Value::Int(1), "<=", "1", true),
        (Value::Int(1), ">=", "1.5", false),
    ] {
        let context = TestContext::new().with(BALL, &[DISTANCE], left);
        let condition = format!("Ball.distance {comparison} {right}");
        assert_eq!(context.holds(&condition), Ok(expected), "{left:?} {comparison} {right}");
        let mirrored = match comparison.strip_prefix('<') {
            Some(rest) => format!(">{rest}"),
            None => comparison.replace('>', "<"),
        };
        let condition = format!("{right} {mirrored} Ball.distance");
        assert_eq!(context.holds(&condition), Ok(expected), "{condition} of {left:?}");
        let condition = format!("Ball.distance {comparison} {right} * Ball.distance / Ball.distance");
        if matches!(left, Value::Float(float) if float.is_finite() && float != 0.0) {
            assert_eq!(context.holds(&condition), Ok(expected), "{condition} of {left:?}");
        }
    }
}

#[test]
fn arithmetic_is_whole_as_long_as_it_is_exact() {
    for condition in [
        "1 + 2 * 3 - 4 == 3",
        "2 - 3 - 4 == -5",
        "5 / 2 == 2.5",
        "8 / 2 / 2 == 2",
        "-(1 + 1) == -2",
        "- -1 == 1",
        "0.5 + 1 == 1.5",
        "18446744073709551615 - 1 == 18446744073709551614",
        "9007199254740993 + 0 == 9007199254740993",
        "-9223372036854775808 < -9223372036854775807",
    ] {
        assert_eq!(TestContext::new().holds(condition), Ok(true), "{condition}");
    }
}

#[test]
fn an_operation_without_a_result_is_an_error() {
    let with = |value| TestContext::new().with(BALL, &[DISTANCE], value);
    for (context, condition, error) in [
        (with(Value::Int(0)), "1 / Ball.distance > 0", GuardError::DivisionByZero),
        (with(Value::Float(-0.0)), "1 / Ball.distance > 0", GuardError::DivisionByZero),
        (with(Value::Float(f64::NAN)), "Ball.distance > 0", GuardError::NotANumber),
        (with(Value::Float(f64::NAN)), "Ball.distance != 0.5", GuardError::NotANumber),
        (with(Value::Uint(u64::MAX)), "Ball.distance + 1 > 0", GuardError::OutOfRange),
        (with(Value::Uint(u64::MAX)), "Ball.distance * Ball.distance > 0", GuardError::OutOfRange),
        (with(Value::Uint(u64::MAX)), "-Ball.distance < 0", GuardError::OutOfRange),
        (with(Value::Text("3")), "Ball.distance > 2", GuardError::WrongType),
        (with(Value::Text("3")), "Ball.distance + 1 > 2", GuardError::WrongType),
        (with(Value::Enum(3)), "Ball.distance == 3", GuardError::WrongType),
        (TestContext::new().with(BALL, &[FOUND], Value::Int(1)), "Ball.found", GuardError::WrongType),
        (
            TestContext::new().with(BALL, &[COLOUR], Value::Int(1)),
            "Ball.colour == \"1\"",
            GuardError::WrongType,
        ),
        (
            with(Value::Float(-1.0)),
            "soccer::root(Ball.distance) > 0",
            GuardError::Call(CallError::new("no root of a negative number")),
        ),
    ] {
        assert_eq!(context.holds(condition), Err(error.clone()), "{condition}");
        assert_eq!(context.holds(&format!("!({condition})")), Err(error), "{condition}");
    }
    let failed = GuardError::Call(CallError::new("no root of a negative number"));
    assert_eq!(failed.to_string(), "the function failed: no root of a negative number");
}

#[test]
fn decided_properties_are_not_evaluated_again() {
    let context = TestContext::new();
    assert_eq!(context.holds("false && 1 / 0 > 1"), Ok(false));
    assert_eq!(context.holds("true || 1 / 0 > 1"), Ok(true));
    assert_eq!(context.holds("Ball.found && 1 / 0 > 1"), Err(GuardError::DivisionByZero));
    assert_eq!(context.holds("1 / 0 > 1 || true"), Err(GuardError::DivisionByZero));
}

#[test]
fn functions_get_their_arguments_in_order() {
    let context = TestContext::new().with(BALL, &[DISTANCE], Value::Float(-0.75));
    assert_eq!(context.holds("near(Ball, abs(Ball.distance))"), Ok(true));
    assert_eq!(context.holds("near(ball.State.Ball, 0.5)"), Ok(false));
    assert_eq!(context.holds("soccer::root(4.0) == 2"), Ok(true));
    let calls = context.calls.borrow();
    assert_eq!(calls[0], (ABS, "[Float(-0.75)]".to_owned()));
    assert_eq!(calls[1], (NEAR, "[Message(..), Float(0.75)]".to_owned()));
}

#[test]
fn texts_and_truths_compare_for_sameness() {
    let context =
        TestContext::new().with(BALL, &[COLOUR], Value::Text("blue")).with(BALL, &[FOUND], Value::Bool(true));
    assert_eq!(context.holds("Ball.colour == \"blue\" && Ball.colour != \"Blue\""), Ok(true));
    assert_eq!(context.holds("Ball.found == true && Ball.found != debug"), Ok(true));
    assert_eq!(context.holds("(1 < 2) == Ball.found"), Ok(true));
}

/// A comparison of a field with a constant reads the field once.
#[test]
fn false_is_a_value() {
    for (found, is_so, is_not_so) in
        [(Some(true), Some(true), Some(false)), (Some(false), Some(false), Some(true)), (None, None, None)]
    {
        let context = context(found, None);
        assert_eq!(truth(&context, "(Ball.found && true) == true"), is_so);
        assert_eq!(truth(&context, "(Ball.found && true) == false"), is_not_so);
    }
}

#[test]
fn a_guard_lists_all_its_reads() {
    let topics = |condition: &str| guard(condition).reads().to_vec();
    let both = [BALL, GAME];
    for condition in [
        "Ball.distance < GameState.score",
        "GameState.score < Ball.distance",
        "abs(Ball.distance) + GameState.score > 1",
        "1 + Ball.distance - GameState.score > 1",
        "Ball.distance * GameState.score > 1",
        "2 * Ball.distance / GameState.score > 1",
        "-Ball.distance < -GameState.score",
        "(Ball.found && true) == (GameState.score > 0)",
        "!(Ball.found || GameState == NULL)",
    ] {
        assert_eq!(topics(condition), both, "{condition}");
        let guard = guard(condition);
        let sources: Vec<_> = guard.sources().iter().map(|source| source.topic).collect();
        assert_eq!(sources, both, "{condition}");
    }
}

#[test]
fn a_guard_is_evaluated_again_and_again() {
    let guard = guard("Ball.distance <= limit");
    for (distance, expected) in [(0.2, true), (0.25, true), (0.3, false)] {
        let context = TestContext::new().with(BALL, &[DISTANCE], Value::Float(distance));
        assert_eq!(guard.evaluate(&context), Ok(expected));
    }
}
