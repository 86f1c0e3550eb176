//! Recordings and logs that must not be lost: a second run, a full disk, an early crash.

use std::fs;
use std::path::Path;
use std::process::Command;

use serde_json::Value;

use crate::kit::{Answer, monas, root};
use crate::running::{Running, ask};

const MATCH: &str = "config/match.xml";

/// A run that records until it is interrupted.
fn live(folder: &Path, tape: &str, more: &[&str]) -> Running {
    let arguments = ["run", MATCH, "--pace", "1", "--record", tape, "--control", "one"];
    Running::start(folder, &[&arguments[..], more].concat(), "control socket: ")
}

fn text(path: &Path) -> String {
    path.display().to_string()
}

/// The number of messages on a tape that verifies.
fn messages(tape: &str) -> u64 {
    let info = monas(&["tape", "info", tape, "--format", "json"]);
    assert_eq!(info.code, Some(0), "{info:?}");
    let mut objects = info.out.lines().map(|line| serde_json::from_str::<Value>(line).expect("JSON"));
    objects.find_map(|object| object["messages"].as_u64()).expect("a number")
}

#[test]
fn a_run_that_is_refused_touches_neither_the_tape_nor_the_log_of_another() {
    let folder = tempfile::tempdir().expect("a folder");
    let tape = text(&folder.path().join("live.mcap"));
    let (settings, log) = (folder.path().join("logger.toml"), folder.path().join("live.log"));
    fs::write(&settings, format!("message_log_file = {:?}\n", text(&log))).expect("a file");
    let settings = text(&settings);
    let first = live(folder.path(), &tape, &["--log", &settings]);
    // Each of the two refusals comes before any file is opened.
    for more in [&["--overwrite"][..], &[]] {
        let arguments = ["run", MATCH, "--record", &tape, "--log", &settings, "--control", "one"];
        let second = ask(folder.path(), &[&arguments[..], more].concat());
        assert_eq!((second.code, second.out.as_str()), (Some(1), ""), "{second:?}");
        assert!(second.err.contains("another run has this name"), "{}", second.err);
    }
    // With a name of its own it may not replace what is being written either.
    let busy = ask(folder.path(), &["run", MATCH, "--for", "1s", "--record", &tape, "--overwrite"]);
    assert_eq!(busy.code, Some(1), "{busy:?}");
    assert!(busy.err.contains("another process is writing it"), "{}", busy.err);
    let ended = first.interrupt();
    assert_eq!(ended.code, Some(130), "{ended:?}");
    let mut names: Vec<_> =
        fs::read_dir(folder.path()).expect("a folder").map(|entry| entry.expect("it").file_name()).collect();
    names.sort_unstable();
    assert_eq!(names, ["live.log", "live.mcap", "logger.toml", "monas"]);
    let verified = monas(&["tape", "verify", &tape]);
    assert_eq!(verified.code, Some(0), "{verified:?}");
}

#[test]
fn a_name_that_exists_is_left_alone_and_the_new_one_is_said() {
    let folder = tempfile::tempdir().expect("a folder");
    let at = |name: &str| folder.path().join(name);
    let (tape, log) = (text(&at("goalie.mcap")), text(&at("goalie.log")));
    fs::write(at("logger.toml"), format!("message_log_file = {log:?}\n")).expect("a file");
    let settings = text(&at("logger.toml"));
    let run = |more: &[&str]| {
        let arguments = ["run", MATCH, "--for", "1s", "--record", &tape, "--log", &settings];
        let answer = monas(&[&arguments[..], more].concat());
        assert_eq!(answer.code, Some(0), "{answer:?}");
        answer
    };
    assert!(!run(&[]).err.contains("note:"));
    let (first, log_of_first) = (fs::read(&tape).expect("a tape"), fs::read(&log).expect("a log"));
    let second = run(&[]);
    for name in ["goalie-2.mcap", "goalie-2.log"] {
        assert!(second.err.contains(&text(&at(name))), "{}", second.err);
        assert!(at(name).is_file(), "{name}");
    }
    assert!(fs::read(&tape).expect("a tape") == first && fs::read(&log).expect("a log") == log_of_first);
    assert!(fs::read(at("goalie-2.mcap")).expect("a tape") == first, "the same run gives the same bytes");
    fs::write(&tape, "old").expect("a file");
    assert!(!run(&["--overwrite"]).err.contains("note:"));
    assert!(fs::read(&tape).expect("a tape") == first && !at("goalie-3.mcap").exists());
}

