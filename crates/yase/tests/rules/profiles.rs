//! The points at which dialects differ: what each value means, a test and more for each. Those of choosers, of names and of failures are in
//! [`choosers`](crate::choosers) and [`scripts`](crate::scripts).

mod entering;
mod events;
mod leaving;
