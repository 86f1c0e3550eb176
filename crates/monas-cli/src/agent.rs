//! `monas agent`: the agents of a run, while it runs.

mod arguments;
pub(crate) mod change;
pub(crate) mod list;
mod save;

use monas::records::{Inquiry, Reply};
use prost::Message;

pub(crate) use arguments::{AgentCommand, agents};

use crate::console::Console;
use crate::exit::Exit;
use crate::failure::Failure;
use crate::topic::arguments::RunChoice;
use crate::topic::connect::{self, failure};

pub(crate) fn execute(command: &AgentCommand, console: &mut Console<'_>) -> Result<Exit, Failure> {
    match command {
        AgentCommand::List { agent, run } => list::execute(agent.as_deref(), run, console),
        AgentCommand::Save { file, run } => save::execute(file.as_deref(), run, console),
        _ => change::execute(command, console),
    }
}

/// What the run that is meant answers.
pub(crate) fn ask(inquiry: Inquiry, run: &RunChoice) -> Result<Reply, Failure> {
    let host = run.host.clone().unwrap_or_default();
    let inquiry = Inquiry { host, ..inquiry }.encode_to_vec();
    let reply = connect::client(run)?.manage(inquiry).map_err(failure(run.format.value))?;
    Reply::decode(reply.as_slice()).map_err(|_| odd(run))
}

/// It answers something else.
pub(crate) fn odd(run: &RunChoice) -> Failure {
    let message = "the run answers what was not asked; it may be of another version";
    Failure::Unreachable(run.format.value, message.into())
}
