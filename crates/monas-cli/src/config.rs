//! `monas config`: configurations without running them.

mod check;
pub(crate) mod layers;
mod show;

use crate::arguments::ConfigCommand;
use crate::console::Console;
use crate::exit::Exit;
use crate::failure::Failure;

pub(crate) use check::checked;

pub(crate) fn execute(command: &ConfigCommand, console: &mut Console<'_>) -> Result<Exit, Failure> {
    match command {
        ConfigCommand::Check(arguments) => check::execute(arguments, console),
        ConfigCommand::Show(arguments) => show::execute(arguments, console),
        ConfigCommand::Schema { xsd, robots, .. } => {
            let grammar = if *robots { crate::deploy::grammar() } else { monas_match::grammar() };
            let schema = if *xsd { grammar.xml_schema() } else { grammar.json_schema() };
            console.out.write_all(schema.as_bytes())?;
            Ok(Exit::Success)
        }
    }
}
