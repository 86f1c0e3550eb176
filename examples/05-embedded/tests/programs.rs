//! Tests of the programs.

use std::error::Error;
use std::io::Write;
use std::process::{Command, Stdio};

#[test]
fn two_rooms_are_driven_step_by_step() -> Result<(), Box<dyn Error>> {
    let output = Command::new(env!("CARGO_BIN_EXE_step-by-step")).output()?;
    assert!(output.status.success());
    assert_eq!(String::from_utf8(output.stdout)?, include_str!("rooms.txt"));
    Ok(())
}

#[test]
fn a_loop_of_its_own_asks_agents_that_run_beside_it() -> Result<(), Box<dyn Error>> {
    let mut program =
        Command::new(env!("CARGO_BIN_EXE_own-loop")).stdin(Stdio::piped()).stdout(Stdio::piped()).spawn()?;
    let mut input = program.stdin.take().ok_or("the program has no input")?;
    input.write_all(b"17.5\n20\nhot\n21.5\n20\n")?;
    drop(input);
    let output = program.wait_with_output()?;
    assert!(output.status.success());
    let output = String::from_utf8(output.stdout)?;
    let answers: Vec<&str> = output.lines().collect();
    assert_eq!(
        answers[..6],
        [
            "temperature?",
            "17.5 degrees: the heater is on",
            "20 degrees: the heater is on",
            "a number, please: invalid float literal",
            "21.5 degrees: the heater is off",
            "20 degrees: the heater is off",
        ]
    );
    assert!(answers[6].ends_with(" cycles"), "{output}");
    Ok(())
}
