//! `monas run` and `monas config check` with the project's own match, for a few simulated seconds.

use std::fs;
use std::io::{BufRead, BufReader};
use std::process::{Command, Stdio};

use crate::kit::{changed, command, monas};
use serde_json::Value;

const MATCH: &str = "config/match.xml";

fn hash_of(text: &str) -> &str {
    let hash = text.lines().find_map(|line| line.strip_prefix("hash: ")).expect("there is a hash");
    assert!(hash.len() == 64 && hash.chars().all(|c| c.is_ascii_hexdigit()), "{hash}");
    hash
}

#[test]
fn a_short_match_ends_with_its_figures_and_hash() {
    let answer = monas(&["run", MATCH, "--seed", "7", "--for", "5s"]);
    assert_eq!(answer.code, Some(0), "{}", answer.err);
    let figures =
        ["goals", "shots", "saves", "falls", "penalties", "possession", "cycles", "overruns", "micro-steps"];
    for figure in
        figures.into_iter().chain(["activity calls", "simulated seconds per wall second", "messages: "])
    {
        assert!(answer.out.contains(figure), "{figure} is not in\n{}", answer.out);
    }
    assert!(answer.out.contains("Goalie") && answer.out.contains("Attacker"), "{}", answer.out);
    assert!(
        answer.out.trim_end().lines().last().is_some_and(|line| line.starts_with("hash: ")),
        "{}",
        answer.out
    );
    // Without a folder of the system, the run names its control socket first.
    let mut said = answer.err.lines().filter(|line| !line.starts_with("control socket: "));
    assert!(said.next().is_some_and(|line| line.contains("Blue 0 : 0 Red")), "{}", answer.err);
}

#[test]
fn the_seed_decides() {
    let hash = |seed| hash_of(&monas(&["run", MATCH, "--seed", seed, "--for", "2s"]).out).to_owned();
    let first = hash("7");
    assert_eq!(first, hash("7"));
    assert_ne!(first, hash("8"));
}

#[test]
fn json_has_one_object_a_line() {
    let answer = monas(&["run", MATCH, "--for", "2s", "--format", "json"]);
    assert_eq!(answer.code, Some(0), "{}", answer.err);
    let objects: Vec<Value> =
        answer.out.lines().map(|line| serde_json::from_str(line).expect("each line is JSON")).collect();
    let count = |kind: &str| objects.iter().filter(|object| object["kind"] == kind).count();
    assert_eq!((count("team"), count("run")), (2, 1));
    assert!(count("agent") >= 6);
    let run = objects.last().expect("there is a last object");
    assert_eq!((&run["kind"], &run["simulated_seconds"]), (&Value::from("run"), &Value::from(2.0)));
    assert_eq!(run["hash"].as_str().map(str::len), Some(64));
}

#[test]
fn a_recording_is_written_and_changes_nothing() {
    let folder = tempfile::tempdir().expect("a folder");
    let tape = folder.path().join("match.mcap");
    let recorded = monas(&["run", MATCH, "--for", "1s", "--record", &tape.display().to_string()]);
    assert_eq!(recorded.code, Some(0), "{}", recorded.err);
    let bytes = fs::read(&tape).expect("it was written");
    let magic = b"\x89MCAP0\r\n";
    assert!(bytes.starts_with(magic) && bytes.ends_with(magic), "it is a whole MCAP file");
    assert_eq!(hash_of(&recorded.out), hash_of(&monas(&["run", MATCH, "--for", "1s"]).out));
}

#[test]
fn a_recording_that_cannot_be_written_is_a_failure() {
    let answer = monas(&["run", MATCH, "--for", "1s", "--record", "nowhere/match.mcap"]);
    assert_eq!(answer.code, Some(1), "{}", answer.err);
    assert!(answer.err.contains("nowhere/match.mcap"), "{}", answer.err);
}

#[test]
#[cfg(unix)]
fn an_interrupted_match_ends_with_its_figures_so_far() {
    let mut child = command(&["run", MATCH, "--pace", "1"])
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .expect("the command starts");
    let mut first_line = String::new();
    let mut err = BufReader::new(child.stderr.take().expect("it is piped"));
    err.read_line(&mut first_line).expect("it says something");
    let killed =
        Command::new("kill").args(["-INT", &child.id().to_string()]).status().expect("there is a kill");
    assert!(killed.success());
    let answer: crate::kit::Answer = child.wait_with_output().expect("it ends").into();
    assert_eq!(answer.code, Some(130), "{answer:?}");
    assert!(answer.out.contains("possession"), "{answer:?}");
    hash_of(&answer.out);
}

