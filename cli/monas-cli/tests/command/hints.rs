//! Replies to mistakes on the command line, and exit codes.

use std::fs;
use std::path::Path;
use std::process::Stdio;

use crate::kit::{Answer, command, monas, root};

fn file(folder: &Path, name: &str, text: &str) -> String {
    let path = folder.join(name);
    fs::write(&path, text).expect("the folder takes files");
    path.display().to_string()
}

#[test]
fn a_setting_of_one_role_is_not_judged_by_another() {
    let answer = monas(&["run", "config/match.xml", "--set", "agent.Attacker.statechart=x", "--for", "1s"]);
    assert_eq!(answer.code, Some(3), "{}", answer.err);
    assert!(answer.err.contains("there is no `statechart` `x`"), "{}", answer.err);
    assert!(answer.err.contains("models/attacker.srm"), "{}", answer.err);
    assert!(!answer.err.contains("no `agent`"), "{}", answer.err);
}

#[test]
fn a_folder_is_no_file_and_is_not_what_was_meant() {
    let answer = monas(&["model", "check", "models"]);
    assert_eq!(answer.code, Some(3));
    assert!(answer.err.contains("`models` is a folder") && answer.err.contains("`models/"), "{}", answer.err);
    let folder = tempfile::tempdir().expect("a folder");
    fs::create_dir(folder.path().join("models")).expect("the folder takes folders");
    let text = "<agent><name>A</name><statechart>models</statechart></agent>";
    let answer = monas(&["config", "check", &file(folder.path(), "agents.xml", text)]);
    assert_eq!(answer.code, Some(3));
    assert!(!answer.err.contains("did you mean `models`"), "{}", answer.err);
}

#[test]
fn the_other_spelling_of_an_attribute_is_suggested() {
    let folder = tempfile::tempdir().expect("a folder");
    let text = "[[agent]]\nname = \"A\"\nfreqency = 10\nactivity = \"Vision\"\n";
    let answer = monas(&["config", "check", &file(folder.path(), "agents.toml", text)]);
    assert_eq!(answer.code, Some(3));
    assert!(answer.err.contains("did you mean `frequency`?"), "{}", answer.err);
    assert!(answer.err.contains("agents.toml:3:1"), "{}", answer.err);
}

#[test]
fn a_missing_attribute_is_lacking() {
    let folder = tempfile::tempdir().expect("a folder");
    let text = "<match><team number=\"1\" name=\"a\" colour=\"blue\"/></match>";
    let answer = monas(&["config", "check", &file(folder.path(), "match.xml", text)]);
    assert!(answer.err.contains("`team` lacks the attribute `side`"), "{}", answer.err);
}

#[test]
fn an_extension_without_a_format_is_refused_as_the_help_says() {
    let folder = tempfile::tempdir().expect("a folder");
    let out = folder.path().join("goalie.xyz").display().to_string();
    let answer = monas(&["model", "convert", "models/goalie.srm", &out]);
    assert_eq!(answer.code, Some(2));
    assert!(answer.err.contains("--as") && answer.err.contains("xmi-2018"), "{}", answer.err);
    assert!(monas(&["model", "convert", "--help"]).out.contains("Any other extension requires this option"));
}

#[test]
fn a_long_line_is_not_shown_as_a_whole() {
    let folder = tempfile::tempdir().expect("a folder");
    let text = format!("Role: r\nLiveness:\nr = {}A ..B\n", " ".repeat(70_000));
    let path = file(folder.path(), "wide.srm", &text);
    let answer = monas(&["model", "check", &path]);
    assert_eq!(answer.code, Some(3));
    assert!(answer.err.contains("wide.srm:3:70008"), "{}", answer.err);
    assert!(
        answer.err.lines().all(|line| line.chars().count() <= 200) && answer.err.len() < 2000,
        "{}",
        answer.err
    );
    let json = monas(&["model", "check", &path, "--format", "json"]);
    assert!(json.err.contains("\"column\":70008"), "{}", json.err);
    let sarif = monas(&["model", "check", &path, "--format", "sarif"]);
    assert!(sarif.out.contains("\"startColumn\": 70008"), "{}", sarif.out);
}

#[test]
fn a_configuration_without_agents_is_not_run() {
    let folder = tempfile::tempdir().expect("a folder");
    let empty = file(folder.path(), "agents.xml", "<agents/>\n");
    for command in [&["run", &empty][..], &["config", "check", &empty]] {
        let answer = monas(command);
        assert_eq!((answer.code, answer.out.as_str()), (Some(3), ""), "{}", answer.err);
        assert!(answer.err.contains("has no agent that is enabled"), "{}", answer.err);
    }
    let toml = file(folder.path(), "agents.toml", "");
    let answer = monas(&["config", "check", &toml]);
    assert!(answer.err.contains("add an agent: `[[agent]]`"), "{}", answer.err);
    #[cfg(unix)]
    assert_eq!(monas(&["run", "/dev/null"]).code, Some(3));
}

#[test]
fn a_diagnostic_begins_with_its_severity_and_names_its_file() {
    let answer = monas(&["model", "check", "nowhere.srm"]);
    assert!(
        answer.err.starts_with("error[E0316]: no file `nowhere.srm`\n  --> nowhere.srm\n"),
        "{}",
        answer.err
    );
}

