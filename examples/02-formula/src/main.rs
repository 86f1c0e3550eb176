//! A statechart from two formulas, run in simulated time.
//!
//! Run it with `cargo run -p example-formula`; it prints which activity runs when. The behaviour is
//! defined in `patrol.srm`: the role walks and looks forever (`(Walk . look)~`), and a look is one
//! of two (`Left | Right`). Two lines of refinement define which. `cargo run -- model draw
//! examples/02-formula/patrol.srm -o patrol.svg` draws the resulting chart.
//!
//! The formulas name three activities; here each is a closure that prints its name, added to a
//! `Registry` by hand. Larger programs register activities where they are defined, with
//! `monas::activity!`. The program does not define their order: change the model and run it again.

use monas::{Agent, Blackboard, Registry, Talws, Timestamp};
use yase::Source;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let model = Source::new("patrol.srm", include_str!("../patrol.srm"));
    let (patrol, findings) = aseme::statechart_of_role(&model);
    if let Some(finding) = findings.first() {
        return Err(finding.to_string().into());
    }
    let registry = ["Walk", "Left", "Right"].into_iter().fold(Registry::empty(), |registry, name| {
        registry.with(name, move || move |board: &mut Blackboard| println!("{} {name}", board.now()))
    });
    let talws = Talws::new().registry(registry).agent(Agent::statechart("guard", patrol));
    talws.simulate(7)?.run_until(Timestamp::from_secs_f64(6.0))?;
    Ok(())
}
