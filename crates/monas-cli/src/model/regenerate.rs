//! `monas model regenerate`: what was said of a role's states and transitions, after its formulas were edited.

use std::path::Path;

use aseme::convert::Model;
use aseme::refine::Unmatched;
use aseme::regenerate::{self, Regenerated};
use aseme::srm::{Section, SrmFile};
use monas::config;
use yase::Diagnostic;

use super::{valid_model, write};
use crate::arguments::{Format, RegenerateArguments};
use crate::console::Console;
use crate::exit::Exit;
use crate::failure::Failure;
use crate::report;

pub(crate) fn execute(arguments: &RegenerateArguments, console: &mut Console<'_>) -> Result<Exit, Failure> {
    let format = arguments.format.value;
    let source =
        config::read_file(&arguments.role).map_err(|unread| Failure::Invalid(format, vec![*unread]))?;
    let placed = |found: Vec<Diagnostic>| -> Vec<Diagnostic> {
        found.into_iter().map(|found| found.in_source(&source)).collect()
    };
    let file = match aseme::convert::read(&source) {
        (Some((Model::Role(file), _)), found) if !found.iter().any(Diagnostic::is_error) => *file,
        (Some((Model::Srm(_), _)), _) => {
            return Err(Failure::Usage(format!(
                "`{}` has no comments to put aside what is lost: write it as text by `monas model convert --as role`",
                arguments.role.display()
            )));
        }
        (Some((model, _)), found) if !found.iter().any(Diagnostic::is_error) => {
            let message = "is a model of the kind";
            return Err(Failure::Usage(format!(
                "`{}` {message} {}, not a role",
                arguments.role.display(),
                model.kind()
            )));
        }
        (_, found) => return Err(Failure::Invalid(format, found)),
    };
    let invalid = |found| Failure::Invalid(format, placed(found));
    let mut made = regenerate::put_aside(&file).map_err(invalid)?;
    for path in &arguments.from {
        let entries = entries(path, format, console)?;
        let carried = carried(&made, &entries).map_err(|found| Failure::Invalid(format, found))?;
        (made.text, made.kept) = (carried.text, made.kept + carried.kept);
        made.lost.extend(carried.lost);
    }
    let lost: Vec<Diagnostic> = made.lost.iter().map(warning).collect();
    report::write(console, format, &placed(lost))?;
    let written = write(arguments.output.as_deref(), &made.text, format, console)?;
    if arguments.output.is_some() && format == Format::Text {
        writeln!(console.out, "{} kept, {} lost", made.kept, made.lost.len())?;
    }
    Ok(written)
}

/// What another model says of its states and transitions.
fn entries(
    path: &Path,
    format: Format,
    console: &mut Console<'_>,
) -> Result<Vec<(Section, String)>, Failure> {
    let (source, model, ..) = valid_model(path, format, console)?;
    match model {
        Model::Role(file) => Ok(regenerate::entries_of_role(&file)),
        Model::Chart(chart) => {
            let (chart, found) = chart.to_statechart();
            let found: Vec<Diagnostic> = found.into_iter().map(|found| found.in_source(&source)).collect();
            match found.iter().any(Diagnostic::is_error) {
                true => Err(Failure::Invalid(format, found)),
                false => Ok(regenerate::entries_of_chart(&chart)),
            }
        }
        other => Err(Failure::Usage(format!(
            "`{}` is a model of the kind {}; refinements come from a role or a chart",
            path.display(),
            other.kind()
        ))),
    }
}

fn carried(made: &Regenerated, entries: &[(Section, String)]) -> Result<Regenerated, Vec<Diagnostic>> {
    regenerate::carry(&SrmFile::parse(made.text.as_str()).0, entries)
}

/// Nothing is wrong with a file from which something was put aside.
fn warning(lost: &Unmatched) -> Diagnostic {
    let message = format!("lost: {}", lost.diagnostic.message);
    Diagnostic { severity: yase::Severity::Warning, message, ..lost.diagnostic.clone() }
}
