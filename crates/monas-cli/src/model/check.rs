//! `monas model check`: what is wrong with models.

mod properties;
mod sarif;
pub(super) mod traces;

use std::path::Path;

use aseme::check::{Finding, Report, Settings, World};
use monas::{Registry, config};
use yase::Severity;

use crate::arguments::{CheckArguments, CheckFormat, Format};
use crate::console::Console;
use crate::exit::Exit;
use crate::failure::Failure;
use crate::report;
use properties::Judged;

/// The topics that the runtime, bodies and the simulator publish and read, by how their paths begin.
const ELSEWHERE: [&str; 3] = ["monas/", "body/", "sim/"];

pub(crate) fn execute(arguments: &CheckArguments, console: &mut Console<'_>) -> Result<Exit, Failure> {
    let mut settings = Settings::default();
    settings.events.extend(arguments.events.iter().cloned());
    (settings.states, settings.pool) = (arguments.states, arguments.pool);
    settings.world = arguments.linked.then(linked).transpose()?;
    settings.recorded = super::coverage::recorded(&arguments.tapes)?;
    let (mut reports, mut judged): (Vec<(&Path, Report)>, Vec<Judged>) = (Vec::new(), Vec::new());
    for path in &arguments.files {
        let report = match arguments.properties.as_slice() {
            [] => checked(path, &settings, arguments.all),
            files => properties::checked(path, files, &settings, &mut judged),
        };
        reports.push((path, report));
    }
    if let Some(folder) = &arguments.traces {
        traces::write(folder, &reports)?;
    }
    match arguments.format {
        CheckFormat::Text => {
            text(&reports, arguments.properties.is_empty(), console)?;
            properties::text(&judged, console)?;
        }
        CheckFormat::Json => {
            json(&reports, console)?;
            properties::json(&judged, console)?;
        }
        CheckFormat::Sarif => {
            let findings = reports.iter().flat_map(|(_, report)| &report.findings);
            writeln!(console.out, "{:#}", sarif::document(findings))?;
        }
    }
    Ok(verdict(&reports))
}

/// The messages and functions of this program, and its activities with what they say that they publish and read.
pub(super) fn linked() -> Result<World, Failure> {
    let registry = Registry::linked();
    let vocabulary = registry.vocabulary().map_err(|error| Failure::failed(Format::Text, error))?;
    let mut world = World { vocabulary, ..World::default() };
    for name in registry.activity_names() {
        let activity = registry.activity(name).map_err(|error| Failure::failed(Format::Text, error))?;
        let topics = activity.topics();
        let named = |paths: &[&str]| {
            topics.is_declared().then(|| paths.iter().map(|&path| path.to_owned()).collect())
        };
        world.activities.insert(name.to_owned(), named(topics.published_paths()));
        world.readers.insert(name.to_owned(), named(topics.read_paths()));
    }
    let paths = world.vocabulary.topics.iter().map(|topic| topic.path.clone());
    let is_elsewhere = |path: &String| ELSEWHERE.iter().any(|begin| path.starts_with(begin));
    world.elsewhere = paths.filter(is_elsewhere).collect();
    Ok(world)
}

/// A model that cannot be read is worse than one that is wrong.
fn verdict(reports: &[(&Path, Report)]) -> Exit {
    let any = |is_so: fn(&Report) -> bool| reports.iter().any(|(_, report)| is_so(report));
    match (any(Report::is_unreadable), any(Report::has_errors)) {
        (true, _) => Exit::Invalid,
        (false, true) => Exit::Diverged,
        (false, false) => Exit::Success,
    }
}

fn checked(path: &Path, settings: &Settings, all: bool) -> Report {
    let mut report = match config::read_file(path) {
        Ok(source) => aseme::check::check(&source, settings),
        Err(diagnostic) => Report::of_unreadable(*diagnostic),
    };
    report.findings.retain(|finding| all || finding.diagnostic.severity > Severity::Information);
    report
}

/// All that is wrong with all files, and, where models themselves are looked at, one line for each that has no error.
fn text(reports: &[(&Path, Report)], is_told: bool, console: &mut Console<'_>) -> Result<(), Failure> {
    for (path, report) in reports {
        for finding in &report.findings {
            report::write(console, Format::Text, std::slice::from_ref(&finding.diagnostic))?;
            way_there(finding, console)?;
        }
        if let Some(what) = report.what.as_ref().filter(|_| is_told && !report.has_errors()) {
            writeln!(console.out, "{}: {what}{}, no errors", path.display(), extent(report))?;
        }
    }
    Ok(())
}

/// The way to a finding, if there is one.
pub(super) fn way_there(finding: &Finding, console: &mut Console<'_>) -> Result<(), Failure> {
    if let Some(trace) = &finding.trace {
        writeln!(console.err, "  a way there:\n{}", indented(trace))?;
    }
    Ok(())
}

fn indented(trace: &str) -> String {
    trace.lines().map(|line| format!("    {line}\n")).collect()
}

/// How far an exploration came.
fn extent(report: &Report) -> String {
    match report.explored {
        Some(explored) if explored.is_finished => format!(", {} states explored", explored.states),
        Some(explored) => format!(", not finished exploring: {} states", explored.states),
        None => String::new(),
    }
}

/// One object a line; those with a way there have it as `trace`.
fn json(reports: &[(&Path, Report)], console: &mut Console<'_>) -> Result<(), Failure> {
    for finding in reports.iter().flat_map(|(_, report)| &report.findings) {
        writeln!(console.err, "{}", object(finding))?;
    }
    Ok(())
}

pub(super) fn object(finding: &Finding) -> serde_json::Value {
    let mut object = report::object(&finding.diagnostic);
    if let (Some(trace), Some(fields)) = (&finding.trace, object.as_object_mut()) {
        fields.insert("trace".into(), trace.clone().into());
    }
    object
}
