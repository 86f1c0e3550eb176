//! Messages that the simulated field publishes.
//!
//! These topics are ground truth for recordings, viewers and evaluation, not for players. Only
//! [`REFEREE`](topics::REFEREE) is read: by the field itself.

narukom::include_messages!("monas.sim");

/// The topics of the field's hub.
pub mod topics {
    use super::{Incident, RefereeCall, Score, Truth};

    narukom::topic! {
        /// Poses of ball and robots, ten times a second.
        pub TRUTH: narukom::State<Truth> = "sim/truth";
        /// State of the game and score, published when either changes.
        pub SCORE: narukom::State<Score> = "sim/score";
        /// Notable events, published when they happen.
        pub INCIDENT: narukom::Data<Incident, 64> = "sim/incident";
        /// A person's decision as the referee, published from outside the run.
        pub REFEREE: narukom::Signal<RefereeCall> = "sim/referee";
    }
}
