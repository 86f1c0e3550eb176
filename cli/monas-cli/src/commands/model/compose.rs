//! `monas model compose`: explores the composition of several robots for deadlocks.

use std::path::{Path, PathBuf};
use std::sync::Arc;

use aseme_models::Iac;
use aseme_models::convert::Model;
use aseme_models::iac::ChartKind;
use aseme_verify::composition::{Channels, Composition, compose};
use aseme_verify::{CheckSettings, check_external_events, protocol::parts_taken};
use clap::{Args, ValueHint};
use monas_terminal::{CommandFailure, CommandOutput, Exit, Format, FormatArgument, counted, report};
use serde_json::json;
use yase::{Diagnostic, Source, Span};

use super::conform::NamedChart;
use super::exploration::ExplorationArguments;
use super::robot_file::{name_of, named};
use super::{conform, finding, program};
use crate::input::{valid_chart, valid_model};

/// Arguments of `monas model compose`.
#[derive(Args, Debug)]
pub(crate) struct ComposeArguments {
    /// The model of each robot, as `NAME=FILE` if the robot is not named after its file, as
    /// `ROBOT/AGENT=FILE` if it is one of several agents of a robot; and the models of a protocol.
    #[arg(required = true, value_name = "FILE", value_hint = ValueHint::FilePath)]
    pub(crate) files: Vec<PathBuf>,
    /// The capacity of the channel from one robot to another, in messages; when it is full the
    /// oldest is lost.
    #[arg(long, value_name = "NUMBER", default_value_t = 2, value_parser = clap::builder::RangedU64ValueParser::<usize>::new().range(1..=64))]
    pub(crate) channel: usize,
    /// Allow the loss of any message.
    #[arg(long)]
    pub(crate) lose: bool,
    /// An external event, raised by an activity or a person.
    #[arg(long = "event", value_name = "NAME")]
    pub(crate) events: Vec<String>,
    #[command(flatten)]
    pub(crate) exploration: ExplorationArguments,
    /// Use the topics that the activities of this program declare; they are assumed to publish when
    /// they return.
    #[arg(long)]
    pub(crate) linked: bool,
    /// Write the trace to each finding as a file into this folder, for `model run`.
    #[arg(long, value_name = "FOLDER", value_hint = ValueHint::DirPath)]
    pub(crate) traces: Option<PathBuf>,
    #[command(flatten)]
    pub(crate) format: FormatArgument,
}

pub(crate) fn execute(
    arguments: &ComposeArguments,
    console: &mut CommandOutput<'_>,
) -> Result<Exit, CommandFailure> {
    let format = arguments.format.value;
    let cast = Participants::read(&arguments.files, format, console)?;
    let conforms = cast.conforms(format, console)?;
    let mut settings = CheckSettings::default();
    settings.events.extend(arguments.events.iter().cloned());
    let models: Vec<Arc<Source>> = cast.robots.iter().map(|(_, model)| model.clone()).collect();
    check_external_events(&models, &settings).map_err(CommandFailure::Usage)?;
    let interrupt = arguments.exploration.apply(&mut settings, console)?;
    settings.world = arguments.linked.then(program::linked).transpose()?;
    let mut channels = Channels::default();
    (channels.capacity, channels.may_lose) = (arguments.channel, arguments.lose);
    let found =
        compose(&cast.robots, channels, &settings).map_err(|wrong| CommandFailure::Invalid(format, wrong))?;
    if let Some(folder) = &arguments.traces {
        let named = found.findings.iter().map(|finding| (String::from("composed"), finding));
        finding::write_named_traces(folder, named)?;
    }
    match format {
        Format::Text => text(&found, console)?,
        Format::Json => objects(&found, console)?,
    }
    Ok(match interrupt.exit() {
        Some(exit) => exit,
        None if conforms && !found.has_errors() => Exit::Success,
        None => Exit::Diverged,
    })
}

/// The robots, and the files of their protocol.
struct Participants {
    robots: Vec<(String, Arc<Source>)>,
    files: Vec<PathBuf>,
    protocol: Vec<PathBuf>,
}

