//! The command line itself: help, version, completions, mistakes and closed pipes.

use std::process::Stdio;

use crate::kit::{command, monas};

#[test]
fn version_names_itself() {
    let answer = monas(&["--version"]);
    assert_eq!(answer.code, Some(0));
    assert_eq!(answer.out, format!("monas {}\n", env!("CARGO_PKG_VERSION")));
    assert_eq!(answer.err, "");
}

#[test]
fn help_lists_the_commands_and_exit_codes() {
    let answer = monas(&["--help"]);
    assert_eq!(answer.code, Some(0));
    for word in [
        "run",
        "model",
        "config",
        "new",
        "deploy",
        "doctor",
        "tape",
        "top",
        "topic",
        "completions",
        "4    nothing to connect to",
        "5    a replay differs",
        "130  interrupted",
        "143  terminated",
        "NO_COLOR",
    ] {
        assert!(answer.out.contains(word), "{word} is not in\n{}", answer.out);
    }
}

#[test]
fn usage_mistakes_end_with_2_and_say_what_was_meant() {
    let cases: [(&[&str], &str); 6] = [
        (&[], "Usage: monas"),
        (&["rum"], "'run'"),
        (&["run", "--sed", "7"], "'--seed'"),
        (&["run", "--for", "600"], "write `600s` for seconds"),
        (&["run", "--seed", "seven"], "invalid digit"),
        (&["model", "transform"], "<FILE>"),
    ];
    for (arguments, expected) in cases {
        let answer = monas(arguments);
        assert_eq!(answer.code, Some(2), "{arguments:?}");
        assert!(answer.err.contains(expected), "{arguments:?}:\n{}", answer.err);
        assert_eq!(answer.out, "", "{arguments:?}");
    }
}

/// One case for each exit code but 130, which is tested with interrupted runs.
#[test]
fn each_exit_code_means_one_thing() {
    let folder = tempfile::tempdir().expect("a folder");
    for (arguments, code) in [
        (&["config", "check", "config/match.xml"][..], 0),
        (&["config", "show", "config/match.xml"], 0),
        (&["config", "schema", "--xsd"], 0),
        (&["model", "transform", "models/goalie.srm"], 0),
        (&["tape", "info", "README.md"], 1),
        (&["generate", "models/goalie.srm", "--to", "models/elsewhere"], 2),
        (&["config", "schema"], 2),
        (&["config", "schema", "--xsd", "--json"], 2),
        (&["run", "nowhere.xml"], 3),
        (&["config", "show", "nowhere.xml"], 3),
        (&["model", "draw", "nowhere.srm"], 3),
        (&["model", "ontology", "nowhere.srm"], 3),
        (&["model", "ontology", "models/goalie.srm", "--package", "1"], 2),
        #[cfg(unix)]
        (&["topic", "list", "--run", "unknown-run"], 4),
        #[cfg(unix)]
        (&["studio", "--run", "unknown-run"], 4),
        #[cfg(unix)]
        (&["run", "config/match.xml", "--listen", "127.0.0.1:0"], 2),
        #[cfg(unix)]
        (&["run", "config/match.xml", "--studio", "--listen", "somewhere"], 2),
        (&["run", "config/match.xml", "--pace", "0"], 2),
    ] {
        let answer = command(arguments).env("XDG_RUNTIME_DIR", folder.path()).output().expect("it starts");
        assert_eq!(
            answer.status.code(),
            Some(code),
            "{arguments:?}\n{}",
            String::from_utf8_lossy(&answer.stderr)
        );
    }
}

/// Commands without computation answer at once. One of several attempts has to, since the machine
/// may be busy.
#[test]
fn output_to_a_pipe_has_no_colours() {
    for arguments in [&["--help"][..], &["rum"], &["model", "check", "nowhere.srm"]] {
        let plain = monas(arguments);
        let asked: crate::kit::Answer =
            command(arguments).env("NO_COLOR", "1").output().expect("the command starts").into();
        assert!(!plain.out.contains('\x1b') && !plain.err.contains('\x1b'), "{plain:?}");
        assert_eq!((plain.out, plain.err), (asked.out, asked.err));
    }
}

#[test]
fn completions_are_scripts_that_ask_the_command() {
    for shell in ["bash", "zsh", "fish", "elvish", "powershell"] {
        let answer = monas(&["completions", shell]);
        assert_eq!(answer.code, Some(0), "{shell}");
        assert!(answer.out.contains("COMPLETE") && answer.out.contains("monas"), "{shell}: {}", answer.out);
    }
    let complete = |words: &[&str]| {
        let line = [&["--", "monas"], words].concat();
        let answer = command(&line).env("COMPLETE", "fish").output().expect("the command starts");
        String::from_utf8(answer.stdout).expect("UTF-8")
    };
    assert!(complete(&["model", "tr"]).starts_with("transform"));
    assert!(complete(&["run", "--real"]).starts_with("--realtime"));
}

#[test]
fn a_reader_that_leaves_is_no_failure() {
    let mut child = command(&["completions", "bash"])
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .expect("it starts");
    drop(child.stdout.take());
    let answer: crate::kit::Answer = child.wait_with_output().expect("it ends").into();
    assert_eq!((answer.code, answer.err.as_str()), (Some(0), ""));
}

#[test]
fn a_log_filter_that_is_not_understood_is_named() {
    let filter = "monas=loud";
    let answer: crate::kit::Answer =
        command(&["--version"]).env("MONAS_LOG", filter).output().expect("the command starts").into();
    assert_eq!(answer.code, Some(0));
    assert!(answer.err.contains("MONAS_LOG is invalid"), "{}", answer.err);
}
