//! `monas model regenerate`: keeps the refinements of a role after its formulas were edited.

use std::path::{Path, PathBuf};

use aseme::refine::UnmatchedEntry;
use aseme::srm::{Section, SrmFile};
use aseme_models::convert::Model;
use aseme_models::regenerate::{self, RegeneratedRole};
use clap::{Args, ValueHint};
use monas::config;
use monas_terminal::{
    CommandFailure, CommandOutput, Exit, Format, FormatArgument, check_distinct, report, write_text,
};
use yase::Diagnostic;

use crate::input::valid_model;

/// Arguments of `monas model regenerate`.
#[derive(Args, Debug)]
pub(crate) struct RegenerateArguments {
    /// The role with its edited formulas.
    #[arg(value_hint = ValueHint::FilePath)]
    pub(crate) role: PathBuf,
    /// A role or a chart whose refinements are added; those of the role itself take precedence.
    #[arg(long, value_name = "MODEL", value_hint = ValueHint::FilePath)]
    pub(crate) from: Vec<PathBuf>,
    /// The output file; standard output if not given.
    #[arg(short, long, value_name = "FILE", value_hint = ValueHint::FilePath)]
    pub(crate) output: Option<PathBuf>,
    #[command(flatten)]
    pub(crate) format: FormatArgument,
}

pub(crate) fn execute(
    arguments: &RegenerateArguments,
    console: &mut CommandOutput<'_>,
) -> Result<Exit, CommandFailure> {
    let format = arguments.format.value;
    // only the role itself may be replaced
    if let Some(output) = &arguments.output {
        arguments.from.iter().try_for_each(|from| check_distinct(from, output, "model of --from"))?;
    }
    let source = config::read_file(&arguments.role)
        .map_err(|unread| CommandFailure::Invalid(format, vec![*unread]))?;
    let placed = |found: Vec<Diagnostic>| -> Vec<Diagnostic> {
        found.into_iter().map(|found| found.in_source(&source)).collect()
    };
    let file = match aseme_models::convert::read(&source) {
        (Some((Model::Role(file), _)), found) if !found.iter().any(Diagnostic::is_error) => *file,
        (Some((Model::Srm(_), _)), _) => {
            return Err(CommandFailure::Usage(format!(
                "`{}` has no comments to keep what is lost: convert it with `monas model convert --as role`",
                arguments.role.display()
            )));
        }
        (Some((model, _)), found) if !found.iter().any(Diagnostic::is_error) => {
            let message = "is a model of the kind";
            return Err(CommandFailure::Usage(format!(
                "`{}` {message} {}, not a role",
                arguments.role.display(),
                model.kind()
            )));
        }
        (_, found) => return Err(CommandFailure::Invalid(format, found)),
    };
    let invalid = |found| CommandFailure::Invalid(format, placed(found));
    let mut made = regenerate::comment_out_refinements(&file).map_err(invalid)?;
    for path in &arguments.from {
        let entries = entries(path, format, console)?;
        let carried = carried(&made, &entries).map_err(|found| CommandFailure::Invalid(format, found))?;
        (made.text, made.kept) = (carried.text, made.kept + carried.kept);
        made.lost.extend(carried.lost);
    }
    let found = made.renamed.iter().cloned().chain(made.lost.iter().map(warning)).collect();
    report::write(console, format, &placed(found))?;
    let written = write_text(arguments.output.as_deref(), &made.text, format, console)?;
    if arguments.output.is_some() && format == Format::Text {
        writeln!(console.out, "{} kept, {} lost", made.kept, made.lost.len())?;
    }
    Ok(written)
}

/// The refinements of another model.
fn entries(
    path: &Path,
    format: Format,
    console: &mut CommandOutput<'_>,
) -> Result<Vec<(Section, String)>, CommandFailure> {
    let (source, model, ..) = valid_model(path, format, console)?;
    match model {
        Model::Role(file) => Ok(regenerate::entries_of_role(&file)),
        Model::Chart(chart) => {
            let (chart, found) = chart.to_statechart();
            let found: Vec<Diagnostic> = found.into_iter().map(|found| found.in_source(&source)).collect();
            match found.iter().any(Diagnostic::is_error) {
                true => Err(CommandFailure::Invalid(format, found)),
                false => Ok(regenerate::entries_of_chart(&chart)),
            }
        }
        other => Err(CommandFailure::Usage(format!(
            "`{}` is a model of the kind {}; refinements come from a role or a chart",
            path.display(),
            other.kind()
        ))),
    }
}

fn carried(
    made: &RegeneratedRole,
    entries: &[(Section, String)],
) -> Result<RegeneratedRole, Vec<Diagnostic>> {
    regenerate::apply_refinements(&SrmFile::parse(made.text.as_str()).0, entries)
}

/// A refinement without a match is a warning, not an error.
fn warning(lost: &UnmatchedEntry) -> Diagnostic {
    let message = format!("lost: {}", lost.diagnostic.message);
    Diagnostic { severity: yase::Severity::Warning, message, ..lost.diagnostic.clone() }
}
