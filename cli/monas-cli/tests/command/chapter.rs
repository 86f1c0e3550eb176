//! The chapters in `docs`: runs the commands of each chapter and checks what the chapter says they
//! print, in a folder with the models and configurations of the project. The Rust code of the
//! chapters is tested with the documentation of the crate `monas`; the chapter on modules in
//! `examples/06-module`.

use std::fs;

use crate::copying::copy;
use crate::generate::project;
use crate::kit::root;
use crate::reading::{Reading, read_in};

/// Runs a chapter with at least this many commands.
fn read(name: &str, min: usize) -> Reading {
    let folder = project();
    for part in ["config", "docs"] {
        copy(&root().join(part), &folder.path().join(part));
    }
    read_in(folder, name, min)
}

#[test]
fn the_first_agent() {
    read("first-agent.md", 3);
}

#[test]
fn the_first_chart() {
    read("first-chart.md", 3);
}

#[test]
fn how_time_works() {
    let Reading { hashes, .. } = read("time.md", 6);
    assert_eq!(hashes.len(), 3);
    assert!(hashes.iter().all(|hash| *hash == hashes[0]), "one seed, one run: {hashes:?}");
}

#[test]
fn changing_what_runs() {
    read("live.md", 21);
}

#[test]
fn what_a_recording_explains() {
    read("studio.md", 4);
}

#[test]
fn to_the_robot() {
    read("deploy.md", 2);
}

#[test]
fn coming_from_elsewhere() {
    read("porting.md", 2);
}

#[test]
fn invariants() {
    read("properties.md", 4);
}

#[test]
fn what_a_role_does() {
    read("scenarios.md", 4);
}

#[test]
fn recipes() {
    read("cookbook.md", 20);
}

#[test]
fn symptoms_and_remedies() {
    read("troubleshooting.md", 20);
}

#[test]
fn from_goals_to_robots_that_act_together() {
    let Reading { folder, .. } = read("goals.md", 14);
    let drawn = fs::read(folder.path().join("protocol.svg")).expect("it is drawn");
    let page = root().join("docs/protocol.svg");
    if std::env::var_os("MONAS_BLESS").is_some() {
        fs::write(&page, &drawn).expect("the folder takes files");
    }
    let shown = fs::read(page).expect("it is shown");
    assert!(drawn == shown, "docs/protocol.svg is not up to date: MONAS_BLESS=1 draws it anew");
}

#[test]
fn from_a_protocol_to_a_match() {
    let Reading { folder, hashes, .. } = read("attack.md", 16);
    for drawing in ["attack.svg", "extended_attacker.svg"] {
        let drawn = fs::read(folder.path().join(drawing)).expect("it is drawn");
        let shown = fs::read(root().join("docs").join(drawing)).expect("it is shown");
        assert!(drawn == shown, "docs/{drawing} is not up to date");
    }
    assert_eq!(hashes.len(), 2);
    assert_eq!(hashes[0], hashes[1], "interpreted and generated");
}
