//! `monas explain`, its examples, and the manual pages.

use std::fs;
use std::process::Command;
use std::sync::Mutex;

use monas_diagnostics::{Explanation, explanations};

use crate::kit::{Answer, command, monas};

#[test]
fn a_code_is_explained_with_example_and_remedy() {
    let answer = monas(&["explain", "e0205"]);
    assert_eq!((answer.code, answer.err.as_str()), (Some(0), ""));
    assert!(answer.out.starts_with("E0205: an operator lacks a term\n"), "{}", answer.out);
    assert!(answer.out.contains("\n    keeper = Stand . . TrackBall\n"), "{}", answer.out);
    assert!(answer.out.contains("\n    monas model check example.srm\n"), "{}", answer.out);
    assert!(answer.out.contains("\nRemedy: "), "{}", answer.out);
}

#[test]
fn without_a_code_all_are_listed_in_80_columns() {
    let answer = monas(&["explain"]);
    assert_eq!((answer.code, answer.err.as_str()), (Some(0), ""));
    assert!(answer.out.contains("  M05    a branch that may have no enabled transition\n"), "{}", answer.out);
    let wide = answer.out.lines().find(|line| line.chars().count() > 80);
    assert_eq!(wide, None);
    for it in explanations() {
        let all = it.text(80);
        let wide = all.lines().find(|line| line.chars().count() > 80 && !line.starts_with("    "));
        assert_eq!(wide, None, "{}", it.code);
    }
}

#[test]
fn an_unknown_code_is_answered_with_near_ones() {
    let answer = monas(&["explain", "E0124"]);
    assert_eq!(answer.code, Some(2));
    assert_eq!(
        answer.err,
        "error: there is no code `E0124`; near are E0120, E0121, E0122, E0123; `monas explain` lists all\n"
    );
    for far in ["?", "E9999"] {
        let expected = format!("error: there is no code `{far}`; `monas explain` lists all\n");
        assert_eq!(monas(&["explain", far]).err, expected);
    }
}

/// The output of an example's commands, in a folder with its files.
fn printed(it: &Explanation) -> Option<String> {
    let commands = it.command()?;
    let folder = tempfile::tempdir().expect("a folder");
    for (name, text) in it.files() {
        fs::write(folder.path().join(name), text).expect("the folder takes files");
    }
    let mut all = String::new();
    for line in commands.lines() {
        let words: Vec<&str> = line.split_whitespace().skip(1).collect();
        let answer: Answer =
            command(&words).current_dir(folder.path()).output().expect("the command starts").into();
        all += &format!("$ {line}\n{}{}", answer.out, answer.err);
    }
    Some(all)
}

#[test]
fn each_example_gives_its_code() {
    let (left, wrong) = (Mutex::new(explanations()), Mutex::new(Vec::new()));
    let next = || left.lock().expect("no thread has panicked").pop();
    let work = || {
        while let Some(it) = next() {
            let printed = printed(&it);
            if printed.as_ref().is_some_and(|all| !all.contains(&format!("[{}]", it.code))) {
                wrong.lock().expect("no thread has panicked").push((it.code, printed));
            }
        }
    };
    std::thread::scope(|scope| (0..2).for_each(|_| drop(scope.spawn(work))));
    let wrong = wrong.into_inner().expect("no thread has panicked");
    assert!(wrong.is_empty(), "examples without their code: {wrong:#?}");
}

#[test]
fn each_command_has_a_manual_page() {
    let folder = tempfile::tempdir().expect("a folder");
    let pages = folder.path().join("man/man1");
    let answer = monas(&["man", &pages.display().to_string()]);
    assert_eq!((answer.code, answer.out.as_str(), answer.err.as_str()), (Some(0), "", ""));
    let page = |name: &str| fs::read_to_string(pages.join(name)).expect("the page is there");
    assert!(page("monas.1").contains(".TH monas 1"), "{}", page("monas.1"));
    assert!(page("monas-model-check.1").contains("\\-\\-properties"), "{}", page("monas-model-check.1"));
    let answer = monas(&["man", "Cargo.toml"]);
    assert_eq!(answer.code, Some(1), "a file is not a folder");
    assert!(answer.err.starts_with("error: Cargo.toml: "), "{}", answer.err);
}

#[test]
#[cfg(target_os = "linux")]
fn on_a_terminal_the_command_that_explains_is_named_once() {
    let folder = tempfile::tempdir().expect("a folder");
    let model = folder.path().join("a.srm");
    fs::write(&model, "Role: a\nLiveness:\na = Stand . . TrackBall .\n").expect("the folder takes files");
    let line = format!("{} model check {}", env!("CARGO_BIN_EXE_monas"), model.display());
    // `script` gives the command a terminal.
    let Ok(output) = Command::new("script").args(["-qec", &line, "/dev/null"]).output() else { return };
    let text = String::from_utf8_lossy(&output.stdout).into_owned();
    assert_eq!(text.matches("`monas explain E0205` says more about this diagnostic").count(), 1, "{text}");
    assert!(!monas(&["model", "check", &model.display().to_string()]).err.contains("explain"));
}
