//! The command `monas`, as a library.
//!
//! The binary of a team is five lines: it links the crates that hold the team's activities and calls [`main`]. The command
//! `monas` of this crate is such a binary, with the activities of `monas-soccer`. Nothing of Monas happens here: this crate
//! reads the command line, calls the libraries below, and shows what they answer. It is the only place that renders a
//! [`yase::Diagnostic`], draws a progress bar, catches Ctrl-C, or sets anything for the whole process (the logger, the panic
//! hook).
//!
//! [`run`] is the whole command as a function of its arguments that writes into what it is given, so that a test
//! reads what a person would see. It returns an [`Exit`], of which each has one code:
//!
//! ```
//! let (mut out, mut err) = (Vec::new(), Vec::new());
//!
//! let exit = monas_cli::run(["monas", "--version"], &mut out, &mut err);
//! assert_eq!(exit, monas_cli::Exit::Success);
//! assert!(String::from_utf8(out)?.starts_with("monas "));
//!
//! let exit = monas_cli::run(["monas", "fly"], &mut Vec::new(), &mut err);
//! assert_eq!(exit.code(), 2);
//! assert!(String::from_utf8(err)?.contains("unrecognized subcommand 'fly'"));
//! # Ok::<(), std::string::FromUtf8Error>(())
//! ```
//!
//! What a command is asked for goes to standard output; diagnostics, progress and the log go to standard error. A command
//! that writes into a closed pipe ends quietly.

#[cfg(unix)]
mod agent;
mod arguments;
#[cfg(unix)]
mod chart;
mod config;
mod console;
mod deploy;
mod doctor;
mod duration;
mod exit;
mod failure;
mod generate;
mod handover;
mod log;
mod model;
#[cfg(unix)]
mod module;
mod new;
mod process;
mod report;
mod run;
mod tape;
#[cfg(unix)]
mod top;
#[cfg(unix)]
mod topic;

use std::ffi::OsString;
use std::io::{self, Write};
use std::process::ExitCode;

use clap::{CommandFactory, Parser};
use clap_complete::env::Shells;

use arguments::{Arguments, Command};
use console::Console;
use failure::Failure;

pub use exit::Exit;
pub use monas::memory::Counting;

/// The command with the arguments, output and signals of this process.
pub fn main() -> ExitCode {
    process::main().into()
}

/// The command with these arguments (the first is its own name), writing into `out` and `err` as if no terminal were there.
/// Signals are left alone.
pub fn run<Argument: Into<OsString> + Clone>(
    arguments: impl IntoIterator<Item = Argument>,
    out: &mut dyn Write,
    err: &mut dyn Write,
) -> Exit {
    dispatch(arguments, &mut Console::plain(out, err))
}

fn dispatch<Argument: Into<OsString> + Clone>(
    arguments: impl IntoIterator<Item = Argument>,
    console: &mut Console<'_>,
) -> Exit {
    let done = match Arguments::try_parse_from(arguments) {
        Ok(arguments) => execute(arguments.command, console),
        Err(error) => answer(&error, console).map_err(Failure::from),
    };
    done.unwrap_or_else(|failure| failure.report(console))
}

fn execute(command: Command, console: &mut Console<'_>) -> Result<Exit, Failure> {
    match command {
        Command::Run(arguments) => run::execute(&arguments, console),
        Command::Generate(arguments) => generate::execute(&arguments, console),
        Command::Config(command) => config::execute(&command, console),
        Command::Model(command) => model::execute(&command, console),
        #[cfg(unix)]
        Command::Topic(arguments) => topic::execute(arguments, console),
        #[cfg(unix)]
        Command::Agent(command) => agent::execute(&command, console),
        #[cfg(unix)]
        Command::Chart(command) => chart::execute(&command, console),
        #[cfg(unix)]
        Command::Module(command) => module::execute(&command, console),
        #[cfg(unix)]
        Command::Top(arguments) => top::execute(&arguments, console),
        Command::Log(arguments) => log::execute(&arguments, console),
        Command::Tape(command) => tape::execute(&command, console),
        Command::New(arguments) => new::execute(&arguments, console),
        Command::Deploy(arguments) => deploy::execute(&arguments, console),
        Command::Doctor(arguments) => doctor::execute(&arguments, console),
        Command::Completions { shell } => completions(shell, console).map_err(Failure::from),
    }
}

/// What clap has to say: help and version are asked for, anything else is a mistake.
fn answer(error: &clap::Error, console: &mut Console<'_>) -> io::Result<Exit> {
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

fn completions(shell: clap_complete::Shell, console: &mut Console<'_>) -> io::Result<Exit> {
    let mut script = Vec::new();
    let name = shell.to_string();
    let shells = Shells::builtins();
    match shells.completer(&name) {
        // The shell asks this command itself what fits, so that it completes what runs knows too.
        Some(completer) => {
            completer.write_registration("COMPLETE", "monas", "monas", "monas", &mut script)?
        }
        None => clap_complete::generate(shell, &mut Arguments::command(), "monas", &mut script),
    }
    console.out.write_all(&script)?;
    Ok(Exit::Success)
}

/// The code in the README compiles.
#[cfg(doctest)]
#[doc = include_str!("../../../README.md")]
struct Readme;