#[test]
fn the_projects_match_is_without_findings() {
    let answer = monas(&["config", "check", MATCH]);
    assert_eq!(
        (answer.code, answer.out.as_str()),
        (Some(0), "config/match.xml: no errors\n"),
        "{}",
        answer.err
    );
}

#[test]
fn each_mistake_is_found_before_anything_runs() {
    let cases = [
        (MATCH, "half=", "hlaf=", "`half`"),
        (MATCH, "roles/goalie.xml", "roles/golie.xml", "goalie.xml"),
        ("config/roles/goalie.xml", "priority", "pirority", "`priority`"),
        ("config/roles/attacker.xml", "models/attacker.srm", "models/atacker.srm", "attacker.srm"),
        ("models/attacker.srm", "( WalkTowardsBall", "( WalkTowardBall", "`WalkTowardsBall`"),
        ("models/attacker.srm", "kickBall = LeftKick", "kickBall = player", "`player`"),
        (
            "models/goalie.srm",
            "CONDITION -> search : [!Ball.found]",
            "CONDITION -> search : [!Ball.fuond]",
            "`found`",
        ),
        (
            "models/goalie.srm",
            "CONDITION -> search : [!Ball.found]",
            "CONDITION -> search : [!(Ball.found]",
            "`)`",
        ),
    ];
    for (file, text, replacement, hint) in cases {
        let (folder, line) = changed(file, text, replacement);
        let config = folder.path().join(MATCH).display().to_string();
        for arguments in [&["run", &config][..], &["config", "check", &config]] {
            let answer = monas(arguments);
            assert_eq!((answer.code, answer.out.as_str()), (Some(3), ""), "{replacement}: {answer:?}");
            for part in [&format!("{file}:{line}:"), hint] {
                assert!(answer.err.contains(part), "{replacement}: no {part} in\n{}", answer.err);
            }
        }
    }
}

#[test]
fn unreachable_sources_are_found_before_the_run() {
    let guard = "CONDITION -> search : [!Ball.found]";
    for (other, said) in [
        ("CONDITION -> search : [!striker.ball.State.Ball.found]", ["E0320", "host `striker`"]),
        ("CONDITION -> search : [!Visoin.Ball.found]", ["E0321", "`Goalie`"]),
    ] {
        let (folder, _) = changed("models/goalie.srm", guard, other);
        for config in [MATCH, "config/roles/goalie.xml"] {
            let config = folder.path().join(config).display().to_string();
            for arguments in [&["run", &config, "--for", "1s"][..], &["config", "check", &config]] {
                let answer = monas(arguments);
                assert_eq!((answer.code, answer.out.as_str()), (Some(3), ""), "{arguments:?}: {answer:?}");
                for part in said {
                    assert!(answer.err.contains(part), "{arguments:?}: no {part} in\n{}", answer.err);
                }
            }
        }
    }
}

#[test]
fn a_missing_configuration_is_named() {
    let answer = monas(&["run", "config/mtach.xml"]);
    assert_eq!(answer.code, Some(3));
    assert!(answer.err.contains("config/mtach.xml") && answer.err.contains("match.xml"), "{}", answer.err);
}

#[test]
fn agents_without_a_match_run_in_real_time() {
    let answer = monas(&["run", "config/roles/goalie.xml", "--for", "300ms"]);
    assert_eq!(answer.code, Some(0), "{}", answer.err);
    assert!(answer.out.contains("Goalie") && answer.out.contains("mean cycle"), "{}", answer.out);

    let answer = monas(&["run", "config/roles/goalie.xml", "--for", "300ms", "--format", "json"]);
    let agent: Value = serde_json::from_str(&answer.out).expect("one object");
    assert_eq!(
        (&agent["kind"], &agent["agent"], &agent["stopped"]),
        (&"agent".into(), &"Goalie".into(), &Value::Null)
    );
    assert!(agent["cycles"].as_u64().is_some_and(|cycles| cycles >= 3), "{agent}");
}

