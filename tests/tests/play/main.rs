//! Whole matches and runs: what players do, and that it repeats.
//!
//! One program, since each one links all crates, and so that long matches of one file are played
//! beside those of another.

/// Whether tests that have a long form take it, as in `.ci/run`.
fn is_long() -> bool {
    std::env::var_os("MONAS_LONG_TESTS").is_some()
}

mod decisions;
mod determinism;
mod freshness;
mod golden;
mod images;
mod kick_off;
mod localisation;
mod nao;
mod rcsssmj;
mod traces;
