//! Configuration: agents as people write them.

mod repair;
pub mod xml;
