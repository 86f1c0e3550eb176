//! Play with the latency and the errors of real cameras is still soccer.

#![allow(clippy::unwrap_used)] // tests may panic

use std::time::Duration;

use monas_match::{MatchOptions, MatchSource};
use monas_sim::Physics;
use monas_tests::{MatchRow, UNKIND, UNKIND_ATTACK, UNKIND_STANDING, play, root};

const HALF: Duration = Duration::from_secs(300);

/// The parameters of the errors of cameras; all are zero by default.
const ERRORS: [&str; 8] = [
    "camera_latency",
    "light_change",
    "false_ball",
    "false_post",
    "false_robot",
    "wrong_goal",
    "wrong_side",
    "wrong_team",
];

/// The physics of a match.
fn physics(file: &str) -> Physics {
    let plan = MatchSource::load(root().join(file), &monas::Registry::linked()).unwrap();
    let running = plan.start(MatchOptions { seed: 1, record: None }).unwrap();
    running.pitch().with_world(|world| world.physics().clone())
}

#[test]
fn the_unkind_matches_have_every_error_of_cameras() {
    for file in [UNKIND.file, UNKIND_STANDING.file, UNKIND_ATTACK.file] {
        let physics = physics(file);
        let kind = ERRORS.iter().find(|error| physics.get(error).unwrap() == 0.0);
        assert_eq!(kind, None, "{file}");
    }
}

#[test]
fn both_teams_play_soccer() {
    let rows: Vec<MatchRow> = (1..=4).map(|seed| play(&UNKIND, seed, HALF).unwrap()).collect();
    let sum = |figure: fn(&MatchRow) -> [u32; 2]| rows.iter().flat_map(figure).sum::<u32>();
    let (goals, kicks) = (sum(|row| row.goals), sum(|row| row.kicks));
    assert!(goals >= 4, "{goals} goals in four halves");
    assert!(kicks >= 60, "{kicks} kicks in four halves");
}

#[test]
fn attackers_score_against_a_team_that_stands_still() {
    let goals: u32 = (1..=2).map(|seed| play(&UNKIND_STANDING, seed, HALF).unwrap().goals[0]).sum();
    assert!(goals >= 5, "{goals} goals in two halves");
}
