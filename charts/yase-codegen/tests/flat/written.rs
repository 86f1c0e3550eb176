//! The statechart `c`, flattened. Generated: changes here are lost.
//!
//! `State::start` returns the initial state, `State::handle` reacts to an event.
//! Conditions and actions are methods of `Host`.
#![allow(dead_code, clippy::all)] // unused items are allowed, and generated code has one style

/// The external events.
#[derive(Clone, Copy, PartialEq, Eq, Hash, Debug)]
pub enum Event {
    /// `go`
    Go,
    /// `moved`
    Moved,
    /// `stop`
    Stop,
    /// `back`
    Back,
}

/// The conditions and actions of the chart.
pub trait Host {
    /// The condition `ready`
    fn ready(&self) -> bool;
    /// The condition `tired`
    fn tired(&self) -> bool;
    /// The action `move`
    fn move_(&mut self);
    /// The action `stop`
    fn stop(&mut self);
    /// The action `leave A`
    fn leave_a(&mut self);
}

/// The configurations.
#[derive(Clone, Copy, PartialEq, Eq, Hash, Debug)]
pub enum State {
    /// In `both/one/A`, `both/two/C`.
    AC,
    /// In `both/one/B`, `both/two/D`.
    BD,
    /// In `both/one/B`, `both/two/C`.
    BC,
    /// In `Z`.
    Z,
    /// In `Z`.
    ZV2,
    /// In `both/one/A`, `both/two/D`.
    AD,
}

impl State {
    /// The initial state.
    pub fn start(_host: &mut impl Host) -> State {
        State::AC
    }

    /// Reacts to an event.
    #[inline]
    pub fn handle(&mut self, event: Event, host: &mut impl Host) {
        match (*self, event) {
            (State::AC, Event::Go) => {
                if host.ready() {
                    host.leave_a();
                    host.move_();
                    if host.tired() {
                        *self = State::BC;
                        return;
                    }
                    *self = State::BD;
                }
            }
            (State::AC, Event::Stop) => {
                host.leave_a();
                host.stop();
                *self = State::Z;
            }
            (State::BD, Event::Stop) => {
                host.stop();
                *self = State::ZV2;
            }
            (State::BC, Event::Moved) => {
                if host.tired() {
                    return;
                }
                *self = State::BD;
            }
            (State::BC, Event::Stop) => {
                host.stop();
                *self = State::Z;
            }
            (State::Z, Event::Back) => *self = State::AC,
            (State::ZV2, Event::Back) => *self = State::AD,
            (State::AD, Event::Go) => {
                if host.ready() {
                    host.leave_a();
                    host.move_();
                    *self = State::BD;
                }
            }
            (State::AD, Event::Stop) => {
                host.leave_a();
                host.stop();
                *self = State::ZV2;
            }
            _ => {}
        }
    }

    /// The paths of the innermost active states; none after the end.
    pub const fn active(self) -> &'static [&'static str] {
        match self {
            State::AC => &["both/one/A", "both/two/C"],
            State::BD => &["both/one/B", "both/two/D"],
            State::BC => &["both/one/B", "both/two/C"],
            State::Z => &["Z"],
            State::ZV2 => &["Z"],
            State::AD => &["both/one/A", "both/two/D"],
        }
    }
}
