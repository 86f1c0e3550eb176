//! Cost of messages in comparison with other crates: `cargo bench -p narukom`.
//!
//! Machines are shared and differ, so absolute figures mean little: all contestants of a table take
//! turns in one run of several rounds, and the table shows the median over the rounds, with the
//! smallest and the largest. A word after `--` selects the tables whose title contains it; a number
//! sets the number of rounds: `cargo bench -p narukom -- polling 15`.
#![allow(clippy::disallowed_methods, reason = "a benchmark reads the clock and starts threads")]
#![allow(clippy::unwrap_used, reason = "a benchmark that cannot go on stops")]

mod fan_out;
mod latency;
mod messages;
mod one_thread;
mod table;

use table::Selection;

fn main() {
    let selection = Selection::from_arguments();
    one_thread::publish_and_read(&selection);
    one_thread::nearest(&selection);
    one_thread::idle_topics(&selection);
    latency::polling(&selection);
    latency::blocking(&selection);
    latency::large(&selection);
    fan_out::eight(&selection);
    fan_out::eight_large(&selection);
}
