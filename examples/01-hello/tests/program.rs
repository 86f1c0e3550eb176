//! Tests of the program in real time.

use std::error::Error;
use std::io::{BufRead, BufReader};
use std::process::{Command, Stdio};

/// The times of the first greetings, in seconds.
fn greetings(count: usize) -> Result<Vec<f64>, Box<dyn Error>> {
    let mut program = Command::new(env!("CARGO_BIN_EXE_example-hello")).stdout(Stdio::piped()).spawn()?;
    let output = program.stdout.take().ok_or("the program has no output")?;
    let mut output = BufReader::new(output).lines();
    let lines: Result<Vec<String>, _> = output.by_ref().take(count).collect();
    program.kill()?;
    program.wait()?;
    lines?
        .iter()
        .map(|line| second_of(line).ok_or_else(|| format!("`{line}` is not a greeting").into()))
        .collect()
}

/// The time in a greeting: 0.1 for `hello at 0.100000000 s`.
fn second_of(line: &str) -> Option<f64> {
    line.strip_prefix("hello at ")?.strip_suffix(" s")?.parse().ok()
}

#[test]
fn it_greets_ten_times_a_second() -> Result<(), Box<dyn Error>> {
    let seconds = greetings(4)?;
    assert_eq!(seconds.len(), 4, "{seconds:?}");
    // No greeting comes before it is due; the delay depends on the machine.
    for (number, second) in seconds.iter().enumerate() {
        assert!(*second >= number as f64 / 10.0, "{seconds:?}");
    }
    Ok(())
}
