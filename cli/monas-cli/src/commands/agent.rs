//! `monas agent`: inspects and changes the agents of a run.

mod arguments;
mod change;
mod list;
mod save;

use monas_terminal::{CommandFailure, CommandOutput, Exit};

pub(crate) use arguments::AgentCommand;

pub(crate) fn execute(
    command: &AgentCommand,
    console: &mut CommandOutput<'_>,
) -> Result<Exit, CommandFailure> {
    match command {
        AgentCommand::List { agent, run } => list::execute(agent.as_deref(), run, console),
        AgentCommand::Save { file, run } => save::execute(file.as_deref(), run, console),
        _ => change::execute(command, console),
    }
}
