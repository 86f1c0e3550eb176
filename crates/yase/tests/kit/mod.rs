//! What the tests of the machine share: charts written as text, a world with blackboards and activities, and scripts of what
//! happens in it.

#![allow(dead_code, unreachable_pub, unused_imports)] // each test target uses a part

pub mod chart;
pub mod script;
pub mod world;

pub use chart::chart;
pub use script::{ByMicroSteps, Interpreter, Script, play};
pub use world::World;
