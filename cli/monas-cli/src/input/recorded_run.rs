//! A recorded run: its configuration, and the replay of its agents.

use std::collections::BTreeMap;
use std::io::{self, Write};
use std::path::Path;
#[cfg(feature = "soccer")]
use std::path::PathBuf;

use monas::replay::{RecordedPublisher, Replay};
use monas::{Agent, ConfigurationBundle, HostConfig, Registry, Talws, Timestamp};
#[cfg(feature = "soccer")]
use monas_match::MatchSource;
use monas_studio::TapeChart;
use monas_tape::{CONTINUATION, Channel, Recording, RecordingItem, TapeOverview};
use monas_terminal::{CommandFailure, Format, failed};
use yase::{Diagnostic, Statechart};

use super::configuration::{ConfigurationKind, kind_of};
use super::layers::{self, LayerArguments};

/// The description of a run on its tape.
pub(crate) struct RecordedRun {
    version: String,
    configuration: String,
    /// Settings of the command line, one per line.
    settings: String,
    /// The robot whose overrides the configuration has.
    robot: Option<String>,
    /// The folder of the configuration, if paths depend on it.
    folder: Option<String>,
    /// The hosts whose agents ran: those of other robots of a match may have had other processes.
    robots: Vec<String>,
    time: TimeMode,
}

/// The time of a run.
enum TimeMode {
    Simulated { seed: u64 },
    Real,
}

/// The run of a tape.
///
/// # Errors
/// The reason why the run cannot be replayed, with the file.
pub(crate) fn run_of(tape: &Path, overview: &TapeOverview) -> Result<RecordedRun, String> {
    if let Some(damage) = overview.damages.first() {
        return Err(format!("{damage}; `monas tape recover` keeps what can be read"));
    }
    complete_run(overview).map_err(|reason| format!("{}: {reason}", tape.display()))
}

/// The end of the run, if the tape contains it.
pub(crate) fn end_of(overview: &TapeOverview) -> Option<Timestamp> {
    let facts = overview.facts.iter().find(|facts| facts.name == monas_recording::END)?;
    facts.entries.get("nanoseconds")?.parse().ok().map(Timestamp::from_nanos)
}

/// Refuses a moment after the end of the run, or after the last message if that is later.
pub(crate) fn check_within(
    option: &str,
    seconds: f64,
    overview: &TapeOverview,
) -> Result<(), CommandFailure> {
    let last = end_of(overview).max(overview.span.map(|(_, last)| last)).unwrap_or_default();
    let last = last.since(Timestamp::ZERO).as_secs_f64();
    if seconds <= last {
        return Ok(());
    }
    Err(CommandFailure::Usage(format!("{option} is {seconds:.3} s, and the tape ends at {last:.3} s")))
}

fn complete_run(overview: &TapeOverview) -> Result<RecordedRun, String> {
    let run = description(overview)?;
    if let Some(of) = overview.facts.iter().find(|facts| facts.name == CONTINUATION) {
        let of = of.entries.get("of").map_or("another tape", String::as_str);
        return Err(format!("the tape continues {of}, which could not be written: its beginning is missing"));
    }
    if let Some(dropped) = dropped(overview) {
        return Err(format!(
            "{dropped} messages were dropped because the disk was too slow: the inputs of agents are incomplete"
        ));
    }
    if let Some((topic, number)) = begun_late(overview) {
        return Err(format!(
            "the tape starts after its run: the first message on `{topic}` is number {number}"
        ));
    }
    Ok(run)
}

/// Reads the description of the run from a tape.
fn description(overview: &TapeOverview) -> Result<RecordedRun, String> {
    let facts = overview.facts.iter().find(|facts| facts.name == monas_recording::RUN);
    let facts =
        &facts.ok_or("the tape does not describe its run: it was not recorded by `monas run`")?.entries;
    let fact = |key: &str| facts.get(key).cloned().ok_or(format!("the tape lacks the {key} of its run"));
    let time = match fact("time")?.as_str() {
        "simulated" => TimeMode::Simulated { seed: seed(&fact("seed")?)? },
        _ => TimeMode::Real,
    };
    let settings = facts.get(monas_recording::SETTINGS).cloned().unwrap_or_default();
    let folder = facts.get(monas_recording::FOLDER).cloned();
    let robot = overview.facts.iter().find(|facts| facts.name == monas_recording::ROBOT);
    let robot = robot.and_then(|facts| facts.entries.get("name").cloned());
    let robots = fact("robots")?.split(' ').map(str::to_owned).collect();
    Ok(RecordedRun {
        version: fact("version")?,
        configuration: fact("configuration")?,
        settings,
        robot,
        folder,
        robots,
        time,
    })
}

/// Writes the recorded configuration of any tape into a folder, also of one that cannot be
/// replayed. Returns its path and the settings of the command line.
#[cfg(feature = "soccer")]
pub(crate) fn recorded_configuration(
    recording: &Recording,
    folder: &Path,
    format: Format,
) -> Result<(PathBuf, Vec<String>), CommandFailure> {
    let overview = recording.overview().map_err(failed(format))?;
    let run = description(&overview).map_err(|message| CommandFailure::Failed(format, message))?;
    let files = files(recording, &run).map_err(failed(format))?;
    let path = files.unpack(folder).map_err(failed(format))?;
    Ok((path, run.settings.lines().map(str::to_owned).collect()))
}

