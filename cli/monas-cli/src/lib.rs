//! The command `monas`, as a library.
//!
//! A team's program links the crates with the team's activities and calls [`main`]. The command
//! `monas` of this crate is such a program, with the activities of `monas-soccer`. The crate
//! contains no robotics: it parses the command line, calls the libraries, and prints their results.
//! It is the only crate that installs global state of the process (logger, panic hook, crash
//! report).
//!
//! Each command has a module with its arguments and its work. Commands share code only through
//! the crate `monas-terminal` for output and two modules: `remote` for runs in other processes,
//! and `input` for configurations, models and recordings.
//!
//! [`run`] executes a command line and writes to the given streams, so that tests see what a user
//! would see. It returns an [`Exit`], which maps to one exit code:
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
//! Results go to standard output; diagnostics, progress and the log go to standard error. A command
//! that writes to a closed pipe exits successfully.

mod arguments;
mod commands;
mod crash_report;
mod delegate;
mod dispatch;
mod input;
mod process;
#[cfg(unix)]
mod remote;

use std::ffi::OsString;
use std::io::Write;
use std::process::ExitCode;

use monas_terminal::CommandOutput;

pub use monas::memory::CountingAllocator;
pub use monas_terminal::Exit;

/// Executes the command with the arguments, streams and signals of this process.
pub fn main() -> ExitCode {
    process::main().into()
}

/// Executes a command line, whose first argument is the program's name, and writes to `out` and
/// `err` as to files. Does not handle signals.
pub fn run<Argument: Into<OsString> + Clone>(
    arguments: impl IntoIterator<Item = Argument>,
    out: &mut dyn Write,
    err: &mut dyn Write,
) -> Exit {
    dispatch::dispatch(arguments, &mut CommandOutput::plain(out, err))
}

/// The code in the README compiles.
#[cfg(doctest)]
#[doc = include_str!("../../../README.md")]
struct Readme;
