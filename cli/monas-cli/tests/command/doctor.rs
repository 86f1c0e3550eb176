//! `monas doctor`: its checks and exit codes.

use std::fs;

use serde_json::Value;

use crate::kit::{changed, command, monas};

/// Area and state of each finding.
fn findings(arguments: &[&str]) -> (Option<i32>, Vec<(String, String, String)>) {
    let answer = monas(&[&["doctor", "--format", "json"], arguments].concat());
    let text = |object: &Value, key: &str| object[key].as_str().unwrap_or_default().to_owned();
    let found = answer.out.lines().map(|line| {
        let object: Value = serde_json::from_str(line).expect("a line is an object");
        (text(&object, "area"), text(&object, "state"), text(&object, "message"))
    });
    (answer.code, found.collect())
}

#[test]
fn it_looks_at_five_things() {
    let (code, found) = findings(&["config/match.xml"]);
    assert_eq!(code, Some(0), "{found:?}");
    for area in ["toolchain", "permissions", "clock", "ports", "configuration"] {
        assert!(found.iter().any(|(one, ..)| one == area), "{area} in {found:?}");
    }
    let configuration = found.last().expect("findings");
    assert_eq!(configuration, &("configuration".into(), "ok".into(), "config/match.xml is valid".into()));
}

#[test]
fn a_configuration_that_is_wrong_ends_with_3_and_is_explained() {
    let (folder, _) = changed("config/roles/goalie.xml", "models/goalie.srm", "models/golie.srm");
    let file = folder.path().join("config/roles/goalie.xml").display().to_string();
    let answer = monas(&["doctor", &file]);
    assert_eq!(answer.code, Some(3), "{}", answer.out);
    assert!(
        answer.out.contains("1 error\n") && answer.err.contains("did you mean `models/goalie.srm`?"),
        "{}",
        answer.err
    );
    let (code, found) = findings(&["nowhere.xml"]);
    let configuration = found.iter().find(|found| found.0 == "configuration");
    assert_eq!((code, configuration.map(|found| found.1.as_str())), (Some(3), Some("error")), "{found:?}");
    let empty = tempfile::tempdir().expect("a folder");
    let answer = command(&["doctor"]).current_dir(&empty).output().expect("monas runs");
    let out = String::from_utf8_lossy(&answer.stdout);
    assert!(answer.status.success() && out.contains("there is no config/agents.xml"), "{out}");
}

#[test]
fn ports_of_links_are_checked() {
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("agents.xml");
    fs::write(&path, "<link transport='zenoh'><listen>7447</listen><send topics='a/b'/></link>")
        .expect("the folder takes files");
    let (_, found) = findings(&[&path.display().to_string()]);
    let ports: Vec<&str> =
        found.iter().filter(|found| found.0 == "ports").map(|found| found.2.as_str()).collect();
    assert!(
        matches!(ports.as_slice(), [port] if port.contains("7447") || port.contains("cannot be seen")),
        "{ports:?}"
    );
}
