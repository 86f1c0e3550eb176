//! A robot's estimate of the ball in matches on images and on finished sightings, and its play.
//!
//! `cargo run --release -p monas-tests --bin images -- SECONDS SEED...`

use std::process::ExitCode;
use std::time::Duration;

use monas_tests::{BallKnowledge, TODAY};

/// The matches: a name, settings, and the width of the images of the watched robot.
const MATCHES: [(&str, &[&str], Option<u32>); 6] = [
    ("today, finished sightings", &TODAY, None),
    ("today, images of 320 by 240", &TODAY, Some(320)),
    ("2010, finished sightings", &[], None),
    ("2010, images of 320 by 240", &[], Some(320)),
    ("2010, images of 640 by 480", &[], Some(640)),
    ("today, images of 640 by 480", &TODAY, Some(640)),
];

fn main() -> ExitCode {
    let numbers: Option<Vec<u64>> = std::env::args().skip(1).map(|word| word.parse().ok()).collect();
    let Some([seconds, seeds @ ..]) = numbers.as_deref() else {
        eprintln!("give the seconds of each match and seeds: images 120 1 2 3");
        return ExitCode::FAILURE;
    };
    println!("| | ball in view | known | wrong | error of distance | of position | kicks |");
    println!("|---|---|---|---|---|---|---|");
    for (name, settings, width) in MATCHES {
        match BallKnowledge::of_matches(settings, width, seeds, Duration::from_secs(*seconds)) {
            Ok(found) => println!("| {name} {}", row(&found)),
            Err(error) => {
                eprintln!("{name}: {error}");
                return ExitCode::FAILURE;
            }
        }
    }
    ExitCode::SUCCESS
}

fn row(found: &BallKnowledge) -> String {
    let (known, wrong) =
        (100.0 * found.known_share(), 100.0 * found.wrong as f64 / found.in_view.max(1) as f64);
    let (error, distance) = (100.0 * found.error(), found.pose_error());
    let BallKnowledge { in_view, kicks, .. } = found;
    format!("| {in_view} | {known:.1} % | {wrong:.1} % | {error:.1} % | {distance:.2} m | {kicks} |")
}
