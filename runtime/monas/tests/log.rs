//! The log: the settings of the thesis, the origin of lines, and the contents of the file after the
//! process has ended.
#![allow(clippy::unwrap_used, clippy::panic)] // a test may fail
#![allow(unsafe_code, reason = "counting allocations takes an allocator")]

use std::alloc::{GlobalAlloc, Layout, System};
use std::cell::Cell;
use std::io::{BufRead, BufReader, Write};
use std::path::Path;
use std::process::{Command, Stdio};
use std::sync::{Arc, Mutex};

use monas::logger::{self, LogFormat, LogSettings, Logger, Severity};
use monas::records::foxglove::Log;
use monas::records::foxglove::log::Level;
use monas::records::{Action, Change, LOG};
use monas::{Agent, Blackboard, BoxError, Hz, RunHash, Talws};
use narukom::Timestamp;
use tracing::Dispatch;
use tracing_subscriber::prelude::*;

thread_local! {
    static ALLOCATIONS: Cell<u64> = const { Cell::new(0) };
}

struct AllocationCounter;

// SAFETY: the call is passed to the system allocator unchanged.
unsafe impl GlobalAlloc for AllocationCounter {
    unsafe fn alloc(&self, layout: Layout) -> *mut u8 {
        let _ = ALLOCATIONS.try_with(|count| count.set(count.get() + 1));
        // SAFETY: the call is passed to the system allocator unchanged.
        unsafe { System.alloc(layout) }
    }

    unsafe fn dealloc(&self, block: *mut u8, layout: Layout) {
        // SAFETY: the call is passed to the system allocator unchanged.
        unsafe { System.dealloc(block, layout) }
    }
}

#[global_allocator]
static ALLOCATOR: AllocationCounter = AllocationCounter;

/// An open log, for tests that write through the dispatch.
fn begun(settings: LogSettings) -> (Dispatch, Logger) {
    let (layer, logger) = logger::layer();
    let dispatch = Dispatch::new(tracing_subscriber::registry().with(layer));
    tracing::dispatcher::with_default(&dispatch, || logger.begin(settings).unwrap());
    (dispatch, logger)
}

fn to(file: &Path) -> LogSettings {
    LogSettings { file: Some(file.into()), verbosity: Severity::ExtraExtraInfo, ..LogSettings::default() }
}

/// The content of the file after `speak` has run.
fn written(settings: impl FnOnce(LogSettings) -> LogSettings, speak: impl FnOnce()) -> String {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("log.txt");
    let (dispatch, logger) = begun(settings(to(&file)));
    tracing::dispatcher::with_default(&dispatch, speak);
    logger.end();
    std::fs::read_to_string(file).unwrap()
}

/// The words that follow the time.
fn without_times(log: &str) -> Vec<&str> {
    log.lines().map(|line| line.split_once("Z ").unwrap().1).collect()
}

fn settings_in(name: &str, text: &str) -> (LogSettings, Vec<String>) {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join(name);
    std::fs::write(&file, text).unwrap();
    let (settings, diagnostics) = LogSettings::load(file);
    let messages = diagnostics.iter().map(|found| format!("{}: {}", found.code, found.message));
    (settings, messages.collect())
}

#[test]
fn the_listing_of_the_thesis_is_a_log_s_settings_as_it_is_printed() {
    let (settings, wrong) = settings_in("logger.xml", include_str!("listings/4.5.xml"));
    assert_eq!(wrong, Vec::<String>::new());
    let expected = LogSettings {
        file: Some("MonasLog.txt".into()),
        console: true,
        colour: true,
        filter: None,
        verbosity: Severity::ExtraExtraInfo,
        format: LogFormat::Text,
    };
    assert_eq!(settings, expected);
}

