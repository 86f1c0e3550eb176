//! `monas new`: created files and refusals. That a project builds, runs and passes its tests is
//! checked by `cargo xtask project`.

use std::fs;
use std::path::Path;
use std::process::Command;

use crate::kit::{Answer, command, root};

/// Runs the command in a folder.
fn monas_in(folder: &Path, arguments: &[&str]) -> Answer {
    command(arguments).current_dir(folder).output().expect("the command starts").into()
}

fn project() -> tempfile::TempDir {
    let folder = tempfile::tempdir().expect("a folder");
    let answer = monas_in(folder.path(), &["new", "my-team"]);
    assert_eq!(answer.code, Some(0), "{}", answer.err);
    assert!(answer.out.lines().any(|line| line == "my-team/Cargo.toml"), "{}", answer.out);
    assert!(answer.err.contains("cd my-team && cargo test"), "{}", answer.err);
    folder
}

fn read(path: &Path) -> String {
    fs::read_to_string(path).unwrap_or_else(|error| panic!("{}: {error}", path.display()))
}

#[test]
fn a_project_has_its_folders_and_manifests_that_cargo_reads() {
    let folder = project();
    let team = folder.path().join("my-team");
    for part in ["activities", "functionalities", "messages", "models", "statecharts", "config", "src"] {
        assert!(team.join(part).is_dir(), "{part}");
    }
    assert!(read(&team.join("messages/greeting.proto")).contains("package my_team;"));
    assert_eq!(read(&team.join("Cargo.lock")), read(&root().join("Cargo.lock")));
    let arguments = ["metadata", "--offline", "--no-deps", "--format-version", "1"];
    let metadata = cargo_in(Command::new(env!("CARGO")).args(arguments), &team);
    let metadata: serde_json::Value = serde_json::from_str(&metadata).expect("JSON");
    let packages = metadata["packages"].as_array().expect("packages").iter();
    let mut names: Vec<&str> = packages.filter_map(|package| package["name"].as_str()).collect();
    names.sort_unstable();
    assert_eq!(names, ["activities", "functionalities", "messages", "my-team"]);
}

/// This program does not have the activities of the project, and would write skeletons of them.
#[test]
fn nothing_is_generated_where_the_program_of_the_project_does_not_start() {
    let folder = project();
    let team = folder.path().join("my-team");
    let mut generate = command(&["-q", "generate", "models/greeter.srm"]);
    let answer: Answer =
        generate.current_dir(&team).env("PATH", "/nowhere").output().expect("the command starts").into();
    assert_eq!(answer.code, Some(1), "{}", answer.err);
    assert!(answer.err.contains("nothing is generated: cargo: "), "{}", answer.err);
    assert!(!team.join("statecharts/greeter").exists());
}

#[test]
fn the_present_folder_becomes_a_project_of_its_name() {
    let folder = tempfile::tempdir().expect("a folder");
    let team = folder.path().join("my-team");
    fs::create_dir(&team).expect("the folder takes folders");
    let answer = monas_in(&team, &["new", "."]);
    assert_eq!(answer.code, Some(0), "{}", answer.err);
    assert!(read(&team.join("Cargo.toml")).contains("program = \"my-team\""));
    // A forgotten name makes no project.
    let answer = monas_in(folder.path(), &["new", "activity"]);
    assert_eq!(answer.code, Some(2), "{}", answer.err);
    assert!(answer.err.contains("the activity has no name: `monas new activity NAME`"), "{}", answer.err);
    assert!(!folder.path().join("activity").exists());
}

fn cargo_in(cargo: &mut Command, folder: &Path) -> String {
    let output = cargo.current_dir(folder).output().expect("cargo starts");
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    String::from_utf8(output.stdout).expect("UTF-8")
}

#[test]
fn an_activity_is_one_new_file_and_nothing_else_changes() {
    let folder = project();
    let team = folder.path().join("my-team");
    let before = texts(&team);
    // Also from a folder within the project.
    let answer = monas_in(&team.join("config"), &["new", "activity", "TrackBall"]);
    assert_eq!(answer.code, Some(0), "{}", answer.err);
    // Qualified, since the soccer player linked into this command has an activity of that name.
    assert!(answer.err.contains("`activities::TrackBall`"), "{}", answer.err);
    let mut after = texts(&team);
    let text = after.remove("activities/track_ball.rs").expect("the activity is there");
    assert!(text.contains("monas::activity!(TrackBall);"), "{text}");
    assert_eq!(after, before);
    let again = monas_in(&team, &["new", "activity", "TrackBall"]);
    assert_eq!(again.code, Some(1));
    assert!(again.err.contains("exists already"), "{}", again.err);
    let other = monas_in(&team, &["new", "activity", "Juggle", "--format", "json"]);
    assert_eq!(other.out, "{\"written\":\"activities/juggle.rs\"}\n");
}

