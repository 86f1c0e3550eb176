//! At which points of its hub's history a chart fetches messages, and where it publishes between them.
//!
//! In simulated time both follow from the run. In real time other threads publish meanwhile, so it is chance: it is noted, for the
//! record of the chart's turn, and whoever repeats the turn leads the chart through the same points.

/// Leads an agent through what was recorded of it. It is called on the agent's thread.
pub(crate) trait Lead: Send {
    /// Messages are about to be fetched: those that had been published then are to be there.
    fn fetching(&mut self);

    /// Something is about to be published: what others had published before is to be there.
    fn publishing(&mut self);
}

/// What becomes of these points.
#[derive(Default)]
pub(super) enum Fetching {
    /// Nobody wants to know.
    #[default]
    Unnoted,
    /// They are noted: how many publications the hub had taken, for each fetch. The list keeps its memory.
    Noted(Vec<u64>),
    /// They are given.
    Led(Box<dyn Lead>),
}

impl Fetching {
    /// Messages are about to be fetched.
    pub(super) fn begin(&mut self) {
        if let Fetching::Led(lead) = self {
            lead.fetching();
        }
    }

    /// Messages were fetched.
    pub(super) fn end(&mut self, position: u64) {
        if let Fetching::Noted(positions) = self {
            positions.push(position);
        }
    }

    /// Something is about to be published.
    pub(super) fn publishing(&mut self) {
        if let Fetching::Led(lead) = self {
            lead.publishing();
        }
    }

    /// What was noted.
    pub(super) fn noted(&self) -> &[u64] {
        match self {
            Fetching::Noted(positions) => positions,
            _ => &[],
        }
    }

    /// Begins to note anew.
    pub(super) fn forget(&mut self) {
        if let Fetching::Noted(positions) = self {
            positions.clear();
        }
    }
}
