//! A recording process is killed, and its tape is recovered.

use std::io::{BufRead, BufReader};
use std::path::Path;
use std::process::{Command, Stdio};

use crate::ball::*;
use monas_tape::{Recording, Tape, recover};
use narukom::prost::Message as _;

/// Environment variable with the path of the tape, for the process to be killed.
const TAPE_VARIABLE: &str = "MONAS_TAPE_VICTIM";
/// The number of published balls after which the process reports.
const REPORTED_AFTER: u64 = 500;

/// In the process to be killed: records forever, and reports when so many messages have been
/// flushed that they cannot be lost.
#[test]
fn victim() {
    let Some(path) = std::env::var_os(TAPE_VARIABLE) else { return };
    let tape = Tape::create_real_time(Path::new(&path)).unwrap();
    let hub = hub("robot");
    hub.observe(Box::new(tape.clone()));
    let mut publisher = hub.publisher(SEEN, "vision").unwrap();
    for number in 1_u64.. {
        publisher.publish(Ball { distance: number as f64 }, at(number));
        if number == REPORTED_AFTER {
            tape.flush().unwrap();
            println!("recorded");
        }
    }
}

/// Checks that the messages' sequence numbers and distances are 1, 2, 3 and so on; returns their
/// number.
fn counted(recording: &Recording) -> u64 {
    let mut count = 0;
    for message in recording.messages().unwrap() {
        let message = message.unwrap();
        count += 1;
        let ball = Ball::decode(message.bytes).unwrap();
        assert_eq!((u64::from(message.sequence), ball.distance), (count, count as f64));
    }
    count
}

#[test]
fn the_tape_of_a_killed_process_is_read_and_recovered() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("killed.mcap");
    let mut child = Command::new(std::env::current_exe().unwrap())
        .args(["--exact", "killed::victim", "--nocapture"])
        .env(TAPE_VARIABLE, &path)
        .stdout(Stdio::piped())
        .spawn()
        .unwrap();
    let lines = BufReader::new(child.stdout.take().unwrap()).lines();
    let said = lines.map(Result::unwrap).find(|line| line.contains("recorded"));
    assert!(said.is_some(), "it records");
    child.kill().unwrap();
    assert!(!child.wait().unwrap().success(), "it was killed");

    let cut = Recording::open(&path).unwrap();
    assert!(!cut.is_finished());
    let before = counted(&cut);
    assert!(before >= REPORTED_AFTER, "{before}");

    let recovery = recover(&path, &path).unwrap();
    assert_eq!((recovery.was_finished, recovery.was_whole(), recovery.messages), (false, false, before));
    let mended = Recording::open(&path).unwrap();
    assert!(mended.is_finished());
    assert_eq!(counted(&mended), before);
    assert_eq!(mended.overview().unwrap().messages(), before);
    // An intact tape is unchanged.
    let bytes = std::fs::read(&path).unwrap();
    assert!(recover(&path, &path).unwrap().was_whole());
    assert!(std::fs::read(&path).unwrap() == bytes);
}
