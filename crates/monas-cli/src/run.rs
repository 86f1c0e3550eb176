//! `monas run`: a match in simulated time, or a set of agents in real time.

mod control;
mod coverage;
mod interrupt;
mod links;
mod live;
pub(crate) mod pace;
mod play;
mod scoreboard;
pub(crate) mod table;

use std::path::Path;

use monas::config;
use monas::logger::{Settings, Severity};
use yase::Diagnostic;

use crate::arguments::{Format, RunArguments};
use crate::config::layers;
use crate::console::Console;
use crate::exit::Exit;
use crate::failure::Failure;
use crate::generate::differences;
use crate::report;

pub(crate) use interrupt::Interrupt;
pub(crate) use live::not_started;
pub(crate) use pace::WallClock;

/// What a configuration describes.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub(crate) enum Kind {
    /// `<match>`: teams on a field.
    Match,
    /// Anything else: agents of one host.
    Agents,
}

pub(crate) fn execute(arguments: &RunArguments, console: &mut Console<'_>) -> Result<Exit, Failure> {
    let invalid = |diagnostics| Failure::Invalid(arguments.format.value, diagnostics);
    let kind = kind_of(&arguments.config).map_err(|unread| invalid(vec![*unread]))?;
    if kind == Kind::Match && arguments.layers.robot.is_some() {
        let message =
            "--robot is for the agents of one robot; a match says what holds for each in its `<robot>`";
        return Err(Failure::Usage(message.into()));
    }
    let unlinked = differences(&arguments.config);
    if unlinked.iter().any(Diagnostic::is_error) {
        return Err(invalid(unlinked));
    }
    report::write(console, arguments.format.value, &unlinked)?;
    let layers = layers::of(&arguments.config, &arguments.layers).map_err(invalid)?;
    let asked = match &arguments.log {
        Some(file) => write_log(file, arguments.format.value, console)?,
        None => Severity::Info,
    };
    console.log.iter().for_each(|log| log.publish(asked.max(Severity::Info)));
    match kind {
        Kind::Match => play::execute(arguments, &layers, console),
        Kind::Agents => live::execute(arguments, &layers, console),
    }
}

/// Has a log written as a file says. Gives the least grave lines that are wanted.
fn write_log(file: &Path, format: Format, console: &Console<'_>) -> Result<Severity, Failure> {
    let (mut settings, diagnostics) = Settings::load(file);
    if diagnostics.iter().any(Diagnostic::is_error) {
        return Err(Failure::Invalid(format, diagnostics));
    }
    let Some(log) = &console.log else {
        return Err(Failure::Usage(
            "--log is for the command: the program that calls it has a log of its own".into(),
        ));
    };
    settings.colour &= console.colour_err;
    let verbosity = settings.verbosity;
    log.write(settings)
        .map(|()| verbosity)
        .map_err(|error| Failure::failed(format, format_args!("the log of {}: {error}", file.display())))
}

/// What a configuration describes, by the name of its first element.
pub(crate) fn kind_of(config: &Path) -> Result<Kind, Box<Diagnostic>> {
    let (elements, _) = monas_match::grammar().parse(&config::read_file(config)?);
    Ok(if elements.first().is_some_and(|root| root.is("match")) { Kind::Match } else { Kind::Agents })
}
