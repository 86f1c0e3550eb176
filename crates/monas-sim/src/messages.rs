//! What the simulated field publishes about itself.
//!
//! Players have no business with these topics: they are for recordings, viewers and judges.

narukom::include_messages!("monas.sim");

/// The topics of the field's own hub.
pub mod topics {
    use super::{Incident, Score, Truth};

    narukom::topic! {
        /// Where everything is, ten times a second.
        pub TRUTH: narukom::State<Truth> = "sim/truth";
        /// State of the game and score, whenever either changes.
        pub SCORE: narukom::State<Score> = "sim/score";
        /// Everything of note, when it happens.
        pub INCIDENT: narukom::Data<Incident, 64> = "sim/incident";
    }
}
