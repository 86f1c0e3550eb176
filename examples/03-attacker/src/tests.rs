//! Tests of the decision: one message in, one activity out.

use super::*;

/// The activity chosen for a ball during play.
fn choice(ball: Ball) -> &'static str {
    let chosen = choices(GamePhase::Playing, ball).unwrap();
    let [activity] = chosen.as_slice() else { panic!("{chosen:?} for {ball:?}") };
    activity
}

#[test]
fn a_ball_that_is_not_seen_is_searched_for() {
    assert_eq!(choice(Ball::default()), "SearchBall");
    assert_eq!(choice(Ball { found: false, ..seen(0.15, 0.05) }), "SearchBall");
}

#[test]
fn a_ball_that_is_far_is_walked_to() {
    for (x, y) in [(3.0, 0.0), (0.4, 0.0), (0.0, -2.0), (-0.5, 0.1)] {
        assert_eq!(choice(seen(x, y)), "WalkTowardsBall");
    }
}

#[test]
fn a_ball_that_is_near_is_brought_before_a_foot() {
    for (x, y) in [(0.24, 0.0), (0.15, 0.0), (0.0, 0.2), (0.05, -0.05)] {
        assert_eq!(choice(seen(x, y)), "AlignWithBall");
    }
}

#[test]
fn a_ball_before_a_foot_is_kicked_with_that_foot() {
    assert_eq!(choice(seen(0.15, 0.05)), "LeftKick");
    assert_eq!(choice(seen(0.16, 0.04)), "LeftKick");
    assert_eq!(choice(seen(0.15, -0.05)), "RightKick");
}

#[test]
fn nothing_is_decided_while_the_game_is_not_on() {
    for phase in [GamePhase::Initial, GamePhase::Ready, GamePhase::Set, GamePhase::Finished] {
        assert_eq!(choices(phase, seen(0.15, 0.05)).unwrap(), Vec::<&str>::new(), "{phase:?}");
    }
}
