//! The machine against a naive interpreter of the same rules: on random charts, scripts and
//! semantics both must behave equally.

use yase_reference::parallel;

/// The number of charts that are played: shortly, and at length.
const CHARTS: [u64; 2] = [2_000, 10_000];

/// Plays both halves of the charts concurrently. Prints the histogram; every row must have
/// occurred.
#[test]
fn machine_and_reference_write_the_same_lines() {
    let charts = CHARTS[usize::from(crate::is_long())];
    let found = std::thread::scope(|threads| {
        let second = threads.spawn(|| parallel::compare(charts / 2..charts));
        let mut found = parallel::compare(0..charts / 2);
        found.join(second.join().expect("it does not panic"));
        found
    });
    println!("{}", found.histogram.text());
    if let Some(difference) = found.difference {
        panic!("{difference}");
    }
    assert_eq!(found.refused, Vec::<String>::new(), "the generator makes charts");
    assert_eq!(found.histogram.missing(), Vec::<&String>::new(), "each row occurs");
    assert_eq!(found.histogram.played(), charts, "every chart is played");
    assert!(found.histogram.row("R17 comes to rest") > charts * 7 / 10, "most charts come to rest");
}
