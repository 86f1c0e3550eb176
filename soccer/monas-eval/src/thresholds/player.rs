//! The thresholds of the attacker, as in `models/attacker.srm`.

use std::time::Duration;

/// Below this distance the robot aligns with the ball, metres.
pub(crate) const NEAR: f64 = 0.25;
/// The ball's position for a kick, and the accepted error, metres.
pub(crate) const KICK: (f64, f64) = (0.15, 0.05);
pub(crate) const TOLERANCE: f64 = 0.025;
/// A team mate that is so much nearer to the ball takes it, metres.
pub(crate) const NEARER: f64 = 0.3;
/// Without the ball only the head searches for the first time, and the robot turns until the
/// second; seconds.
pub(crate) const LOOK: f64 = 2.5;
pub(crate) const WANDER: f64 = 13.0;
/// From here on either axis the robot stands in the centre, metres.
pub(crate) const CENTRAL: f64 = 0.5;
/// A ball that is faster rolls, m/s.
pub(crate) const STILL: f64 = 0.3;
/// Speed of a turn, rad/s.
pub(crate) const TURN: f64 = 0.7;
/// The robot glances at a goal below this confidence of its pose, while the ball is farther away
/// than this (m) and was seen within this time (s).
pub(crate) const CERTAIN: f64 = 0.85;
pub(crate) const QUIET: f64 = 0.7;
pub(crate) const SEEN: f64 = 0.6;
pub(crate) const GLANCE: Duration = Duration::from_millis(400);
pub(crate) const GLANCE_EVERY: Duration = Duration::from_secs(3);
