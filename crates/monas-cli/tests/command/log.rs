//! `monas run --log`.

use std::fs;
use std::path::Path;

use crate::kit::{Answer, command, root};

/// Plays a second with a log as a text says, in a folder.
fn run(folder: &Path, settings: &str) -> Answer {
    let file = folder.join("logger.xml");
    fs::write(&file, settings).expect("a file");
    let config = root().join("config/match.xml").display().to_string();
    let mut command = command(&["run", &config, "--for", "1s", "--log", &file.display().to_string()]);
    command.current_dir(folder).output().expect("the command starts").into()
}

#[test]
fn a_run_is_logged_as_the_file_says() {
    let folder = tempfile::tempdir().expect("a folder");
    let settings = "<MessageLogFile>a.log</MessageLogFile><LogFileVerbosityLevel>4</LogFileVerbosityLevel>";
    let answer = run(folder.path(), settings);
    assert_eq!(answer.code, Some(0), "{}", answer.err);
    let log = || fs::read_to_string(folder.path().join("a.log")).expect("a log");
    let first = log();
    for line in [
        "    0.000000 s DEBUG [blue-1 Goalie] no way out",
        "    1.000000 s INFO  [red-1 Goalie] stopped: the run has ended",
    ] {
        assert!(first.contains(line), "{first}");
    }
    assert_eq!(run(folder.path(), settings).code, Some(0));
    let simulated =
        |log: &str| log.lines().filter(|line| line.contains(" s ")).map(str::to_owned).collect::<Vec<_>>();
    assert_eq!(simulated(&log()), simulated(&first), "the same run has the same lines");
    let answer =
        run(folder.path(), "<MessageLogCerr>1</MessageLogCerr><MessageLogFormat>json</MessageLogFormat>");
    assert_eq!(answer.code, Some(0), "{}", answer.err);
}

#[test]
fn the_settings_that_are_shipped_are_understood() {
    let (settings, wrong) = monas::logger::Settings::load(root().join("config/logger.xml"));
    assert!(wrong.is_empty(), "{wrong:?}");
    assert_eq!(settings.file.as_deref(), Some(Path::new("MonasLog.txt")));
    assert!(settings.console && settings.colour && settings.filter.is_none());
}

#[test]
fn what_the_file_says_wrongly_is_told_before_anything_runs() {
    let folder = tempfile::tempdir().expect("a folder");
    let answer =
        run(folder.path(), "<MessageLogFilter>all</MessageLogFilter>\n<MessageLogFyle>a</MessageLogFyle>");
    assert_eq!((answer.code, answer.out.as_str()), (Some(3), ""));
    assert!(answer.err.contains("logger.xml:2:2"), "{}", answer.err);
    assert!(answer.err.contains("did you mean `message_log_file`?"), "{}", answer.err);
    let answer = run(folder.path(), "<MessageLogFile>no/folder/a.log</MessageLogFile>");
    assert_eq!(answer.code, Some(1));
    assert!(answer.err.contains("logger.xml: "), "{}", answer.err);
}
