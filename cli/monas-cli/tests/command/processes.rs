//! A match in which robots have processes of their own.

use std::fs;
use std::path::Path;

use serde_json::Value;

use crate::kit::monas;
use crate::running::{Running, ask, objects};

const MATCH: &str = "config/team_processes.xml";

/// The processes of robots of a match whose sockets are in a folder: robot and number.
fn processes(folder: &Path) -> Vec<(String, u32)> {
    let folder = folder.display().to_string();
    let robot_of = |entry: fs::DirEntry| {
        let number = entry.file_name().to_str()?.parse().ok()?;
        // A process may end meanwhile.
        let line = fs::read(entry.path().join("cmdline")).ok()?;
        let words: Vec<String> =
            line.split(|byte| *byte == 0).map(|word| String::from_utf8_lossy(word).into_owned()).collect();
        let value = |option: &str| words.iter().skip_while(|word| *word != option).nth(1).cloned();
        value("--body").filter(|body| body.starts_with(&folder))?;
        Some((value("--only")?, number))
    };
    fs::read_dir("/proc").expect("Linux").filter_map(Result::ok).filter_map(robot_of).collect()
}

fn start(folder: &Path, more: &[&str]) -> Running {
    let arguments = ["run", MATCH, "--realtime", "--seed", "1", "--control", "team"];
    Running::start(folder, &[&arguments[..], more].concat(), "control socket: ")
}

/// Waits until the robots with processes have these numbers of them.
fn await_processes(folder: &Path, count: usize) -> Vec<(String, u32)> {
    (0..10_000).map(|_| processes(folder)).find(|found| found.len() == count).expect("the processes")
}

#[cfg(target_os = "linux")]
#[test]
fn the_process_of_a_robot_that_is_killed_comes_back_and_the_others_play_on() {
    let folder = tempfile::tempdir().expect("a folder");
    let tape = folder.path().join("team.mcap").display().to_string();
    let mut run = start(folder.path(), &["--for", "14s", "--format", "json", "--record", &tape]);
    let robots = await_processes(folder.path(), 3);
    // They are runs, which tools reach by name.
    let seen =
        || ask(folder.path(), &["topic", "echo", "body/sensors", "--run", "team-blue-2", "--count", "1"]);
    assert!((0..100).any(|_| seen().code == Some(0)), "{:?}", seen());
    let (_, killed) = robots.iter().find(|(robot, _)| robot == "blue-2").expect("it has a process");
    let status = std::process::Command::new("kill").args(["-9", &killed.to_string()]).status();
    assert!(status.expect("there is a kill").success());
    run.await_line("and is started again");
    let answer = run.wait();
    assert_eq!(answer.code, Some(0), "{answer:?}");
    let all = objects(&answer.out);
    let of = |kind: &str, host: &str| -> Vec<Value> {
        all.iter().filter(|object| object["kind"] == kind && object["host"] == host).cloned().collect()
    };
    for host in ["blue-1", "blue-2", "blue-3", "red-1", "red-2", "red-3"] {
        let [agent] = &of("agent", host)[..] else { panic!("{host}: {answer:?}") };
        assert!(agent["micro_steps"].as_u64() > Some(100), "{host}: {agent}");
        // The body itself, and for a process its other end; neither misses a cycle.
        let bodies = of("body", host);
        assert_eq!(bodies.len(), if host.starts_with("blue") { 2 } else { 1 }, "{host}: {answer:?}");
        let period = bodies[0]["period_seconds"].as_f64().expect("a number");
        let cycles = bodies[0]["cycles"].as_f64().expect("a number");
        assert!(cycles >= 14.0 / period - 1.0, "{host}: {bodies:?}");
        let other_end = bodies.last().expect("one of them");
        let delay = other_end["sense_to_act_p50_seconds"].as_f64().expect("it moves");
        assert!(delay < 1.5 * period, "{host}: {bodies:?}");
    }
    assert_eq!(processes(folder.path()), [], "all have ended with the match");
    // The recording has what passed in the process of the match.
    let verified = monas(&["tape", "verify", &tape]);
    assert_eq!(verified.code, Some(0), "{verified:?}");
    assert!(verified.out.contains("of 3 agents replayed"), "{verified:?}");
}

#[cfg(target_os = "linux")]
#[test]
fn the_processes_of_robots_end_with_a_match_that_is_killed() {
    let folder = tempfile::tempdir().expect("a folder");
    let run = start(folder.path(), &[]);
    await_processes(folder.path(), 3);
    run.kill();
    await_processes(folder.path(), 0);
}

#[test]
fn in_simulated_time_all_agents_run_in_one_process() {
    let run = |config: &str| monas(&["run", config, "--seed", "3", "--for", "3s", "--format", "json"]);
    let (one, other) = (run(MATCH), run("config/nao_sim.xml"));
    assert_eq!((one.code, other.code), (Some(0), Some(0)), "{one:?}");
    let hash = |out: &str| objects(out).last().expect("the run")["hash"].clone();
    assert_eq!(hash(&one.out), hash(&other.out));
}

#[test]
fn what_cannot_be_is_said() {
    let cases: [(&[&str], i32, &str); 4] = [
        (&["config/roles/goalie.xml", "--only", "blue-1", "--body", "x"], 2, "--only is for matches"),
        (&[MATCH, "--only", "blue-1"], 2, "--body <ADDRESS>"),
        (
            &[MATCH, "--only", "blue-9", "--body", "x"],
            1,
            "the match has no robot `blue-9`; there are blue-1, blue-2",
        ),
        (&[MATCH, "--only", "red-1", "--body", "x"], 1, "a body of kind `field` is in a match only"),
    ];
    for (arguments, code, part) in cases {
        let answer = monas(&[&["run"], arguments].concat());
        assert_eq!(answer.code, Some(code), "{arguments:?}: {answer:?}");
        assert!(answer.err.contains(part), "{arguments:?}: {answer:?}");
    }
    let folder = tempfile::tempdir().expect("a folder");
    let text = fs::read_to_string(crate::kit::root().join(MATCH)).expect("it is there");
    let file = folder.path().join("match.xml").display().to_string();
    let root = crate::kit::root().display().to_string();
    let text = text.replace("config/", &format!("{root}/config/")).replace("<body kind=\"nao\"/>", "");
    fs::write(&file, text).expect("a file");
    let answer = monas(&["run", &file, "--realtime", "--for", "1s"]);
    assert_eq!(answer.code, Some(1), "{answer:?}");
    assert!(answer.err.contains("has no interface for agents in another process"), "{answer:?}");
}
