//! Variation points of dialects: at least one test for each value. Those of choosers, names and
//! failures are in [`choosers`](crate::rules::choosers) and [`scripts`](crate::rules::scripts).

mod entering;
mod events;
mod leaving;
mod segments;
