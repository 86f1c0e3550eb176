//! A program with a main loop of its own: it waits for temperatures to be typed and says what the thermostat makes of them. Monas runs on threads beside it
//! and is stopped when the input ends.

use std::error::Error;
use std::io::{self, BufRead};
use std::thread;
use std::time::Duration;

use example_embedded::messages::Temperature;
use example_embedded::{HEATER, TEMPERATURE, talws};
use monas::{Running, Talws};
use narukom::Narukom;

fn main() -> Result<(), Box<dyn Error>> {
    let running = talws().start()?;
    let hub = running.hub(Talws::LOCAL).ok_or("there are no agents")?.clone();
    println!("temperature?");
    for line in io::stdin().lock().lines() {
        match line?.trim().parse() {
            Ok(celsius) => {
                println!("{celsius} degrees: the heater is {}", answer(&running, &hub, celsius)?)
            }
            Err(error) => println!("a number, please: {error}"),
        }
    }
    println!("{} cycles", running.stop().cycles());
    Ok(())
}

/// Tells the thermostat and waits for what it decides: for a cycle of its, a tenth of a second at most.
fn answer(running: &Running, hub: &Narukom, celsius: f64) -> Result<&'static str, Box<dyn Error>> {
    let now = || running.overview().now();
    let mut board = hub.blackboard("window");
    board.publish(TEMPERATURE, Temperature { celsius })?;
    board.publish_all(now());
    loop {
        board.process_messages(now());
        match board.read(HEATER) {
            Some(heater) if heater.decided_at.to_bits() == celsius.to_bits() => {
                return Ok(if heater.is_on { "on" } else { "off" });
            }
            _ if running.has_ended() => return Err("the thermostat has ended".into()),
            _ => thread::park_timeout(Duration::from_millis(1)),
        }
    }
}
