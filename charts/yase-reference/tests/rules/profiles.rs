//! Variation points of dialects: at least one test for each value. Those of choosers, names and
//! failures are in [`choosers`](crate::choosers) and [`scripts`](crate::scripts).

mod entering;
mod events;
mod leaving;
mod segments;
