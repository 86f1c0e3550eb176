//! No guard of the players judges a moment that is gone: `monas model check` finds none (M29), and
//! it does find the guards of a role whose attack is assessed elsewhere only.

#![allow(clippy::unwrap_used)] // tests may panic

use aseme_verify::check::check;
use aseme_verify::{CheckSettings, ProgramSymbols};
use monas::Registry;
use monas_tests::root;
use yase::Source;

/// The messages of the linked activities, and their topics.
fn program() -> ProgramSymbols {
    let registry = Registry::linked();
    let mut world =
        ProgramSymbols { vocabulary: registry.vocabulary().unwrap(), ..ProgramSymbols::default() };
    for name in registry.activity_names() {
        let topics = registry.activity(name).unwrap().topics();
        let paths = |paths: &[&str]| paths.iter().map(|&path| path.to_owned()).collect();
        world.activities.insert(name.to_owned(), Some(paths(topics.published_paths())));
        world.readers.insert(name.to_owned(), Some(paths(topics.read_paths())));
        world.ended_by.insert(name.to_owned(), paths(topics.ending_paths()));
    }
    world
}

/// The guards of a role that read what is not derived yet, as messages.
fn stale(role: &str) -> Vec<String> {
    let text = std::fs::read_to_string(root().join(role)).unwrap();
    let mut settings = CheckSettings::default();
    settings.world = Some(program());
    settings.states = 0;
    let report = check(&Source::new(role, text), &settings);
    assert!(!report.has_errors(), "{role}: {:?}", report.findings);
    let stale = report.findings.iter().filter(|finding| finding.diagnostic.code == "M29");
    stale.map(|finding| finding.diagnostic.message.clone()).collect()
}

#[test]
fn the_players_judge_what_is_derived_from_the_present_ball() {
    for role in ["goalie", "attacker", "extended_attacker"] {
        assert_eq!(stale(&format!("models/{role}.srm")), [""; 0], "{role}");
    }
}

#[test]
fn a_pass_that_is_judged_before_the_ball_is_at_the_foot_is_found() {
    let found = stale("tests/season/stale_attack.srm");
    let of = |state: &str| found.iter().filter(|message| message.contains(state)).count();
    assert!(of("center/WalkTowardsBall`") >= 1, "the guard of the pass: {found:#?}");
    assert!(of("[kickBall]]") + of("[kickBall]/WalkTowardsBall`") >= 1, "the guard of the shot: {found:#?}");
    assert!(found.iter().all(|message| message.contains("soccer/attack")), "{found:#?}");
}
