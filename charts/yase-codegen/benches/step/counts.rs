//! The work of every contestant: counting entries and exits.
#![allow(unreachable_pub, reason = "statig's macro wants the event to be public")]

/// The event.
#[derive(Clone, Copy, Debug)]
pub enum Event {
    /// The event to which the charts react.
    Toggle,
    /// Another event, without effect.
    Other,
}

/// The number of events.
pub(crate) const EVENTS: usize = 2;

/// The number of counted states that are active at once in each chart.
pub(crate) const FLAT: usize = 1;
pub(crate) const HIER: usize = 4;
pub(crate) const ORTHO: usize = 3;
pub(crate) const DEEP: usize = 8;

/// Entry and exit counts of each state. The initially active states come first.
#[derive(Clone, Debug, Default)]
pub(crate) struct Counts {
    pub(crate) entries: [u64; 2 * DEEP],
    pub(crate) exits: [u64; 2 * DEEP],
}

impl Counts {
    #[inline]
    pub(crate) fn enter(&mut self, state: usize) {
        self.entries[state] += 1;
    }

    #[inline]
    pub(crate) fn leave(&mut self, state: usize) {
        self.exits[state] += 1;
    }

    /// Asserts that each of `events` events has exchanged the first `side` states for the `side`
    /// others, or back.
    pub(crate) fn assert(&self, side: usize, events: u64, who: &str) {
        let (there, back) = (events.div_ceil(2), events / 2);
        for state in 0..side {
            assert_eq!((self.exits[state], self.entries[state]), (there, back), "{who}: state {state}");
            let other = side + state;
            assert_eq!((self.entries[other], self.exits[other]), (there, back), "{who}: state {other}");
        }
    }
}

/// A machine of one of the three charts.
pub(crate) trait Toggle {
    /// Takes one event.
    fn handle(&mut self, event: Event);

    /// The counts since its creation, without the initial entries.
    fn counts(&self) -> Counts;
}
