//! Interoperability: Python's `mcap` and `mcap-protobuf-support` decode a tape.
//!
//! The interpreter is `MONAS_PYTHON`, or else `python3`; without these packages the test prints
//! that it was skipped.

use std::process::{Command, Output};

/// Prints a line for each message: topic, publisher, sequence, time in nanoseconds, distance.
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
    std::fs::write(&path, crate::ball::recorded(2)).unwrap();
    assert_eq!(decoded(&path), expected(2));
    // A truncated one is rejected, but can be read after recovery.
    let mut bytes = crate::ball::recorded(30);
    bytes.truncate(bytes.len() / 2);
    std::fs::write(&path, bytes).unwrap();
    assert!(!python(&["-c", DECODE, path.to_str().unwrap()]).unwrap().status.success());
    let recovery = monas_tape::recover(&path, &path).unwrap();
    let lines = decoded(&path);
    assert_eq!(lines.len() as u64, recovery.messages);
    let all = expected(30);
    assert!(!lines.is_empty() && lines.iter().all(|line| all.contains(line)), "{lines:?}");
}

/// The messages that Python reads, sorted.
fn decoded(path: &std::path::Path) -> Vec<String> {
    let output = python(&["-c", DECODE, path.to_str().unwrap()]).unwrap();
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    let text = String::from_utf8(output.stdout).unwrap();
    let mut lines: Vec<String> = text.lines().map(str::to_owned).collect();
    lines.sort_unstable();
    lines
}

/// The expected messages of `rounds` rounds.
fn expected(rounds: u64) -> Vec<String> {
    let mut expected = Vec::new();
    for host in ["robot_1", "robot_2"] {
        for number in 1..=rounds {
            let (millis, later) = (100 * number, 100 * number + 50);
            expected.push(format!("{host}/soccer/ball vision {number} {millis}000000 {number}.0"));
            expected.push(format!("{host}/soccer/ball body {number} {later}000000 {number}.0"));
            expected.push(format!("{host}/soccer/sighting vision {number} {millis}000000 {number}.0"));
        }
    }
    expected.sort_unstable();
    expected
}
