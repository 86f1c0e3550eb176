//! An agent that greets ten times a second, in real time, until Ctrl-C ends the program.
//!
//! Run it with `cargo run -p example-hello`. The program is the seven lines below. An **activity** is any function on a
//! blackboard; an **agent** calls its activities in order, so many times a second; **Talws** runs agents. The blackboard is all
//! that an activity knows of the world: messages, chance and, as here, the time since the start of the run.
//!
//! `run` lets time pass by itself. With `simulate` in its place the same agent runs as fast as it can be computed, which is how
//! it is tested (in `tests.rs`, next to this file): a second of greetings, without waiting for a second.

use monas::{Agent, Blackboard, Hz, Talws};
fn hello(blackboard: &mut Blackboard) {
    println!("hello at {}", blackboard.now());
}
fn main() -> Result<(), monas::Error> {
    Talws::new().agent(Agent::new("greeter", Hz(10)).activity(hello)).run().map(drop)
}

#[cfg(test)]
mod tests;
