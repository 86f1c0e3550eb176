//! Maps arguments to a command, and the command's result to an exit status.

use std::ffi::OsString;
use std::path::Path;
use std::{fs, io};

use clap::{CommandFactory, Parser};
use clap_complete::env::Shells;
use monas_terminal::{CommandFailure, CommandOutput, Exit, Format, UnreadOutput, wanted_colours};

use crate::arguments::{Arguments, Command};
use crate::commands;

/// Parses the arguments, of which the first is the program's name, and executes the command.
pub(crate) fn dispatch<Argument: Into<OsString> + Clone>(
    arguments: impl IntoIterator<Item = Argument>,
    console: &mut CommandOutput<'_>,
) -> Exit {
    let arguments: Vec<OsString> = arguments.into_iter().map(Into::into).collect();
    let words: Vec<String> = arguments.iter().map(|word| word.to_string_lossy().into_owned()).collect();
    console.paint(wanted_colours(&words));
    let parsed = Arguments::try_parse_from(arguments);
    if let Ok(arguments) = &parsed {
        arguments.globals.apply(console);
    }
    let done = match parsed {
        Ok(arguments) if arguments.command.is_stream() => execute(arguments.command, console),
        Ok(arguments) => {
            // The exit code depends on the findings of the command, also if its results are not
            // read.
            let mut out = UnreadOutput(&mut *console.out);
            let mut rest = CommandOutput {
                out: &mut out,
                err: &mut *console.err,
                bars: console.bars.clone(),
                log: console.log.clone(),
                codes: console.codes.clone(),
                ..*console
            };
            execute(arguments.command, &mut rest)
        }
        Err(error) => answer(&error, console).map_err(CommandFailure::from),
    };
    let exit = done.unwrap_or_else(|failure| failure.report(console));
    // If standard error cannot be written, only the exit code remains.
    let _ = console.name_explanations();
    exit
}

fn execute(command: Command, console: &mut CommandOutput<'_>) -> Result<Exit, CommandFailure> {
    match command {
        Command::Run(arguments) => commands::run::execute(&arguments, console),
        Command::Generate(arguments) => commands::generate::execute(&arguments, console),
        Command::Config(command) => commands::config::execute(&command, console),
        Command::Model(command) => commands::model::execute(&command, console),
        #[cfg(unix)]
        Command::Topic(arguments) => commands::topic::execute(arguments, console),
        #[cfg(unix)]
        Command::Agent(command) => commands::agent::execute(&command, console),
        #[cfg(unix)]
        Command::Chart(command) => commands::chart::execute(&command, console),
        #[cfg(unix)]
        Command::Module(command) => commands::module::execute(&command, console),
        #[cfg(unix)]
        Command::Top(arguments) => commands::top::execute(&arguments, console),
        #[cfg(unix)]
        Command::Studio(arguments) => commands::studio::execute(&arguments, console),
        Command::Log(arguments) => commands::log::execute(&arguments, console),
        Command::Tape(command) => commands::tape::execute(&command, console),
        Command::Why(arguments) => commands::why::execute(&arguments, console),
        Command::New(arguments) => commands::new::execute(&arguments, console),
        Command::Deploy(arguments) => commands::deploy::execute(&arguments, console),
        Command::Doctor(arguments) => commands::doctor::execute(&arguments, console),
        #[cfg(feature = "soccer")]
        Command::Referee(arguments) => commands::referee::execute(&arguments, console),
        #[cfg(feature = "soccer")]
        Command::Eval(arguments) => commands::eval::execute(&arguments, console),
        #[cfg(feature = "soccer")]
        Command::Vision(arguments) => commands::vision::execute(&arguments, console),
        Command::Explain(arguments) => commands::explain::execute(&arguments, console),
        Command::Man { folder } => manual_pages(&folder),
        Command::Completions { shell } => completions(shell, console).map_err(CommandFailure::from),
    }
}

/// Writes clap's answer: help and version were requested, anything else is an error.
fn answer(error: &clap::Error, console: &mut CommandOutput<'_>) -> io::Result<Exit> {
    let text = error.render();
    let (target, colour) = match error.use_stderr() {
        true => (&mut *console.err, console.colour_err),
        false => (&mut *console.out, console.colour_out),
    };
    match colour {
        true => write!(target, "{}", text.ansi())?,
        false => write!(target, "{text}")?,
    }
    Ok(if error.exit_code() == 0 { Exit::Success } else { Exit::Usage })
}

fn completions(shell: clap_complete::Shell, console: &mut CommandOutput<'_>) -> io::Result<Exit> {
    let mut script = Vec::new();
    let name = shell.to_string();
    let shells = Shells::builtins();
    match shells.completer(&name) {
        // The shell asks this program for candidates, so that names known to a run are completed.
        Some(completer) => {
            completer.write_registration("COMPLETE", "monas", "monas", "monas", &mut script)?
        }
        None => clap_complete::generate(shell, &mut Arguments::command(), "monas", &mut script),
    }
    console.out.write_all(&script)?;
    Ok(Exit::Success)
}

/// One page per command, as `monas-model-check.1`.
fn manual_pages(folder: &Path) -> Result<Exit, CommandFailure> {
    let written =
        fs::create_dir_all(folder).and_then(|()| clap_mangen::generate_to(Arguments::command(), folder));
    written
        .map(|()| Exit::Success)
        .map_err(|error| CommandFailure::Failed(Format::Text, format!("{}: {error}", folder.display())))
}
