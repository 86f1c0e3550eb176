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

use crate::arguments::RunArguments;
use crate::config::layers;
use crate::console::Console;
use crate::exit::Exit;
use crate::failure::Failure;

pub(crate) use interrupt::Interrupt;
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
    let layers = layers::of(&arguments.config, &arguments.layers).map_err(invalid)?;
    match kind {
        Kind::Match => play::execute(arguments, &layers, console),
        Kind::Agents => live::execute(arguments, &layers, console),
    }
}

/// What a configuration describes, by the name of its first element.
pub(crate) fn kind_of(config: &Path) -> Result<Kind, Box<yase::Diagnostic>> {
    let (elements, _) = monas_match::grammar().parse(&config::read_file(config)?);
    Ok(if elements.first().is_some_and(|root| root.is("match")) { Kind::Match } else { Kind::Agents })
}