#[test]
fn recordings_in_a_folder_are_named_after_their_run_and_the_oldest_are_removed() {
    let folder = tempfile::tempdir().expect("a folder");
    let recordings = folder.path().join("recordings/");
    for number in 1..=3 {
        let arguments = ["run", MATCH, "--for", "100ms", "--record", &text(&recordings), "--keep", "2"];
        let answer = monas(&[&arguments[..], &["--no-control"]].concat());
        assert_eq!(answer.code, Some(0), "{answer:?}");
        let named = format!("recording into {}000{number}-match-", recordings.display());
        assert!(answer.err.contains(&named), "{}", answer.err);
    }
    let names = fs::read_dir(&recordings).expect("a folder").map(|entry| entry.expect("it").file_name());
    let mut names: Vec<String> = names.map(|name| name.to_string_lossy().into_owned()).collect();
    names.sort_unstable();
    let numbers: Vec<&str> = names.iter().map(|name| &name[..11]).collect();
    assert_eq!(numbers, ["0002-match-", "0003-match-"]);
    assert!(messages(&text(&recordings.join(&names[1]))) > 0);
}

/// The figures and the hash of a match.
fn results(answer: &Answer) -> (bool, bool) {
    (answer.out.contains("possession"), answer.out.lines().any(|line| line.starts_with("hash: ")))
}

#[test]
#[cfg(target_os = "linux")]
fn a_full_disk_is_said_at_once_and_the_results_are_printed() {
    let answer = monas(&["run", MATCH, "--for", "3s", "--record", "/dev/full"]);
    assert_eq!((answer.code, results(&answer)), (Some(1), (true, true)), "{answer:?}");
    let lines: Vec<&str> = answer.err.lines().collect();
    // Only the name of the control socket comes before the alarm.
    let first = lines.iter().find(|line| !line.starts_with("control socket: ")).expect("a line");
    assert!(first.contains("the tape /dev/full cannot be written: No space left on device"), "{lines:?}");
    let last = lines.last().expect("a line");
    assert!(last.starts_with("error: the recording is incomplete: ") && last.contains("missing"), "{last}");
    let quiet = monas(&["run", MATCH, "--for", "3s"]);
    assert_eq!(quiet.out.lines().last(), answer.out.lines().last(), "the hash does not depend on the disk");
}

/// A file system of this many bytes, if this process may mount one.
struct SmallDisk(tempfile::TempDir);

impl SmallDisk {
    fn mount(size: &str) -> Option<SmallDisk> {
        let folder = tempfile::tempdir().expect("a folder");
        let mut mount = Command::new("mount");
        mount.args(["-t", "tmpfs", "-o", &format!("size={size},mode=700"), "none"]).arg(folder.path());
        match mount.output() {
            Ok(output) if output.status.success() => Some(SmallDisk(folder)),
            _ => {
                println!("a file system cannot be mounted here: the full disk is not tested");
                None
            }
        }
    }
}

impl Drop for SmallDisk {
    fn drop(&mut self) {
        let _ = Command::new("umount").arg(self.0.path()).status();
    }
}

