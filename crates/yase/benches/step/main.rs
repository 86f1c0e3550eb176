//! What a step costs, beside what others need for the same: `cargo bench -p yase`.
//!
//! Three charts, the same for everybody: **flat**, A and B that change places on an event; **hier**, two branches four deep, where the
//! outermost state answers the event and leads to the innermost of the other branch (4 exits, 4 entries); **ortho**, three regions that
//! each do what flat does (3 transitions an event). Every state counts its entries and exits, and the counts are asserted. All take turns in
//! one run, on the thread's own processor time, so that what disturbs one disturbs all; what counts are the ratios.
//!
//! Who is compared:
//!
//! - a `match` written by hand, which is what the best compiler of charts could reach,
//! - a table interpreter written by hand: the floor for a chart that is only known at run time. It has no guards, queue, history or activities,
//! - `statig`, whose charts are compiled, without regions, history or models at run time,
//! - YASE, with all that it is,
//! - the same chart as Rust that YASE writes ([`yase::flatten`]).
//!
//! Further tables: what guards, traces and deep transitions cost, and how long it takes to make charts ready.
//!
//! Three runs, medians: flat 10 to 14 ns, 2.5 to 2.9 times the table interpreter; hier 17 to 20 ns, 2.2 to 2.3 times; ortho 22 to 32 ns, 2.3 to 3.1 times. Flattened: flat 1.3 to
//! 2.1 ns, 1.0 to 1.2 times the `match` by hand; hier 2.3 ns and ortho 1.9 ns, below it. A field compared with a constant adds 4.5 ns, nine that do not hold 27 ns; flattened, all of
//! them less than half a nanosecond. A trace adds 19 ns. A chart of 1,000 states is parsed and compiled in 4 ms, one of 100,000 in 0.8 s. Nothing of a step allocates. Run by `cargo test` without
//! `--bench`, each contestant only shows that it counts right.
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

/// One chart and everybody who runs it.
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
