//! The statechart `c`, flattened. Generated: changes here are lost.
//!
//! `State::start` returns the initial state, `State::handle` reacts to an event.
//! Conditions and actions are methods of `World`.
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
pub trait World {
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
    pub fn start(_world: &mut impl World) -> State {
        State::AC
    }

    /// Reacts to an event.
    #[inline]
    pub fn handle(&mut self, event: Event, world: &mut impl World) {
        match (*self, event) {
            (State::AC, Event::Go) => {
                if world.ready() {
                    world.leave_a();
                    world.move_();
                    if world.tired() {
                        *self = State::BC;
                        return;
                    }
                    *self = State::BD;
                }
            }
            (State::AC, Event::Stop) => {
                world.leave_a();
                world.stop();
                *self = State::Z;
            }
            (State::BD, Event::Stop) => {
                world.stop();
                *self = State::ZV2;
            }
            (State::BC, Event::Moved) => {
                if world.tired() {
                    return;
                }
                *self = State::BD;
            }
            (State::BC, Event::Stop) => {
                world.stop();
                *self = State::Z;
            }
            (State::Z, Event::Back) => *self = State::AC,
            (State::ZV2, Event::Back) => *self = State::AD,
            (State::AD, Event::Go) => {
                if world.ready() {
                    world.leave_a();
                    world.move_();
                    *self = State::BD;
                }
            }
            (State::AD, Event::Stop) => {
                world.leave_a();
                world.stop();
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
