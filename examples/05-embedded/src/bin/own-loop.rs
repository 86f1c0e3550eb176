//! A program with its own main loop: it reads temperatures from standard input and prints the
//! thermostat's decisions. Monas runs on other threads and is stopped when the input ends.

use std::error::Error;
use std::io::{self, BufRead};
use std::thread;
use std::time::Duration;

use example_embedded::messages::Temperature;
use example_embedded::{HEATER, TEMPERATURE, talws};
use monas::{RealTimeRun, Talws};
use narukom::Hub;

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

/// Sends a temperature to the thermostat and waits for its decision: at most one cycle, a tenth of
/// a second.
fn answer(running: &RealTimeRun, hub: &Hub, celsius: f64) -> Result<&'static str, Box<dyn Error>> {
    let now = || running.run_handle().now();
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
