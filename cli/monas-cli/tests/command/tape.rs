//! `monas tape` with recordings of the project's own match.

use std::fs;
use std::io::{BufRead, BufReader};
use std::path::{Path, PathBuf};
use std::process::Stdio;
use std::sync::LazyLock;

use serde_json::Value;

use crate::kit::{Answer, changed, command, monas, root};

const MATCH: &str = "config/match.xml";

/// A folder with the first seconds of a match on tape.
struct Recorded {
    folder: tempfile::TempDir,
}

/// Recorded once, since it is only read.
static RECORDED: LazyLock<Recorded> = LazyLock::new(|| {
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("match.mcap");
    let answer = monas(&["run", MATCH, "--seed", "7", "--for", "25s", "--record", &text(&path)]);
    assert_eq!(answer.code, Some(0), "{}", answer.err);
    Recorded { folder }
});

fn tape() -> String {
    text(&RECORDED.folder.path().join("match.mcap"))
}

fn text(path: &Path) -> String {
    path.display().to_string()
}

#[test]
fn an_output_that_is_the_tape_and_moments_outside_of_it_are_refused() {
    let tape = tape();
    let before = fs::read(&tape).expect("the tape");
    for command in [
        &["export", &tape, "-o", &tape][..],
        &["cut", &tape, "--to", "1s", "-o", &tape],
        &["merge", &tape, &tape, "-o", &tape],
    ] {
        let refused = monas(&[&["tape"], command].concat());
        assert_eq!(refused.code, Some(2), "{refused:?}");
        assert!(refused.err.contains("is the tape itself: name another file"), "{refused:?}");
    }
    assert!(fs::read(&tape).expect("the tape") == before);
    for command in [
        &["run", MATCH, "--for", "1s", "--record", "-"][..],
        &["tape", "cut", &tape, "-o", "-"],
        &["tape", "merge", &tape, &tape, "-o", "-"],
        &["tape", "recover", &tape, "-o", "-"],
    ] {
        let to_output = monas(command);
        assert_eq!((to_output.code, to_output.out.as_str()), (Some(2), ""), "{to_output:?}");
        assert!(to_output.err.contains("standard output has the results: name a file"), "{to_output:?}");
    }
    for command in [&["cut", &tape, "-o", "late.mcap"][..], &["export", &tape]] {
        let late = monas(&[&["tape"], command, &["--from", "100s"]].concat());
        assert_eq!(late.code, Some(2), "{late:?}");
        assert!(late.err.contains("--from is 100.000 s, and the tape ends at 25.000 s"), "{late:?}");
    }
    let rows = |more: &[&str]| {
        done(&[&["tape", "export", &tape, "--topic", "sim/score", "--format", "csv"], more].concat()).out
    };
    assert_eq!(rows(&["-o", "-"]), rows(&[]));
    let what_if = |times: &[&str]| {
        let change = ["--set", "agent.Goalie.frequency=50"];
        monas(&[&["tape", "what-if", &tape], times, &change].concat())
    };
    let late = what_if(&["--at", "100s"]);
    assert_eq!(late.code, Some(2), "{late:?}");
    assert!(late.err.contains("--at is 100.000 s, and the tape ends at 25.000 s"), "{late:?}");
    let short = what_if(&["--at", "5s", "--for", "1s"]);
    assert_eq!(short.code, Some(2), "{short:?}");
    assert!(short.err.contains("--for is a time of the match, which is before --at"), "{short:?}");
}

#[test]
fn the_end_of_a_comparison_is_not_a_difference() {
    let whole = tape();
    let folder = tempfile::tempdir().expect("a folder");
    let part = text(&folder.path().join("part.mcap"));
    done(&["tape", "cut", &whole, "--to", "5s", "-o", &part]);
    let kept = text(&folder.path().join("kept.mcap"));
    let what_if = |tape: &str, more: &[&str]| {
        let change = ["--at", "3s", "--set", "agent.Goalie.frequency=50"];
        done(&[&["tape", "what-if", tape], &change[..], more].concat()).out
    };
    // sim/truth is published at whole seconds, and 25 s is the end of the run.
    for (tape, more, end) in [
        (&whole, &["--for", "4s"][..], 4.0),
        (&whole, &["--for", "26s", "-o", &kept], 25.0),
        (&part, &[], 4.98),
        (&kept, &[], 26.0),
    ] {
        let answer = what_if(tape, more);
        assert!(answer.contains(&format!("no message differs up to {end:.3} s")), "{more:?}: {answer}");
    }
}

