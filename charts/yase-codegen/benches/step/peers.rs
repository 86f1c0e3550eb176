//! The charts in `statig`. It has no regions: three machines replace them.
#![allow(unreachable_pub, reason = "statig's macro writes public types")]

use crate::counts::{Counts, Event, FLAT, ORTHO, Toggle};

pub(crate) fn flat() -> impl Toggle {
    Flat(flat::machine(0, FLAT))
}

struct Flat(flat::Machine);

impl Toggle for Flat {
    fn handle(&mut self, event: Event) {
        self.0.handle(&event);
    }

    fn counts(&self) -> Counts {
        flat::counts(&self.0)
    }
}

pub(crate) fn ortho() -> impl Toggle {
    Ortho(std::array::from_fn(|region| flat::machine(region, ORTHO + region)))
}

struct Ortho([flat::Machine; ORTHO]);

impl Toggle for Ortho {
    fn handle(&mut self, event: Event) {
        for machine in &mut self.0 {
            machine.handle(&event);
        }
    }

    fn counts(&self) -> Counts {
        let mut sum = Counts::default();
        for machine in &self.0 {
            let counts = flat::counts(machine);
            for state in 0..counts.entries.len() {
                sum.entries[state] += counts.entries[state];
                sum.exits[state] += counts.exits[state];
            }
        }
        sum
    }
}

pub(crate) fn hier() -> impl Toggle {
    Hier(hier::machine())
}

struct Hier(hier::Machine);

impl Toggle for Hier {
    fn handle(&mut self, event: Event) {
        self.0.handle(&event);
    }

    fn counts(&self) -> Counts {
        hier::counts(&self.0)
    }
}

mod flat {
    use statig::blocking::*;

    use crate::counts::{Counts, Event};

    pub(super) type Machine = StateMachine<Pair>;

    pub struct Pair {
        first: usize,
        second: usize,
        counts: Counts,
    }

    pub(super) fn machine(first: usize, second: usize) -> Machine {
        let mut machine = Pair { first, second, counts: Counts::default() }.state_machine();
        machine.init();
        machine
    }

    /// Without the first entry.
    pub(super) fn counts(machine: &Machine) -> Counts {
        let mut counts = machine.inner().counts.clone();
        counts.entries[machine.inner().first] -= 1;
        counts
    }

    #[state_machine(initial = "State::one()", state(derive()))]
    impl Pair {
        #[state(entry_action = "enter_one", exit_action = "leave_one")]
        fn one(event: &Event) -> Outcome<State> {
            match event {
                Event::Toggle => Transition(State::two()),
                Event::Other => Super,
            }
        }

        #[state(entry_action = "enter_two", exit_action = "leave_two")]
        fn two(event: &Event) -> Outcome<State> {
            match event {
                Event::Toggle => Transition(State::one()),
                Event::Other => Super,
            }
        }

        #[action]
        fn enter_one(&mut self) {
            self.counts.enter(self.first);
        }

        #[action]
        fn leave_one(&mut self) {
            self.counts.leave(self.first);
        }

        #[action]
        fn enter_two(&mut self) {
            self.counts.enter(self.second);
        }

        #[action]
        fn leave_two(&mut self) {
            self.counts.leave(self.second);
        }
    }
}

mod hier {
    use statig::blocking::*;

    use crate::counts::{Counts, Event, HIER};

    pub(super) type Machine = StateMachine<Branches>;

    #[derive(Default)]
    pub struct Branches {
        counts: Counts,
    }

    pub(super) fn machine() -> Machine {
        let mut machine = Branches::default().state_machine();
        machine.init();
        machine
    }

    /// Without the first entries.
    pub(super) fn counts(machine: &Machine) -> Counts {
        let mut counts = machine.inner().counts.clone();
        for state in 0..HIER {
            counts.entries[state] -= 1;
        }
        counts
    }

    #[state_machine(initial = "State::s3()", state(derive()), superstate(derive()))]
    impl Branches {
        #[superstate(entry_action = "enter_s0", exit_action = "leave_s0")]
        fn s0(event: &Event) -> Outcome<State> {
            match event {
                Event::Toggle => Transition(State::s7()),
                Event::Other => Super,
            }
        }

        #[superstate(superstate = "s0", entry_action = "enter_s1", exit_action = "leave_s1")]
        fn s1() -> Outcome<State> {
            Super
        }

        #[superstate(superstate = "s1", entry_action = "enter_s2", exit_action = "leave_s2")]
        fn s2() -> Outcome<State> {
            Super
        }

        #[state(superstate = "s2", entry_action = "enter_s3", exit_action = "leave_s3")]
        fn s3() -> Outcome<State> {
            Super
        }

        #[superstate(entry_action = "enter_s4", exit_action = "leave_s4")]
        fn s4(event: &Event) -> Outcome<State> {
            match event {
                Event::Toggle => Transition(State::s3()),
                Event::Other => Super,
            }
        }

        #[superstate(superstate = "s4", entry_action = "enter_s5", exit_action = "leave_s5")]
        fn s5() -> Outcome<State> {
            Super
        }

        #[superstate(superstate = "s5", entry_action = "enter_s6", exit_action = "leave_s6")]
        fn s6() -> Outcome<State> {
            Super
        }

        #[state(superstate = "s6", entry_action = "enter_s7", exit_action = "leave_s7")]
        fn s7() -> Outcome<State> {
            Super
        }

        #[action]
        fn enter_s0(&mut self) {
            self.counts.enter(0);
        }

        #[action]
        fn leave_s0(&mut self) {
            self.counts.leave(0);
        }

        #[action]
        fn enter_s1(&mut self) {
            self.counts.enter(1);
        }

        #[action]
        fn leave_s1(&mut self) {
            self.counts.leave(1);
        }

        #[action]
        fn enter_s2(&mut self) {
            self.counts.enter(2);
        }

        #[action]
        fn leave_s2(&mut self) {
            self.counts.leave(2);
        }

        #[action]
        fn enter_s3(&mut self) {
            self.counts.enter(3);
        }

        #[action]
        fn leave_s3(&mut self) {
            self.counts.leave(3);
        }

        #[action]
        fn enter_s4(&mut self) {
            self.counts.enter(4);
        }

        #[action]
        fn leave_s4(&mut self) {
            self.counts.leave(4);
        }

        #[action]
        fn enter_s5(&mut self) {
            self.counts.enter(5);
        }

        #[action]
        fn leave_s5(&mut self) {
            self.counts.leave(5);
        }

        #[action]
        fn enter_s6(&mut self) {
            self.counts.enter(6);
        }

        #[action]
        fn leave_s6(&mut self) {
            self.counts.leave(6);
        }

        #[action]
        fn enter_s7(&mut self) {
            self.counts.enter(7);
        }

        #[action]
        fn leave_s7(&mut self) {
            self.counts.leave(7);
        }
    }
}
