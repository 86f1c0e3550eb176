//! The ways to findings, each as a file of its own.

use std::collections::BTreeMap;
use std::fs;
use std::path::Path;

use aseme::check::{Finding, Report};

use crate::arguments::Format;
use crate::failure::Failure;

/// Writes `MODEL-CODE-NUMBER.trace` for each finding with a way there; the folder is made if it is not there.
pub(super) fn write(folder: &Path, reports: &[(&Path, Report)]) -> Result<(), Failure> {
    let found = reports.iter().flat_map(|(model, report)| {
        let model = model.file_stem().map_or_else(String::new, |stem| stem.to_string_lossy().into_owned());
        report.findings.iter().map(move |finding| (model.clone(), finding))
    });
    write_all(folder, found)
}

/// Writes the way to each finding as `NAME-CODE-NUMBER.trace`.
pub(in crate::model) fn write_all<'f>(
    folder: &Path,
    found: impl Iterator<Item = (String, &'f Finding)>,
) -> Result<(), Failure> {
    let failed = |verb: &str, path: &Path, error: std::io::Error| {
        Failure::Failed(Format::Text, format!("cannot {verb} {}: {error}", path.display()))
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
        fs::write(&path, text).map_err(|error| failed("write", &path, error))?;
    }
    Ok(())
}
