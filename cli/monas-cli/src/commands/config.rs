//! `monas config`: inspects configurations without running them.

mod check;
mod show;

use std::path::PathBuf;

use clap::{Args, Subcommand, ValueHint};
use monas_terminal::{CommandFailure, CommandOutput, Exit, FormatArgument};

use crate::input::{DEFAULT_CONFIGURATION, LayerArguments, grammar};

/// A configuration with its layers.
#[derive(Args, Debug)]
pub(crate) struct ConfigArguments {
    /// A match or a file of agents, in XML or TOML.
    #[arg(default_value = DEFAULT_CONFIGURATION, value_hint = ValueHint::FilePath)]
    pub(crate) config: PathBuf,
    #[command(flatten)]
    pub(crate) layers: LayerArguments,
    #[command(flatten)]
    pub(crate) format: FormatArgument,
}

#[derive(Subcommand, Debug)]
pub(crate) enum ConfigCommand {
    /// Read a configuration and every file it names, bind its charts, and report what is wrong.
    #[command(after_help = "Example: monas config check config/match.xml")]
    Check(ConfigArguments),
    /// Print every value of a configuration with its origin: default, file, robot or command line.
    ///
    /// Names of activities and models are not checked; use `config check` for that. Each line
    /// starts with the path that `--set` takes.
    #[command(after_help = "Example: monas config show config/agents.xml --set agent.Motion.frequency=50")]
    Show(ConfigArguments),
    /// Print the schema of configurations for editors: XML Schema for XML, JSON Schema for TOML.
    #[command(after_help = "Example: monas config schema --xsd > monas.xsd")]
    #[command(group(clap::ArgGroup::new("language").required(true)))]
    Schema {
        /// XML Schema 1.0.
        #[arg(long, group = "language")]
        xsd: bool,
        /// JSON Schema 2020-12.
        #[arg(long, group = "language")]
        json: bool,
        /// Print the schema of the file of robots that `deploy` reads, instead of that of runs.
        #[arg(long)]
        robots: bool,
    },
}

pub(crate) fn execute(
    command: &ConfigCommand,
    console: &mut CommandOutput<'_>,
) -> Result<Exit, CommandFailure> {
    match command {
        ConfigCommand::Check(arguments) => check::execute(arguments, console),
        ConfigCommand::Show(arguments) => show::execute(arguments, console),
        ConfigCommand::Schema { xsd, robots, .. } => {
            let grammar = if *robots { monas_deploy::robots_grammar() } else { grammar() };
            let schema = if *xsd { grammar.xml_schema() } else { grammar.json_schema() };
            console.out.write_all(schema.as_bytes())?;
            Ok(Exit::Success)
        }
    }
}
