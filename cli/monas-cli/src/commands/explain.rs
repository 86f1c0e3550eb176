//! `monas explain`: what diagnostic codes mean.

use std::ffi::OsStr;
use std::io;

use clap::Args;
use clap_complete::engine::{ArgValueCompleter, CompletionCandidate};
use monas_diagnostics::{Explanation, FAMILIES, explanations};
use monas_terminal::{CommandFailure, CommandOutput, Exit};

/// The columns of an explanation.
const MAX_COLUMNS: usize = 80;

/// Maximum number of codes that are suggested instead of an unknown one.
const MAX_SUGGESTIONS: usize = 8;

/// Minimum number of characters that a suggested code shares with the unknown one.
const MIN_COMMON_CHARACTERS: usize = 2;

/// The arguments of `monas explain`.
#[derive(Args, Debug)]
pub(crate) struct ExplainArguments {
    /// The code of a diagnostic, for example E0205; without it, all codes are listed.
    #[arg(add = ArgValueCompleter::new(candidates))]
    code: Option<String>,
}

pub(crate) fn execute(
    arguments: &ExplainArguments,
    console: &mut CommandOutput<'_>,
) -> Result<Exit, CommandFailure> {
    match &arguments.code {
        None => list(console)?,
        Some(code) => {
            let wanted = code.trim_start_matches("[").trim_end_matches("]").to_uppercase();
            let explained = explanations();
            let found = explained.iter().find(|it| it.code == wanted);
            let found = found.ok_or_else(|| unknown(code, &wanted, &explained))?;
            write!(console.out, "{}", found.text(MAX_COLUMNS))?;
        }
    }
    Ok(Exit::Success)
}

fn list(console: &mut CommandOutput<'_>) -> io::Result<()> {
    for (index, family) in FAMILIES.iter().enumerate() {
        let before = if index == 0 { "" } else { "\n" };
        writeln!(console.out, "{before}{}", family.title)?;
        for Explanation { code, title, .. } in family.explanations() {
            writeln!(console.out, "  {code:<5}  {title}")?;
        }
    }
    Ok(())
}

/// Suggests the codes that begin with as many characters of the unknown one as possible.
fn unknown(code: &str, wanted: &str, explained: &[Explanation]) -> CommandFailure {
    let near = (MIN_COMMON_CHARACTERS..=wanted.len())
        .rev()
        .filter(|&end| wanted.is_char_boundary(end))
        .find_map(|end| {
            let begin_so = explained.iter().map(|it| it.code).filter(|it| it.starts_with(&wanted[..end]));
            let codes: Vec<&str> = begin_so.take(MAX_SUGGESTIONS).collect();
            (!codes.is_empty()).then(|| format!("near are {}; ", codes.join(", ")))
        });
    let near = near.unwrap_or_default();
    CommandFailure::Usage(format!("there is no code `{code}`; {near}`monas explain` lists all"))
}

/// The codes that begin with what was typed.
fn candidates(typed: &OsStr) -> Vec<CompletionCandidate> {
    let typed = typed.to_string_lossy().to_uppercase();
    let explained = explanations();
    let fitting = explained.iter().filter(|it| it.code.starts_with(&typed));
    fitting.map(|it| CompletionCandidate::new(it.code).help(Some(it.title.into()))).collect()
}