#[test]
fn an_activity_that_is_a_module_is_a_crate_which_the_workspace_finds() {
    let folder = project();
    let team = folder.path().join("my-team");
    let before = texts(&team);
    let answer = monas_in(&team, &["new", "activity", "TrackBall", "--module"]);
    assert_eq!(answer.code, Some(0), "{}", answer.err);
    assert_eq!(answer.out, "modules/track_ball/Cargo.toml\nmodules/track_ball/lib.rs\n");
    assert!(answer.err.contains("`monas module build track_ball`"), "{}", answer.err);
    let mut after = texts(&team);
    let library = after.remove("modules/track_ball/lib.rs").expect("the activity is there");
    assert!(library.contains("monas::activity!(TrackBall);\nmonas::module!();\n"), "{library}");
    assert!(after.remove("modules/track_ball/Cargo.toml").expect("the crate").contains("\"cdylib\""));
    assert_eq!(after, before);
    let arguments = ["metadata", "--offline", "--no-deps", "--format-version", "1"];
    let metadata = cargo_in(Command::new(env!("CARGO")).args(arguments), &team);
    assert!(metadata.contains("modules/track_ball/Cargo.toml"), "{metadata}");
    assert!(monas_in(&team, &["new", "activity", "TrackBall", "--module"]).err.contains("exists already"));
    for (arguments, expected) in [
        (&["new", "activity", "Messages", "--module"][..], "choose another name"),
        (&["new", "other-team", "--module"], "--module is for an activity"),
    ] {
        let answer = monas_in(&team, arguments);
        assert_eq!(answer.code, Some(2), "{arguments:?}\n{}", answer.err);
        assert!(answer.err.contains(expected), "{arguments:?}\n{}", answer.err);
    }
}

#[test]
fn a_project_that_has_no_folder_of_modules_gets_one() {
    let folder = project();
    let team = folder.path().join("my-team");
    let manifest = read(&team.join("Cargo.toml"));
    fs::write(team.join("Cargo.toml"), manifest.replace(", \"modules/*\"", "")).expect("a file");
    let answer = monas_in(&team, &["new", "activity", "Look", "--module"]);
    assert!(answer.out.lines().any(|line| line == "Cargo.toml"), "{}", answer.out);
    assert!(read(&team.join("Cargo.toml")).contains("\"modules/*\""));
}

/// Every file of a folder by its path.
fn texts(folder: &Path) -> std::collections::BTreeMap<String, String> {
    fn below(folder: &Path, root: &Path, found: &mut std::collections::BTreeMap<String, String>) {
        for entry in fs::read_dir(folder).expect("a folder") {
            let path = entry.expect("an entry").path();
            match path.is_dir() {
                true => below(&path, root, found),
                false => {
                    let name = path.strip_prefix(root).expect("within").display().to_string();
                    found.insert(name, read(&path));
                }
            }
        }
    }
    let mut found = std::collections::BTreeMap::new();
    below(folder, folder, &mut found);
    found
}

#[test]
fn a_failed_creation_writes_nothing() {
    let folder = tempfile::tempdir().expect("a folder");
    fs::create_dir(folder.path().join("full")).expect("the folder takes folders");
    fs::write(folder.path().join("full/a.txt"), "mine").expect("the folder takes files");
    for (arguments, code, expected) in [
        (&["new", "My-Team"][..], 2, "lower-case letters"),
        (&["new", "std"], 2, "is reserved by"),
        (&["new", "full"], 1, "not empty"),
        (&["new", "team", "--monas", "/nowhere"], 2, "--monas PATH"),
        (&["new", "activity", "Vision"], 3, "`monas new my-team` creates one"),
        (&["new", "activity", "vision"], 2, "an upper-case letter"),
        (&["new", "message", "Ball"], 2, "monas new activity"),
        (&["new"], 2, "Usage"),
    ] {
        let answer = monas_in(folder.path(), arguments);
        assert_eq!(answer.code, Some(code), "{arguments:?}\n{}", answer.err);
        assert!(answer.err.contains(expected), "{arguments:?}\n{}", answer.err);
    }
    let names: Vec<_> = fs::read_dir(folder.path()).expect("a folder").collect();
    assert_eq!(names.len(), 1, "{names:?}");
}
