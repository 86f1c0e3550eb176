//! Tests that the generated patrol behaves like the interpreted one.

use std::error::Error;
use std::process::Command;

#[test]
fn the_program_prints_what_the_interpreted_one_prints() -> Result<(), Box<dyn Error>> {
    let output = Command::new(env!("CARGO_BIN_EXE_example-generated")).output()?;
    assert_eq!(String::from_utf8(output.stdout)?, include_str!("../../02-formula/tests/patrol.txt"));
    assert!(output.status.success());
    Ok(())
}