#[test]
fn a_tape_is_verified_as_a_whole_and_its_log_is_read() {
    let answer = done(&["tape", "verify", &tape(), "--format", "json"]);
    let replayed = done(&["tape", "replay", &tape(), "--verify", "--format", "json"]);
    let tallies = |answer: &Answer| {
        let tallies = objects(&answer.out).into_iter().filter(|object| object["kind"] == "tally");
        tallies.collect::<Vec<_>>()
    };
    assert!(tallies(&answer).len() > 20, "{}", answer.out);
    assert_eq!(tallies(&answer), tallies(&replayed));

    let all = objects(&done(&["log", &tape(), "--format", "json"]).out);
    assert!(!all.is_empty());
    let lines = |more: &[&str]| {
        let tape = tape();
        let arguments = [&["log", tape.as_str(), "--format", "json"], more].concat();
        objects(&done(&arguments).out)
    };
    let few = lines(&["--robot", "blue-1", "--agent", "Goalie", "--count", "1"]);
    assert_eq!(few.len(), 1);
    assert_eq!((&few[0]["robot"], &few[0]["agent"]), (&"blue-1".into(), &"Goalie".into()));
    let unknown = monas(&["log", &tape(), "--robot", "blue-1", "--robot", "blu-2"]);
    let expected = "the tape has no robot `blu-2`; did you mean `blue-2`?";
    assert!(unknown.code == Some(2) && unknown.err.contains(expected), "{unknown:?}");
    let unknown = monas(&["log", &tape(), "--agent", "Goalie", "--agent", "Gaolie"]);
    let expected = "the tape has no agent `Gaolie`; did you mean `Goalie`?";
    assert!(unknown.code == Some(2) && unknown.err.contains(expected), "{unknown:?}");
    assert!(lines(&["--level", "warning"]).len() < all.len());
    let text = done(&["log", &tape(), "--robot", "blue-1", "--count", "1"]).out;
    assert!(text.contains(" s ") && text.contains(" blue-1 Goalie"), "{text}");
}

/// The output of a command that succeeds.
fn done(arguments: &[&str]) -> Answer {
    let answer = monas(arguments);
    assert_eq!(answer.code, Some(0), "{arguments:?}: {answer:?}");
    answer
}

fn objects(text: &str) -> Vec<Value> {
    text.lines().map(|line| serde_json::from_str(line).expect("each line is JSON")).collect()
}

/// A file that does not exist, in a new folder.
fn fresh(name: &str) -> (tempfile::TempDir, PathBuf) {
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join(name);
    (folder, path)
}

#[test]
fn info_reports_run_files_and_channels() {
    let answer = done(&["tape", "info", &tape()]);
    for part in [
        "finished",
        "seed                7",
        "time                simulated",
        "robots              blue-1 blue-2 blue-3 red-1 red-2 red-3",
        "configuration       config/match.xml",
        "configuration hash  ",
        "models/goalie.srm",
        "config/roles/attacker.xml",
        "monas/cycle",
        "monas/chart",
        "field",
        "body/sensors",
    ] {
        assert!(answer.out.contains(part), "no {part} in\n{}", answer.out);
    }
    let objects = objects(&done(&["tape", "info", &tape(), "--format", "json"]).out);
    let of = |kind: &str| objects.iter().filter(|object| object["kind"] == kind).collect::<Vec<_>>();
    assert_eq!((of("tape")[0]["finished"].as_bool(), of("file").len()), (Some(true), 7));
    let messages: u64 = of("channel").iter().filter_map(|channel| channel["messages"].as_u64()).sum();
    assert_eq!(of("tape")[0]["messages"].as_u64(), Some(messages));
    let hash = of("facts")[0]["entries"]["configuration_hash"].as_str().expect("a hash").to_owned();
    assert!(hash.len() == 64 && hash.chars().all(|c| c.is_ascii_hexdigit()), "{hash}");
}

