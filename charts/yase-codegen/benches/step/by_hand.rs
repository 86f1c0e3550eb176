//! The charts written by hand.

use crate::counts::{Counts, Event, FLAT, HIER, ORTHO, Toggle};

#[derive(Clone, Copy, Debug, Default)]
enum Side {
    #[default]
    First,
    Second,
}

#[derive(Default)]
pub(crate) struct Flat {
    state: Side,
    counts: Counts,
}

impl Toggle for Flat {
    #[inline(never)]
    fn handle(&mut self, event: Event) {
        match (self.state, event) {
            (Side::First, Event::Toggle) => {
                self.counts.leave(0);
                self.state = Side::Second;
                self.counts.enter(FLAT);
            }
            (Side::Second, Event::Toggle) => {
                self.counts.leave(FLAT);
                self.state = Side::First;
                self.counts.enter(0);
            }
            (_, Event::Other) => {}
        }
    }

    fn counts(&self) -> Counts {
        self.counts.clone()
    }
}

#[derive(Default)]
pub(crate) struct Hier {
    state: Side,
    counts: Counts,
}

impl Toggle for Hier {
    #[inline(never)]
    fn handle(&mut self, event: Event) {
        let (left, entered) = match (self.state, event) {
            (Side::First, Event::Toggle) => (0, HIER),
            (Side::Second, Event::Toggle) => (HIER, 0),
            (_, Event::Other) => return,
        };
        for level in (0..HIER).rev() {
            self.counts.leave(left + level);
        }
        self.state = if left == 0 { Side::Second } else { Side::First };
        for level in 0..HIER {
            self.counts.enter(entered + level);
        }
    }

    fn counts(&self) -> Counts {
        self.counts.clone()
    }
}

#[derive(Default)]
pub(crate) struct Ortho {
    states: [Side; ORTHO],
    counts: Counts,
}

impl Toggle for Ortho {
    #[inline(never)]
    fn handle(&mut self, event: Event) {
        for region in 0..ORTHO {
            match (self.states[region], event) {
                (Side::First, Event::Toggle) => {
                    self.counts.leave(region);
                    self.states[region] = Side::Second;
                    self.counts.enter(ORTHO + region);
                }
                (Side::Second, Event::Toggle) => {
                    self.counts.leave(ORTHO + region);
                    self.states[region] = Side::First;
                    self.counts.enter(region);
                }
                (_, Event::Other) => {}
            }
        }
    }

    fn counts(&self) -> Counts {
        self.counts.clone()
    }
}
