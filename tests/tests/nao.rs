//! The goalie through the interface of a Nao: its joints, against the same shooters as with the
//! body of the field.
//!
//! `MONAS_SHOOTERS=20 cargo test -p monas-tests --test nao -- --nocapture` plays as many seeds of
//! five minutes each, and prints the table.

#![allow(clippy::unwrap_used)] // tests may panic

use std::time::Duration;

use monas::config::Layers;
use monas_match::{MatchOptions, MatchSource};
use monas_robot::topics::JOINTS;
use monas_soccer::MotionResult;
use monas_soccer::topics::MOTION_STATE;
use monas_tests::{MatchRow, Variant, play, root};

const FIELD: Variant = Variant { name: "shooters", file: "tests/season/shooters.xml" };
const NAO: Variant = Variant { name: "shooters_nao", file: "tests/season/shooters_nao.xml" };

/// Seeds and length of the short comparison.
const SHORT: (u64, Duration) = (3, Duration::from_secs(100));

/// Goals conceded and saves of the goalie, over the seeds.
fn figures(variant: &Variant, seeds: u64, length: Duration) -> (u32, u32) {
    let rows: Vec<MatchRow> = (1..=seeds).map(|seed| play(variant, seed, length).unwrap()).collect();
    rows.iter().for_each(|row| println!("{row}"));
    (rows.iter().map(|row| row.goals[1]).sum(), rows.iter().map(|row| row.saves[0]).sum())
}

#[test]
fn the_goalie_defends_through_the_interface_of_a_nao() {
    let many =
        std::env::var("MONAS_SHOOTERS").ok().map(|seeds| (seeds.parse().unwrap(), Duration::from_secs(300)));
    let (seeds, length) = many.unwrap_or(SHORT);
    let [(conceded, saves), (conceded_nao, saves_nao)] =
        [&FIELD, &NAO].map(|one| figures(one, seeds, length));
    println!(
        "{seeds} matches of {} s: conceded {conceded}, saves {saves}; as a Nao conceded {conceded_nao}, saves {saves_nao}",
        length.as_secs()
    );
    assert!(saves > 0 && 5 * saves_nao >= 4 * saves, "{saves_nao} saves instead of {saves}");
    assert!(2 * conceded_nao <= 3 * conceded, "{conceded_nao} goals instead of {conceded}");
}

#[test]
fn a_match_of_naos_repeats_with_its_seed() {
    let length = Duration::from_secs(20);
    let naos = Variant { name: "nao_sim", file: "config/nao_sim.xml" };
    let (one, again) = (play(&naos, 7, length).unwrap(), play(&naos, 7, length).unwrap());
    assert_eq!(one.hash, again.hash);
    assert_ne!(one.hash, play(&monas_tests::MATCH, 7, length).unwrap().hash);
}

/// A greeting with an arm, in place of the kick with the left foot.
const GREETING: &str = "<poses>\n  <pose duration=\"0.4\" RShoulderPitch=\"-0.5\"/>\n  \
                        <pose duration=\"0.4\" RShoulderPitch=\"1.5\"/>\n</poses>\n";

#[test]
fn the_kick_of_a_file_moves_the_joints_and_behaviours_learn_its_result() {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("greeting.xml");
    std::fs::write(&file, GREETING).unwrap();
    let kick_off = ["initial", "ready", "set"].map(|phase| format!("simulator.rules.{phase}_duration=0"));
    let kick = format!("match.team.1.robot.2.body.kick={}", file.display());
    let grammar = monas_match::grammar();
    let layers = kick_off
        .iter()
        .chain([&kick])
        .fold(Layers::new(), |layers, setting| layers.set(setting, &grammar).unwrap());
    let path = root().join("config/nao_sim.xml");
    let plan = MatchSource::load_with(path, &monas::Registry::linked(), &layers).unwrap();
    let mut running = plan.start(MatchOptions { seed: 7, record: None }).unwrap();
    let hub = running.simulation().and_then(|simulation| simulation.hub("blue-2")).unwrap();
    let mut board = hub.blackboard("test");
    let anatomy = monas_nao::anatomy();
    let shoulders = ["LShoulderPitch", "RShoulderPitch"].map(|name| anatomy.joint(name).unwrap());
    // Whether an arm has been up, and the result of the skill that ended after that.
    let (mut is_up, mut results, mut done) = (false, Vec::new(), 0);
    while running.now() < Duration::from_secs(60) && results.is_empty() {
        running.advance(running.now() + Duration::from_millis(20)).unwrap();
        board.process_messages(running.simulation().unwrap().now());
        let angles = board.read(JOINTS).map(|joints| joints.positions.clone()).unwrap_or_default();
        is_up |= shoulders.iter().any(|&shoulder| angles.get(shoulder).is_some_and(|&angle| angle < -0.4));
        let Some(state) = board.read(MOTION_STATE) else { continue };
        if state.done != done {
            done = state.done;
            results.extend(is_up.then(|| state.result()));
        }
    }
    assert_eq!(results, [MotionResult::Performed]);
}
