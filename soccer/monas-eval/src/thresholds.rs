//! Thresholds of the decisions: a role has them in its model, both other methodologies share them.

pub(crate) mod goalie;
pub(crate) mod player;
