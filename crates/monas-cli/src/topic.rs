//! `monas topic`: the topics of a run, while it runs.

pub(crate) mod arguments;
pub(crate) mod connect;
mod echo;
mod figures;
mod list;
mod publish;
mod reach;
mod schemas;

pub(crate) use arguments::TopicArguments;
pub(crate) use echo::watch;

use arguments::TopicCommand;

use crate::console::Console;
use crate::exit::Exit;
use crate::failure::Failure;

use reach::Reach;

pub(crate) fn execute(arguments: TopicArguments, console: &mut Console<'_>) -> Result<Exit, Failure> {
    let TopicArguments { link, mut command } = arguments;
    let choice = command.run_mut();
    let reach = match &link {
        Some(_) if choice.run.is_some() => {
            return Err(Failure::Usage(
                "--run is a run on this computer, --link goes elsewhere: one of them".into(),
            ));
        }
        Some(config) => Some(Reach::open(config, choice.format.value)?),
        None => None,
    };
    choice.reached = reach.as_ref().map(Reach::socket);
    if let (Some(reach), TopicCommand::Pub { topic, .. }) = (&reach, &command) {
        reach.check_sent(topic)?;
    }
    let exit = carry_out(&command, console)?;
    match (&reach, &command) {
        (Some(reach), TopicCommand::Pub { .. }) => reach.wait_until_sent().map(|()| exit),
        _ => Ok(exit),
    }
}

fn carry_out(command: &TopicCommand, console: &mut Console<'_>) -> Result<Exit, Failure> {
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
