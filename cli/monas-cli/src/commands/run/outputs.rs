//! The files that a run writes: its log and its recording.

use std::path::Path;
use std::time::SystemTime;

use monas::logger::{LogSettings, Severity};
use monas::records::LOG;
use monas::records::foxglove::Log;
use monas::records::foxglove::log::Level;
use monas::{ConfigurationBundle, RunHandle, Timestamp};
use monas_tape::{ExistingFile, RecordingFolder, RecordingLimits, Tape, TapeFile};
use monas_terminal::{CommandFailure, CommandOutput, Format, failed, report};
use yase::Diagnostic;

use super::{RunArguments, control};
use crate::crash_report;
use crate::input::robot_file;

/// The name under which alarms of the recording are published.
pub(crate) const RECORDING: &str = "recording";

/// Opens the log and the recording of a run, after everything that could refuse the run was
/// checked. Existing files stay, unless the arguments say otherwise.
pub(super) fn open(
    arguments: &RunArguments,
    to_tape: fn(TapeFile) -> Result<Tape, monas_tape::Error>,
    console: &mut CommandOutput<'_>,
) -> Result<Option<Tape>, CommandFailure> {
    let least_grave = match &arguments.log {
        Some(file) => begin_log(file, arguments, console)?,
        None => Severity::Info,
    };
    console.log.iter().for_each(|log| log.publish(least_grave.max(Severity::Info)));
    let Some(path) = &arguments.record else { return Ok(None) };
    let file = tape_file(path, arguments).map_err(failed(arguments.format.value))?;
    if file.path() != path {
        let reason = if path.is_dir() { "" } else { ", since that file exists" };
        let (new, path) = (file.path().display(), path.display());
        report::note(console, arguments.format.value, &format!("recording into {new} for {path}{reason}"))?;
    }
    let tape = to_tape(file).map_err(failed(arguments.format.value))?;
    crash_report::flush_in_crash(&tape);
    Ok(Some(tape))
}

/// The files of a run: its configuration, and the overrides of its robot.
pub(super) fn files(arguments: &RunArguments) -> ConfigurationBundle {
    let config = &arguments.config;
    let robot = arguments.layers.robot.as_ref().and_then(|name| robot_file(config, name).ok());
    ConfigurationBundle::including(config, robot.as_slice())
}

/// The file of `--record`; in a folder a new one, named after the run.
#[expect(clippy::disallowed_methods, reason = "recordings of a robot are named by the wall clock")]
fn tape_file(path: &Path, arguments: &RunArguments) -> Result<TapeFile, monas_tape::Error> {
    if path.is_dir() || path.as_os_str().to_string_lossy().ends_with(std::path::MAIN_SEPARATOR) {
        let limits = RecordingLimits { count: arguments.keep.max(1), bytes: arguments.keep_size };
        let time = humantime::format_rfc3339_seconds(SystemTime::now()).to_string().replace(':', "-");
        let run = format!("{}-{time}", control::name_of(arguments));
        return RecordingFolder::new(path, limits).create(&run);
    }
    TapeFile::create(path, existing(arguments))
}

fn existing(arguments: &RunArguments) -> ExistingFile {
    if arguments.overwrite { ExistingFile::Replace } else { ExistingFile::Keep }
}

/// Starts the log that a file configures. Returns its verbosity.
fn begin_log(
    file: &Path,
    arguments: &RunArguments,
    console: &mut CommandOutput<'_>,
) -> Result<Severity, CommandFailure> {
    let format = arguments.format.value;
    let (mut settings, diagnostics) = LogSettings::load(file);
    if diagnostics.iter().any(Diagnostic::is_error) {
        return Err(CommandFailure::Invalid(format, diagnostics));
    }
    let Some(log) = &console.log else {
        return Err(CommandFailure::Usage(
            "--log needs the log of the process, which belongs to the calling program".into(),
        ));
    };
    settings.colour &= console.colour_err;
    let (verbosity, requested) = (settings.verbosity, settings.file.clone());
    let begun = log.write(settings, existing(arguments)).map_err(|error| {
        CommandFailure::failed(format, format_args!("the log of {}: {error}", file.display()))
    })?;
    if let (Some(new), Some(path)) = (begun.filter(|new| Some(new) != requested.as_ref()), &requested) {
        let (new, path) = (new.display(), path.display());
        report::note(console, format, &format!("logging into {new} for {path}, since that file exists"))?;
    }
    Ok(verbosity)
}

/// Completes the recording, after the results of the run were written.
pub(super) fn finish(tape: Option<Tape>, format: Format) -> Result<Option<u64>, CommandFailure> {
    tape.map(|tape| tape.finish())
        .transpose()
        .map_err(|error| CommandFailure::failed(format, format_args!("the recording is incomplete: {error}")))
}

/// Publishes on the hosts of a run when its recording fails, and when it continues.
pub(super) struct RecordingAlarm {
    tape: Option<Tape>,
    run: RunHandle,
    failure: Option<String>,
}

impl RecordingAlarm {
    pub(super) fn new(tape: Option<Tape>, run: RunHandle) -> RecordingAlarm {
        RecordingAlarm { tape, run, failure: None }
    }

    /// Compares the state of the recording with the previous check. Between two steps of simulated
    /// time no agent runs, and lines of the log are not part of the run's hash.
    pub(super) fn check(&mut self, now: Timestamp) {
        let Some(tape) = &self.tape else { return };
        let failure = tape.failure();
        if failure == self.failure {
            return;
        }
        let (level, message) = match &failure {
            Some(failure) => (Level::Fatal, format!("{failure}; messages are not recorded")),
            None => {
                let file = tape.files().pop().unwrap_or_default();
                (Level::Warning, format!("the recording continues in {}", file.display()))
            }
        };
        self.failure = failure;
        for hub in self.run.hubs() {
            // A hub may lack the topic; the process's log has the line.
            let Ok(mut publisher) = hub.publisher(LOG, RECORDING) else { continue };
            let mut line = Log { message: message.clone(), name: RECORDING.into(), ..Log::default() };
            line.set_level(level);
            publisher.publish(line, now);
        }
    }
}
