//! The statechart `ortho`, flattened. Generated: changes here are lost.
//!
//! `State::start` returns the initial state, `State::handle` reacts to an event.
//! Conditions and actions are methods of `Host`.
#![allow(dead_code, clippy::all)] // unused items are allowed, and generated code has one style

/// The external events.
#[derive(Clone, Copy, PartialEq, Eq, Hash, Debug)]
pub enum Event {
    /// `toggle`
    Toggle,
}

/// The conditions and actions of the chart.
pub trait Host {
    /// The action `enter 0`
    fn enter_0(&mut self);
    /// The action `leave 0`
    fn leave_0(&mut self);
    /// The action `enter 3`
    fn enter_3(&mut self);
    /// The action `leave 3`
    fn leave_3(&mut self);
    /// The action `enter 1`
    fn enter_1(&mut self);
    /// The action `leave 1`
    fn leave_1(&mut self);
    /// The action `enter 4`
    fn enter_4(&mut self);
    /// The action `leave 4`
    fn leave_4(&mut self);
    /// The action `enter 2`
    fn enter_2(&mut self);
    /// The action `leave 2`
    fn leave_2(&mut self);
    /// The action `enter 5`
    fn enter_5(&mut self);
    /// The action `leave 5`
    fn leave_5(&mut self);
}

/// The configurations.
#[derive(Clone, Copy, PartialEq, Eq, Hash, Debug)]
pub enum State {
    /// In `both/1/s0`, `both/2/s1`, `both/3/s2`.
    S0S1S2,
    /// In `both/1/s3`, `both/2/s4`, `both/3/s5`.
    S3S4S5,
}

impl State {
    /// The initial state.
    pub fn start(host: &mut impl Host) -> State {
        host.enter_0();
        host.enter_1();
        host.enter_2();
        State::S0S1S2
    }

    /// Reacts to an event.
    #[inline]
    pub fn handle(&mut self, event: Event, host: &mut impl Host) {
        match (*self, event) {
            (State::S0S1S2, Event::Toggle) => {
                host.leave_0();
                host.enter_3();
                host.leave_1();
                host.enter_4();
                host.leave_2();
                host.enter_5();
                *self = State::S3S4S5;
            }
            (State::S3S4S5, Event::Toggle) => {
                host.leave_3();
                host.enter_0();
                host.leave_4();
                host.enter_1();
                host.leave_5();
                host.enter_2();
                *self = State::S0S1S2;
            }
        }
    }

    /// The paths of the innermost active states; none after the end.
    pub const fn active(self) -> &'static [&'static str] {
        match self {
            State::S0S1S2 => &["both/1/s0", "both/2/s1", "both/3/s2"],
            State::S3S4S5 => &["both/1/s3", "both/2/s4", "both/3/s5"],
        }
    }
}