#[test]
fn a_seed_is_refused_where_time_is_real() {
    let answer = monas(&["run", "config/roles/goalie.xml", "--seed", "7"]);
    assert_eq!(answer.code, Some(2));
    assert!(answer.err.contains("--seed is for simulated time"), "{}", answer.err);
}

#[test]
fn two_mistakes_in_two_files_are_two_diagnostics() {
    let (folder, _) = changed(MATCH, "half=", "hlaf=");
    let role = folder.path().join("config/roles/goalie.xml");
    let text = fs::read_to_string(&role).expect("the role is there");
    fs::write(&role, text.replacen("priority", "pirority", 1)).expect("the folder takes files");
    let config = folder.path().join(MATCH).display().to_string();
    let answer = monas(&["config", "check", &config, "--format", "json"]);
    assert_eq!((answer.code, answer.err.lines().count()), (Some(3), 2), "{}", answer.err);
    assert!(answer.err.contains("`hlaf`") && answer.err.contains("`pirority`"), "{}", answer.err);
}

#[test]
fn a_pace_holds_a_match_back() {
    let answer = monas(&["run", MATCH, "--for", "300ms", "--pace", "1", "--format", "json"]);
    let run: Value =
        answer.out.lines().last().and_then(|line| serde_json::from_str(line).ok()).expect("the run");
    assert_eq!(run["simulated_seconds"], 0.3);
    assert!(run["wall_seconds"].as_f64().is_some_and(|wall| wall >= 0.3), "{run}");
}

/// Bodies and agents have threads of their own; no body drifts from the clock, and a command
/// reaches it in the cycle after the sensing that it is based on.
#[test]
#[cfg(feature = "soccer")]
fn in_real_time_bodies_keep_their_cycles_and_receive_commands_in_the_next() {
    for (config, periods) in
        [("config/match.xml", [0.02; 6]), ("config/nao_sim.xml", [0.012, 0.012, 0.012, 0.02, 0.02, 0.02])]
    {
        let answer = monas(&["run", config, "--realtime", "--for", "4s", "--no-control", "--format", "json"]);
        assert_eq!(answer.code, Some(0), "{}", answer.err);
        let objects: Vec<Value> =
            answer.out.lines().map(|line| serde_json::from_str(line).expect("JSON")).collect();
        let of_kind = |kind: &'static str| objects.iter().filter(move |object| object["kind"] == kind);
        let run = of_kind("run").next().expect("the run");
        assert!(
            run["hash"].is_null() && run["simulated_seconds"].as_f64().is_some_and(|s| s >= 4.0),
            "{run}"
        );
        let bodies: Vec<&Value> = of_kind("body").collect();
        assert_eq!(bodies.len(), 6, "{}", answer.out);
        for (body, period) in bodies.into_iter().zip(periods) {
            assert_eq!((body["period_seconds"].as_f64(), body["failures"].as_u64()), (Some(period), Some(0)));
            let cycles = body["cycles"].as_f64().expect("a number");
            assert!(cycles >= 4.0 / period - 1.0, "{config}: {body}");
            let delay = body["sense_to_act_p50_seconds"].as_f64().expect("the robots move");
            assert!(delay < 1.5 * period, "{config}: {body}");
        }
        let moved =
            |agent: &Value| agent["micro_steps"].as_u64() > Some(0) && agent["core_share"].is_number();
        assert!(of_kind("agent").all(moved), "{}", answer.out);
    }
}

#[test]
#[cfg(feature = "soccer")]
fn the_field_is_shown_as_text_that_fits_a_small_terminal() {
    let run = ["run", "config/match.xml", "--seed", "7", "--for", "3s", "--no-control"];
    let (shown, usual) = (monas(&[&run[..], &["--field"]].concat()), monas(&run));
    assert_eq!(hash_of(&shown.out), hash_of(&usual.out), "looking changes nothing");
    let lines: Vec<&str> = shown.err.lines().collect();
    assert_eq!(lines.len(), 4 * 23, "a picture a second: {}", shown.err);
    assert!(lines.iter().all(|line| line.chars().count() <= 80), "{}", shown.err);
    assert!(lines[23].starts_with("  0:01  Blue 0 : 0 Red"), "{}", lines[23]);
    assert_eq!(shown.err.matches("b1").count(), 4, "{}", shown.err);
}
