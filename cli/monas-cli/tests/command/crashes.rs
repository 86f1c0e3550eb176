//! Faults that end the process: what is reported, and what is recorded up to there.

use std::path::PathBuf;
use std::process::Command;

use crate::kit::{Answer, monas};

/// The example `faulty`, in the folder next to this test.
pub(crate) fn faulty() -> PathBuf {
    let test = std::env::current_exe().expect("a test");
    test.parent().and_then(|folder| folder.parent()).expect("two folders").join("examples/faulty")
}

const CONFIG: &str = "<agent frequency=\"50\"><name>Head</name><activity>Faulty</activity></agent>\n\
                      <agent frequency=\"50\"><name>Legs</name><activity>Steady</activity></agent>\n";

#[test]
fn a_fault_that_ends_the_process_names_the_activity_and_the_tape_reaches_up_to_it() {
    let folder = tempfile::tempdir().expect("a folder");
    let config = folder.path().join("robot.xml");
    std::fs::write(&config, CONFIG).expect("a file");
    for (fault, cause, code) in [
        ("abort", "SIGABRT (abort)", None),
        ("segv", "SIGSEGV (invalid access to memory)", None),
        ("overflow", "SIGSEGV (invalid access to memory)", None),
        ("exit", "a call of `exit`", Some(7)),
    ] {
        let tape = folder.path().join(fault).with_extension("mcap").display().to_string();
        let mut run = Command::new(faulty());
        run.args(["run", "--no-control", "--for", "20s", "--record", &tape]).arg(&config);
        let answer: Answer = run.env("FAULT", fault).output().expect("the command starts").into();
        // None: a signal has ended it.
        assert_eq!(answer.code, code, "{fault}: {answer:?}");
        let lines: Vec<&str> = answer.err.lines().collect();
        let begin = lines.iter().position(|line| line.ends_with(&format!("is ended by {cause}")));
        let report = &lines[begin.unwrap_or_else(|| panic!("{fault}: no report in {answer:?}"))..];
        assert_eq!(report[1], "  here: in activity local/Head/Faulty");
        let other = "  another thread: after activity local/Legs/Steady";
        assert!(report.contains(&other), "{fault}: {report:?}");
        assert!(report.contains(&"  the recording reaches up to here"), "{fault}: {report:?}");

        // The fault comes in the tenth cycle, 0.2 s after the start.
        let exported = monas(&["tape", "export", &tape, "--topic", "monas/cycle", "--format", "jsonl"]);
        let cycles = exported.out.lines().filter(|line| line.contains("\"publisher\":\"Head\"")).count();
        assert_eq!(cycles, 10, "{fault}: {exported:?}");
        let recovered = monas(&["tape", "recover", &tape]);
        assert_eq!(recovered.code, Some(0), "{recovered:?}");
    }
}

#[test]
fn a_run_that_ends_by_itself_reports_nothing() {
    let folder = tempfile::tempdir().expect("a folder");
    let config = folder.path().join("robot.xml");
    std::fs::write(&config, CONFIG).expect("a file");
    let mut run = Command::new(faulty());
    run.args(["run", "--no-control", "--for", "100ms"]).arg(&config);
    let answer: Answer = run.env_remove("FAULT").output().expect("the command starts").into();
    assert_eq!(answer.code, Some(0), "{answer:?}");
    assert!(!answer.err.contains("fatal"), "{}", answer.err);
}