#[test]
fn toml_is_equivalent_and_errors_are_reported() {
    let text = "message_log_file = \"a.log\"\nmessage_log_filter = \"Vision Motion\"\nlog_file_verbosity_level = -3\n\
                message_log_format = \"json\"\n";
    let (settings, wrong) = settings_in("logger.toml", text);
    assert_eq!(wrong, Vec::<String>::new());
    let expected = LogSettings {
        file: Some("a.log".into()),
        filter: Some(vec!["Vision".into(), "Motion".into()]),
        verbosity: Severity::FatalError,
        format: LogFormat::Json,
        ..LogSettings::default()
    };
    assert_eq!(settings, expected);
    let (_, wrong) =
        settings_in("logger.xml", "<MessageLogFiel>a</MessageLogFiel><MessageLogCerr>2</MessageLogCerr>");
    assert_eq!(wrong.len(), 2, "{wrong:?}");
    assert!(wrong[0].contains("MessageLogFiel") && wrong[1].contains("`2`"), "{wrong:?}");
}

#[test]
fn the_five_kinds_of_the_thesis_have_their_words() {
    let speak = || {
        monas::fatal!("no camera");
        tracing::error!("no ball");
        tracing::warn!("dark");
        tracing::info!(x = 1.5, name = "ball", "seen");
        tracing::debug!("again");
        tracing::trace!("and again");
        logger::write("Behavior", &"Error in getting memory proxy", Severity::Error);
    };
    let log = written(|settings| settings, speak);
    let mut lines = without_times(&log);
    lines.sort_unstable(); // errors are written at once, the others in their turn
    let expected = [
        "DEBUG again",
        "ERROR [Behavior] Error in getting memory proxy",
        "ERROR no ball",
        "FATAL no camera",
        "INFO  seen x=1.5 name=\"ball\"",
        "TRACE and again",
        "WARN  dark",
    ];
    assert_eq!(lines, expected);
    for (verbosity, count) in [
        (Severity::FatalError, 3),
        (Severity::Error, 3),
        (Severity::Info, 5),
        (Severity::ExtraInfo, 6),
        (Severity::ExtraExtraInfo, 7),
    ] {
        let log = written(|settings| LogSettings { verbosity, ..settings }, speak);
        assert_eq!(log.lines().count(), count, "{verbosity:?}");
    }
}

/// Two agents on a robot, of which one activity fails in its third cycle.
fn team() -> Talws {
    let says = |name: &'static str| {
        move |_: &mut Blackboard| -> Result<(), BoxError> {
            tracing::info!("{name} is at work");
            Ok(())
        }
    };
    let mut count = 0;
    let fails = move |_: &mut Blackboard| -> Result<(), BoxError> {
        count += 1;
        if count == 3 { Err("no ball".into()) } else { Ok(()) }
    };
    let vision = Agent::new("vision", Hz(100))
        .activity(says("the first"))
        .named_activity("Second", Box::new(says("the second")));
    Talws::new().agent(vision).agent(Agent::new("mind", Hz(100)).named_activity("Behavior", Box::new(fails)))
}

#[test]
fn a_line_has_robot_activity_and_time_and_is_reproducible() {
    let run = || team().simulate(1).unwrap().run_until(Timestamp::from_nanos(30_000_000)).unwrap();
    let log = written(|settings| settings, run);
    let again = written(|settings| settings, run);
    // errors are written at once, the others by the logger's thread
    let sorted = |log: &str| log.lines().map(str::to_owned).collect::<std::collections::BTreeSet<_>>();
    assert_eq!(sorted(&log), sorted(&again));
    let mut lines: Vec<&str> =
        log.lines().filter(|line| line.contains("Second") || line.contains("Behavior")).collect();
    lines.sort_unstable();
    let expected = [
        "    0.000000 s INFO  [local vision/Second #1] the second is at work",
        "    0.010000 s INFO  [local vision/Second #2] the second is at work",
        "    0.020000 s ERROR [local mind/Behavior #3] activity failed: no ball",
        "    0.020000 s INFO  [local vision/Second #3] the second is at work",
    ];
    assert_eq!(lines, expected);
    let of = |names: &[&str]| {
        let filter = Some(names.iter().map(|name| (*name).to_owned()).collect());
        written(|settings| LogSettings { filter, ..settings }, run)
    };
    assert_eq!(of(&["Second"]).lines().count(), 3 + 1, "an error is always written");
    assert_eq!(of(&["vision"]).lines().count(), 6 + 1, "an agent stands for its activities");
    assert_eq!(of(&["Behaviour"]).lines().count(), 1);
}

