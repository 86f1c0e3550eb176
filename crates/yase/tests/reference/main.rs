//! The machine against a naive interpreter of the same rules: on random charts, scripts and semantics both must do the same.

#![allow(clippy::expect_used, clippy::panic, clippy::unwrap_used)] // the functions around the tests are tests too

#[path = "../kit/mod.rs"]
mod kit;
mod oracle;

use oracle::many;

/// So many charts are made; those of which it is [known](oracle::random::Case::is_settled) that both must read them alike are played, which
/// is about one in nine.
const MADE: u64 = 60_000;

/// How many are played at least.
const PLAYED: u64 = 6_000;

/// What cannot occur in the charts that are played, beside the points of other dialects.
const ELSEWHERE: [&str; 5] = [
    "R4 an event of more tokens",
    "R10 START in the same step",
    "R12 JOIN, all have arrived",
    "R12 JOIN, each",
    "R16 done.state",
];

/// Half of the charts at the same time as the other half. What occurred in them is printed, and every row must have occurred.
#[test]
fn machine_and_reference_write_the_same_lines() {
    let found = std::thread::scope(|threads| {
        let second = threads.spawn(|| many::compare(MADE / 2..MADE));
        let mut found = many::compare(0..MADE / 2);
        found.join(second.join().expect("it does not panic"));
        found
    });
    println!("{}", found.histogram.text());
    if let Some(difference) = found.difference {
        panic!("{difference}");
    }
    assert_eq!(found.refused, Vec::<String>::new(), "the generator makes charts");
    let missing: Vec<&String> =
        found.histogram.missing().into_iter().filter(|row| is_expected(row)).collect();
    assert_eq!(missing, Vec::<&String>::new(), "each row occurs");
    let played = found.histogram.row("chooser declared")
        + found.histogram.row("chooser seeded")
        + found.histogram.row("chooser scripted");
    assert!(played > PLAYED, "{played} charts are played");
    assert!(found.histogram.row("R17 comes to rest") > played * 7 / 10, "most charts come to rest");
}

fn is_expected(row: &str) -> bool {
    let of_other_dialects = ["point ", "points ", "profile "].iter().any(|title| row.starts_with(title));
    !of_other_dialects && !ELSEWHERE.contains(&row)
}
