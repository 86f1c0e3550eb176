//! `monas model check`: what is wrong with models.

mod sarif;

use std::path::Path;

use aseme::check::{Report, Settings};
use monas::config;
use yase::{Diagnostic, Severity};

use crate::arguments::{CheckArguments, CheckFormat, Format};
use crate::console::Console;
use crate::exit::Exit;
use crate::failure::Failure;
use crate::report;

pub(crate) fn execute(arguments: &CheckArguments, console: &mut Console<'_>) -> Result<Exit, Failure> {
    let mut settings = Settings::default();
    settings.events.extend(arguments.events.iter().cloned());
    let reports: Vec<(&Path, Report)> = arguments
        .files
        .iter()
        .map(|path| (path.as_path(), checked(path, &settings, arguments.all)))
        .collect();
    match arguments.format {
        CheckFormat::Text => text(&reports, console)?,
        CheckFormat::Json => {
            for (_, report) in &reports {
                report::write(console, Format::Json, &diagnostics(report))?;
            }
        }
        CheckFormat::Sarif => {
            let findings = reports.iter().flat_map(|(_, report)| &report.findings);
            writeln!(console.out, "{:#}", sarif::document(findings))?;
        }
    }
    Ok(verdict(&reports))
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

fn diagnostics(report: &Report) -> Vec<Diagnostic> {
    report.findings.iter().map(|finding| finding.diagnostic.clone()).collect()
}

/// All that is wrong with all files, and one line for each that has no error.
fn text(reports: &[(&Path, Report)], console: &mut Console<'_>) -> Result<(), Failure> {
    for (path, report) in reports {
        report::write(console, Format::Text, &diagnostics(report))?;
        if let Some(what) = report.what.as_ref().filter(|_| !report.has_errors()) {
            writeln!(console.out, "{}: {what}, no errors", path.display())?;
        }
    }
    Ok(())
}