impl Participants {
    fn read(
        files: &[PathBuf],
        format: Format,
        console: &mut CommandOutput<'_>,
    ) -> Result<Participants, CommandFailure> {
        let (mut robots, mut protocol) = (Vec::new(), Vec::new());
        for file in files {
            let path = name_of(file).1;
            let (source, model, ..) = valid_model(&path, format, console)?;
            match model {
                Model::Aip(_) => protocol.push(path),
                Model::Chart(chart) if chart.kind == ChartKind::Inter => protocol.push(path),
                Model::Chart(_) | Model::Role(_) => robots.push((file.clone(), source)),
                other => {
                    let (path, kind) = (path.display(), other.kind());
                    return Err(CommandFailure::Usage(format!(
                        "`{path}` is a model of the kind {kind}: expected robots (roles or charts) or a protocol (AIP, EAC)"
                    )));
                }
            }
        }
        if robots.is_empty() {
            return Err(CommandFailure::Usage("no file is the model of a robot (a role or a chart)".into()));
        }
        let files: Vec<PathBuf> = robots.iter().map(|(file, _)| file.clone()).collect();
        let names = named(&files)?;
        let robots =
            names.iter().zip(robots).map(|((name, _), (_, source))| (name.clone(), source)).collect();
        Ok(Participants { robots, files: names.into_iter().map(|(_, file)| file).collect(), protocol })
    }

    /// Whether the participants conform to the protocol and every part is taken; true without a
    /// protocol.
    fn conforms(&self, format: Format, console: &mut CommandOutput<'_>) -> Result<bool, CommandFailure> {
        if self.protocol.is_empty() {
            return Ok(true);
        }
        let protocol = conform::LoadedModels::read(&self.protocol, format, console)?;
        let charts = protocol.charts(format)?;
        let mut taken: Vec<(String, bool)> = Vec::new();
        let mut files = self.protocol.clone();
        for file in &self.files {
            let player = player(file, format, console)?;
            let parts: Vec<(String, bool)> =
                charts.iter().flat_map(|(_, _, chart)| parts_taken(&player, chart)).collect();
            if parts.iter().any(|(_, is_taken)| *is_taken) && !files.contains(file) {
                files.push(file.clone());
            }
            taken.extend(parts);
        }
        let is_given = conform::conform(&files, format, console)? == Exit::Success;
        let mut missing: Vec<&str> = taken.iter().map(|(name, _)| name.as_str()).collect();
        missing.sort_unstable();
        missing.dedup();
        missing.retain(|name| !taken.iter().any(|(other, is_taken)| other == name && *is_taken));
        let found: Vec<Diagnostic> = missing.iter().map(|name| unplayed_role(name, &charts)).collect();
        report::write(console, format, &found)?;
        Ok(is_given && found.is_empty())
    }
}

/// The error for a part that no robot takes, at the part in its protocol.
fn unplayed_role(name: &str, charts: &[NamedChart]) -> Diagnostic {
    let message = format!("no robot takes the part `{name}` in the protocol");
    let mut nodes =
        charts.iter().flat_map(|(_, source, chart)| chart.nodes.iter().map(move |node| (source, node)));
    let part = nodes.find(|(_, node)| node.name == name);
    let span = part.map_or_else(Span::default, |(_, node)| node.position.0);
    let found = Diagnostic::error("E0936", span, message)
        .with_hint("compose it with a role that has a composite of that name");
    match part {
        Some((source, _)) => found.in_source(source),
        None => found,
    }
}

fn player(path: &Path, format: Format, console: &mut CommandOutput<'_>) -> Result<Iac, CommandFailure> {
    Ok(Iac::from_statechart(&valid_chart(path, format, console)?, ChartKind::Intra))
}

fn text(found: &Composition, console: &mut CommandOutput<'_>) -> Result<(), CommandFailure> {
    for finding in &found.findings {
        report::write(console, Format::Text, std::slice::from_ref(&finding.diagnostic))?;
        finding::print_trace(finding, console)?;
    }
    if found.is_one_process {
        let note = "no chart reads a message by the name of a robot: these are agents of one process";
        writeln!(console.out, "{note}")?;
    }
    for (from, to, message) in &found.passing {
        writeln!(console.out, "`{message}` passes from {from} to {to}")?;
    }
    if found.passing.is_empty() {
        writeln!(console.out, "no message passes between robots: no chart reads one by the name of a robot")?;
    }
    for (name, states) in &found.robots {
        writeln!(console.out, "{name}: {} explored", counted(*states as u64, "state"))?;
    }
    if !found.has_errors() {
        writeln!(console.out, "no deadlock; all {} states of the composition were explored", found.states)?;
    }
    Ok(())
}

fn objects(found: &Composition, console: &mut CommandOutput<'_>) -> Result<(), CommandFailure> {
    for finding in &found.findings {
        writeln!(console.err, "{}", finding::object(finding))?;
    }
    for (from, to, message) in &found.passing {
        writeln!(console.out, "{}", json!({"message": message, "from": from, "to": to}))?;
    }
    for (name, states) in &found.robots {
        writeln!(console.out, "{}", json!({"robot": name, "states": states}))?;
    }
    writeln!(
        console.out,
        "{}",
        json!({"states": found.states, "finished": found.is_finished, "one_process": found.is_one_process})
    )?;
    Ok(())
}
