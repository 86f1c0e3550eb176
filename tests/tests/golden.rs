//! Two short matches come to exactly what their golden rows say. `MONAS_BLESS=1` writes the rows anew.

#![allow(clippy::unwrap_used)] // a test fails by panicking

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
