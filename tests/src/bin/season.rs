//! Plays a season and writes or checks its golden table: see `cargo xtask season`.

use std::process::ExitCode;

use monas_tests::{root, season, short_rows};

fn main() -> ExitCode {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let result = match arguments.iter().map(String::as_str).collect::<Vec<_>>()[..] {
        [] => write(),
        ["--check"] => check(),
        _ => Err("usage: season [--check]".into()),
    };
    match result {
        Ok(()) => ExitCode::SUCCESS,
        Err(message) => {
            eprintln!("{message}");
            ExitCode::FAILURE
        }
    }
}

fn played() -> Result<String, String> {
    let table = season(|row| eprintln!("{row}"))?;
    let text = table.text();
    let failures = table.failures();
    match failures.is_empty() {
        true => Ok(text),
        false => Err(format!("{text}\nnot what it must come to:\n{}", failures.join("\n"))),
    }
}

fn write() -> Result<(), String> {
    let short = short_rows()?;
    std::fs::write(root().join("tests/golden/short.txt"), short).map_err(|error| error.to_string())?;
    let text = played()?;
    print!("{text}");
    std::fs::write(root().join("tests/golden/season.txt"), text).map_err(|error| error.to_string())
}

fn check() -> Result<(), String> {
    let golden = std::fs::read_to_string(root().join("tests/golden/season.txt")).map_err(|error| error.to_string())?;
    let text = played()?;
    let differs = |(now, before): &(&str, &str)| now != before;
    let first = text.lines().zip(golden.lines()).find(differs);
    match first {
        Some((now, before)) => Err(format!("the season differs:\n  was {before}\n  is  {now}")),
        None if text.len() != golden.len() => Err("the season has more or fewer lines than its golden table".into()),
        None => {
            print!("{text}");
            println!("\nthe season is as its golden table says");
            Ok(())
        }
    }
}
