//! The statechart `flat`, flattened: generated, so that what is changed here is lost when that is done again.
//!
//! `State::start` begins, `State::handle` says what an event leads to. What it asks and does on the way are the methods of `World`.
#![allow(dead_code, clippy::all)] // not every program asks for everything, and generated code has one style

/// What comes from outside.
#[derive(Clone, Copy, PartialEq, Eq, Hash, Debug)]
pub enum Event {
    /// `toggle`
    Toggle,
}

/// What the chart asks, and what it has done.
pub trait World {
    /// Does this: `enter 0`
    fn enter_0(&mut self);
    /// Does this: `leave 0`
    fn leave_0(&mut self);
    /// Does this: `enter 1`
    fn enter_1(&mut self);
    /// Does this: `leave 1`
    fn leave_1(&mut self);
}

/// What is active.
#[derive(Clone, Copy, PartialEq, Eq, Hash, Debug)]
pub enum State {
    /// In `s0`.
    S0,
    /// In `s1`.
    S1,
}

impl State {
    /// Begins.
    pub fn start(world: &mut impl World) -> State {
        world.enter_0();
        State::S0
    }

    /// Does what an event leads to.
    #[inline]
    pub fn handle(&mut self, event: Event, world: &mut impl World) {
        match (*self, event) {
            (State::S0, Event::Toggle) => {
                world.leave_0();
                world.enter_1();
                *self = State::S1;
            }
            (State::S1, Event::Toggle) => {
                world.leave_1();
                world.enter_0();
                *self = State::S0;
            }
        }
    }

    /// The innermost states that are active, by their paths; none when it is over.
    pub const fn active(self) -> &'static [&'static str] {
        match self {
            State::S0 => &["s0"],
            State::S1 => &["s1"],
        }
    }
}
