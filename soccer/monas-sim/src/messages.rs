//! Messages that the simulated field publishes.
//!
//! These topics are ground truth for recordings, viewers and evaluation, not for players.

narukom::include_messages!("monas.sim");

/// The topics of the field's hub.
pub mod topics {
    use super::{Incident, Score, Truth};

    narukom::topic! {
        /// Poses of ball and robots, ten times a second.
        pub TRUTH: narukom::State<Truth> = "sim/truth";
        /// State of the game and score, published when either changes.
        pub SCORE: narukom::State<Score> = "sim/score";
        /// Notable events, published when they happen.
        pub INCIDENT: narukom::Data<Incident, 64> = "sim/incident";
    }
}
