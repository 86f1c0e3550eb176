//! The same files and the same seed give the same bytes: in repeated runs, on one core, in another
//! order. Any other input gives different ones.

#![allow(clippy::unwrap_used)] // tests may panic

use std::fs;
use std::path::Path;
use std::process::Command;
use std::time::Duration;

use monas_match::{MatchOptions, MatchSource};
use monas_tests::{MATCH, play, root};

const LENGTH: Duration = Duration::from_secs(30);

/// Plays a match file and returns the hash and the number of messages.
fn hash_of(path: &Path, seed: u64) -> (String, u64) {
    let plan = MatchSource::load(path, &monas::Registry::linked()).unwrap();
    let mut running = plan.start(MatchOptions { seed, record: None }).unwrap();
    running.advance(LENGTH).unwrap();
    let summary = running.finish().unwrap();
    (summary.hash.unwrap(), summary.messages)
}

#[test]
fn the_same_seed_gives_the_same_hash_and_another_seed_another() {
    let path = root().join(MATCH.file);
    let (hash, messages) = hash_of(&path, 7);
    assert_eq!(hash.len(), 64);
    assert!(hash.chars().all(|digit| digit.is_ascii_hexdigit()));
    assert!(messages > 10_000, "{messages}");
    assert_eq!(hash_of(&path, 7), (hash.clone(), messages));
    assert_ne!(hash_of(&path, 8).0, hash);
}

#[test]
fn one_core_or_two_make_no_difference() {
    let row = |cores: &str| {
        let mut command = Command::new("taskset");
        command.args(["-c", cores, env!("CARGO_BIN_EXE_season"), "row", "match", "7", "30"]);
        let output = command.output().ok().filter(|output| output.status.success())?;
        Some(String::from_utf8(output.stdout).unwrap())
    };
    let (Some(one), Some(two)) = (row("0"), row("0,1")) else {
        println!("skipped: no `taskset`, or fewer than two cores");
        return;
    };
    assert_eq!(one, two);
    let hash = play(&MATCH, 7, LENGTH).unwrap().hash;
    assert!(one.contains(&hash[..16]), "{one} has not {hash}");
}

/// Writes the project's configuration and models to a separate folder, in the order of `teams`,
/// `robots` and `agents`, and returns the match file.
fn written(folder: &Path, teams: [usize; 2], robots: [usize; 3], agents: [usize; 3]) -> std::path::PathBuf {
    for (from, to) in [("models", "models"), ("config/fields", "config/fields")] {
        copy(&root().join(from), &folder.join(to));
    }
    fs::create_dir_all(folder.join("config/roles")).unwrap();
    for role in ["goalie", "attacker"] {
        fs::write(folder.join(format!("config/roles/{role}.xml")), role_text(role, agents)).unwrap();
    }
    let path = folder.join("config/match.xml");
    fs::write(&path, match_text(teams, robots)).unwrap();
    path
}

fn copy(from: &Path, to: &Path) {
    fs::create_dir_all(to).unwrap();
    for entry in fs::read_dir(from).unwrap() {
        let entry = entry.unwrap();
        fs::copy(entry.path(), to.join(entry.file_name())).unwrap();
    }
}

/// A role with two agents in addition to the playing one.
fn role_text(role: &str, order: [usize; 3]) -> String {
    let agents = [
        format!("<agent><name>Player</name><statechart>models/{role}.srm</statechart></agent>\n"),
        "<agent thread_frequency=\"10\"><name>Gambler</name><activity>Dice</activity></agent>\n".into(),
        "<agent thread_frequency=\"20\"><name>Another</name><activity>Dice</activity></agent>\n".into(),
    ];
    order.map(|index| agents[index].as_str()).concat()
}

fn match_text(teams: [usize; 2], robots: [usize; 3]) -> String {
    let robot = |index: usize| {
        let role = if index == 0 { "goalie" } else { "attacker" };
        format!("    <robot number=\"{}\" role=\"config/roles/{role}.xml\"/>\n", index + 1)
    };
    let players = robots.map(robot).concat();
    let team = |(number, name, side): (usize, &str, &str)| {
        let colour = name.to_lowercase();
        format!(
            "  <team number=\"{number}\" name=\"{name}\" colour=\"{colour}\" side=\"{side}\">\n{players}  </team>\n"
        )
    };
    let both = [team((1, "Blue", "left")), team((2, "Red", "right"))];
    let listed = teams.map(|index| both[index].as_str()).concat();
    format!("<match field=\"config/fields/thesis.xml\" half=\"60s\">\n{listed}</match>\n")
}

#[test]
fn the_order_in_files_makes_no_difference() {
    let hash = |teams, robots, agents| {
        let folder = tempfile::tempdir().unwrap();
        hash_of(&written(folder.path(), teams, robots, agents), 7)
    };
    let first = hash([0, 1], [0, 1, 2], [0, 1, 2]);
    assert_eq!(hash([1, 0], [0, 1, 2], [0, 1, 2]), first, "teams");
    assert_eq!(hash([0, 1], [2, 0, 1], [0, 1, 2]), first, "robots");
    assert_eq!(hash([0, 1], [0, 1, 2], [2, 1, 0]), first, "agents");
}

#[test]
fn one_changed_constant_in_a_guard_makes_a_difference() {
    let folder = tempfile::tempdir().unwrap();
    let path = written(folder.path(), [0, 1], [0, 1, 2], [0, 1, 2]);
    let before = hash_of(&path, 7);
    let model = folder.path().join("models/attacker.srm");
    let text = fs::read_to_string(&model).unwrap();
    assert!(text.contains("near = 0.25"));
    fs::write(&model, text.replace("near = 0.25", "near = 0.26")).unwrap();
    assert_ne!(hash_of(&path, 7).0, before.0);
}
