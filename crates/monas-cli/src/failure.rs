//! Why a command did not do what it was asked for.

use std::fmt::Display;
use std::io;

use serde_json::json;
use yase::Diagnostic;

use crate::arguments::Format;
use crate::console::Console;
use crate::exit::Exit;
use crate::report;

/// What went wrong, and how it is to be told.
#[derive(Debug)]
pub(crate) enum Failure {
    /// A text that a person wrote is wrong.
    Invalid(Format, Vec<Diagnostic>),
    /// What the command line asks for cannot be had together.
    Usage(String),
    /// It could not be done.
    Failed(Format, String),
    /// What it is to connect to is not there.
    Unreachable(Format, String),
    /// Standard output or standard error does not take what is written.
    Output(io::Error),
}

impl Failure {
    /// It could not be done because of an error below.
    pub(crate) fn failed(format: Format, error: impl Display) -> Failure {
        Failure::Failed(format, error.to_string())
    }

    /// Tells it on standard error.
    pub(crate) fn report(self, console: &mut Console<'_>) -> Exit {
        let (told, exit) = match self {
            Failure::Invalid(format, diagnostics) => {
                (report::write(console, format, &diagnostics), Exit::Invalid)
            }
            Failure::Usage(message) => (tell(console, Format::Text, &message), Exit::Usage),
            Failure::Failed(format, message) => (tell(console, format, &message), Exit::Failure),
            Failure::Unreachable(format, message) => (tell(console, format, &message), Exit::Unreachable),
            Failure::Output(error) if error.kind() == io::ErrorKind::BrokenPipe => (Ok(()), Exit::Success),
            Failure::Output(error) => (tell(console, Format::Text, &error.to_string()), Exit::Failure),
        };
        // Standard error that cannot be written to leaves nowhere to say so: the exit code remains.
        if told.is_err() { Exit::Failure } else { exit }
    }
}

impl From<io::Error> for Failure {
    fn from(error: io::Error) -> Failure {
        Failure::Output(error)
    }
}

fn tell(console: &mut Console<'_>, format: Format, message: &str) -> io::Result<()> {
    match format {
        Format::Text => writeln!(console.err, "error: {message}"),
        Format::Json => writeln!(console.err, "{}", json!({"severity": "error", "message": message})),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn told(failure: Failure) -> (Exit, String) {
        let (mut out, mut err) = (Vec::new(), Vec::new());
        let exit = failure.report(&mut Console::plain(&mut out, &mut err));
        assert!(out.is_empty());
        (exit, String::from_utf8(err).unwrap())
    }

    #[test]
    fn a_closed_pipe_is_no_failure() {
        let closed = io::Error::from(io::ErrorKind::BrokenPipe);
        assert_eq!(told(closed.into()), (Exit::Success, String::new()));
    }

    #[test]
    fn failures_are_told_in_the_format_asked_for() {
        let failed = |format| Failure::Failed(format, "no room".into());
        assert_eq!(told(failed(Format::Text)), (Exit::Failure, "error: no room\n".into()));
        let (_, line) = told(failed(Format::Json));
        assert_eq!(line, "{\"severity\":\"error\",\"message\":\"no room\"}\n");
    }
}
