//! Two short matches equal their golden rows exactly. `MONAS_BLESS=1` updates the rows.

#![allow(clippy::unwrap_used)] // tests may panic

use monas_tests::{root, short_rows};

#[test]
fn two_matches_of_120_s_are_replayed_exactly() {
    let path = root().join("tests/golden/short.txt");
    let rows = short_rows().unwrap();
    if std::env::var_os("MONAS_BLESS").is_some() {
        std::fs::write(&path, &rows).unwrap();
    }
    assert_eq!(std::fs::read_to_string(path).unwrap(), rows);
}

#[test]
fn a_season_is_replayed_exactly_and_its_figures_are_within_their_bounds() {
    if crate::is_long() {
        println!("{}", monas_tests::check_season(|_| ()).unwrap_or_else(|failure| panic!("{failure}")));
    } else {
        println!("skipped: the season is played with MONAS_LONG_TESTS=1, or by `cargo xtask season --check`");
    }
}
