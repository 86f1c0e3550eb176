//! Findings of checks and the traces to them, as text, JSON and files.

use std::collections::BTreeMap;
use std::fs;
use std::path::Path;

use aseme_verify::{Finding, check::CheckReport};
use monas_terminal::{CommandFailure, CommandOutput, Format, report};

/// Prints the trace to a finding, if there is one.
pub(crate) fn print_trace(finding: &Finding, console: &mut CommandOutput<'_>) -> Result<(), CommandFailure> {
    if let Some(trace) = finding.trace.as_ref().filter(|_| finding.diagnostic.is_error() || !console.quiet) {
        writeln!(console.err, "  trace:\n{}", indented(trace))?;
    }
    Ok(())
}

fn indented(trace: &str) -> String {
    trace.lines().map(|line| format!("    {line}\n")).collect()
}

pub(crate) fn object(finding: &Finding) -> serde_json::Value {
    let mut object = report::object(&finding.diagnostic);
    if let (Some(trace), Some(fields)) = (&finding.trace, object.as_object_mut()) {
        fields.insert("trace".into(), trace.clone().into());
    }
    object
}

/// Writes `MODEL-CODE-NUMBER.trace` for each finding with a trace; creates the folder if necessary.
pub(crate) fn write_traces(folder: &Path, reports: &[(&Path, CheckReport)]) -> Result<(), CommandFailure> {
    let found = reports.iter().flat_map(|(model, report)| {
        let model = model.file_stem().map_or_else(String::new, |stem| stem.to_string_lossy().into_owned());
        report.findings.iter().map(move |finding| (model.clone(), finding))
    });
    write_named_traces(folder, found)
}

/// Writes the trace to each finding as `NAME-CODE-NUMBER.trace`.
pub(crate) fn write_named_traces<'f>(
    folder: &Path,
    found: impl Iterator<Item = (String, &'f Finding)>,
) -> Result<(), CommandFailure> {
    let failed = |verb: &str, path: &Path, error: std::io::Error| {
        CommandFailure::Failed(Format::Text, format!("cannot {verb} {}: {error}", path.display()))
    };
    fs::create_dir_all(folder).map_err(|error| failed("make", folder, error))?;
    let mut numbers: BTreeMap<String, usize> = BTreeMap::new();
    for (model, finding) in found {
        let Some(trace) = &finding.trace else { continue };
        let name = format!("{model}-{}", finding.diagnostic.code);
        let number = numbers.entry(name.clone()).or_default();
        *number += 1;
        let path = folder.join(format!("{name}-{number}.trace"));
        let text = format!("# {}\n{trace}", finding.diagnostic.message);
        monas_files::write(&path, text).map_err(|error| failed("write", &path, error))?;
    }
    Ok(())
}
