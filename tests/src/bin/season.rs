//! Plays a season and writes or checks its golden table: see `cargo xtask season`.
//!
//! `season row VARIANT SEED SECONDS` plays one match and prints its row, `season rows VARIANT 1-20
//! SECONDS` several and their sums, `season count` with the arguments of `row` prints passes,
//! kick-offs, crowding and the time in each state. `season poses VARIANT 1-20 SECONDS` prints how
//! far the robots' poses are from the truth, and how long robots need that are carried away. They
//! know the variants of the season and those with ideal cameras.

use std::process::ExitCode;
use std::time::Duration;

use monas_tests::{
    MatchRow, OTHER_VARIANTS, SeasonTable, VARIANTS, Variant, check_season, kidnap, play, pose_errors,
    quantile, root, season, short_rows,
};

fn main() -> ExitCode {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let result = match arguments.iter().map(String::as_str).collect::<Vec<_>>()[..] {
        [] => write(),
        ["--check"] => check(),
        ["rows", variant, seeds, seconds] => rows(variant, seeds, seconds),
        ["row", variant, seed, seconds] => row(variant, seed, seconds),
        ["poses", variant, seeds, seconds] => poses(variant, seeds, seconds),
        ["count", variant, seed, seconds] => count(variant, seed, seconds),
        _ => {
            Err("usage: season [--check | (row | count) VARIANT SEED SECONDS | (rows | poses) VARIANT FROM-TO SECONDS]"
                .into())
        }
    };
    match result {
        Ok(()) => ExitCode::SUCCESS,
        Err(message) => {
            eprintln!("{message}");
            ExitCode::FAILURE
        }
    }
}

fn row(variant: &str, seed: &str, seconds: &str) -> Result<(), String> {
    let (variant, seed, length) = game(variant, seed, seconds)?;
    println!("{}\n{}", MatchRow::HEADER, play(variant, seed, length)?);
    Ok(())
}

fn rows(variant: &str, seeds: &str, seconds: &str) -> Result<(), String> {
    let (from, to) = seeds.split_once('-').ok_or_else(|| format!("`{seeds}` are not seeds"))?;
    let (_, from, length) = game(variant, from, seconds)?;
    let (variant, to, _) = game(variant, to, seconds)?;
    println!("{}", MatchRow::HEADER);
    let table = SeasonTable::play(&[*variant], from..=to, length, |row| println!("{row}"))?;
    println!("{}", table.sums(variant));
    Ok(())
}

fn poses(variant: &str, seeds: &str, seconds: &str) -> Result<(), String> {
    let (from, to) = seeds.split_once('-').ok_or_else(|| format!("`{seeds}` are not seeds"))?;
    let (_, from, length) = game(variant, from, seconds)?;
    let (variant, to, _) = game(variant, to, seconds)?;
    let (mut distances, mut turns, mut recoveries, mut lost) = (Vec::new(), Vec::new(), Vec::new(), 0);
    for seed in from..=to {
        let errors = pose_errors(variant, seed, length)?;
        distances.extend(errors.distances);
        turns.extend(errors.turns);
        let kidnapped = kidnap(variant, seed, length)?;
        recoveries.extend(kidnapped.recoveries);
        lost += kidnapped.lost;
    }
    let print = |what: &str, values: &[f64], unit: &str| {
        let [median, p90, p95] = [0.5, 0.9, 0.95].map(|part| quantile(values, part).unwrap_or(f64::NAN));
        println!("{what:<28} median {median:.2} {unit}, 90 % {p90:.2} {unit}, 95 % {p95:.2} {unit}");
    };
    print("error of the position", &distances, "m");
    print("error of the heading", &turns, "rad");
    print("recovery after kidnapping", &recoveries, "s");
    println!("{} of {} kidnapped robots were lost for 30 s", lost, recoveries.len() + lost);
    Ok(())
}

fn count(variant: &str, seed: &str, seconds: &str) -> Result<(), String> {
    let (variant, seed, length) = game(variant, seed, seconds)?;
    print!("{}", play(variant, seed, length)?.team_play);
    Ok(())
}

fn game(variant: &str, seed: &str, seconds: &str) -> Result<(&'static Variant, u64, Duration), String> {
    let known = VARIANTS.iter().chain(&OTHER_VARIANTS).find(|known| known.name == variant);
    let variant = known.ok_or_else(|| format!("no variant `{variant}`"))?;
    let seed = seed.parse().map_err(|_| format!("`{seed}` is not a seed"))?;
    let seconds = seconds.parse().map_err(|_| format!("`{seconds}` is not a number of seconds"))?;
    Ok((variant, seed, Duration::from_secs(seconds)))
}

fn write() -> Result<(), String> {
    let short = short_rows()?;
    std::fs::write(root().join("tests/golden/short.txt"), short).map_err(|error| error.to_string())?;
    let text = season(|row| eprintln!("{row}"))?.checked_text()?;
    print!("{text}");
    std::fs::write(root().join("tests/golden/season.txt"), text).map_err(|error| error.to_string())
}

fn check() -> Result<(), String> {
    print!("{}", check_season(|row| eprintln!("{row}"))?);
    println!("\nthe season is as its golden table says");
    Ok(())
}
