//! One match and its row: `cargo run --release -p monas-tests --example one -- VARIANT SEED SECONDS`.

use std::time::Duration;

use monas_tests::{DICE, MATCH, NO_GOALIE, Row, STANDING, play};

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let [variant, seed, seconds] = &arguments[..] else { return Err("VARIANT SEED SECONDS".into()) };
    let variants = [MATCH, STANDING, DICE, NO_GOALIE];
    let variant = variants.iter().find(|known| known.name == variant).ok_or("no such variant")?;
    println!("{}\n{}", Row::HEADER, play(variant, seed.parse()?, Duration::from_secs(seconds.parse()?))?);
    Ok(())
}