/// A topic with a publisher that had published before the tape began, and the sequence number of
/// its first recorded message.
fn begun_late(overview: &TapeOverview) -> Option<(&str, u32)> {
    let mut first: BTreeMap<(&str, &str, &str), u32> = BTreeMap::new();
    for one in overview.channels.iter().filter(|one| one.channel.received_by.is_none()) {
        let Channel { host, topic, publisher, .. } = &*one.channel;
        // The parts of a channel count together.
        let number = first.entry((host, topic, publisher)).or_insert(u32::MAX);
        *number = one.first_sequence.min(*number);
    }
    first.into_iter().find(|(_, number)| *number != 1).map(|((_, topic, _), number)| (topic, number))
}

fn seed(text: &str) -> Result<u64, String> {
    text.parse().map_err(|_| format!("the tape's seed `{text}` is not a number"))
}

/// The number of messages that were dropped, if any.
fn dropped(overview: &TapeOverview) -> Option<&str> {
    let dropped = overview.facts.iter().filter_map(|facts| facts.entries.get("dropped"));
    dropped.map(String::as_str).find(|dropped| *dropped != "0")
}

impl RecordedRun {
    /// The seed of a run in simulated time.
    #[cfg(feature = "soccer")]
    pub(crate) fn seed(&self) -> Option<u64> {
        match self.time {
            TimeMode::Simulated { seed } => Some(seed),
            TimeMode::Real => None,
        }
    }

    /// The hosts whose agents ran.
    fn present(&self, mut hosts: Vec<HostConfig>) -> Vec<HostConfig> {
        hosts.retain(|host| self.robots.contains(&host.name));
        hosts
    }

    /// Warns if the versions differ.
    pub(crate) fn warn(&self, err: &mut dyn Write) -> io::Result<()> {
        let ours = env!("CARGO_PKG_VERSION");
        match self.version == ours {
            true => Ok(()),
            false => writeln!(err, "the tape was recorded by version {}, this is {ours}", self.version),
        }
    }
}

/// The hosts with the selected agents, of the recorded configuration or of `config`.
pub(crate) fn chosen_hosts(
    recording: &Recording,
    run: &RecordedRun,
    config: Option<&Path>,
    agents: &[String],
    format: Format,
) -> Result<Vec<HostConfig>, CommandFailure> {
    let hosts = match config {
        Some(path) => {
            let hosts = load(path, "", None, format)?;
            if let [first, ..] = &hosts[..]
                && !hosts.iter().any(|host| run.robots.contains(&host.name))
            {
                let (robots, path) = (run.robots.join(", "), path.display());
                return Err(CommandFailure::Usage(format!(
                    "the tape has no robot `{}` of {path}; it has {robots}",
                    first.name
                )));
            }
            run.present(hosts)
        }
        None => configured(recording, run, format)?,
    };
    choose(hosts, agents)
}

/// The hosts of a recording with all their agents, from the recorded configuration and models.
pub(crate) fn recorded_hosts(
    tape: &Path,
    recording: &Recording,
    format: Format,
) -> Result<Vec<HostConfig>, CommandFailure> {
    let overview = recording.overview().map_err(failed(format))?;
    let run = run_of(tape, &overview).map_err(|message| CommandFailure::Failed(format, message))?;
    configured(recording, &run, format)
}

/// The charts of a recording, from the recorded configuration and models, also if it cannot be
/// replayed.
pub(crate) fn recorded_charts(
    recording: &Recording,
    format: Format,
) -> Result<Vec<TapeChart>, CommandFailure> {
    let overview = recording.overview().map_err(failed(format))?;
    let run = description(&overview).map_err(|message| CommandFailure::Failed(format, message))?;
    let hosts = configured(recording, &run, format)?;
    let of_agent = |host: &HostConfig, agent: &Agent| {
        let of_chart = |(statechart, chart): (&Statechart, u32)| TapeChart {
            host: host.name.clone(),
            agent: agent.name().to_owned(),
            chart,
            model: statechart.name.clone(),
            statechart: statechart.clone(),
        };
        agent.charts().iter().zip(0..).map(of_chart).collect::<Vec<_>>()
    };
    Ok(hosts.iter().flat_map(|host| host.agents.iter().flat_map(|agent| of_agent(host, agent))).collect())
}

fn configured(
    recording: &Recording,
    run: &RecordedRun,
    format: Format,
) -> Result<Vec<HostConfig>, CommandFailure> {
    let folder = tempfile::tempdir().map_err(|error| CommandFailure::failed(format, error))?;
    let files = files(recording, run).map_err(failed(format))?;
    let path = files.unpack(folder.path()).map_err(|error| CommandFailure::failed(format, error))?;
    Ok(run.present(load(&path, &run.settings, run.robot.clone(), format)?))
}