#[test]
fn every_agent_of_a_match_does_again_what_it_did() {
    let answer = done(&["tape", "replay", &tape(), "--verify", "--format", "json"]);
    let objects = objects(&answer.out);
    let last = objects.last().expect("a summary");
    assert_eq!((&last["kind"], &last["differences"]), (&"replay".into(), &0.into()), "{}", answer.out);
    // Everything that agents published was compared: as many messages of each topic and agent as
    // are on the tape.
    let tallies: Vec<_> = objects.iter().filter(|object| object["kind"] == "tally").collect();
    let info = done(&["tape", "info", &tape(), "--format", "json"]).out;
    let channels = self::objects(&info);
    let recorded =
        channels.iter().filter(|one| ["Goalie", "Attacker"].map(Value::from).contains(&one["publisher"]));
    let mut compared = 0;
    for channel in recorded {
        let tally = tallies.iter().find(|tally| {
            ["host", "topic"].iter().all(|key| tally[key] == channel[key])
                && tally["agent"] == channel["publisher"]
        });
        let tally = tally.unwrap_or_else(|| panic!("{channel} was not compared"));
        assert_eq!(tally["compared"], channel["messages"], "{channel}");
        compared += tally["compared"].as_u64().unwrap_or_default();
    }
    assert_eq!(last["compared"].as_u64(), Some(compared));
    assert!(compared > 10_000, "{compared}");
}

#[test]
fn some_agents_are_replayed_without_the_others() {
    let answer = done(&["tape", "replay", &tape(), "--agents", "goalie", "--verify"]);
    assert!(
        answer.out.contains("25.0 s of 2 agents replayed") && answer.out.contains(" 0 differences"),
        "{}",
        answer.out
    );
    let answer = done(&["tape", "replay", &tape(), "--agents", "blue-2/attacker,red-1", "--verify"]);
    assert!(answer.out.contains("25.0 s of 2 agents replayed"), "{}", answer.out);
    for (agent, hint) in [("goali", "did you mean `Goalie`?"), ("Nope", "it has Attacker, Goalie")] {
        let answer = monas(&["tape", "replay", &tape(), "--agents", agent]);
        assert_eq!(answer.code, Some(2), "{answer:?}");
        assert!(answer.err.contains(&format!("no agent `{agent}`; {hint}")), "{}", answer.err);
    }
}

#[test]
fn a_changed_threshold_shows_as_the_first_message_that_differs() {
    let (folder, _) = changed("models/attacker.srm", "kick_x = 0.15", "kick_x = 0.60");
    let config = text(&folder.path().join(MATCH));
    let replay = ["tape", "replay", &tape(), "--config", &config];
    let answer = monas(&[&replay[..], &["--verify"]].concat());
    assert_eq!(answer.code, Some(5), "{answer:?}");
    let first = answer.out.lines().next().expect("a line");
    assert!(first.starts_with("first difference: ") && first.contains("/Attacker, cycle "), "{first}");
    assert!(answer.out.contains("recorded") && answer.out.contains("replayed"), "{}", answer.out);
    assert!(!answer.out.contains("Goalie"), "the goalies have not changed: {}", answer.out);

    let answer = done(&[&replay[..], &["--format", "json"]].concat());
    let first = &objects(&answer.out)[0];
    assert_eq!((&first["kind"], &first["agent"]), (&"difference".into(), &"Attacker".into()));
    for key in ["host", "cycle", "topic", "seconds", "what"] {
        assert!(!first[key].is_null(), "{key}: {first}");
    }
    assert!(first["fields"].as_array().is_some_and(|fields| !fields.is_empty()), "{first}");
}

#[cfg(unix)]
#[test]
fn a_replay_is_viewed_in_the_studio() {
    let (folder, _) = changed("models/attacker.srm", "kick_x = 0.15", "kick_x = 0.60");
    let config = text(&folder.path().join(MATCH));
    let replay = ["tape", "replay", &tape(), "--config", &config, "--verify", "--studio"];
    let viewed = crate::running::Running::start(folder.path(), &replay, "studio: http://127.0.0.1:");
    let answer = viewed.interrupt();
    assert_eq!(answer.code, Some(5), "{answer:?}");
    assert!(answer.out.contains("first difference: "), "{answer:?}");
    let refused = monas(&["tape", "replay", &tape(), "--listen", "127.0.0.1:0"]);
    assert!(refused.code == Some(2) && refused.err.contains("add --studio"), "{}", refused.err);
}

