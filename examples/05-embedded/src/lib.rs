//! A thermostat for two programs that embed Monas in their own control flow:
//!
//! - `cargo run -p example-embedded --bin step-by-step` simulates two rooms and advances each
//!   room's agents by the step of the simulation, two runs in one program;
//! - `cargo run -p example-embedded --bin own-loop` responds to standard input while the agents run
//!   on their own threads.
//!
//! Both need only a hub from Monas: like an agent, a program participates through its own
//! blackboard, whose cycle it closes explicitly with
//! [`process_messages`](Blackboard::process_messages) and [`publish_all`](Blackboard::publish_all).

use monas::{Agent, Blackboard, BoxError, Hz, Talws};

/// Messages between a room and its thermostat.
pub mod messages {
    narukom::include_messages!("example.heating");
}

use messages::{Heater, Temperature};

narukom::topic! {
    /// Readings of the thermometer.
    pub TEMPERATURE: narukom::State<Temperature> = "room/temperature";
    /// Commands to the heater.
    pub HEATER: narukom::State<Heater> = "room/heater";
}

/// Heating starts below this temperature, degrees Celsius.
const COLD: f64 = 19.0;
const WARM: f64 = 21.0;

/// The agent of a room.
pub fn talws() -> Talws {
    Talws::new().agent(Agent::new("thermostat", Hz(10)).activity(thermostat))
}

/// Between the two limits the heater keeps its state.
fn thermostat(board: &mut Blackboard) -> Result<(), BoxError> {
    let Some(&Temperature { celsius }) = board.read(TEMPERATURE) else { return Ok(()) };
    let was_on = board.read(HEATER).is_some_and(|heater| heater.is_on);
    let is_on = celsius < COLD || (was_on && celsius < WARM);
    board.publish(HEATER, Heater { is_on, decided_at: celsius })?;
    Ok(())
}
