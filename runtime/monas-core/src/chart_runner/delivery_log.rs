//! The positions of the hub's history at which a chart fetches messages and publishes.
//!
//! In simulated time both follow from the run. In real time other threads publish concurrently, so
//! the positions vary: they are recorded with the chart's turn, and a replay repeats the turn with
//! the same positions.

/// Guides an agent through its recording. Called on the agent's thread.
pub trait ReplayGuide: Send {
    /// Called before messages are fetched: publishes the messages that had been published by then.
    fn fetching(&mut self);

    /// Called before a publication: publishes what others had published before it.
    fn publishing(&mut self);
}

/// The treatment of fetch positions.
#[derive(Default)]
pub(crate) enum DeliveryLog {
    /// Not recorded.
    #[default]
    Unnoted,
    /// Recorded: the number of publications that the hub had taken, for each fetch. The list keeps
    /// its memory.
    Noted(Vec<u64>),
    /// Given by a recording.
    Led(Box<dyn ReplayGuide>),
}

impl DeliveryLog {
    /// Called before messages are fetched.
    pub(crate) fn begin(&mut self) {
        if let DeliveryLog::Led(lead) = self {
            lead.fetching();
        }
    }

    /// Called after messages were fetched.
    pub(crate) fn end(&mut self, position: u64) {
        if let DeliveryLog::Noted(positions) = self {
            positions.push(position);
        }
    }

    /// Called before a publication.
    pub(crate) fn publishing(&mut self) {
        if let DeliveryLog::Led(lead) = self {
            lead.publishing();
        }
    }

    /// The recorded positions.
    pub(crate) fn recorded(&self) -> &[u64] {
        match self {
            DeliveryLog::Noted(positions) => positions,
            _ => &[],
        }
    }

    /// Clears the recorded positions.
    pub(crate) fn clear(&mut self) {
        if let DeliveryLog::Noted(positions) = self {
            positions.clear();
        }
    }
}
