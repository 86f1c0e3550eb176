//! `monas module`: inspects, builds, loads and replaces modules of a run.

mod arguments;
mod build;
mod change;
mod list;
mod show;

use monas_terminal::{CommandFailure, CommandOutput, Exit};

pub(crate) use arguments::ModuleCommand;

pub(crate) fn execute(
    command: &ModuleCommand,
    console: &mut CommandOutput<'_>,
) -> Result<Exit, CommandFailure> {
    match command {
        ModuleCommand::List { run } => list::execute(run, console),
        ModuleCommand::Load { file, agent, run } => change::load(file, agent.as_deref(), run, console),
        ModuleCommand::Unload { name, run } => change::unload(name, run, console),
        ModuleCommand::Reload { name, file, run } => change::reload(name, file.as_deref(), run, console),
        ModuleCommand::Show { file, format } => show::execute(file, format.value, console),
        ModuleCommand::Build { package, format } => build::execute(package.as_deref(), format.value, console),
    }
}
