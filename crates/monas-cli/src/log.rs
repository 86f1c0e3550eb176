//! `monas log`: what agents have to say, of a run while it runs or of a tape.

mod line;

use clap::{Args, ValueEnum, ValueHint};
use clap_complete::engine::{ArgValueCandidates, CompletionCandidate};
use monas::records::foxglove::Log;
use monas::records::foxglove::log::Level;
use monas_tape::Recording;
use prost::Message;
use std::path::{Path, PathBuf};
use std::time::Duration;

use crate::arguments::{Format, FormatArgument};
use crate::console::Console;
use crate::exit::Exit;
use crate::failure::Failure;
use crate::tape::failed;
#[cfg(unix)]
use crate::topic::arguments::{Limits, RunChoice};
#[cfg(unix)]
use crate::topic::connect;
use line::Line;

/// The topic that lines are messages on.
const TOPIC: &str = "monas/log";

#[derive(Args, Debug)]
pub(crate) struct LogArguments {
    /// The lines of this tape; of a run from now on, if it is not said.
    #[arg(value_hint = ValueHint::FilePath)]
    tape: Option<PathBuf>,
    /// Only lines of this robot. May be given several times.
    #[arg(long = "robot", value_name = "NAME", add = ArgValueCandidates::new(robots))]
    robots: Vec<String>,
    /// Only lines of this agent. May be given several times.
    #[arg(long = "agent", value_name = "NAME")]
    agents: Vec<String>,
    /// Only lines of this activity. May be given several times.
    #[arg(long = "activity", value_name = "NAME")]
    activities: Vec<String>,
    /// Only lines that are at least so grave.
    #[arg(long, value_name = "LEVEL", default_value = "debug")]
    level: Severity,
    /// Which run, by the name of its socket; not needed if there is one.
    #[arg(long, value_name = "NAME", conflicts_with = "tape")]
    run: Option<String>,
    /// End after so many lines.
    #[arg(long, value_name = "NUMBER")]
    count: Option<u64>,
    /// Follow a run for so long, for example 10s; until Ctrl-C, if it is not said.
    #[arg(long = "for", value_name = "TIME", value_parser = crate::duration::parse, conflicts_with = "tape")]
    length: Option<Duration>,
    #[command(flatten)]
    format: FormatArgument,
}

/// How grave a line is, the least first.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Debug, ValueEnum)]
enum Severity {
    Debug,
    Info,
    Warning,
    Error,
    Fatal,
}

impl Severity {
    const fn of(level: Level) -> Severity {
        match level {
            Level::Unknown | Level::Debug => Severity::Debug,
            Level::Info => Severity::Info,
            Level::Warning => Severity::Warning,
            Level::Error => Severity::Error,
            Level::Fatal => Severity::Fatal,
        }
    }

    const fn word(self) -> &'static str {
        match self {
            Severity::Debug => "debug",
            Severity::Info => "info",
            Severity::Warning => "warning",
            Severity::Error => "error",
            Severity::Fatal => "fatal",
        }
    }
}

#[cfg(unix)]
fn robots() -> Vec<CompletionCandidate> {
    connect::known_hosts().into_iter().map(CompletionCandidate::new).collect()
}

#[cfg(not(unix))]
fn robots() -> Vec<CompletionCandidate> {
    Vec::new()
}

pub(crate) fn execute(arguments: &LogArguments, console: &mut Console<'_>) -> Result<Exit, Failure> {
    match &arguments.tape {
        Some(tape) => of_tape(tape, arguments, console),
        None => of_run(arguments, console),
    }
}

fn of_tape(tape: &Path, arguments: &LogArguments, console: &mut Console<'_>) -> Result<Exit, Failure> {
    let format = arguments.format.value;
    let recording = Recording::open(tape).map_err(failed(format))?;
    let mut left = arguments.count.unwrap_or(u64::MAX);
    for message in recording.messages().map_err(failed(format))? {
        if left == 0 {
            break;
        }
        let message = message.map_err(failed(format))?;
        if message.channel.topic != TOPIC {
            continue;
        }
        let log = read(message.bytes, format)?;
        let line = Line::new(&message.channel.host, message.published, &log);
        if arguments.wants(&line) {
            line.write(format, console)?;
            left -= 1;
        }
    }
    Ok(Exit::Success)
}

/// Follows a run.
#[cfg(unix)]
fn of_run(arguments: &LogArguments, console: &mut Console<'_>) -> Result<Exit, Failure> {
    let format = arguments.format.value;
    let host = match &arguments.robots[..] {
        [one] => Some(one.clone()),
        _ => None,
    };
    let choice = RunChoice::of(arguments.run.clone(), host, arguments.format);
    let limits = Limits { count: None, length: arguments.length };
    let mut left = arguments.count.unwrap_or(u64::MAX);
    crate::topic::watch(TOPIC, true, &limits, &choice, console, |seen, console| {
        if let Some(seen) = seen {
            let log = read(&seen.payload, format)?;
            let line = Line::new(&seen.host, monas::Moment::from_nanos(seen.local), &log);
            if left > 0 && arguments.wants(&line) {
                line.write(format, console)?;
                left -= 1;
            }
        }
        Ok(left > 0)
    })
}

#[cfg(not(unix))]
fn of_run(arguments: &LogArguments, _: &mut Console<'_>) -> Result<Exit, Failure> {
    let message = "runs are followed through sockets of Unix: name a tape".to_owned();
    Err(Failure::Unreachable(arguments.format.value, message))
}

fn read(bytes: &[u8], format: Format) -> Result<Log, Failure> {
    Log::decode(bytes)
        .map_err(|error| Failure::failed(format, format!("a line on `{TOPIC}` cannot be read: {error}")))
}

impl LogArguments {
    fn wants(&self, line: &Line<'_>) -> bool {
        let is_one_of =
            |wanted: &[String], name: &str| wanted.is_empty() || wanted.iter().any(|one| one == name);
        line.severity >= self.level
            && is_one_of(&self.robots, line.robot)
            && is_one_of(&self.agents, line.agent)
            && is_one_of(&self.activities, line.activity)
    }
}
