//! The patrol of `02-formula`, with its chart as Rust: the build script generates it, and no generated code is committed.
//!
//! Run it with `cargo run -p example-generated`; it prints what the interpreted patrol prints, line by line. `build.rs` names the model and says
//! which functions its activities are. Rename one of these, here or in the formulas, and the compiler says what is missing. A team that would rather
//! read and commit the generated crate calls `monas generate` instead.

use monas::{Agent, Blackboard, Hz, Moment, Registry, Talws};

include!(concat!(env!("OUT_DIR"), "/patrol.rs"));

fn walk(board: &mut Blackboard) {
    println!("{} Walk", board.now());
}

fn left(board: &mut Blackboard) {
    println!("{} Left", board.now());
}

fn right(board: &mut Blackboard) {
    println!("{} Right", board.now());
}

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let chart = Registry::linked().chart("patrol").ok_or("the chart registers itself")??;
    let agent = Agent::new("guard", Hz(10)).generated(chart);
    Talws::new().agent(agent).simulate(7)?.run_until(Moment::from_secs_f64(6.0))?;
    Ok(())
}
