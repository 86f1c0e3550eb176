//! `monas tape what-if`: a recorded match with other agents from a moment on.

use std::path::PathBuf;
use std::time::Duration;

use aseme_models::convert::Model;
use aseme_models::iac::{ChartKind, Iac};
use clap::{Args, ValueHint};
use monas::duration;
use monas::records::{Action, Change, Setting};
use monas_match::{MatchOptions, MatchPlan, MatchSource};
use monas_studio::{TapeChart, TapeRun};
use monas_tape::{ExistingFile, Recording, Tape, TapeFile};
use monas_terminal::{CommandFailure, CommandOutput, Exit, Format, FormatArgument, failed, report, table};
use serde_json::{Value, json};
use yase::expression::{Expression, parse_transition};

use crate::commands::studio::scene;
use crate::input::{
    ConfigurationKind, LayerArguments, check_within, end_of, file_parser, kind_of, layers, recorded_charts,
    recorded_configuration, run_of,
};

/// Arguments of `monas tape what-if`.
#[derive(Args, Debug)]
pub(crate) struct WhatIfArguments {
    /// The tape of a match in simulated time, with all topics from its start.
    #[arg(value_hint = ValueHint::FilePath)]
    file: PathBuf,
    /// The moment of the change, for example 7.5s.
    #[arg(long, value_name = "TIME", value_parser = duration::parse)]
    at: Duration,
    /// Set a value of agents: agent.NAME.ATTRIBUTE=VALUE, or agent.NAME.ACTIVITY.PARAMETER=VALUE.
    /// May be given several times.
    #[arg(long = "set", value_name = "PATH=VALUE", required_unless_present = "guards")]
    settings: Vec<String>,
    /// Replace the guard of a transition: `A -> B=[condition]`. May be given several times.
    #[arg(long = "guard", value_name = "A -> B=[…]")]
    guards: Vec<String>,
    /// Change only agents of this robot; of all if not given. May be given several times.
    #[arg(long = "host", value_name = "NAME")]
    hosts: Vec<String>,
    /// Play up to this time of the match; up to the end of the tape if not given.
    #[arg(long = "for", value_name = "TIME", value_parser = duration::parse)]
    length: Option<Duration>,
    /// Keep the other future as a tape.
    #[arg(short, long, value_name = "FILE", value_hint = ValueHint::FilePath, value_parser = file_parser())]
    output: Option<PathBuf>,
    #[command(flatten)]
    format: FormatArgument,
}

pub(crate) fn execute(
    arguments: &WhatIfArguments,
    console: &mut CommandOutput<'_>,
) -> Result<Exit, CommandFailure> {
    let format = arguments.format.value;
    let refused = |reason: String| CommandFailure::Failed(format, reason);
    let recording = Recording::open(&arguments.file).map_err(failed(format))?;
    let overview = recording.overview().map_err(failed(format))?;
    let run = run_of(&arguments.file, &overview).map_err(refused)?;
    run.warn(console.err)?;
    let seed =
        run.seed().ok_or_else(|| refused("only a run in simulated time can be played again".into()))?;
    let charts = recorded_charts(&recording, format)?;
    let recorded = TapeRun::new("", recording.clone(), &charts, scene()).map_err(failed(format))?;
    check_within("--at", arguments.at.as_secs_f64(), &overview)?;
    if arguments.length.is_some_and(|length| length < arguments.at) {
        return Err(CommandFailure::Usage("--for is a time of the match, which is before --at".to_owned()));
    }
    let changes = changes(arguments, &recorded).map_err(refused)?;

    let folder = tempfile::tempdir().map_err(failed(format))?;
    let path = arguments.output.clone().unwrap_or_else(|| folder.path().join("what-if.mcap"));
    let file = TapeFile::create(&path, ExistingFile::Keep).map_err(failed(format))?;
    if file.path() != path {
        let (new, path) = (file.path().display(), path.display());
        report::note(console, format, &format!("recording into {new} for {path}, since that file exists"))?;
    }
    let path = file.path().to_owned();
    let tape = Tape::to_file(file).map_err(failed(format))?;
    let options = MatchOptions { seed, record: Some(tape.clone()) };
    let plan = plan(&recording, folder.path(), format)?;
    let mut running = plan.start(options).map_err(failed(format))?;
    // Without the end of its run a tape may lack messages of its last moment.
    let recorded_end = end_of(&overview).map_or_else(
        || Duration::from_secs_f64(recorded.end_seconds()),
        |end| Duration::from_nanos(end.as_nanos()),
    );
    let end = arguments.length.unwrap_or(recorded_end);
    running.advance(arguments.at).map_err(failed(format))?;
    let mut texts = Vec::new();
    for PlannedChange { host, text, change } in changes {
        let changed = running.change(&host, change).map_err(failed(format))?;
        if !changed.done {
            let reasons: Vec<&str> =
                changed.findings.iter().map(|finding| finding.message.as_str()).collect();
            return Err(refused(format!("{host}: {text} is refused: {}", reasons.join("; "))));
        }
        texts.push(format!("{host}: {text}"));
    }
    running.advance(end.max(arguments.at)).map_err(failed(format))?;
    running.finish().map_err(failed(format))?;
    tape.finish().map_err(failed(format))?;

    let other = Recording::open(&path).map_err(failed(format))?;
    let other = TapeRun::new("", other, &charts, scene()).map_err(failed(format))?;
    let end = end.min(recorded_end).as_secs_f64();
    let futures =
        RunComparison { recorded: &recorded, other: &other, at: arguments.at.as_secs_f64(), end, texts };
    futures.write(console, format)
}

