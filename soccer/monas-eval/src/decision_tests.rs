//! Test support: the tests that the decisions of a behaviour in Rust pass, however it is called.

use crate::decision_cases::{Case, Decision, Requests, goalie_cases, player_cases};

/// A behaviour of a robot that stands, during play.
pub(crate) trait DecisionFixture {
    fn new() -> Self;

    /// Decides once on the inputs of a case.
    fn decide(&mut self, case: &Case) -> Requests;

    /// Lets time pass.
    fn wait(&mut self, millis: u64);

    /// Ends the motion that was requested last.
    fn finish_motion(&mut self);
}

/// The tests of a goalie and a player in their fixtures.
macro_rules! decision_tests {
    ($goalie:ty, $player:ty) => {
        #[test]
        fn goalie_decides_as_in_the_scenarios() {
            $crate::decision_tests::decides_all::<$goalie>(&$crate::decision_cases::goalie_cases());
        }

        #[test]
        fn player_decides_as_in_the_scenarios() {
            $crate::decision_tests::decides_all::<$player>(&$crate::decision_cases::player_cases());
        }

        #[test]
        fn goalie_decides_again_when_its_dive_is_over() {
            $crate::decision_tests::goalie_decides_again_after_its_dive::<$goalie>();
        }

        #[test]
        fn player_decides_again_when_its_kick_is_over() {
            $crate::decision_tests::player_decides_again_after_its_kick::<$player>();
        }

        #[test]
        fn player_glances_for_a_moment_and_not_again_soon() {
            $crate::decision_tests::player_glances_for_a_moment::<$player>();
        }
    };
}
pub(crate) use decision_tests;

/// The case of a scenario.
pub(crate) fn find(cases: Vec<Case>, scenario: &str) -> Case {
    cases.into_iter().find(|case| case.scenario == scenario).unwrap()
}

pub(crate) fn decides_all<F: DecisionFixture>(cases: &[Case]) {
    for case in cases {
        case.assert(F::new().decide(case));
    }
}

pub(crate) fn goalie_decides_again_after_its_dive<F: DecisionFixture>() {
    let (dive, search) = (find(goalie_cases(), "dive_left"), find(goalie_cases(), "search"));
    decides_again::<F>(&dive, &search);
}

pub(crate) fn player_decides_again_after_its_kick<F: DecisionFixture>() {
    let (kick, search) = (find(player_cases(), "kick_left"), find(player_cases(), "search"));
    decides_again::<F>(&kick, &search);
}

/// Nothing is decided while a motion runs.
fn decides_again<F: DecisionFixture>(motion: &Case, search: &Case) {
    let mut fixture = F::new();
    motion.assert(fixture.decide(motion));
    fixture.wait(100);
    assert_eq!(fixture.decide(search), (None, None));
    fixture.finish_motion();
    search.assert(fixture.decide(search));
    motion.assert(fixture.decide(motion));
}

pub(crate) fn player_glances_for_a_moment<F: DecisionFixture>() {
    let mut fixture = F::new();
    let glance = find(player_cases(), "look_at_goal");
    let walk = Case { decision: Decision::WalkTowardsBall, ..glance };
    for _ in 0..2 {
        glance.assert(fixture.decide(&glance));
        fixture.wait(300);
        assert_eq!(fixture.decide(&glance), (None, None));
        fixture.wait(100);
        walk.assert(fixture.decide(&glance));
        fixture.wait(1000);
        walk.assert(fixture.decide(&glance));
        fixture.wait(1600);
    }
}
