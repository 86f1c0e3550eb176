//! Plays matches of one methodology, and prints the sums that `monas eval` compares, one `name
//! value` a line.
//!
//! `play config/evaluation/agents.xml 1 10 600` plays the match file with the seeds 1 to 10 for
//! 600 s each. With `direct` after them, blue is built directly on the robots.

use std::path::Path;
use std::process::ExitCode;
use std::time::Duration;

use monas::Registry;
use monas_eval::{PlayFigures, direct_players, play};

fn main() -> ExitCode {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let result = match arguments.iter().map(String::as_str).collect::<Vec<_>>()[..] {
        [file, first, last, seconds] => sums(file, [first, last, seconds], false),
        [file, first, last, seconds, "direct"] => sums(file, [first, last, seconds], true),
        _ => Err("usage: play MATCH-FILE FIRST-SEED LAST-SEED SECONDS [direct]".into()),
    };
    match result {
        Ok(sums) => {
            for (name, count) in sums.counts() {
                println!("{name} {count}");
            }
            ExitCode::SUCCESS
        }
        Err(message) => {
            eprintln!("{message}");
            ExitCode::FAILURE
        }
    }
}

fn sums(file: &str, numbers: [&str; 3], is_direct: bool) -> Result<PlayFigures, String> {
    let [Some(first), Some(last), Some(seconds)] = numbers.map(|number| number.parse::<u64>().ok()) else {
        return Err(format!("{numbers:?} are not whole numbers"));
    };
    let registry = Registry::linked();
    let mut sums = PlayFigures::default();
    for seed in first..=last {
        let plan = monas_eval::load(Path::new(file), &registry).map_err(|error| error.to_string())?;
        let plan = if is_direct { direct_players(plan) } else { plan };
        let played = play(plan, seed, Duration::from_secs(seconds));
        sums = sums.plus(played.map_err(|error| error.to_string())?);
    }
    Ok(sums)
}
