//! SCXML: reading, writing, sessions, and third-party suites.

#![allow(clippy::unwrap_used)] // the functions around the tests are tests too

mod irp;
mod reading;
mod round_trip;
mod scion;
mod session;
mod suites;

#[test]
fn the_w3c_tests_pass_that_are_on_record() {
    let Some(folder) = suites::folder("irp") else {
        println!("the W3C's suite is not there: nothing was run");
        return;
    };
    let report = irp::run(&folder);
    println!("{report}");
    assert!(report.null().0 >= suites::recorded("irp null"));
    assert!(report.mandatory().0 >= suites::recorded("irp mandatory"));
}
