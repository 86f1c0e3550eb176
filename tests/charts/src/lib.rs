//! Random charts, generated as Rust and interpreted: both must produce the same traces.
//!
//! Charts, scripts and semantics are those with which the tests of `yase` compare the machine with
//! its reference. `build.rs` generates 200 of them; `MONAS_CHARTS=0..5000 cargo test -p
//! chart-tests` compares 5,000.

#![cfg(test)]
#![allow(clippy::expect_used, clippy::panic, clippy::unwrap_used)] // test code

#[allow(unreachable_pub, unused_imports)] // separate crates elsewhere
mod generated {
    use yase::Diagnostic;
    use yase_codegen::typed::TypedChart;

    /// Constructor of a chart.
    pub(crate) type ChartConstructor = fn() -> Result<TypedChart, Vec<Diagnostic>>;

    include!(concat!(env!("OUT_DIR"), "/charts.rs"));
}

use std::sync::Arc;

use yase::{Chooser, CompiledChart, Machine};

use yase_reference::chooser::ChoicePolicy;
use yase_reference::random::Case;
use yase_reference::script;
use yase_reference::test_host::{TestHost, vocabulary};

/// The trace of all calls to the host.
fn played(case: &Case, chart: CompiledChart) -> Vec<String> {
    let mut host = TestHost { verbose: true, reads: true, ..TestHost::new(&case.chart) };
    let mut machine = Machine::new(Arc::new(chart));
    machine.set_chooser(match &case.policy {
        ChoicePolicy::Declared => Chooser::declared(),
        ChoicePolicy::Seeded(seed) => Chooser::seeded(*seed),
        ChoicePolicy::Scripted(choices) => Chooser::scripted(choices.clone()),
    });
    script::run(&mut machine, &case.script, &mut host);
    host.say(format!("at the end {:?} {:?}", machine.status(), machine.configuration()));
    host.log
}

#[test]
fn generated_charts_leave_the_traces_of_interpreted_ones() {
    let (mut guards, mut lines) = (0, 0);
    for (number, make) in generated::CHARTS {
        let case = Case::numbered(*number);
        let typed = make().expect("what is generated fits together");
        assert_eq!(*typed.statechart(), case.chart, "chart {number}");
        let interpreted = case.chart.compile_with(&vocabulary(), case.semantics).expect("it is a chart");
        let generated = typed.compile(&vocabulary(), case.semantics).expect("its functions fit");
        guards += generated.guards().len();
        let (expected, found) = (played(&case, interpreted), played(&case, generated));
        lines += expected.len();
        let pairs = expected.iter().zip(&found).enumerate();
        let difference = pairs.clone().find(|(_, (expected, found))| expected != found);
        assert!(expected == found, "chart {number} differs: {difference:?}");
    }
    println!("{} charts, {guards} guards, {lines} lines", generated::CHARTS.len());
    assert!(guards > generated::CHARTS.len(), "the charts have guards");
}
