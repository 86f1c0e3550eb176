//! The thresholds of the goalie, as in `models/goalie.srm`.

/// The goalie acts if the ball crosses its lateral axis within this time, seconds.
pub(crate) const ACT_WITHIN: f64 = 1.0;
/// Beyond this bearing it falls, and beyond the second it dives; radians.
pub(crate) const FALL_FROM: f64 = 15.0 * std::f64::consts::PI / 180.0;
pub(crate) const DIVE_FROM: f64 = 25.0 * std::f64::consts::PI / 180.0;
