//! Other people's tools read the tapes: Python's `mcap` and `mcap-protobuf-support` decode one.
//!
//! The interpreter is `MONAS_PYTHON`, or else `python3`; without these packages the test says that it was skipped.
#![allow(clippy::unwrap_used, clippy::panic, reason = "a test that cannot go on fails")]

mod ball;

use std::process::{Command, Output};

/// Prints a line for each message: topic, publisher, sequence, moment in nanoseconds, distance.
const DECODE: &str = r#"
import sys
from mcap.reader import make_reader
from mcap_protobuf.decoder import DecoderFactory

with open(sys.argv[1], "rb") as file:
    reader = make_reader(file, decoder_factories=[DecoderFactory()])
    for schema, channel, message, ball in reader.iter_decoded_messages():
        print(channel.topic, channel.metadata["publisher"], message.sequence, message.log_time, ball.distance)
"#;

fn python(arguments: &[&str]) -> Option<Output> {
    let interpreter = std::env::var_os("MONAS_PYTHON").unwrap_or_else(|| "python3".into());
    Command::new(interpreter).args(arguments).output().ok()
}

#[test]
fn python_decodes_a_tape() {
    let imports = python(&["-c", "import mcap, mcap_protobuf"]);
    if !imports.is_some_and(|output| output.status.success()) {
        println!("skipped: python3 with mcap and mcap-protobuf-support is not there");
        return;
    }
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("run.mcap");
    std::fs::write(&path, ball::recorded(2)).unwrap();
    let output = python(&["-c", DECODE, path.to_str().unwrap()]).unwrap();
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    let text = String::from_utf8(output.stdout).unwrap();
    let mut lines: Vec<_> = text.lines().collect();
    lines.sort_unstable();
    let mut expected = Vec::new();
    for host in ["robot_1", "robot_2"] {
        for (number, millis) in [(1, 100), (2, 200)] {
            let later = millis + 50;
            expected.push(format!("{host}/soccer/ball vision {number} {millis}000000 {number}.0"));
            expected.push(format!("{host}/soccer/ball body {number} {later}000000 {number}.0"));
            expected.push(format!("{host}/soccer/sighting vision {number} {millis}000000 {number}.0"));
        }
    }
    expected.sort_unstable();
    assert_eq!(lines, expected);
}
