//! The goalie through the interface of a Nao: its joints, against the same shooters as with the
//! body of the field.
//!
//! `MONAS_SHOOTERS=20 cargo test -p monas-tests --test play nao -- --nocapture` plays as many seeds
//! of five minutes each, and prints the table.

#![allow(clippy::unwrap_used)] // tests may panic

use std::ops::RangeInclusive;
use std::thread;
use std::time::Duration;

use monas_nao as _; // the body registers itself at link time
use monas_tests::{MatchRow, Variant, play};

const FIELD: Variant = Variant { name: "shooters", file: "tests/season/shooters.xml" };
const NAO: Variant = Variant { name: "shooters_nao", file: "tests/season/shooters_nao.xml" };

/// The seeds that are played: in the short form of the test, and in the long one.
const SEEDS: [RangeInclusive<u64>; 2] = [2..=2, 1..=4];

/// Goals conceded and saves of the goalie, over the seeds.
fn figures(variant: &Variant, seeds: RangeInclusive<u64>, length: Duration) -> (u32, u32) {
    let rows: Vec<MatchRow> = seeds.map(|seed| play(variant, seed, length).unwrap()).collect();
    rows.iter().for_each(|row| println!("{row}"));
    (rows.iter().map(|row| row.goals[1]).sum(), rows.iter().map(|row| row.saves[0]).sum())
}

#[test]
fn the_goalie_defends_through_the_interface_of_a_nao() {
    let many = std::env::var("MONAS_SHOOTERS")
        .ok()
        .map(|seeds| (1..=seeds.parse().unwrap(), Duration::from_secs(300)));
    let (seeds, length) =
        many.unwrap_or((SEEDS[usize::from(crate::is_long())].clone(), Duration::from_secs(200)));
    let [(conceded, saves), (conceded_nao, saves_nao)] = thread::scope(|scope| {
        [&FIELD, &NAO]
            .map(|one| scope.spawn(|| figures(one, seeds.clone(), length)))
            .map(|of_one| of_one.join().unwrap())
    });
    println!(
        "seeds {seeds:?}, {} s each: conceded {conceded}, saves {saves}; as a Nao conceded {conceded_nao}, saves {saves_nao}",
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
