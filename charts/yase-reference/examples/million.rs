//! Compares the machine with the reference interpreter on any number of random charts:
//!
//! ```text
//! cargo run --release -p yase-reference --example million -- 1000000 [first]
//! ```
//!
//! Progress is written to stderr, the histogram to stdout. The first chart with a difference is
//! shrunk and printed, and the exit code is 1.

#![allow(clippy::expect_used, clippy::panic, clippy::unwrap_used)] // it shares its code with a test

use std::process::ExitCode;
use std::sync::atomic::{AtomicU64, Ordering};

use yase_reference::parallel::{self, Found};

/// The number of charts played between checks for a difference found by another thread.
const BATCH: u64 = 1000;

fn main() -> ExitCode {
    let mut arguments = std::env::args().skip(1);
    let mut number = |default: u64| match arguments.next().map(|text| text.parse()) {
        None => Some(default),
        Some(number) => number.ok(),
    };
    let (Some(charts), Some(first)) = (number(1_000_000), number(0)) else {
        eprintln!("usage: million [charts] [first]");
        return ExitCode::from(2);
    };
    report(&run(first, first.saturating_add(charts)), charts)
}

/// Plays all charts with these numbers on all processors.
fn run(first: u64, end: u64) -> Found {
    let next = AtomicU64::new(first);
    let workers = std::thread::available_parallelism().map_or(1, usize::from);
    std::thread::scope(|threads| {
        let handles: Vec<_> = (0..workers).map(|_| threads.spawn(|| work(&next, end))).collect();
        let mut all = Found::default();
        for handle in handles {
            all.join(handle.join().expect("it does not panic"));
        }
        all
    })
}

fn work(next: &AtomicU64, end: u64) -> Found {
    let mut all = Found::default();
    loop {
        let from = next.fetch_add(BATCH, Ordering::Relaxed);
        if from >= end {
            return all;
        }
        all.join(parallel::compare(from..end.min(from + BATCH)));
        if all.difference.is_some() {
            next.fetch_max(end, Ordering::Relaxed);
        }
        if from.is_multiple_of(10 * BATCH) {
            eprintln!("{from} of {end}");
        }
    }
}

fn report(found: &Found, charts: u64) -> ExitCode {
    println!("{}", found.histogram.text());
    for why in found.refused.iter().take(5) {
        println!("refused: {why}");
    }
    for row in found.histogram.missing() {
        println!("never: {row}");
    }
    let (resting, played) = (found.histogram.row("R17 comes to rest"), found.histogram.played());
    println!("{played} of {charts} charts were played, {resting} come to rest");
    match &found.difference {
        Some(difference) => println!("{difference}"),
        None => println!("no difference in {charts} charts, {} of them refused", found.refused.len()),
    }
    ExitCode::from(u8::from(found.difference.is_some() || !found.refused.is_empty()))
}
