//! An agent that prints a greeting ten times a second, in real time, until Ctrl-C ends the program.
//!
//! Run it with `cargo run -p example-hello`. The program is the seven lines below. An **activity**
//! is any function of a blackboard; an **agent** calls its activities in order at a fixed rate;
//! **Talws** runs agents. The blackboard is an activity's only access to the world: messages,
//! random numbers and, as here, the time since the start of the run.
//!
//! `run` runs in real time. With `simulate` instead, the same agent runs as fast as it can be
//! computed, which is how it is tested (in `tests.rs`, next to this file): a second of greetings,
//! without waiting for a second.

use monas::{Agent, Blackboard, Hz, Talws};
fn hello(blackboard: &mut Blackboard) {
    println!("hello at {}", blackboard.now());
}
fn main() -> Result<(), monas::Error> {
    Talws::new().agent(Agent::new("greeter", Hz(10)).activity(hello)).run().map(drop)
}

#[cfg(test)]
mod tests;
