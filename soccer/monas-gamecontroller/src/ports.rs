//! The league's UDP ports.

/// Control data, from the GameController to robots.
pub const CONTROL_PORT: u16 = 3838;

/// Return data, from robots to the GameController.
pub const RETURN_PORT: u16 = 3939;