#[test]
fn an_impossible_replay_has_a_reason() {
    let (_folder, part) = fresh("part.mcap");
    done(&["tape", "cut", &tape(), "--from", "5s", "-o", &text(&part)]);
    let answer = monas(&["tape", "replay", &text(&part)]);
    assert_eq!(answer.code, Some(1));
    assert!(answer.err.contains("part.mcap: the tape starts after its run"), "{}", answer.err);
    let config = part.with_file_name("lights.xml");
    let agents = "<agent frequency=\"5\"><name>Goalie</name><activity>LedHandler</activity></agent>";
    fs::write(&config, agents).expect("the folder takes files");
    for agents in [&[][..], &["--agents", "Goalie"]] {
        let answer = monas(&[&["tape", "replay", &tape(), "--config", &text(&config)], agents].concat());
        assert_eq!(answer.code, Some(2), "{answer:?}");
        let expected = format!("the tape has no robot `local` of {}; it has blue-1, ", text(&config));
        assert!(answer.err.contains(&expected), "{}", answer.err);
    }
}

#[test]
fn a_part_of_a_tape_explains_what_was_active_before_it() {
    let (_folder, part) = fresh("part.mcap");
    done(&["tape", "cut", &tape(), "--from", "14s", "-o", &text(&part)]);
    let why = |tape: &str| done(&["why", tape, "blue-2", "--state", "active", "--at", "15"]).out;
    let whole = why(&tape());
    assert!(whole.starts_with("blue-2 Attacker was in active at 15.000 s, since 0."), "{whole}");
    let expected = "was in active at 15.000 s, since an earlier time; its steps are on the tape from 14.";
    assert!(why(&text(&part)).contains(expected), "{}", why(&text(&part)));
}

#[test]
fn a_part_of_a_tape_does_not_claim_what_never_happened_before_it() {
    let (_folder, part) = fresh("part.mcap");
    done(&["tape", "cut", &tape(), "--from", "10s", "-o", &text(&part)]);
    let why = |tape: &str, transition: &str| {
        done(&["why", tape, "blue-2", "--transition", transition, "--at", "10.05"]).out
    };
    let vision = why(&text(&part), "Vision -> Vision");
    for expected in [
        "vision_timeout: timer, started before the tape, if at all",
        "GameState.player_state: what was delivered on soccer/game_state is not on the tape",
    ] {
        assert!(vision.contains(expected), "{vision}");
    }
    let left = why(&text(&part), "initialize -> active");
    let expected = "fired last before the tape, if at all, fires next after the tape, if at all\n";
    assert!(left.contains(expected), "{left}");
    let whole = why(&tape(), "1");
    assert!(whole.contains("fired last never, fires next after the tape, if at all\n"), "{whole}");
}

/// A short run in real time.
fn live(folder: &Path) -> String {
    let live = text(&folder.join("live.mcap"));
    done(&["run", "config/roles/goalie.xml", "--for", "300ms", "--record", &live]);
    live
}

#[test]
fn real_time_recordings_are_replayed() {
    let folder = tempfile::tempdir().expect("a folder");
    let live = live(folder.path());
    let info = done(&["tape", "info", &live]);
    assert!(info.out.contains("time                real") && info.out.contains("dropped  0"), "{}", info.out);
    let replayed = objects(&done(&["tape", "replay", &live, "--verify", "--format", "json"]).out);
    let last = replayed.last().expect("a summary");
    assert_eq!(last["differences"], 0, "{replayed:?}");
    assert!(last["compared"].as_u64().is_some_and(|compared| compared > 20), "{last}");
    assert!(last["recorded_seconds"].as_f64().is_some_and(|seconds| seconds >= 0.3), "{last}");
    assert_eq!(last["simulated_seconds"], Value::Null, "nothing was simulated");

    let (changed, _) = changed("models/goalie.srm", "motion_timeout, 100ms", "motion_timeout, 20ms");
    let config = text(&changed.path().join("config/roles/goalie.xml"));
    let answer = monas(&["tape", "replay", &live, "--verify", "--config", &config]);
    assert_eq!(answer.code, Some(5), "{answer:?}");
    assert!(answer.out.contains("first difference: local/Goalie, cycle "), "{}", answer.out);
}

