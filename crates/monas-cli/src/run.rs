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

use monas::config::{self, xml};

use crate::arguments::RunArguments;
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
    match kind_of(&arguments.config)
        .map_err(|unread| Failure::Invalid(arguments.format.value, vec![*unread]))?
    {
        Kind::Match => play::execute(arguments, console),
        Kind::Agents => live::execute(arguments, console),
    }
}

/// What a configuration describes, by the name of its first element.
pub(crate) fn kind_of(config: &Path) -> Result<Kind, Box<yase::Diagnostic>> {
    let (elements, _) = xml::parse(&config::read_file(config)?);
    Ok(if elements.first().is_some_and(|root| root.is("match")) { Kind::Match } else { Kind::Agents })
}
