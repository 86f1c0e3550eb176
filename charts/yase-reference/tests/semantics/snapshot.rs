//! Machines are inspected, captured and restored: by micro-step, by name, and as text.

mod editing;
mod every_step;
mod fixture;
mod micro_steps;
mod misfits;
mod profiles;