/// The threads of an agent publish under one name, some on the same topics.
#[test]
fn an_agent_with_several_threads_is_replayed_thread_by_thread() {
    let folder = tempfile::tempdir().expect("a folder");
    let (config, live) = (folder.path().join("agents.xml"), text(&folder.path().join("live.mcap")));
    let models = text(&root().join("models"));
    let agent = format!(
        "<agent frequency='100'><name>Player</name><activity>LedHandler</activity>\
         <statechart>{models}/goalie.srm</statechart><statechart>{models}/attacker.srm</statechart></agent>"
    );
    fs::write(&config, agent).expect("a file");
    done(&["run", &text(&config), "--for", "300ms", "--record", &live]);
    let info = done(&["tape", "info", &live]).out;
    assert!(["Player ", "Player #2 ", "Player #3 "].iter().all(|part| info.contains(part)), "{info}");
    let replayed = objects(&done(&["tape", "replay", &live, "--verify", "--format", "json"]).out);
    let last = replayed.last().expect("a summary");
    assert_eq!(last["differences"], 0, "{replayed:?}");
    assert!(last["compared"].as_u64().is_some_and(|compared| compared > 50), "{last}");
}

/// A model that a configuration names by its absolute path is on the tape and is replayed, with the
/// settings of the run.
#[test]
fn a_replay_needs_neither_the_place_nor_the_settings_of_its_run() {
    let folder = tempfile::tempdir().expect("a folder");
    let model = folder.path().join("elsewhere/goalie.srm");
    fs::create_dir(folder.path().join("elsewhere")).expect("a folder");
    let role = fs::read_to_string(root().join("models/goalie.srm")).expect("the model");
    fs::write(&model, &role).expect("a file");
    let agents = fs::read_to_string(root().join("config/roles/goalie.xml")).expect("the agents");
    assert!(agents.contains("models/goalie.srm"), "{agents}");
    let (config, live) = (folder.path().join("agents.xml"), text(&folder.path().join("live.mcap")));
    fs::write(&config, agents.replace("models/goalie.srm", &text(&model))).expect("a file");
    let slower = ["--set", "agent.Goalie.stats_cycle=3"];
    done(&[&["run", &text(&config), "--for", "300ms", "--record", &live], &slower[..]].concat());
    let info = done(&["tape", "info", &live]);
    assert!(info.out.contains("agent.Goalie.stats_cycle=3"), "{}", info.out);

    fs::write(&model, role.replace("motion_timeout, 100ms", "motion_timeout, 20ms")).expect("a file");
    let answer = done(&["tape", "replay", &live, "--verify"]);
    assert!(answer.out.contains(" 0 differences"), "{}", answer.out);
    fs::remove_dir_all(folder.path().join("elsewhere")).expect("it is there");
    done(&["tape", "replay", &live, "--verify"]);
}

#[test]
fn a_part_of_what_was_recorded_in_real_time_is_refused() {
    let folder = tempfile::tempdir().expect("a folder");
    let (live, part) = (live(folder.path()), text(&folder.path().join("part.mcap")));
    done(&["tape", "cut", &live, "--topic", "monas/**", "-o", &part]);
    let answer = monas(&["tape", "replay", &part]);
    assert_eq!(answer.code, Some(1), "{answer:?}");
    assert!(answer.err.contains("the recording lacks messages of `local`"), "{}", answer.err);
}

#[test]
fn a_part_from_the_beginning_is_replayed_as_far_as_it_goes() {
    let (_folder, part) = fresh("part.mcap");
    done(&["tape", "cut", &tape(), "--to", "5.003s", "-o", &text(&part)]);
    let answer = done(&["tape", "replay", &text(&part), "--verify"]);
    assert!(answer.out.contains(" 0 differences"), "{}", answer.out);
}

#[test]
fn messages_become_json_and_tables() {
    let select = ["--topic", "soccer/ball", "--host", "blue-1"];
    let json = done(&[&["tape", "export", &tape()], &select[..]].concat()).out;
    let objects = objects(&json);
    assert!(!objects.is_empty());
    for (number, object) in (1..).zip(&objects) {
        assert_eq!((&object["topic"], &object["sequence"]), (&"soccer/ball".into(), &Value::from(number)));
        assert!(object["message"]["found"].is_boolean(), "{object}");
    }
    let csv = done(&[&["tape", "export", &tape(), "--format", "csv"], &select[..]].concat()).out;
    let mut lines = csv.lines();
    let header: Vec<&str> = lines.next().expect("a header").split(',').collect();
    assert_eq!(header[..5], ["seconds", "host", "publisher", "topic", "sequence"]);
    let found = header.iter().position(|column| *column == "found").expect("a column for the field");
    let cells: Vec<&str> = lines.clone().map(|line| line.split(',').nth(found).expect("a cell")).collect();
    let expected: Vec<String> = objects.iter().map(|object| object["message"]["found"].to_string()).collect();
    assert_eq!(cells, expected);

    let answer = monas(&["tape", "export", &tape(), "--topic", "soccer/bal"]);
    assert_eq!(answer.code, Some(2));
    assert!(answer.err.contains("no topic `soccer/bal`; did you mean `soccer/ball`?"), "{}", answer.err);
}

