//! `monas config show`: every value with its origin.

use std::io::{self, Write};

use monas::config::{self, ResolvedEntry};
#[cfg(feature = "soccer")]
use monas_match::MatchSource;
use monas_terminal::{CommandFailure, CommandOutput, Exit, Format, report};
use serde_json::{Value, json};
use yase::Diagnostic;

use super::ConfigArguments;
use crate::input::{ConfigurationKind, grammar, kind_of, layers};

/// The widest left column, in characters; longer lines push their origin to the right.
const MAX_LEFT_WIDTH: usize = 64;

pub(crate) fn execute(
    arguments: &ConfigArguments,
    console: &mut CommandOutput<'_>,
) -> Result<Exit, CommandFailure> {
    let (config, format) = (&arguments.config, arguments.format.value);
    let invalid = |diagnostics| CommandFailure::Invalid(format, diagnostics);
    let kind = kind_of(config).map_err(|unread| invalid(vec![*unread]))?;
    let layers = layers::of(config, &arguments.layers).map_err(invalid)?;
    let grammar = grammar();
    let (elements, diagnostics) = match kind {
        #[cfg(feature = "soccer")]
        ConfigurationKind::Match => MatchSource::elements(config, &layers),
        ConfigurationKind::Agents => {
            let resolved = config::resolve(config, &grammar, &layers);
            (resolved.elements.clone(), resolved.into_diagnostics())
        }
    };
    let entries = config::entries(&elements, &grammar);
    match format {
        Format::Text => table(console.out, &entries)?,
        Format::Json => entries.iter().try_for_each(|entry| writeln!(console.out, "{}", object(entry)))?,
    }
    if diagnostics.iter().any(Diagnostic::is_error) {
        return Err(invalid(diagnostics));
    }
    report::write(console, format, &diagnostics)?;
    Ok(Exit::Success)
}

fn table(out: &mut dyn Write, entries: &[ResolvedEntry]) -> io::Result<()> {
    let left = |entry: &ResolvedEntry| match &entry.value {
        Some(value) => format!("{} = {value}", entry.path),
        None => entry.path.clone(),
    };
    let widths = entries.iter().map(|entry| left(entry).chars().count());
    let width = widths.filter(|width| *width <= MAX_LEFT_WIDTH).max().unwrap_or_default();
    entries.iter().try_for_each(|entry| writeln!(out, "{:width$}  {}", left(entry), entry.origin()))
}

fn object(entry: &ResolvedEntry) -> Value {
    let position = entry.location.as_ref().map(|(source, span)| source.position(span.start));
    json!({
        "path": entry.path,
        "value": entry.value,
        "layer": entry.layer.name(),
        "file": entry.location.as_ref().map(|(source, _)| source.name.as_str()),
        "line": position.map(|(line, _)| line),
        "column": position.map(|(_, column)| column),
    })
}
