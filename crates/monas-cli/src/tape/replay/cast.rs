//! Who plays in a replay: the run that was recorded, its configuration, and the agents that are wanted.

use std::collections::BTreeMap;
use std::io::{self, Write};
use std::path::Path;

use monas::replay::{Company, Replay};
use monas::{Agent, HostConfig, Provenance, Registry, Talws};
use monas_match::Match;
use monas_tape::{Channel, Content, Overview, Recording};
use yase::Diagnostic;

use super::super::arguments::ReplayArguments;
use super::super::failed;
use super::super::select::unknown;
use crate::arguments::{Format, LayerArguments};
use crate::config::layers;
use crate::failure::Failure;
use crate::run::{Kind, kind_of};

/// What a tape says of its run.
pub(super) struct Run {
    version: String,
    configuration: String,
    /// What the command line had set, a line each.
    settings: String,
    /// Where the configuration was, if that makes a difference.
    folder: Option<String>,
    time: Time,
}

/// How its time passed.
enum Time {
    Simulated { seed: u64 },
    Real,
}

/// The run of a tape.
///
/// The error says why it cannot be replayed.
pub(super) fn run_of(overview: &Overview) -> Result<Run, String> {
    if let Some(damage) = overview.damages.first() {
        return Err(format!("{damage}; `monas tape recover` keeps what can be read"));
    }
    let facts = overview.facts.iter().find(|facts| facts.name == monas_match::RUN);
    let facts =
        &facts.ok_or("the tape does not say of which run it is: it was not recorded by `monas run`")?.entries;
    let fact =
        |key: &str| facts.get(key).cloned().ok_or(format!("the tape does not say the {key} of its run"));
    let time = match fact("time")?.as_str() {
        "simulated" => Time::Simulated { seed: seed(&fact("seed")?)? },
        _ => Time::Real,
    };
    if let Some(dropped) = dropped(overview) {
        return Err(format!(
            "{dropped} messages were left out of the tape because the disk was too slow: what agents were given is not on it"
        ));
    }
    if let Some((topic, number)) = begun_late(overview) {
        return Err(format!(
            "the tape does not begin with its run: the first message on `{topic}` is number {number}"
        ));
    }
    let settings = facts.get(monas_match::SETTINGS).cloned().unwrap_or_default();
    let folder = facts.get(monas_match::FOLDER).cloned();
    Ok(Run { version: fact("version")?, configuration: fact("configuration")?, settings, folder, time })
}

/// A topic of whose publishers one had published before the tape began, and the number of the first message that it has of it.
fn begun_late(overview: &Overview) -> Option<(&str, u32)> {
    let mut first: BTreeMap<(&str, &str, &str), u32> = BTreeMap::new();
    for one in overview.channels.iter().filter(|one| one.channel.received_by.is_none()) {
        let Channel { host, topic, publisher, .. } = &*one.channel;
        // Its parts count together.
        let number = first.entry((host, topic, publisher)).or_insert(u32::MAX);
        *number = one.first_sequence.min(*number);
    }
    first.into_iter().find(|(_, number)| *number != 1).map(|((_, topic, _), number)| (topic, number))
}

fn seed(text: &str) -> Result<u64, String> {
    text.parse().map_err(|_| format!("the tape's seed `{text}` is no number"))
}

/// How many messages were left out, if any were.
fn dropped(overview: &Overview) -> Option<&str> {
    let dropped = overview.facts.iter().filter_map(|facts| facts.entries.get("dropped"));
    dropped.map(String::as_str).find(|dropped| *dropped != "0")
}

impl Run {
    /// Says what may make a difference.
    pub(super) fn warn(&self, err: &mut dyn Write) -> io::Result<()> {
        let ours = env!("CARGO_PKG_VERSION");
        match self.version == ours {
            true => Ok(()),
            false => writeln!(err, "the tape was recorded by version {}, this is {ours}", self.version),
        }
    }
}

/// The hosts with the agents that are wanted.
pub(super) fn hosts(
    arguments: &ReplayArguments,
    recording: &Recording,
    run: &Run,
) -> Result<Vec<HostConfig>, Failure> {
    let format = arguments.format.value;
    let hosts = match &arguments.config {
        Some(path) => load(path, "", format)?,
        None => configured(recording, run, format)?,
    };
    choose(hosts, &arguments.agents)
}

/// The hosts of a recording with all their agents, as its configuration and models describe them.
pub(crate) fn recorded_hosts(recording: &Recording, format: Format) -> Result<Vec<HostConfig>, Failure> {
    let overview = recording.overview().map_err(failed(format))?;
    let run = run_of(&overview).map_err(|message| Failure::Failed(format, message))?;
    configured(recording, &run, format)
}