/// A dispatch whose logger writes nothing and publishes lines of this severity.
fn publishing(least_grave: Option<Severity>) -> Dispatch {
    let (layer, logger) = logger::layer();
    let dispatch = Dispatch::new(tracing_subscriber::registry().with(layer));
    let begin = || least_grave.into_iter().for_each(|least_grave| logger.publish(least_grave));
    tracing::dispatcher::with_default(&dispatch, begin);
    dispatch
}

/// The lines published by a run of some cycles at 100 Hz, and its hash.
fn published(talws: Talws, least_grave: Option<Severity>, cycles: u64) -> (Vec<(String, Log)>, String) {
    let (lines, hash) = (Arc::new(Mutex::new(Vec::new())), RunHash::new());
    let (mut talws, seen) = (talws, lines.clone());
    talws.observe(Box::new(hash.clone()));
    talws.observe(Box::new(move |publication: narukom::Publication<'_>| {
        if publication.topic.path() == LOG.path() {
            let mut bytes = Vec::new();
            publication.sample.message.encode_to(&mut bytes);
            let log = <Log as prost::Message>::decode(&bytes[..]).unwrap();
            seen.lock().unwrap().push((publication.host.to_owned(), log));
        }
    }));
    tracing::dispatcher::with_default(&publishing(least_grave), || {
        talws.simulate(1).unwrap().run_until(Timestamp::from_nanos(cycles * 10_000_000)).unwrap();
        tracing::info!("the run is over");
    });
    let lines = lines.lock().unwrap().clone();
    (lines, hash.finish().0)
}

#[test]
fn lines_are_messages_of_the_host_they_are_about_and_the_hash_of_the_run_does_not_count_them() {
    let run = |least_grave| published(team(), least_grave, 3);
    let (lines, hash) = run(Some(Severity::Info));
    assert_eq!((lines.clone(), hash.clone()), run(Some(Severity::Info)), "each time the same");
    assert_eq!((Vec::new(), hash.clone()), run(None));
    let (errors, same) = run(Some(Severity::Error));
    assert_eq!(same, hash);
    let [(host, error)] = errors.as_slice() else { panic!("{errors:?}") };
    assert_eq!(host, "local");
    assert_eq!((error.level(), error.name.as_str()), (Level::Error, "mind/Behavior"));
    assert_eq!(error.message, "activity failed: no ball cycle=3");
    assert_eq!(error.timestamp.map(|it| (it.seconds, it.nanos)), Some((0, 20_000_000)));
    let second = lines.iter().filter(|(_, line)| line.name == "vision/Second");
    let words: Vec<&str> = second.map(|(_, line)| line.message.as_str()).collect();
    let expected = [1, 2, 3].map(|cycle| format!("the second is at work cycle={cycle}"));
    assert_eq!(words, expected);
    let (_, first) = &lines[0];
    assert!(first.file.ends_with("log.rs") && first.line > 0, "{first:?}");
    assert_eq!(lines.len(), 7, "what is written outside of the run is not a host's: {lines:?}");
}

#[test]
fn publishing_a_line_allocates_nothing() {
    let allocations = |least_grave| {
        let works = |_: &mut Blackboard| tracing::info!(x = 0.41, "a message of {} words", 5);
        let mut simulation =
            Talws::new().agent(Agent::new("a", Hz(100)).activity(works)).simulate(1).unwrap();
        tracing::dispatcher::with_default(&publishing(least_grave), || {
            simulation.run_until(Timestamp::from_nanos(2_000_000_000)).unwrap();
            let before = ALLOCATIONS.get();
            simulation.run_until(Timestamp::from_nanos(12_000_000_000)).unwrap();
            ALLOCATIONS.get() - before
        })
    };
    assert_eq!(allocations(Some(Severity::Info)), allocations(None));
}