#[test]
#[cfg(target_os = "linux")]
fn an_export_to_a_full_disk_names_the_file() {
    for format in ["csv", "jsonl"] {
        let answer = monas(&["tape", "export", &tape(), "--format", format, "-o", "/dev/full"]);
        assert_eq!(answer.code, Some(1), "{answer:?}");
        let expected = "error: cannot write /dev/full: No space left on device";
        assert!(answer.err.starts_with(expected), "{}", answer.err);
    }
}

#[test]
fn parts_of_a_match_that_overlap_are_merged_to_the_match() {
    let (folder, first) = fresh("first.mcap");
    let (rest, whole) = (folder.path().join("rest.mcap"), folder.path().join("whole.mcap"));
    done(&["tape", "cut", &tape(), "--to", "5s", "-o", &text(&first)]);
    done(&["tape", "cut", &tape(), "--from", "3s", "-o", &text(&rest)]);
    done(&["tape", "merge", &text(&first), &text(&rest), "-o", &text(&whole)]);
    let export = |path: &str| done(&["tape", "export", path]).out;
    assert!(export(&text(&whole)) == export(&tape()));
    let answer = done(&["tape", "verify", &text(&whole)]);
    assert!(answer.out.contains(" 0 differences"), "{}", answer.out);
}

#[test]
fn a_match_cut_by_hosts_and_merged_again_is_the_match() {
    let (folder, first) = fresh("first.mcap");
    let (rest, whole) = (folder.path().join("rest.mcap"), folder.path().join("whole.mcap"));
    let hosts = ["blue-1", "blue-2", "blue-3", "red-1", "red-2", "red-3", "field"];
    let cut = |hosts: &[&str], to: &Path| {
        let (from, to) = (tape(), text(to));
        let mut arguments = vec!["tape", "cut", &from, "-o", &to];
        arguments.extend(hosts.iter().flat_map(|host| ["--host", host]));
        done(&arguments);
    };
    cut(&hosts[..3], &first);
    cut(&hosts[3..], &rest);
    done(&["tape", "merge", &text(&first), &text(&rest), "-o", &text(&whole)]);
    // The order within a moment may differ, but not that of one host's messages.
    for host in ["blue-1", "field"] {
        let export = |path: &str| done(&["tape", "export", path, "--host", host]).out;
        assert!(export(&text(&whole)) == export(&tape()), "{host}");
    }
    let answer = done(&["tape", "replay", &text(&whole), "--verify"]);
    assert!(answer.out.contains(" 0 differences"), "{}", answer.out);
}

#[test]
#[cfg(unix)]
fn the_tape_of_a_killed_match_is_recovered_and_replayed() {
    let (_folder, path) = fresh("killed.mcap");
    let file = text(&path);
    let mut child = command(&["run", MATCH, "--seed", "7", "--record", &file])
        .stdout(Stdio::null())
        .stderr(Stdio::piped())
        .spawn()
        .expect("the command starts");
    let mut err = BufReader::new(child.stderr.take().expect("it is piped")).lines();
    // After the third event much of the match has been played.
    assert_eq!(err.by_ref().take(4).count(), 4);
    child.kill().expect("it runs");
    child.wait().expect("it ends");
    drop(err);
    let info = done(&["tape", "info", &file]);
    assert!(info.out.contains("truncated: `monas tape recover` repairs it"), "{}", info.out);
    let answer = done(&["tape", "recover", &file]);
    assert!(answer.out.contains("recovered"), "{}", answer.out);
    let info = done(&["tape", "info", &file]);
    assert!(info.out.contains("finished"), "{}", info.out);
    let answer = done(&["tape", "replay", &file, "--agents", "goalie", "--verify"]);
    assert!(answer.out.contains(" 0 differences"), "{}", answer.out);
    let answer = done(&["tape", "recover", &file]);
    assert!(answer.out.contains("already complete"), "{}", answer.out);
}