fn configured(recording: &Recording, run: &Run, format: Format) -> Result<Vec<HostConfig>, Failure> {
    let folder = tempfile::tempdir().map_err(|error| Failure::failed(format, error))?;
    let files = files(recording, run).map_err(failed(format))?;
    let path = files.unpack(folder.path()).map_err(|error| Failure::failed(format, error))?;
    load(&path, &run.settings, format)
}

/// The configuration in a tape.
fn files(recording: &Recording, run: &Run) -> Result<Provenance, monas_tape::Error> {
    let mut files = Vec::new();
    for content in recording.contents()? {
        if let Content::Attachment(file) = content? {
            files.push((file.name.to_owned(), file.bytes.to_vec()));
        }
    }
    let files = Provenance::from_files(run.configuration.clone(), files);
    Ok(match &run.folder {
        Some(folder) => files.in_folder(folder),
        None => files,
    })
}

/// The agents of a configuration; warnings have been given when it was recorded, or are given when it is run.
fn load(path: &Path, settings: &str, format: Format) -> Result<Vec<HostConfig>, Failure> {
    let registry = Registry::linked();
    let invalid = |diagnostics| Failure::Invalid(format, diagnostics);
    let settings = settings.lines().map(str::to_owned).collect();
    let layers = layers::of(path, &LayerArguments { settings, robot: None }).map_err(invalid)?;
    match kind_of(path).map_err(|unread| invalid(vec![*unread]))? {
        Kind::Match => Ok(Match::load_with(path, &registry, &layers).map_err(invalid)?.agents()),
        Kind::Agents => {
            let (setup, diagnostics) = monas::config::load_with(path, &registry, &layers);
            if diagnostics.iter().any(Diagnostic::is_error) {
                return Err(invalid(diagnostics));
            }
            let monas::config::Setup { agents, links, modules, .. } = setup;
            let name = Talws::LOCAL.into();
            Ok(vec![HostConfig { name, agents, links, modules, ..HostConfig::default() }])
        }
    }
}

/// Those hosts and agents that are wanted: all, if nothing is said.
fn choose(mut hosts: Vec<HostConfig>, wanted: &[String]) -> Result<Vec<HostConfig>, Failure> {
    let names = |hosts: &[HostConfig]| -> Vec<(String, String)> {
        let of = |host: &HostConfig| {
            host.agents.iter().map(|agent| (host.name.clone(), agent.name().to_owned())).collect::<Vec<_>>()
        };
        hosts.iter().flat_map(of).collect()
    };
    let all = names(&hosts);
    for pattern in wanted {
        if !all.iter().any(|(host, agent)| fits(pattern, host, agent)) {
            let names: Vec<String> = all.iter().map(|(_, agent)| agent.to_lowercase()).collect();
            return Err(unknown("configuration", "agent", pattern, names.iter().map(String::as_str)));
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

/// Whether an agent is meant by `agent`, `host/agent` or `host`; small and large letters are the same.
fn fits(pattern: &str, host: &str, agent: &str) -> bool {
    let same = |a: &str, b: &str| a.to_lowercase() == b.to_lowercase();
    match pattern.split_once('/') {
        Some((on, name)) => same(on, host) && same(name, agent),
        None => same(pattern, agent) || same(pattern, host),
    }
}

/// The replay of these agents, among all who published.
pub(super) fn replay(hosts: Vec<HostConfig>, run: &Run, overview: &Overview) -> Result<Replay, monas::Error> {
    let cycles = monas::records::CYCLE.path();
    let mut company: Vec<Company> = Vec::new();
    for counted in overview.channels.iter().filter(|one| one.channel.received_by.is_none()) {
        let (host, publisher) = (&counted.channel.host, &counted.channel.publisher);
        let (is_agent, last_part) = (counted.channel.topic == cycles, counted.channel.part);
        match company.iter_mut().find(|one| one.host == *host && one.publisher == *publisher) {
            Some(known) => {
                known.is_agent |= is_agent;
                known.last_part = known.last_part.max(last_part);
            }
            None => {
                let (host, publisher) = (host.clone(), publisher.clone());
                company.push(Company { host, publisher, is_agent, last_part });
            }
        }
    }
    let mut talws = Talws::new();
    for host in hosts {
        talws.host(host);
    }
    match run.time {
        Time::Simulated { seed } => talws.replay(seed, &company),
        Time::Real => talws.replay_real_time(&company),
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
