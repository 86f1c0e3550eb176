//! Roles as formulas: parsed, refined, transformed and drawn.

#![allow(clippy::expect_used, clippy::panic, reason = "the functions around tests are tests too")]

mod diagnostics;
mod drawing;
mod figures;
mod golden;
mod properties;
mod refinement;
mod shared_cases;
mod xmi;
