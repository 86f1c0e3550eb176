//! `monas module`: the modules of a run, and how they are built.

mod arguments;
mod build;
mod change;
mod list;
mod show;

pub(crate) use arguments::ModuleCommand;

use crate::console::Console;
use crate::exit::Exit;
use crate::failure::Failure;

pub(crate) fn execute(command: &ModuleCommand, console: &mut Console<'_>) -> Result<Exit, Failure> {
    match command {
        ModuleCommand::List { run } => list::execute(run, console),
        ModuleCommand::Load { file, agent, run } => change::load(file, agent.as_deref(), run, console),
        ModuleCommand::Unload { name, run } => change::unload(name, run, console),
        ModuleCommand::Reload { name, file, run } => change::reload(name, file.as_deref(), run, console),
        ModuleCommand::Show { file, format } => show::execute(file, format.value, console),
        ModuleCommand::Build { package, format } => build::execute(package.as_deref(), format.value, console),
    }
}