#[test]
fn files_that_are_no_tape_are_named() {
    let (_folder, path) = fresh("text.mcap");
    fs::write(&path, "no tape").expect("the folder takes files");
    for verb in ["info", "recover", "export", "replay"] {
        let answer = monas(&["tape", verb, &text(&path)]);
        assert_eq!(answer.code, Some(1), "{verb}");
        assert!(answer.err.contains("does not begin as an MCAP file"), "{verb}: {}", answer.err);
        let answer = monas(&["tape", verb, "nowhere.mcap"]);
        assert_eq!(answer.code, Some(1), "{verb}");
        assert!(answer.err.contains("nowhere.mcap"), "{verb}: {}", answer.err);
    }
}

#[test]
#[cfg(feature = "soccer")]
fn the_field_of_a_match_is_drawn_at_a_time_and_as_an_animation() {
    let (folder, path) = fresh("field.svg");
    let still = done(&["tape", "draw", &tape(), "--at", "14s", "-o", &text(&path)]);
    assert_eq!((still.out.as_str(), still.err.as_str()), ("", ""));
    let still = fs::read_to_string(&path).expect("it is written");
    assert!(still.starts_with("<svg") && still.contains("14 s · half 1, playing"), "{still}");
    assert!(still.contains(">Blue</text>") && still.contains(">Red</text>") && still.contains("0 : 0"));
    assert_eq!(still.matches("font-size=\"13\" font-weight=\"700\"").count(), 6, "each robot has its number");
    assert!(still.contains("stroke=\"#a9c8ff\" opacity=\"0.6\""), "a robot sees the ball: {still}");
    assert!(!still.contains("<animate"));
    let moving = done(&["tape", "draw", &tape(), "--from", "10s", "--to", "20s"]).out;
    assert!(moving.contains("<animateTransform") && moving.contains("dur=\"10s\""), "{moving}");
    assert!(moving.len() < 300_000, "{}", moving.len());
    let part = text(&folder.path().join("part.mcap"));
    done(&["tape", "cut", &tape(), "--from", "10s", "--to", "20s", "-o", &part]);
    let of_part = done(&["tape", "draw", &part, "--at", "14s"]).out;
    assert_eq!(of_part.matches("<circle r=\"5\"").count(), 1, "a part of a tape is drawn, too");
}

#[test]
#[cfg(feature = "soccer")]
fn what_cannot_be_drawn_is_said() {
    let said = |arguments: &[&str]| {
        let answer = monas(&[&["tape", "draw"], arguments].concat());
        (answer.code, answer.err)
    };
    let (code, err) = said(&[&tape(), "--at", "500s"]);
    let expected = "error: 500 s is outside of the tape, which shows the field from 0 s to 24.9 s\n";
    assert_eq!((code, err.as_str()), (Some(1), expected));
    assert_eq!(said(&[&tape(), "--from", "5s", "--to", "5s"]).0, Some(2));
    assert_eq!(said(&[&tape(), "--from", "5s", "--to", "9s", "--every", "1ns"]).0, Some(2));
    assert_eq!(said(&[&tape()]).0, Some(2), "no time is given");
    let (folder, path) = fresh("agents.mcap");
    let agents = folder.path().join("agents.xml");
    let agent = "<agent thread_frequency=\"10\"><name>A</name><activity>Stand</activity></agent>";
    fs::write(&agents, agent).expect("the folder takes files");
    done(&["run", &text(&agents), "--for", "100ms", "--record", &text(&path), "--no-control"]);
    let (code, err) = said(&[&text(&path), "--at", "0s"]);
    let instead = format!("with `monas studio {}`", path.display());
    assert!(code == Some(1) && err.contains("agents outside of a match") && err.contains(&instead), "{err}");
    let only = text(&folder.path().join("only.mcap"));
    done(&["tape", "cut", &tape(), "--topic", "soccer/ball", "-o", &only]);
    let (code, err) = said(&[&only, "--at", "1s"]);
    assert!(code == Some(1) && err.contains("from the topic `sim/truth`, of which the tape has no"), "{err}");
}
