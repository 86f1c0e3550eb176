//! Ways for packets to travel.

#[cfg(all(unix, feature = "local"))]
mod local;

#[cfg(all(unix, feature = "local"))]
pub use local::{Local, default_folder};
