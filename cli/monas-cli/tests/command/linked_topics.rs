//! A run does not depend on which topics a program links beside those that it uses.

use std::fs;
use std::path::Path;
use std::time::Duration;

use monas::records::Setting;
use monas_match::{MatchOptions, MatchSource};
use monas_tape::Tape;

use crate::kit::{monas, root};

narukom::topic! {
    /// A topic of this program alone. It sorts before all others, so every topic has another slot
    /// here than in `monas`.
    pub UNRELATED: narukom::State<Setting> = "a/unrelated";
}

const MATCH: &str = "config/match.xml";

/// Plays a match in this program, records it and returns the hash of the run.
fn record(file: &Path, seconds: u64) -> String {
    let registry = monas::Registry::linked();
    let plan =
        MatchSource::load(root().join(MATCH), &registry).unwrap_or_else(|found| panic!("{}", found[0]));
    let tape = Tape::create(file).expect("the folder takes files");
    let options = MatchOptions { seed: 1, record: Some(tape.clone()) };
    let mut running = plan.start(options).expect("the match starts");
    running.advance(Duration::from_secs(seconds)).expect("the match goes on");
    let hash = running.finish().expect("the match ends").hash.expect("simulated time");
    tape.finish().expect("it was written");
    hash
}

fn hash_of_monas(length: &str) -> String {
    let answer = monas(&["run", MATCH, "--seed", "1", "--for", length]);
    let hash = answer.out.lines().find_map(|line| line.strip_prefix("hash: "));
    hash.unwrap_or_else(|| panic!("no hash in {answer:?}")).to_owned()
}

#[test]
fn programs_with_different_topics_give_the_same_hash_and_verify_the_same_tape() {
    let linked = |path: &str| narukom::TOPICS.iter().any(|topic| topic.path() == path);
    assert!(linked(UNRELATED.path()), "this program links a topic that `monas` does not");
    let topics = monas(&["topic", "info", UNRELATED.path()]);
    assert_ne!(topics.code, Some(0), "{topics:?}");

    let folder = tempfile::tempdir().expect("a folder");
    let file = folder.path().join("match.mcap");
    assert_eq!(record(&file, 5), hash_of_monas("5s"));
    let verified = monas(&["tape", "verify", &file.display().to_string()]);
    assert_eq!(verified.code, Some(0), "{verified:?}");
}

#[test]
fn a_run_has_the_hash_of_its_row_in_the_season() {
    let rows = fs::read_to_string(root().join("tests/golden/short.txt")).expect("the golden rows");
    let row = rows.lines().nth(1).expect("a row of seed 1");
    let hash = hash_of_monas("120s");
    assert!(row.ends_with(&hash[..16]), "{row} has not {hash}");
}
