//! Duration of a step, compared with other libraries: `cargo bench -p yase-codegen`.
//!
//! Three charts, equal for all contestants: **flat**, two states that alternate on an event;
//! **hier**, two branches four deep, where the outermost state has a transition to the innermost of
//! the other branch (4 exits, 4 entries); **ortho**, three regions that each behave as flat (3
//! transitions per event). Every state counts its entries and exits, and the counts are asserted.
//! Contestants alternate in one run, measured in processor time of the thread, so that disturbances
//! affect all; the relevant results are the ratios.
//!
//! Contestants:
//!
//! - a `match` written by hand, the optimum for a chart compiler,
//! - a table interpreter written by hand: a lower bound for a chart that is only known at run time.
//!   It has no guards, queue, history or activities,
//! - `statig`, whose charts are compiled, without regions, history or models at run time,
//! - YASE with all features,
//! - the same chart flattened to Rust ([`yase_codegen::flatten`]).
//!
//! Further tables: the cost of guards, traces and deep transitions, and the time to compile charts.
//!
//! A step does not allocate. Without `--bench`, as in `cargo test`, only the counts of each
//! contestant are checked.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, reason = "a bench that cannot go on ends")]

mod allocations;
mod building;
mod by_hand;
mod counts;
mod features;
mod flattened;
mod harness;
mod ours;
mod peers;
mod table;

use counts::{FLAT, HIER, ORTHO, Toggle};
use harness::{Contestant, Race, Racer};

fn main() {
    let race = Race::from_arguments();
    let [flat, hier, ortho] = [FLAT, HIER, ORTHO];
    let chart = ours::flat();
    let written = flattened::Flat::new(&chart);
    engines(&race, "flat", flat, by_hand::Flat::default(), peers::flat(), written, &chart);
    let chart = ours::hier();
    let written = flattened::Hier::new(&chart);
    engines(&race, "hier", hier, by_hand::Hier::default(), peers::hier(), written, &chart);
    let chart = ours::ortho();
    let written = flattened::Ortho::new(&chart);
    engines(&race, "ortho", ortho, by_hand::Ortho::default(), peers::ortho(), written, &chart);
    features::run(&race);
    building::run(&race);
}

/// One chart and all its contestants.
fn engines(
    race: &Race,
    title: &str,
    side: usize,
    by_hand: impl Toggle + 'static,
    peer: impl Toggle + 'static,
    written: impl Toggle + 'static,
    chart: &yase::Statechart,
) {
    let mut contestants: Vec<Box<dyn Contestant>> = vec![
        Box::new(Racer::new("table interpreter", side, table::Machine::new(chart))),
        Box::new(Racer::new("match by hand", side, by_hand)),
        Box::new(Racer::new("statig", side, peer)),
        Box::new(Racer::new("yase, flattened", side, written)),
        Box::new(Racer::new("yase", side, ours::Ours::new(chart))),
    ];
    race.run(&format!("{title}, ns an event"), &mut contestants);
}
