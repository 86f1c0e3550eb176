//! The statechart `c`, flattened: generated, so that what is changed here is lost when that is done again.
//!
//! `State::start` begins, `State::handle` says what an event leads to. What it asks and does on the way are the methods of `World`.
#![allow(dead_code, clippy::all)] // not every program asks for everything, and generated code has one style

/// What comes from outside.
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

/// What the chart asks, and what it has done.
pub trait World {
    /// Whether this holds: `ready`
    fn ready(&self) -> bool;
    /// Whether this holds: `tired`
    fn tired(&self) -> bool;
    /// Does this: `move`
    fn move_(&mut self);
    /// Does this: `stop`
    fn stop(&mut self);
    /// Does this: `leave A`
    fn leave_a(&mut self);
}

/// What is active.
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
    /// Begins.
    pub fn start(_world: &mut impl World) -> State {
        State::AC
    }

    /// Does what an event leads to.
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

    /// The innermost states that are active, by their paths; none when it is over.
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