/// The recorded match.
fn plan(
    recording: &Recording,
    folder: &std::path::Path,
    format: Format,
) -> Result<MatchPlan, CommandFailure> {
    let (path, settings) = recorded_configuration(recording, folder, format)?;
    let invalid = |diagnostics| CommandFailure::Invalid(format, diagnostics);
    if kind_of(&path).map_err(|unread| invalid(vec![*unread]))? != ConfigurationKind::Match {
        return Err(CommandFailure::Failed(format, "the tape is not that of a match".into()));
    }
    let layers = layers::of(&path, &LayerArguments { settings, robot: None }).map_err(invalid)?;
    MatchSource::load_with(&path, &monas::Registry::linked(), &layers).map_err(invalid)
}

/// A change of one agent.
struct PlannedChange {
    host: String,
    text: String,
    change: Change,
}

fn changes(arguments: &WhatIfArguments, tape: &TapeRun) -> Result<Vec<PlannedChange>, String> {
    let mut hosts = tape.chart_hosts();
    arguments.hosts.iter().try_for_each(|host| tape.check_chart_host(host))?;
    hosts.retain(|host| arguments.hosts.is_empty() || arguments.hosts.iter().any(|wanted| wanted == host));
    let mut planned = Vec::new();
    for setting in &arguments.settings {
        planned.extend(setting_changes(setting, &hosts, tape)?);
    }
    let mut charts: Vec<(TapeChart, Vec<String>)> = Vec::new();
    for guard in &arguments.guards {
        let (name, condition) = parse_guard(guard)?;
        let (mut reason, mut is_found) = (String::new(), false);
        for host in &hosts {
            match tape.transition(host, None, name) {
                Ok((chart, transition)) => {
                    is_found = true;
                    let index = charts.iter().position(|(known, _)| {
                        (&known.host, &known.agent, known.chart) == (&chart.host, &chart.agent, chart.chart)
                    });
                    let position = index.unwrap_or_else(|| {
                        charts.push((chart.clone(), Vec::new()));
                        charts.len() - 1
                    });
                    let (chart, texts) = &mut charts[position];
                    chart.statechart.transition_mut(transition).expression.guard = Some(condition.clone());
                    texts.push(guard.clone());
                }
                Err(error) => reason = error,
            }
        }
        if !is_found {
            return Err(reason);
        }
    }
    planned.extend(charts.into_iter().map(|(chart, texts)| {
        let model = Model::Chart(Iac::from_statechart(&chart.statechart, ChartKind::Intra));
        let change = Change {
            action: Action::SwapModel.into(),
            agent: chart.agent.clone(),
            chart: (chart.chart + 1).to_string(),
            file: "what-if.iac".into(),
            text: model.to_text(),
            ..Change::default()
        };
        PlannedChange { host: chart.host, text: format!("{}: {}", chart.agent, texts.join(", ")), change }
    }));
    Ok(planned)
}

