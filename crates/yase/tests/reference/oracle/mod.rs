//! A naive interpreter of statecharts, random charts, and what compares it with the machine.
//!
//! A [case](random::Case) is a chart, what happens to it, and how it is read, all made from its number. [`many::compare`] has both
//! interpreters play cases, counts what occurred in them, and makes the first difference small.

pub(crate) mod chance;
pub(crate) mod compare;
pub(crate) mod histogram;
pub(crate) mod many;
pub(crate) mod random;
mod shrink;
mod stepper;