#[test]
#[cfg(target_os = "linux")]
fn with_room_again_the_recording_continues_in_a_new_file_and_meanwhile_tools_see_the_alarm() {
    let Some(disk) = SmallDisk::mount("2m") else { return };
    let sockets = tempfile::tempdir().expect("a folder");
    let at = |name: &str| disk.0.path().join(name);
    fs::write(at("ballast"), vec![0; 1 << 20]).expect("there is room");
    let tape = text(&at("live.mcap"));
    let mut run = live(sockets.path(), &tape, &["--for", "600s"]);
    run.await_line("cannot be written: No space left on device");
    let top = ask(sockets.path(), &["top", "--once"]);
    assert!(top.out.starts_with("alarm: the tape ") && top.out.contains("No space left"), "{}", top.out);
    let top = ask(sockets.path(), &["top", "--once", "--format", "json"]);
    let first: Value = serde_json::from_str(top.out.lines().next().expect("a line")).expect("JSON");
    assert!(first["alarm"].as_str().is_some_and(|alarm| alarm.contains("No space left")), "{first}");
    fs::remove_file(at("ballast")).expect("it is ours");
    run.await_line("the recording continues in ");
    let answer = run.interrupt();
    assert_eq!((answer.code, results(&answer)), (Some(1), (true, true)), "{answer:?}");
    assert!(answer.err.contains("error: the recording is incomplete: the tape "), "{}", answer.err);
    let second =
        monas(&["tape", "export", &text(&at("live-2.mcap")), "--topic", "monas/log", "--format", "jsonl"]);
    assert!(second.out.contains("the recording continues in"), "{second:?}");
    assert!(messages(&tape) > 0 && messages(&text(&at("live-2.mcap"))) > 0);
    let replayed = monas(&["tape", "replay", &text(&at("live-2.mcap"))]);
    assert_eq!(replayed.code, Some(1), "{replayed:?}");
    assert!(replayed.err.contains("continues"), "{}", replayed.err);
}

#[test]
#[cfg(target_os = "linux")]
fn a_full_disk_leaves_a_role_as_it_was() {
    let Some(disk) = SmallDisk::mount("64k") else { return };
    let role = disk.0.path().join("goalie.srm");
    let goalie = root().join("models/goalie.srm");
    let before = fs::read_to_string(goalie).expect("a role");
    fs::write(&role, &before).expect("there is room");
    // The remaining space holds only a part of the role.
    let mut ballast = fs::File::create(disk.0.path().join("ballast")).expect("there is room");
    while std::io::Write::write_all(&mut ballast, &[0; 4096]).is_ok() {}
    let answer = monas(&["model", "regenerate", &text(&role), "-o", &text(&role)]);
    assert_eq!(answer.code, Some(1), "{answer:?}");
    assert!(answer.err.contains("No space left"), "{}", answer.err);
    assert_eq!(fs::read_to_string(&role).expect("it is there"), before);
    assert_eq!(fs::read_dir(disk.0.path()).expect("a folder").count(), 2, "no draft is left");
}

/// A limit on the size of files acts like a full disk; by itself it would end the process.
#[test]
#[cfg(target_os = "linux")]
fn a_limit_on_the_size_of_files_is_an_error_and_not_the_end() {
    let folder = tempfile::tempdir().expect("a folder");
    let tape = folder.path().join("limited.mcap");
    let mut shell = Command::new("sh");
    let script = "ulimit -f 64; exec \"$0\" run \"$1\" --for 3s --no-control --record \"$2\"";
    shell.args(["-c", script, env!("CARGO_BIN_EXE_monas"), MATCH]).arg(&tape).current_dir(root());
    let answer: Answer = shell.output().expect("the shell starts").into();
    assert_eq!((answer.code, results(&answer)), (Some(1), (true, true)), "{answer:?}");
    assert!(answer.err.contains("cannot be written: File too large"), "{}", answer.err);
}

/// Programs such as `timeout` signal a process and its group, so that it is signalled twice.
#[test]
fn a_run_that_is_signalled_twice_at_once_ends_in_order() {
    let folder = tempfile::tempdir().expect("a folder");
    let tape = text(&folder.path().join("live.mcap"));
    let run = live(folder.path(), &tape, &[]);
    // It is answered after the run has begun.
    assert_eq!(ask(folder.path(), &["agent", "list"]).code, Some(0));
    let ended = run.interrupt_and_terminate();
    assert!(matches!(ended.code, Some(130 | 143)), "{ended:?}");
    assert!(ended.out.contains("score") || ended.out.contains("hash: "), "the results are there: {ended:?}");
    assert!(!folder.path().join("monas/one.sock").exists(), "its socket is gone with it");
    assert_eq!(monas(&["tape", "verify", &tape]).code, Some(0));
}