#[test]
fn a_missing_file_is_searched_in_the_folders_above() {
    let hint = |folder: &Path, arguments: &[&str]| {
        let output = command(arguments).current_dir(folder).output().expect("monas runs");
        assert_eq!(output.status.code(), Some(3), "{output:?}");
        let text = String::from_utf8_lossy(&output.stderr).into_owned();
        text.split_once("= help: ").map(|(_, hint)| hint.trim_end().to_owned())
    };
    let models = root().join("models");
    let found = hint(&models, &["run", "config/match.xml"]);
    assert_eq!(found.as_deref(), Some("did you mean `../config/match.xml`?"));
    let found = hint(&root().join("docs"), &["model", "check", "models/goalie.srm"]);
    assert_eq!(found.as_deref(), Some("did you mean `../models/goalie.srm`?"));
    let empty = tempfile::tempdir().expect("a folder");
    let found = hint(empty.path(), &["run"]);
    assert_eq!(found.as_deref(), Some("name a configuration, or create a project: `monas new my-team`"));
    assert_eq!(hint(empty.path(), &["run", "nowhere.xml"]), None);
}

/// The exit code of a command whose output is not read.
fn unread(arguments: &[&str]) -> Option<i32> {
    let mut child =
        command(arguments).stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().expect("it starts");
    drop((child.stdout.take(), child.stderr.take()));
    child.wait().expect("it ends").code()
}

#[test]
fn closed_pipes_do_not_change_what_was_found() {
    let folder = tempfile::tempdir().expect("a folder");
    let broken = file(folder.path(), "broken.srm", "Role: r\nLiveness:\nr = A ..B\n");
    let wrong = file(folder.path(), "wrong.srm", "Role: r\nLiveness:\nr = TrakBall\n");
    assert_eq!(unread(&["model", "check", &broken]), Some(3));
    assert_eq!(unread(&["model", "check", &wrong]), Some(5));
    assert_eq!(unread(&["config", "check", "nowhere.xml"]), Some(3));
    assert_eq!(unread(&["rum"]), Some(2));
}

#[test]
fn tables_and_help_fit_the_terminal() {
    let at = |columns: &str, arguments: &[&str]| -> Answer {
        command(arguments).env("COLUMNS", columns).output().expect("the command starts").into()
    };
    let folder = tempfile::tempdir().expect("a folder");
    let tape = folder.path().join("match.mcap").display().to_string();
    let run = at("80", &["run", "config/match.xml", "--for", "1s", "--record", &tape]);
    assert_eq!(run.code, Some(0), "{}", run.err);
    let info = at("80", &["tape", "info", &tape]);
    assert!(info.out.contains("Attacker") && info.out.contains("soccer/"), "{}", info.out);
    let help = at("80", &["run", "--help"]);
    for text in [&run.out, &info.out, &help.out] {
        let is_wide = |line: &&str| {
            line.chars().count() > 80 && !line.starts_with("  never ") && !line.contains("hash")
        };
        let wide: Vec<&str> = text.lines().filter(is_wide).collect();
        assert!(wide.is_empty(), "{wide:#?}");
    }
}

#[test]
fn findings_name_states_briefly_also_if_a_formula_is_long() {
    let folder = tempfile::tempdir().expect("a folder");
    let attacker = fs::read_to_string(root().join("models/attacker.srm")).expect("it is there");
    let path = file(folder.path(), "a.srm", &attacker.replace("PLAYING", "PLAYNG"));
    let checked = monas(&["model", "check", &path]);
    assert!(checked.err.contains("no value `PLAYNG` (from `active/"), "{}", checked.err);
    let converted = monas(&["model", "convert", "models/goalie.srm", "/dev/null", "--as", "scxml"]);
    assert!(converted.err.contains("has an activity, which SCXML cannot represent"), "{}", converted.err);
    for line in checked.err.lines().chain(converted.err.lines()) {
        let is_message = line.starts_with("error[") || line.starts_with("warning[");
        let mut names = line.split('`').skip(1).step_by(2).filter(|_| is_message);
        let long = names.find(|name| name.contains('/') && name.chars().count() > 60);
        assert_eq!(long, None, "{line}");
    }
}

#[test]
fn files_of_another_kind_are_named_and_reported_once() {
    let run = monas(&["run", "models/goalie.srm"]);
    assert_eq!(run.code, Some(3), "{run:?}");
    assert_eq!(run.err.matches("error").count(), 1, "{}", run.err);
    assert!(run.err.contains("E0301") && run.err.contains("models/goalie.srm:1:1"), "{}", run.err);
    let tape = monas(&["tape", "info", "config/match.xml"]);
    let expected = "config/match.xml: the tape is damaged: it does not begin as an MCAP file";
    assert!(tape.code == Some(1) && tape.err.contains(expected), "{tape:?}");
    let evaluation = monas(&["eval", "models"]);
    assert_eq!(evaluation.code, Some(3), "{evaluation:?}");
    assert_eq!(evaluation.err.matches("error[E0316]").count(), 1, "{}", evaluation.err);
}
