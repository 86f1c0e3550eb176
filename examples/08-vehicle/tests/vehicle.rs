//! Tests of the vehicle: its role alone, twenty minutes of its warehouse, and the command.

use std::error::Error;
use std::path::Path;
use std::process::Command;

use example_vehicle::messages::Vehicle;
use example_vehicle::{ORDERS, VEHICLE};
use monas::{Registry, RunHash, Statistics, Talws, Timestamp};

type Outcome<T = ()> = Result<T, Box<dyn Error>>;

const FOLDER: &str = env!("CARGO_MANIFEST_DIR");

/// The output of the command, which has to succeed.
fn command(arguments: &[&str]) -> Outcome<String> {
    let output = Command::new(env!("CARGO_BIN_EXE_vehicle")).args(arguments).current_dir(FOLDER).output()?;
    let text = String::from_utf8([output.stdout, output.stderr].concat())?;
    assert!(output.status.success(), "{arguments:?}: {text}");
    Ok(text)
}

/// Simulates twenty minutes. Returns the hash, the calls, the lowest charge and the orders that
/// wait at the end.
fn twenty_minutes(seed: u64) -> Outcome<(String, Statistics, f64, u32)> {
    let mut talws = Talws::from_config(Path::new(FOLDER).join("config/vehicle.xml"), Registry::linked())?;
    let hash = RunHash::new();
    talws.observe(Box::new(hash.clone()));
    let mut simulation = talws.simulate(seed)?;
    let mut window = simulation.hub(Talws::LOCAL).ok_or("there are no agents")?.blackboard("window");
    let mut lowest = f64::INFINITY;
    for second in 1..=1200 {
        let now = Timestamp::from_secs_f64(f64::from(second));
        simulation.run_until(now)?;
        window.process_messages(now);
        let Vehicle { charge, .. } = window.read(VEHICLE).ok_or("nothing is measured")?;
        lowest = lowest.min(*charge);
    }
    let waiting = window.read(ORDERS).map_or(0, |orders| orders.waiting);
    Ok((hash.finish().0, simulation.statistics(), lowest, waiting))
}

#[test]
fn deliveries_never_empty_the_battery() -> Outcome {
    let (hash, statistics, lowest, waiting) = twenty_minutes(7)?;
    let calls = |activity| statistics.calls(Talws::LOCAL, activity);
    assert!(lowest > 0.1, "the charge falls to {lowest}");
    assert!(waiting < 10, "{waiting} of 48 orders wait");
    assert!(calls("Charge") > 0 && calls("PutDown") > 0, "{statistics:?}");
    assert_eq!(twenty_minutes(7)?.0, hash);
    assert_ne!(twenty_minutes(8)?.0, hash);
    Ok(())
}

#[test]
fn the_role_passes_its_checks_and_its_scenario() -> Outcome {
    let answer = command(&["model", "check", "models/courier.srm"])?;
    assert!(answer.ends_with("no errors\n") && !answer.contains("warning"), "{answer}");
    command(&["model", "run", "models/courier.srm", "tests/low_battery.scenario"])?;
    Ok(())
}

#[test]
fn a_recording_is_replayed_without_differences() -> Outcome {
    let folder = tempfile::tempdir()?;
    let tape = folder.path().join("vehicle.mcap");
    let tape = tape.to_str().ok_or("the folder has a strange name")?;
    command(&["run", "config/vehicle.xml", "--for", "1s", "--no-control", "--record", tape])?;
    let answer = command(&["tape", "replay", tape, "--agents", "Courier", "--verify"])?;
    assert!(answer.contains("0 differences"), "{answer}");
    Ok(())
}
