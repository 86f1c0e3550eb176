//! Tests of the greeter in simulated time.

use monas::{Agent, Error, Hz, Talws, Timestamp};

use crate::hello;

#[test]
fn ten_greetings_in_the_first_second() -> Result<(), Error> {
    let mut simulation = Talws::new().agent(Agent::new("greeter", Hz(10)).activity(hello)).simulate(7)?;
    simulation.run_until(Timestamp::from_secs_f64(1.0))?;
    assert_eq!(simulation.statistics().calls(Talws::LOCAL, "hello"), 10);
    Ok(())
}
