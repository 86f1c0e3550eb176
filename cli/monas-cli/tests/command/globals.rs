//! The options that each command has, and standard input.

use std::fs;

use crate::kit::{Answer, command, given, monas};

const WARNED: &str = "Role: a\nLiveness:\na = Stand . TrackBall | SearchBall\n";
const AGENT: &str = "<agent thread_frequency=\"10\"><name>A</name><activity>Stand</activity></agent>";

#[test]
fn a_quiet_command_prints_no_warnings_and_no_remarks() {
    let loud = given(&["model", "check", "-"], WARNED);
    assert!(loud.code == Some(0) && loud.err.contains("warning[E0210]"), "{loud:?}");
    for arguments in [["-q", "model", "check", "-"], ["model", "check", "-", "--quiet"]] {
        let quiet = given(&arguments, WARNED);
        assert_eq!((quiet.code, quiet.err.as_str()), (Some(0), ""), "{quiet:?}");
        assert_eq!(quiet.out, loud.out, "results stay");
    }
    assert!(loud.out.starts_with("<stdin>: "), "{loud:?}");
    let wrong = given(&["-q", "model", "check", "-"], "Role: a\nLiveness:\na = Stand .\n");
    assert!(wrong.code == Some(3) && wrong.err.contains("error[E0205]"), "{wrong:?}");
    let run = ["run", "config/match.xml", "--seed", "7", "--for", "2s"];
    let (loud, quiet) = (monas(&run), monas(&[&run[..], &["-q"]].concat()));
    assert!(!loud.err.is_empty(), "the run says what happens");
    assert_eq!(quiet.err, "");
    let hash = |answer: &Answer| answer.out.lines().last().map(str::to_owned);
    assert_eq!(hash(&quiet), hash(&loud), "results stay");
}

#[test]
fn a_verbose_command_logs_more_unless_the_environment_chooses() {
    let run = ["run", "config/match.xml", "--seed", "7", "--for", "5s"];
    let usual = monas(&run).err;
    assert!(!usual.contains("INFO"), "{usual}");
    let verbose = monas(&[&["-v"], &run[..]].concat()).err;
    assert!(verbose.contains(" INFO ") && !verbose.contains("DEBUG"), "{verbose}");
    let chosen = command(&[&["-v"], &run[..]].concat()).env("MONAS_LOG", "error").output();
    assert!(!Answer::from(chosen.expect("the command starts")).err.contains("INFO"));
    let both = monas(&["-q", "-v", "explain"]);
    assert_eq!(both.code, Some(2), "{both:?}");
}

#[test]
fn colours_are_used_as_asked() {
    let coloured = |arguments: &[&str]| given(arguments, WARNED).err.contains("\x1b[");
    assert!(!coloured(&["model", "check", "-"]), "not a terminal");
    assert!(coloured(&["--color", "always", "model", "check", "-"]));
    assert!(coloured(&["model", "check", "-", "--color=always"]));
    assert!(!coloured(&["model", "check", "-", "--color", "never"]));
    let help = |colour: &str| monas(&["--color", colour, "run", "--help"]).out.contains("\x1b[");
    assert!(help("always") && !help("never") && !help("auto"));
    let usage = monas(&["--color=always", "fly"]);
    assert!(usage.code == Some(2) && usage.err.contains("\x1b["), "{usage:?}");
    let asked = command(&["--color=always", "fly"]).env("NO_COLOR", "1").output().expect("it starts");
    assert!(Answer::from(asked).err.contains("\x1b["), "the option has precedence");
    assert_eq!(monas(&["--color", "blue", "explain"]).code, Some(2));
}

#[test]
fn models_configurations_and_scenarios_are_read_from_standard_input() {
    let wrong = given(&["model", "check", "-"], "Role: a\nLiveness:\na = Stand .\n");
    assert!(wrong.err.contains("--> <stdin>:3:11"), "{wrong:?}");
    let svg = given(&["model", "draw", "-"], WARNED);
    assert!(svg.code == Some(0) && svg.out.starts_with("<svg"), "{svg:?}");
    let role = given(&["model", "convert", "-", "-", "--as", "xmi"], "Role: a\nLiveness:\na = Stand\n");
    assert!(role.out.contains("liveness="), "{role:?}");
    let checked = given(&["config", "check", "-"], AGENT);
    assert_eq!(checked.code, Some(0), "{checked:?}");
    let toml = "[[agent]]\nname = \"A\"\nfrequency = 10\nactivity = \"Stnd\"\n";
    let checked = given(&["config", "check", "-"], toml);
    assert!(checked.code == Some(3) && checked.err.contains("--> <stdin>:4:"), "{checked:?}");
    let properties = "property \"p\":\n  always in Nowhere\n";
    let checked = given(&["model", "check", "models/goalie.srm", "--properties", "-"], properties);
    assert!(checked.err.contains("--> <stdin>:2:"), "{checked:?}");
    let scenario = "model models/goalie.srm\n\nstart\n  in Nowhere\n";
    let played = given(&["model", "run", "models/goalie.srm", "-"], scenario);
    assert!(played.err.contains("--> <stdin>:4:"), "{played:?}");
    let empty = given(&["doctor", "-"], "<agnet/>");
    assert!(empty.code == Some(3) && empty.err.contains("--> <stdin>:1:2"), "{empty:?}");
}

#[test]
fn a_match_from_standard_input_is_recorded_and_replayed() {
    let folder = tempfile::tempdir().expect("a folder");
    let tape = folder.path().join("a.mcap").display().to_string();
    let text = fs::read_to_string(crate::kit::root().join("config/match.xml")).expect("it is there");
    let run = given(&["run", "-", "--seed", "7", "--for", "2s", "--record", &tape], &text);
    assert_eq!(run.code, Some(0), "{run:?}");
    let verified = monas(&["tape", "verify", &tape]);
    assert_eq!(verified.code, Some(0), "{verified:?}");
}
