//! Two rooms on a winter's evening, in steps of a minute. Each has its own run, advanced by the
//! room; no thread is started.

use std::error::Error;
use std::time::Duration;

use example_embedded::messages::Temperature;
use example_embedded::{HEATER, TEMPERATURE, talws};
use monas::{Blackboard, Simulation, Talws};

/// The length of a step of the rooms.
const STEP: Duration = Duration::from_secs(60);
/// Degrees that the heater adds in a step.
const HEAT: f64 = 0.8;
/// Fraction of its temperature that a room loses in a step.
const LOSS: f64 = 0.01;

struct Room {
    celsius: f64,
    agents: Simulation,
    board: Blackboard,
}

impl Room {
    fn new(celsius: f64) -> Result<Room, Box<dyn Error>> {
        let agents = talws().simulate(7)?;
        let hub = agents.hub(Talws::LOCAL).ok_or("there are no agents")?;
        let board = hub.blackboard("room");
        Ok(Room { celsius, agents, board })
    }

    /// Advances the room by a minute, then its agents with the new temperature. Returns whether the
    /// room was heated.
    fn step(&mut self) -> Result<bool, Box<dyn Error>> {
        let now = self.agents.now();
        self.board.process_messages(now);
        let heats = self.board.read(HEATER).is_some_and(|heater| heater.is_on);
        self.celsius += f64::from(u8::from(heats)) * HEAT - self.celsius * LOSS;
        self.board.publish(TEMPERATURE, Temperature { celsius: self.celsius })?;
        self.board.publish_all(now);
        self.agents.run_until(now + STEP)?;
        Ok(heats)
    }
}

fn main() -> Result<(), Box<dyn Error>> {
    let mut rooms = [Room::new(17.5)?, Room::new(23.0)?];
    println!("minute   kitchen     bath");
    for minute in 0..30 {
        let [kitchen, bath] =
            [rooms[0].step()?, rooms[1].step()?].map(|heats| if heats { "on" } else { "off" });
        println!("{minute:6}  {:5.1} {kitchen:3}  {:5.1} {bath}", rooms[0].celsius, rooms[1].celsius);
    }
    Ok(())
}
