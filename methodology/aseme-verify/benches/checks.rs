//! Durations of the checks of a model: `cargo bench -p aseme-verify`.
//!
//! Medians of one run on two shared cores: the goalie 0.9 s for its 12,879 states, the attacker 0.5
//! s for 14,229, the extended attacker 1.6 s for 25,029, every trace of which is compared with the
//! formulas, those without end too. The role of 100 formulas and 2,000 states is transformed in 5
//! ms, checked in structure and guards in 11 ms, and drawn in 7 ms. (The development build takes
//! 1.1 s, 1.1 s and 3.4 s for the three, and 8 ms, 34 ms and 10 ms for the large one.)
#![allow(clippy::unwrap_used, reason = "a bench that cannot go on ends")]

#[path = "../tests/verify/large.rs"]
mod large;

use std::path::Path;
use std::sync::Arc;

use aseme_verify::{CheckSettings, check::check};
use divan::Bencher;
use yase::Source;
use yase_export as export;

fn main() {
    divan::main();
}

/// All checks of a role, with all its states explored.
#[divan::bench(args = ["goalie", "attacker", "extended_attacker"], sample_count = 5, sample_size = 1)]
fn check_role(bencher: Bencher<'_, '_>, name: &str) {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../models").join(name).with_extension("srm");
    let source = Source::new(format!("{name}.srm"), std::fs::read_to_string(path).unwrap());
    bencher.bench_local(|| {
        let report = check(&source, &CheckSettings::default());
        assert!(report.explored.as_ref().is_some_and(|explored| explored.is_finished));
        report
    });
}

/// A role of 100 formulas and 2,000 states, read and transformed.
#[divan::bench(sample_count = 10, sample_size = 1)]
fn transform_large(bencher: Bencher<'_, '_>) {
    bencher.bench_local(|| aseme_models::statechart_of(&large()));
}

/// Reading, transforming and checking the structure and guards of the large role.
#[divan::bench(sample_count = 10, sample_size = 1)]
fn check_large(bencher: Bencher<'_, '_>) {
    let mut settings = CheckSettings::default();
    settings.states = 0;
    bencher.bench_local(|| check(&large(), &settings));
}

/// Drawing the chart of the large role.
#[divan::bench(sample_count = 10, sample_size = 1)]
fn draw_large(bencher: Bencher<'_, '_>) {
    let chart = aseme_models::statechart_of(&large()).0;
    bencher.bench_local(|| export::to_svg(&chart));
}

fn large() -> Arc<Source> {
    Source::new("large.srm", large::large())
}
