//! A thermostat, for two programs that are in charge themselves and have Monas inside:
//!
//! - `cargo run -p example-embedded --bin step-by-step` simulates two rooms and lets each room's agents live for as long as a step of its
//!   own takes, two runs in one program;
//! - `cargo run -p example-embedded --bin own-loop` answers what is typed, while the agents run on threads of their own.
//!
//! Neither asks Monas for anything but a hub: a program takes part through a blackboard of its own, as agents do, whose cycle it closes
//! by hand with [`process_messages`](Blackboard::process_messages) and [`publish_all`](Blackboard::publish_all).

use monas::{Agent, Blackboard, BoxError, Hz, Talws};

/// What a room and its thermostat tell each other.
pub mod messages {
    narukom::include_messages!("example.heating");
}

use messages::{Heater, Temperature};

narukom::topic! {
    /// What the thermometer shows.
    pub TEMPERATURE: narukom::State<Temperature> = "room/temperature";
    /// What the heater is to do.
    pub HEATER: narukom::State<Heater> = "room/heater";
}

/// It heats below this many degrees Celsius until the next are reached.
const COLD: f64 = 19.0;
const WARM: f64 = 21.0;

/// The agent of a room.
pub fn talws() -> Talws {
    Talws::new().agent(Agent::new("thermostat", Hz(10)).activity(thermostat))
}

/// Between cold and warm it goes on with what it does.
fn thermostat(board: &mut Blackboard) -> Result<(), BoxError> {
    let Some(&Temperature { celsius }) = board.read(TEMPERATURE) else { return Ok(()) };
    let was_on = board.read(HEATER).is_some_and(|heater| heater.is_on);
    let is_on = celsius < COLD || (was_on && celsius < WARM);
    board.publish(HEATER, Heater { is_on, decided_at: celsius })?;
    Ok(())
}