#[test]
fn a_change_is_logged_at_the_time_of_the_simulation() {
    let log = written(
        |settings| settings,
        || {
            let mut simulation = team().simulate(1).unwrap();
            simulation.run_until(Timestamp::from_nanos(10_000_000)).unwrap();
            let pause =
                Change { action: Action::PauseAgent.into(), agent: "mind".into(), ..Change::default() };
            assert!(simulation.change("local", pause).unwrap().done);
        },
    );
    assert!(log.contains("    0.010000 s INFO  [local mind] changed action=PauseAgent\n"), "{log}");
}

#[test]
fn a_violated_property_is_an_error_with_its_name_the_cycle_and_the_time() {
    fn wait(_: &mut Blackboard) {}
    let log = written(
        |settings| settings,
        || {
            let role =
                yase::Source::new("m.srm", "Liveness:\nm = Wait . Wake\nTransitions:\nWait -> Wake : go\n");
            let (chart, _) = aseme_models::statechart_of(&role);
            let (properties, _) =
                aseme_verify::properties::parse("property \"it sleeps\": always not entering Wake");
            let agent = Agent::statechart("m", chart).monitor(properties, monas::ViolationResponse::Log);
            let registry = monas::Registry::linked().with("Wait", || wait).with("Wake", || wait);
            let mut simulation = Talws::new().registry(registry).agent(agent).simulate(1).unwrap();
            simulation.run_until(Timestamp::from_nanos(20_000_000)).unwrap();
            assert!(simulation.raise("local", "m", "go"));
            simulation.run_until(Timestamp::from_nanos(40_000_000)).unwrap();
        },
    );
    let mut errors = log.lines().filter(|line| line.contains("ERROR"));
    let line = errors.next().unwrap().trim_start();
    assert_eq!(errors.next(), None);
    let text = "property violated at 0.020000000 s property=it sleeps";
    assert_eq!(line, format!("0.020000 s ERROR [local m #3] {text}"));
}

#[test]
fn json_has_an_object_a_line() {
    let run = || {
        team().simulate(1).unwrap().run_until(Timestamp::from_nanos(30_000_000)).unwrap();
        tracing::info!("without an \"agent\"\n\u{1b}[31m");
    };
    let log = written(|settings| LogSettings { format: LogFormat::Json, ..settings }, run);
    let objects: Vec<serde_json::Value> =
        log.lines().map(|line| serde_json::from_str(line).unwrap()).collect();
    let failed = objects.iter().find(|object| object["level"] == "ERROR").unwrap();
    let expected = serde_json::json!({
        "simulated_time": 0.02, "level": "ERROR", "robot": "local", "agent": "mind", "activity": "Behavior", "cycle": 3,
        "message": "activity failed: no ball"
    });
    assert_eq!(*failed, expected);
    let last = objects.last().unwrap();
    assert_eq!(last["message"], "without an \"agent\"\n\u{1b}[31m");
    assert!(last["time"].is_string() && last.get("agent").is_none() && last.get("simulated_time").is_none());
}

#[test]
fn a_line_is_a_line_and_steers_no_terminal() {
    let log = written(|settings| settings, || tracing::info!("a\nb\u{1b}[31m\tc"));
    assert_eq!(without_times(&log), ["INFO  a\\nb\\u{1b}[31m\tc"]);
}

#[test]
fn logging_does_not_allocate_and_excess_lines_are_counted() {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("log.txt");
    let (dispatch, logger) = begun(to(&file));
    let speak = |count: u32| (0..count).for_each(|number| tracing::info!(number, "a message of {} words", 5));
    let allocations = tracing::dispatcher::with_default(&dispatch, || {
        speak(10);
        let before = ALLOCATIONS.get();
        speak(100_000);
        ALLOCATIONS.get() - before
    });
    logger.end();
    assert_eq!(allocations, 0);
    let log = std::fs::read_to_string(&file).unwrap();
    let dropped =
        log.lines().filter_map(|line| line.split_once("WARN  ")?.1.split_once(" messages were dropped"));
    let dropped: usize = dropped.map(|(count, _)| count.parse::<usize>().unwrap()).sum();
    let written = log.lines().filter(|line| line.contains("a message of 5 words number=")).count();
    assert_eq!(written + dropped, 100_010);
    assert!(written >= 1024);
}

