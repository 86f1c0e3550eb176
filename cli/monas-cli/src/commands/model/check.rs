//! `monas model check`: errors in models.

mod properties;
mod sarif;

use std::path::{Path, PathBuf};
use std::sync::Arc;

use aseme_verify::{CheckSettings, check::CheckReport, check_external_events};
use clap::{Args, ValueEnum, ValueHint};
use monas::config;
use monas_terminal::{CommandFailure, CommandOutput, Exit, Format, report};
use serde_json::json;
use yase::{Severity, Source};

use super::exploration::{ExplorationArguments, extent};
use super::{finding, program};
use properties::CheckedProperty;

/// Formats of findings about models.
#[derive(Clone, Copy, PartialEq, Eq, Debug, ValueEnum)]
pub(crate) enum CheckFormat {
    /// For people.
    Text,
    /// For programs: one JSON object per line.
    Json,
    /// For editors and code hosts: SARIF 2.1.0.
    Sarif,
}

/// Arguments of `monas model check`.
#[derive(Args, Debug)]
pub(crate) struct CheckArguments {
    /// The model files.
    #[arg(required = true, value_name = "FILE", value_hint = ValueHint::FilePath)]
    pub(crate) files: Vec<PathBuf>,
    /// An external event, raised by an activity, another agent or a person.
    #[arg(long = "event", value_name = "NAME")]
    pub(crate) events: Vec<String>,
    #[command(flatten)]
    pub(crate) exploration: ExplorationArguments,
    /// The number of activities that the agent's pool runs at once; 12 if not given.
    #[arg(long, value_name = "NUMBER")]
    pub(crate) pool: Option<usize>,
    /// Do not check names against the messages, functions and activities of this program: the
    /// model is that of another one.
    #[arg(long)]
    pub(crate) unlinked: bool,
    /// Also report what this recording covered of the charts (with --all).
    #[arg(long = "tape", value_name = "TAPE", value_hint = ValueHint::FilePath, requires = "all")]
    pub(crate) tapes: Vec<PathBuf>,
    /// Check only the properties in this file, on all behaviours of the charts.
    #[arg(long, value_name = "FILE", value_hint = ValueHint::FilePath)]
    pub(crate) properties: Vec<PathBuf>,
    /// Write the trace to each finding as a file into this folder, for `model run`.
    #[arg(long, value_name = "FOLDER", value_hint = ValueHint::DirPath)]
    pub(crate) traces: Option<PathBuf>,
    /// Also report findings of severity information.
    #[arg(long)]
    pub(crate) all: bool,
    /// For people, or for programs: one JSON object per line, or one SARIF 2.1.0 document on
    /// standard output.
    #[arg(long, value_name = "FORMAT", default_value = "text")]
    pub(crate) format: CheckFormat,
}

pub(crate) fn execute(
    arguments: &CheckArguments,
    console: &mut CommandOutput<'_>,
) -> Result<Exit, CommandFailure> {
    let mut settings = CheckSettings::default();
    settings.events.extend(arguments.events.iter().cloned());
    let models: Vec<_> = arguments.files.iter().map(|path| (path, config::read_file(path))).collect();
    // Files that cannot be read are reported below.
    let read: Vec<_> = models.iter().filter_map(|(_, model)| model.as_ref().ok().cloned()).collect();
    if read.len() == models.len() {
        check_external_events(&read, &settings).map_err(CommandFailure::Usage)?;
    }
    settings.pool = arguments.pool;
    let interrupt = arguments.exploration.apply(&mut settings, console)?;
    settings.world = (!arguments.unlinked).then(program::linked).transpose()?;
    settings.recorded = super::coverage::recorded(&arguments.tapes)?;
    let (mut reports, mut judged): (Vec<(&Path, CheckReport)>, Vec<CheckedProperty>) =
        (Vec::new(), Vec::new());
    for (path, model) in models {
        let report = match (model, arguments.properties.as_slice()) {
            (Err(unread), _) => CheckReport::of_unreadable(*unread),
            (Ok(model), []) => checked(&model, &settings, arguments.all),
            (Ok(model), files) => properties::checked(&model, path, files, &settings, &mut judged),
        };
        reports.push((path, report));
    }
    if let Some(folder) = &arguments.traces {
        finding::write_traces(folder, &reports)?;
    }
    match arguments.format {
        CheckFormat::Text => {
            text(&reports, arguments.properties.is_empty(), console)?;
            properties::text(&judged, console)?;
        }
        CheckFormat::Json => {
            json(&reports, arguments.properties.is_empty(), console)?;
            properties::json(&judged, console)?;
        }
        CheckFormat::Sarif => {
            let findings = reports
                .iter()
                .flat_map(|(_, report)| report.findings.iter().map(|it| (it, report.state_paths(it))));
            writeln!(console.out, "{:#}", sarif::document(findings))?;
        }
    }
    Ok(interrupt.exit().unwrap_or_else(|| verdict(&reports)))
}

