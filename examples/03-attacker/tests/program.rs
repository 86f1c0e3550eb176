//! Tests of the program.

use std::error::Error;
use std::process::Command;

#[test]
fn it_prints_what_the_attacker_does() -> Result<(), Box<dyn Error>> {
    let output = Command::new(env!("CARGO_BIN_EXE_example-attacker")).output()?;
    assert_eq!(String::from_utf8(output.stdout)?, include_str!("table.txt"));
    assert!(output.status.success());
    Ok(())
}
