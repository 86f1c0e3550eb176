//! `monas config show`: every value with where it comes from.

use std::io::{self, Write};

use monas::config::{self, Entry};
use monas_match::Match;
use serde_json::{Value, json};
use yase::Diagnostic;

use super::layers;
use crate::arguments::{ConfigArguments, Format};
use crate::console::Console;
use crate::exit::Exit;
use crate::failure::Failure;
use crate::report;
use crate::run::{Kind, kind_of};

/// What is wider stands over the line.
const WIDEST: usize = 64;

pub(super) fn execute(arguments: &ConfigArguments, console: &mut Console<'_>) -> Result<Exit, Failure> {
    let (config, format) = (&arguments.config, arguments.format.value);
    let invalid = |diagnostics| Failure::Invalid(format, diagnostics);
    let kind = kind_of(config).map_err(|unread| invalid(vec![*unread]))?;
    let layers = layers::of(config, &arguments.layers).map_err(invalid)?;
    let grammar = monas_match::grammar();
    let (elements, diagnostics) = match kind {
        Kind::Match => Match::elements(config, &layers),
        Kind::Agents => {
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

fn table(out: &mut dyn Write, entries: &[Entry]) -> io::Result<()> {
    let left = |entry: &Entry| match &entry.value {
        Some(value) => format!("{} = {value}", entry.path),
        None => entry.path.clone(),
    };
    let widths = entries.iter().map(|entry| left(entry).chars().count());
    let width = widths.filter(|width| *width <= WIDEST).max().unwrap_or_default();
    entries.iter().try_for_each(|entry| writeln!(out, "{:width$}  {}", left(entry), entry.origin()))
}

fn object(entry: &Entry) -> Value {
    let position = entry.place.as_ref().map(|(source, span)| source.position(span.start));
    json!({
        "path": entry.path,
        "value": entry.value,
        "layer": entry.layer.name(),
        "file": entry.place.as_ref().map(|(source, _)| source.name.as_str()),
        "line": position.map(|(line, _)| line),
        "column": position.map(|(_, column)| column),
    })
}