/// An unreadable model outweighs one with errors.
fn verdict(reports: &[(&Path, CheckReport)]) -> Exit {
    let any = |is_so: fn(&CheckReport) -> bool| reports.iter().any(|(_, report)| is_so(report));
    match (any(CheckReport::is_unreadable), any(CheckReport::has_errors)) {
        (true, _) => Exit::Invalid,
        (false, true) => Exit::Diverged,
        (false, false) => Exit::Success,
    }
}

fn checked(model: &Arc<Source>, settings: &CheckSettings, all: bool) -> CheckReport {
    let mut report = aseme_verify::check::check(model, settings);
    report.findings.retain(|finding| all || finding.diagnostic.severity > Severity::Information);
    report
}

/// The note on checks that Ctrl-C or the time limit ended.
const STOPPED_NOTE: &str = ", checks not finished (stopped, or the limit of time; see `--seconds`)";

/// Prints the findings of all files, and, without properties, one line for each file without
/// errors.
fn text(
    reports: &[(&Path, CheckReport)],
    has_summary: bool,
    console: &mut CommandOutput<'_>,
) -> Result<(), CommandFailure> {
    for (path, report) in reports {
        for finding in &report.findings {
            report::write(console, Format::Text, std::slice::from_ref(&finding.diagnostic))?;
            finding::print_trace(finding, console)?;
        }
        if let Some(what) = report.kind.as_ref().filter(|_| has_summary && !report.has_errors()) {
            writeln!(
                console.out,
                "{}: {what}{}{}, no errors",
                config::shown_name(path),
                if report.is_stopped { STOPPED_NOTE } else { "" },
                extent(report.explored.as_ref())
            )?;
        }
    }
    Ok(())
}

/// One object per line; a finding with a trace has it as `trace`. Without properties each model
/// that could be read has another line, which says whether its checks are finished.
fn json(
    reports: &[(&Path, CheckReport)],
    has_summary: bool,
    console: &mut CommandOutput<'_>,
) -> Result<(), CommandFailure> {
    let findings = reports.iter().flat_map(|(_, report)| report.findings.iter().map(move |it| (it, report)));
    for (finding, report) in findings {
        let mut object = finding::object(finding);
        let states = report.state_paths(finding);
        if let (false, Some(fields)) = (states.is_empty(), object.as_object_mut()) {
            fields.insert("states".into(), states.into_iter().collect());
        }
        writeln!(console.err, "{object}")?;
    }
    for (path, report) in reports.iter().filter(|(_, report)| has_summary && !report.is_unreadable()) {
        let explored = report.explored.as_ref();
        let is_finished = !report.is_stopped && explored.is_none_or(|explored| explored.is_finished);
        let states = explored.map(|explored| explored.states);
        let object = json!({"model": config::shown_name(path), "states": states, "finished": is_finished});
        writeln!(console.out, "{object}")?;
    }
    Ok(())
}
