//! The Booster T1 on the RoboCup MuJoCo soccer server as a body.

mod anatomy;
mod connection;
pub mod effector;
mod error;
pub mod expression;
pub mod frame;
pub mod monitor;
pub mod percept;

pub use error::{Error, ErrorKind};
