//! The machine against a naive interpreter of the same rules: on random charts, scripts and
//! semantics both must behave equally.

#![allow(clippy::expect_used, clippy::panic, clippy::unwrap_used)] // the functions around the tests are tests too

use yase_reference::parallel;

/// The number of played charts.
const CHARTS: u64 = 10_000;

/// Plays both halves of the charts concurrently. Prints the histogram; every row must have
/// occurred.
#[test]
fn machine_and_reference_write_the_same_lines() {
    let found = std::thread::scope(|threads| {
        let second = threads.spawn(|| parallel::compare(CHARTS / 2..CHARTS));
        let mut found = parallel::compare(0..CHARTS / 2);
        found.join(second.join().expect("it does not panic"));
        found
    });
    println!("{}", found.histogram.text());
    if let Some(difference) = found.difference {
        panic!("{difference}");
    }
    assert_eq!(found.refused, Vec::<String>::new(), "the generator makes charts");
    assert_eq!(found.histogram.missing(), Vec::<&String>::new(), "each row occurs");
    assert_eq!(found.histogram.played(), CHARTS, "every chart is played");
    assert!(found.histogram.row("R17 comes to rest") > CHARTS * 7 / 10, "most charts come to rest");
}
