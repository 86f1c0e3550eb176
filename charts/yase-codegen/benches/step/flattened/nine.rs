//! The statechart `guarded`, flattened. Generated: changes here are lost.
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
    /// The condition `M.n > 100`
    fn m_n_above_100(&self) -> bool;
    /// The condition `M.n > 101`
    fn m_n_above_101(&self) -> bool;
    /// The condition `M.n > 102`
    fn m_n_above_102(&self) -> bool;
    /// The condition `M.n > 103`
    fn m_n_above_103(&self) -> bool;
    /// The condition `M.n > 104`
    fn m_n_above_104(&self) -> bool;
    /// The condition `M.n > 105`
    fn m_n_above_105(&self) -> bool;
    /// The condition `M.n > 106`
    fn m_n_above_106(&self) -> bool;
    /// The condition `M.n > 107`
    fn m_n_above_107(&self) -> bool;
    /// The condition `M.n > 108`
    fn m_n_above_108(&self) -> bool;
    /// The condition `M.n == 0`
    fn m_n_equals_0(&self) -> bool;
    /// The action `enter 0`
    fn enter_0(&mut self);
    /// The action `leave 0`
    fn leave_0(&mut self);
    /// The action `enter 1`
    fn enter_1(&mut self);
    /// The action `leave 1`
    fn leave_1(&mut self);
}

/// The configurations.
#[derive(Clone, Copy, PartialEq, Eq, Hash, Debug)]
pub enum State {
    /// In `s0`.
    S0,
    /// In `s1`.
    S1,
}

impl State {
    /// The initial state.
    pub fn start(host: &mut impl Host) -> State {
        host.enter_0();
        State::S0
    }

    /// Reacts to an event.
    #[inline]
    pub fn handle(&mut self, event: Event, host: &mut impl Host) {
        match (*self, event) {
            (State::S0, Event::Toggle) => {
                if host.m_n_above_100() {
                    host.leave_0();
                    host.enter_1();
                    *self = State::S1;
                    return;
                }
                if host.m_n_above_101() {
                    host.leave_0();
                    host.enter_1();
                    *self = State::S1;
                    return;
                }
                if host.m_n_above_102() {
                    host.leave_0();
                    host.enter_1();
                    *self = State::S1;
                    return;
                }
                if host.m_n_above_103() {
                    host.leave_0();
                    host.enter_1();
                    *self = State::S1;
                    return;
                }
                if host.m_n_above_104() {
                    host.leave_0();
                    host.enter_1();
                    *self = State::S1;
                    return;
                }
                if host.m_n_above_105() {
                    host.leave_0();
                    host.enter_1();
                    *self = State::S1;
                    return;
                }
                if host.m_n_above_106() {
                    host.leave_0();
                    host.enter_1();
                    *self = State::S1;
                    return;
                }
                if host.m_n_above_107() {
                    host.leave_0();
                    host.enter_1();
                    *self = State::S1;
                    return;
                }
                if host.m_n_above_108() {
                    host.leave_0();
                    host.enter_1();
                    *self = State::S1;
                    return;
                }
                if host.m_n_equals_0() {
                    host.leave_0();
                    host.enter_1();
                    *self = State::S1;
                }
            }
            (State::S1, Event::Toggle) => {
                if host.m_n_above_100() {
                    host.leave_1();
                    host.enter_0();
                    *self = State::S0;
                    return;
                }
                if host.m_n_above_101() {
                    host.leave_1();
                    host.enter_0();
                    *self = State::S0;
                    return;
                }
                if host.m_n_above_102() {
                    host.leave_1();
                    host.enter_0();
                    *self = State::S0;
                    return;
                }
                if host.m_n_above_103() {
                    host.leave_1();
                    host.enter_0();
                    *self = State::S0;
                    return;
                }
                if host.m_n_above_104() {
                    host.leave_1();
                    host.enter_0();
                    *self = State::S0;
                    return;
                }
                if host.m_n_above_105() {
                    host.leave_1();
                    host.enter_0();
                    *self = State::S0;
                    return;
                }
                if host.m_n_above_106() {
                    host.leave_1();
                    host.enter_0();
                    *self = State::S0;
                    return;
                }
                if host.m_n_above_107() {
                    host.leave_1();
                    host.enter_0();
                    *self = State::S0;
                    return;
                }
                if host.m_n_above_108() {
                    host.leave_1();
                    host.enter_0();
                    *self = State::S0;
                    return;
                }
                if host.m_n_equals_0() {
                    host.leave_1();
                    host.enter_0();
                    *self = State::S0;
                }
            }
        }
    }

    /// The paths of the innermost active states; none after the end.
    pub const fn active(self) -> &'static [&'static str] {
        match self {
            State::S0 => &["s0"],
            State::S1 => &["s1"],
        }
    }
}
