//! `monas log`: the log of a run or of a tape.

mod line;

use std::collections::BTreeSet;
use std::path::{Path, PathBuf};
use std::time::Duration;

use clap::{Args, ValueEnum, ValueHint};
use clap_complete::engine::{ArgValueCandidates, CompletionCandidate};
use monas::records::foxglove::Log;
use monas::records::foxglove::log::Level;
use monas::{duration, records};
use monas_tape::{Recording, TapeOverview};
use prost::Message;

#[cfg(unix)]
use crate::commands::run::RECORDING;
#[cfg(unix)]
use crate::remote::{RunSelector, WatchLimits, connection, failure, hosts, request, unexpected_reply, watch};
use line::LogLine;
use monas_terminal::{CommandFailure, CommandOutput, Exit, Format, FormatArgument, failed};

/// The topic of log lines.
const TOPIC: &str = "monas/log";

#[derive(Args, Debug)]
pub(crate) struct LogArguments {
    /// Read this tape; without it, follow a run from now on.
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
    /// Only lines of at least this severity.
    #[arg(long, value_name = "LEVEL", default_value = "debug")]
    level: Severity,
    /// The run, by the name of its control socket; not needed if there is only one.
    #[arg(long, value_name = "NAME", conflicts_with = "tape")]
    run: Option<String>,
    /// Stop after this many lines.
    #[arg(long, value_name = "NUMBER")]
    count: Option<u64>,
    /// Follow a run for this time, for example 10s; until Ctrl-C if not given.
    #[arg(long = "for", value_name = "TIME", value_parser = duration::parse, conflicts_with = "tape")]
    length: Option<Duration>,
    #[command(flatten)]
    format: FormatArgument,
}

/// The severity of a line, lowest first.
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
    hosts()
}

#[cfg(not(unix))]
fn robots() -> Vec<CompletionCandidate> {
    Vec::new()
}

pub(crate) fn execute(
    arguments: &LogArguments,
    console: &mut CommandOutput<'_>,
) -> Result<Exit, CommandFailure> {
    match &arguments.tape {
        Some(tape) => of_tape(tape, arguments, console),
        None => of_run(arguments, console),
    }
}

fn of_tape(
    tape: &Path,
    arguments: &LogArguments,
    console: &mut CommandOutput<'_>,
) -> Result<Exit, CommandFailure> {
    let format = arguments.format.value;
    let recording = Recording::open(tape).map_err(failed(format))?;
    let overview = recording.overview().map_err(failed(format))?;
    let hosts = overview.channels.iter().map(|counted| counted.channel.host.as_str());
    arguments.check_robots("tape", &hosts.collect::<Vec<_>>())?;
    if !arguments.agents.is_empty() {
        arguments.check_agents("tape", &agents(&recording, &overview, format)?)?;
    }
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
        let line = LogLine::new(&message.channel.host, message.published, &log);
        if arguments.wants(&line) {
            line.write(format, console)?;
            left -= 1;
        }
    }
    Ok(Exit::Success)
}

/// The agents on a tape: those with records of cycles or charts, and those with lines, since a tape
/// may have been cut to the log.
fn agents(
    recording: &Recording,
    overview: &TapeOverview,
    format: Format,
) -> Result<BTreeSet<String>, CommandFailure> {
    let is_record = |topic: &str| topic == records::CYCLE.path() || topic == records::CHART.path();
    let channels = overview.channels.iter().map(|counted| &counted.channel);
    let recorded = channels.filter(|channel| is_record(&channel.topic));
    let mut agents: BTreeSet<String> = recorded.map(|channel| channel.publisher.clone()).collect();
    for message in recording.messages().map_err(failed(format))? {
        let message = message.map_err(failed(format))?;
        if message.channel.topic == TOPIC {
            let log = read(message.bytes, format)?;
            agents.insert(LogLine::new("", message.published, &log).agent.to_owned());
        }
    }
    Ok(agents)
}

/// Follows a run.
#[cfg(unix)]
fn of_run(arguments: &LogArguments, console: &mut CommandOutput<'_>) -> Result<Exit, CommandFailure> {
    let format = arguments.format.value;
    let host = match &arguments.robots[..] {
        [one] => Some(one.clone()),
        _ => None,
    };
    let choice = RunSelector::of(arguments.run.clone(), host, arguments.format);
    if arguments.robots.len() > 1 {
        let run = connection::client(&choice)?.describe().map_err(failure(format))?;
        arguments.check_robots("run", &run.hosts.iter().map(String::as_str).collect::<Vec<_>>())?;
    }
    if !arguments.agents.is_empty() {
        arguments.check_agents("run", &agents_of_run(arguments)?)?;
    }
    let limits = WatchLimits { count: None, length: arguments.length };
    let mut left = arguments.count.unwrap_or(u64::MAX);
    watch(TOPIC, true, &limits, &choice, console, |seen, console| {
        if let Some(seen) = seen {
            let log = read(&seen.payload, format)?;
            let line = LogLine::new(&seen.host, monas::Timestamp::from_nanos(seen.local), &log);
            if left > 0 && arguments.wants(&line) {
                line.write(format, console)?;
                left -= 1;
            }
        }
        Ok(left > 0)
    })
}

/// The names of the agents of a run, of all its robots, and of what else writes lines.
#[cfg(unix)]
fn agents_of_run(arguments: &LogArguments) -> Result<BTreeSet<String>, CommandFailure> {
    let run = RunSelector::of(arguments.run.clone(), None, arguments.format);
    let reply = request(records::Inquiry { agents: true, ..records::Inquiry::default() }, &run)?;
    let agents = reply.agents.ok_or_else(|| unexpected_reply(&run))?.agents;
    let others = std::iter::once(RECORDING.to_owned());
    Ok(agents.into_iter().map(|agent| agent.name).chain(others).collect())
}

#[cfg(not(unix))]
fn of_run(arguments: &LogArguments, _: &mut CommandOutput<'_>) -> Result<Exit, CommandFailure> {
    let message = "following a run needs Unix sockets: give a tape".to_owned();
    Err(CommandFailure::Unreachable(arguments.format.value, message))
}

fn read(bytes: &[u8], format: Format) -> Result<Log, CommandFailure> {
    Log::decode(bytes).map_err(|error| {
        CommandFailure::failed(format, format!("a line on `{TOPIC}` cannot be read: {error}"))
    })
}

impl LogArguments {
    /// Refuses robots that do not exist.
    fn check_robots(&self, source: &str, hosts: &[&str]) -> Result<(), CommandFailure> {
        match self.robots.iter().find(|robot| !hosts.contains(&robot.as_str())) {
            Some(unknown) => {
                Err(CommandFailure::unknown_name(source, "robot", unknown, hosts.iter().copied()))
            }
            None => Ok(()),
        }
    }

    /// Refuses agents that do not exist.
    fn check_agents(&self, source: &str, agents: &BTreeSet<String>) -> Result<(), CommandFailure> {
        match self.agents.iter().find(|agent| !agents.contains(*agent)) {
            Some(unknown) => {
                let known = agents.iter().map(String::as_str);
                Err(CommandFailure::unknown_name(source, "agent", unknown, known))
            }
            None => Ok(()),
        }
    }

    fn wants(&self, line: &LogLine<'_>) -> bool {
        let is_one_of =
            |wanted: &[String], name: &str| wanted.is_empty() || wanted.iter().any(|one| one == name);
        line.severity >= self.level
            && is_one_of(&self.robots, line.robot)
            && is_one_of(&self.agents, line.agent)
            && is_one_of(&self.activities, line.activity)
    }
}
