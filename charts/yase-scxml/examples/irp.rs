//! Runs the W3C's tests of SCXML processors in simulated time and prints the results.
//!
//! `cargo run -p yase-scxml --example irp` searches the suite in the folder that `MONAS_SHARED`
//! names, or else beside the workspace. It fails if fewer tests pass than are recorded.

#[path = "../tests/scxml/irp.rs"]
#[allow(dead_code)] // the test uses the rest
mod irp;
#[path = "../tests/scxml/suites.rs"]
mod suites;

use std::process::ExitCode;

fn main() -> ExitCode {
    let Some(folder) = suites::folder("irp") else {
        println!("the suite is not there: nothing was run");
        return ExitCode::SUCCESS;
    };
    let report = irp::run(&folder);
    print!("{report}");
    let recorded = (suites::recorded("irp null"), suites::recorded("irp mandatory"));
    if report.null().0 < recorded.0 || report.mandatory().0 < recorded.1 {
        println!("on record are {} documents of the null data model and {} rows", recorded.0, recorded.1);
        return ExitCode::FAILURE;
    }
    ExitCode::SUCCESS
}