/// A transition and its other guard.
fn parse_guard(text: &str) -> Result<(&str, Expression), String> {
    let wrong = || format!("`{text}` is not `A -> B=[condition]`");
    let (name, condition) = text.split_once("=[").ok_or_else(wrong)?;
    let (expression, diagnostics) = parse_transition(&format!("[{condition}"));
    if let Some(diagnostic) = diagnostics.iter().find(|diagnostic| diagnostic.is_error()) {
        return Err(format!("`{text}`: {}", diagnostic.message));
    }
    match (expression.guard, expression.trigger, &expression.actions[..]) {
        (Some(guard), None, []) => Ok((name.trim(), guard)),
        _ => Err(wrong()),
    }
}

/// The changes of a setting `agent.NAME.KEY=VALUE`, on each host with such an agent.
fn setting_changes(text: &str, hosts: &[&str], tape: &TapeRun) -> Result<Vec<PlannedChange>, String> {
    let wrong = || format!("`{text}` is not agent.NAME.KEY=VALUE");
    let (path, value) = text.split_once('=').ok_or_else(wrong)?;
    let (agent, key) = path.strip_prefix("agent.").and_then(|rest| rest.split_once('.')).ok_or_else(wrong)?;
    let on: Vec<&&str> = hosts.iter().filter(|host| tape.has_agent(host, agent)).collect();
    if on.is_empty() {
        return Err(format!("no robot has an agent `{agent}`"));
    }
    Ok(on
        .into_iter()
        .map(|host| {
            let settings = vec![Setting { key: key.to_owned(), value: value.to_owned() }];
            let (action, agent) = (Action::Set.into(), agent.to_owned());
            let change = Change { action, agent, settings, ..Change::default() };
            PlannedChange { host: (*host).to_owned(), text: text.to_owned(), change }
        })
        .collect())
}

/// The recorded future and the other one.
struct RunComparison<'a> {
    recorded: &'a TapeRun,
    other: &'a TapeRun,
    /// The moment of the change, s.
    at: f64,
    /// The end of the comparison, which is not part of it, s.
    end: f64,
    texts: Vec<String>,
}

impl RunComparison<'_> {
    fn write(&self, console: &mut CommandOutput<'_>, format: Format) -> Result<Exit, CommandFailure> {
        let difference = self.recorded.first_difference(self.other, self.end);
        if let Some(before) = difference.as_ref().filter(|difference| difference.time < self.at) {
            let reason = format!(
                "the match is not played as it was recorded: {} number {} of {} differs at {:.3} s already",
                before.topic, before.sequence, before.host, before.time
            );
            return Err(CommandFailure::Failed(format, reason));
        }
        let scores = [self.recorded, self.other].map(|tape| score(tape, self.end));
        let events = [self.recorded, self.other].map(|tape| tape.events_between(self.at, self.end));
        if format == Format::Json {
            let object = json!({"at": self.at, "until": self.end, "changes": self.texts, "difference": difference,
                "recorded": {"score": scores[0], "events": events[0]},
                "what_if": {"score": scores[1], "events": events[1]}});
            writeln!(console.out, "{object}")?;
            return Ok(Exit::Success);
        }
        writeln!(console.out, "the recorded match up to {:.3} s, and from there with", self.at)?;
        for text in &self.texts {
            writeln!(console.out, "  {text}")?;
        }
        match &difference {
            None => writeln!(console.out, "no message differs up to {:.3} s", self.end)?,
            Some(difference) => {
                let of = format!("{} number {}", difference.topic, difference.sequence);
                let by = format!("{} of {}", difference.publisher, difference.host);
                writeln!(console.out, "first difference at {:.3} s: {of} by {by}", difference.time)?;
                let text = |value: &Value| if value.is_null() { "-".into() } else { value.to_string() };
                let fields = difference.fields();
                let rows = fields.iter().map(|(name, a, b)| [name.clone(), text(a), text(b)]);
                writeln!(console.out, "{}", table::of_numbers(["field", "recorded", "what if"], 3, rows))?;
            }
        }
        for (name, (score, events)) in ["recorded", "what if"].into_iter().zip(scores.iter().zip(&events)) {
            writeln!(console.out, "{name}: {score} at {:.3} s", self.end)?;
            for event in events {
                writeln!(console.out, "  {:.3} s  {}", event.time, event.text)?;
            }
        }
        Ok(Exit::Success)
    }
}

fn score(tape: &TapeRun, end: f64) -> String {
    let banner = tape.banner_at(end);
    let groups = banner.map(|banner| banner.groups).unwrap_or_default();
    groups.iter().map(|(name, score)| format!("{name} {score}")).collect::<Vec<_>>().join(", ")
}