#[test]
fn a_log_starts_once() {
    let folder = tempfile::tempdir().unwrap();
    let (_, logger) = begun(to(&folder.path().join("a")));
    assert!(logger.begin(LogSettings::default()).unwrap_err().to_string().contains("was started already"));
    logger.end();
    let (_, other) = logger::layer::<tracing_subscriber::Registry>();
    assert!(other.begin(to(&folder.path().join("no/folder"))).is_err());
}

/// The variable with the file of the process that is killed.
const CHILD_LOG: &str = "MONAS_CHILD_LOG";

/// Runs this test in a child process, which writes two lines, reports that, and ends by `end`.
/// Returns the content of the file after the child has ended; `is_killed` says whether the child is
/// killed.
fn file_after_end(test: &str, is_killed: bool, end: fn()) -> String {
    if let Some(file) = std::env::var_os(CHILD_LOG) {
        let (dispatch, _logger) =
            begun(LogSettings { verbosity: Severity::FatalError, ..to(Path::new(&file)) });
        tracing::dispatcher::with_default(&dispatch, || {
            tracing::error!("one leg is gone");
            monas::fatal!("so is the other");
        });
        println!("written");
        std::io::stdout().flush().unwrap();
        end();
        unreachable!("the process has ended");
    }
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("log.txt");
    let mut process = Command::new(std::env::current_exe().unwrap())
        .args([test, "--exact", "--nocapture"])
        .env(CHILD_LOG, &file)
        .stdin(Stdio::piped())
        .stdout(Stdio::piped())
        .stderr(Stdio::null())
        .spawn()
        .unwrap();
    let lines = BufReader::new(process.stdout.take().unwrap()).lines();
    lines.map(Result::unwrap).find(|line| line.ends_with("written")).unwrap();
    if is_killed {
        process.kill().unwrap();
    }
    assert!(!process.wait().unwrap().success());
    std::fs::read_to_string(file).unwrap()
}

#[test]
fn errors_are_on_the_disk_when_a_process_aborts() {
    let log = file_after_end("errors_are_on_the_disk_when_a_process_aborts", false, || std::process::abort());
    assert_eq!(without_times(&log), ["ERROR one leg is gone", "FATAL so is the other"]);
}

#[test]
fn errors_are_on_the_disk_when_a_process_is_killed() {
    let wait = || drop(std::io::stdin().read_line(&mut String::new()));
    let log = file_after_end("errors_are_on_the_disk_when_a_process_is_killed", true, wait);
    assert_eq!(without_times(&log), ["ERROR one leg is gone", "FATAL so is the other"]);
}

/// A file that blocks until it is read: the logger's thread waits, writers do not.
#[test]
#[cfg(unix)]
#[expect(clippy::disallowed_methods, reason = "the test reads what the threads write")]
fn lines_beyond_the_write_rate_are_dropped_and_reported() {
    let folder = tempfile::tempdir().unwrap();
    let pipe = folder.path().join("log.txt");
    assert!(Command::new("mkfifo").arg(&pipe).status().unwrap().success());
    let opening = {
        let pipe = pipe.clone();
        std::thread::spawn(move || std::fs::File::open(pipe).unwrap())
    };
    let (dispatch, logger) = begun(to(&pipe));
    let reader = opening.join().unwrap();
    let much = "x".repeat(200);
    let count = 20_000;
    tracing::dispatcher::with_default(&dispatch, || {
        (0..count).for_each(|number| tracing::info!("{much} {number}"));
    });
    let reading = std::thread::spawn(move || {
        BufReader::new(reader).lines().map(Result::unwrap).collect::<Vec<String>>()
    });
    logger.end();
    drop((dispatch, logger));
    let lines = reading.join().unwrap();
    let dropped = lines.iter().filter_map(|line| {
        let text = line.strip_suffix(" messages were dropped here: the rate was too high")?;
        text.rsplit(' ').next()?.parse::<usize>().ok()
    });
    let dropped: Vec<usize> = dropped.collect();
    let sum: usize = dropped.iter().sum();
    assert!(sum > 0, "{} lines", lines.len());
    assert_eq!(
        lines.len() - dropped.len() + sum,
        count,
        "each is written, or counted among those that are not"
    );
}
