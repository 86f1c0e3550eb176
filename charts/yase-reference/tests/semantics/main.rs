//! The semantics of the machine: each rule by its name, the suite of PSSM, snapshots, migration,
//! and random charts against the reference interpreter.
//!
//! One program, since each one compiles the generic parts of the machine again.

#![allow(clippy::expect_used, clippy::panic, clippy::unwrap_used)] // the functions around the tests are tests too

/// Whether tests on random charts take their long form, as in `.ci/run`.
fn is_long() -> bool {
    std::env::var_os("MONAS_LONG_TESTS").is_some()
}

mod pssm;
mod reference;
mod rules;
mod snapshot;
mod swap;
