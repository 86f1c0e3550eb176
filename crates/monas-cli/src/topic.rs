//! `monas topic`: the topics of a run, while it runs.

pub(crate) mod arguments;
pub(crate) mod connect;
mod echo;
mod figures;
mod list;
mod publish;
mod schemas;

pub(crate) use arguments::TopicCommand;
pub(crate) use echo::watch;

use crate::console::Console;
use crate::exit::Exit;
use crate::failure::Failure;

pub(crate) fn execute(command: &TopicCommand, console: &mut Console<'_>) -> Result<Exit, Failure> {
    match command {
        TopicCommand::List { pattern, run } => list::list(pattern.as_deref(), run, console),
        TopicCommand::Info { topic, run } => list::info(topic, run, console),
        TopicCommand::Echo { pattern, limits, run } => echo::execute(pattern, limits, run, console),
        TopicCommand::Hz { pattern, limits, run } => figures::hz(pattern, limits, run, console),
        TopicCommand::Bw { pattern, limits, run } => figures::bw(pattern, limits, run, console),
        TopicCommand::Delay { pattern, limits, run } => figures::delay(pattern, limits, run, console),
        TopicCommand::Pub { topic, message, run } => publish::execute(topic, message, run, console),
    }
}
