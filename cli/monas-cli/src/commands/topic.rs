//! `monas topic`: inspects the topics of a run, and publishes on them.

mod arguments;
mod echo;
mod list;
mod publish;
mod schemas;
mod stream_statistics;

use monas_terminal::{CommandFailure, CommandOutput, Exit};

use crate::remote::LinkTargets;
use arguments::TopicCommand;

pub(crate) use arguments::TopicArguments;

pub(crate) fn execute(
    arguments: TopicArguments,
    console: &mut CommandOutput<'_>,
) -> Result<Exit, CommandFailure> {
    let TopicArguments { link, mut command } = arguments;
    let selector = command.run_mut();
    let targets = match &link {
        Some(_) if selector.run.is_some() => {
            return Err(CommandFailure::Usage(
                "--run selects a run on this computer, --link connects to others: use one of them".into(),
            ));
        }
        Some(config) => Some(LinkTargets::open(config, selector.format.value)?),
        None => None,
    };
    selector.reached = targets.as_ref().map(LinkTargets::socket);
    if let (Some(targets), TopicCommand::Pub { topic, .. }) = (&targets, &command) {
        targets.check_sent(topic)?;
    }
    let exit = execute_command(&command, console)?;
    match (&targets, &command) {
        (Some(targets), TopicCommand::Pub { .. }) => targets.wait_until_sent().map(|()| exit),
        _ => Ok(exit),
    }
}

fn execute_command(command: &TopicCommand, console: &mut CommandOutput<'_>) -> Result<Exit, CommandFailure> {
    match command {
        TopicCommand::List { pattern, run } => list::list(pattern.as_deref(), run, console),
        TopicCommand::Info { topic, run } => list::info(topic, run, console),
        TopicCommand::Echo { pattern, limits, run } => echo::execute(pattern, limits, run, console),
        TopicCommand::Hz { pattern, limits, run } => stream_statistics::hz(pattern, limits, run, console),
        TopicCommand::Bw { pattern, limits, run } => stream_statistics::bw(pattern, limits, run, console),
        TopicCommand::Delay { pattern, limits, run } => {
            stream_statistics::delay(pattern, limits, run, console)
        }
        TopicCommand::Pub { topic, message, run } => publish::execute(topic, message, run, console),
    }
}