/// The recorded configuration.
fn files(recording: &Recording, run: &RecordedRun) -> Result<ConfigurationBundle, monas_tape::Error> {
    let mut files = Vec::new();
    for content in recording.contents()? {
        if let RecordingItem::Attachment(file) = content? {
            files.push((file.name.to_owned(), file.bytes.to_vec()));
        }
    }
    let files = ConfigurationBundle::from_files(run.configuration.clone(), files);
    Ok(match &run.folder {
        Some(folder) => files.in_folder(folder),
        None => files,
    })
}

/// The agents of a configuration. Warnings are dropped: they were reported when the run was
/// recorded.
fn load(
    path: &Path,
    settings: &str,
    robot: Option<String>,
    format: Format,
) -> Result<Vec<HostConfig>, CommandFailure> {
    let registry = Registry::linked();
    let invalid = |diagnostics| CommandFailure::Invalid(format, diagnostics);
    let settings = settings.lines().map(str::to_owned).collect();
    let layers = layers::of(path, &LayerArguments { settings, robot }).map_err(invalid)?;
    match kind_of(path).map_err(|unread| invalid(vec![*unread]))? {
        #[cfg(feature = "soccer")]
        ConfigurationKind::Match => {
            Ok(MatchSource::load_with(path, &registry, &layers).map_err(invalid)?.agents())
        }
        ConfigurationKind::Agents => {
            let (setup, diagnostics) = monas::config::load_with(path, &registry, &layers);
            if diagnostics.iter().any(Diagnostic::is_error) {
                return Err(invalid(diagnostics));
            }
            let monas::config::HostSetup { agents, links, modules, .. } = setup;
            let name = Talws::LOCAL.into();
            Ok(vec![HostConfig { name, agents, links, modules, ..HostConfig::default() }])
        }
    }
}

/// Keeps the selected hosts and agents; all if nothing is selected.
fn choose(mut hosts: Vec<HostConfig>, wanted: &[String]) -> Result<Vec<HostConfig>, CommandFailure> {
    let names = |hosts: &[HostConfig]| -> Vec<(String, String)> {
        let of = |host: &HostConfig| {
            host.agents.iter().map(|agent| (host.name.clone(), agent.name().to_owned())).collect::<Vec<_>>()
        };
        hosts.iter().flat_map(of).collect()
    };
    let all = names(&hosts);
    for pattern in wanted {
        if !all.iter().any(|(host, agent)| fits(pattern, host, agent)) {
            let names = all.iter().map(|(_, agent)| agent.as_str());
            return Err(CommandFailure::unknown_name("configuration", "agent", pattern, names));
        }
    }
    for host in &mut hosts {
        let name = host.name.clone();
        let is_wanted =
            |agent: &Agent| wanted.is_empty() || wanted.iter().any(|one| fits(one, &name, agent.name()));
        host.agents.retain(is_wanted);
    }
    hosts.retain(|host| !host.agents.is_empty());
    Ok(hosts)
}

/// Whether a pattern `agent`, `host/agent` or `host` matches an agent; case-insensitive.
fn fits(pattern: &str, host: &str, agent: &str) -> bool {
    let same = |a: &str, b: &str| a.to_lowercase() == b.to_lowercase();
    match pattern.split_once('/') {
        Some((on, name)) => same(on, host) && same(name, agent),
        None => same(pattern, agent) || same(pattern, host),
    }
}

/// The replay of these agents among all recorded publishers.
pub(crate) fn replay(
    hosts: Vec<HostConfig>,
    run: &RecordedRun,
    overview: &TapeOverview,
) -> Result<Replay, monas::Error> {
    let cycles = monas::records::CYCLE.path();
    let mut publishers: Vec<RecordedPublisher> = Vec::new();
    for counted in overview.channels.iter().filter(|one| one.channel.received_by.is_none()) {
        let (host, publisher) = (&counted.channel.host, &counted.channel.publisher);
        let (is_agent, last_part) = (counted.channel.topic == cycles, counted.channel.part);
        match publishers.iter_mut().find(|one| one.host == *host && one.publisher == *publisher) {
            Some(known) => {
                known.is_agent |= is_agent;
                known.last_part = known.last_part.max(last_part);
            }
            None => {
                let (host, publisher) = (host.clone(), publisher.clone());
                publishers.push(RecordedPublisher { host, publisher, is_agent, last_part });
            }
        }
    }
    let mut talws = Talws::new();
    for host in hosts {
        talws.host(host);
    }
    match run.time {
        TimeMode::Simulated { seed } => talws.replay(seed, &publishers),
        TimeMode::Real => talws.replay_real_time(&publishers),
    }
}

#[cfg(test)]
mod tests {
    use super::fits;

    #[test]
    fn agents_are_meant_by_their_name_or_their_host() {
        for pattern in ["Goalie", "goalie", "blue-1/goalie", "blue-1"] {
            assert!(fits(pattern, "blue-1", "Goalie"), "{pattern}");
        }
        for pattern in ["goal", "red-1", "red-1/goalie", "blue-1/"] {
            assert!(!fits(pattern, "blue-1", "Goalie"), "{pattern}");
        }
    }
}
