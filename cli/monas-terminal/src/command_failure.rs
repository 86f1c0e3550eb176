//! Failures of commands.

use std::fmt::Display;
use std::io;

use monas::ErrorKind;
use serde_json::json;
use yase::Diagnostic;
use yase::diagnostic::nearest;

use crate::{CommandOutput, Exit, Format, report};

/// A failure of a command, with the format of its report.
#[derive(Debug)]
pub enum CommandFailure {
    /// A configuration, a model or another text of the user is invalid.
    Invalid(Format, Vec<Diagnostic>),
    /// The command line is contradictory or names something that does not exist.
    Usage(String),
    /// An operation failed.
    Failed(Format, String),
    /// The peer of a connection does not answer.
    Unreachable(Format, String),
    /// Standard output or standard error cannot be written.
    Output(io::Error),
}

impl CommandFailure {
    /// An operation failed with this error.
    pub fn failed(format: Format, error: impl Display) -> CommandFailure {
        CommandFailure::Failed(format, error.to_string())
    }

    /// A run did not start: errors in a configuration are invalid input, a link that does not open
    /// is an unreachable peer.
    pub fn not_started(format: Format, error: monas::Error) -> CommandFailure {
        match error.kind() {
            ErrorKind::Invalid => CommandFailure::Invalid(format, error.diagnostics().to_vec()),
            ErrorKind::Link => CommandFailure::Unreachable(format, error.to_string()),
            _ => CommandFailure::failed(format, error),
        }
    }

    /// A name that does not exist in a tape or a configuration; lists the known ones.
    pub fn unknown_name<'a>(
        source: &str,
        what: &str,
        name: &str,
        known: impl Iterator<Item = &'a str>,
    ) -> CommandFailure {
        let mut known: Vec<&str> = known.collect();
        known.sort_unstable();
        known.dedup();
        let hint = match nearest(name, known.iter().copied()) {
            Some(near) => format!("did you mean `{near}`?"),
            None if known.is_empty() => "it has none".to_owned(),
            None => format!("it has {}", known.join(", ")),
        };
        CommandFailure::Usage(format!("the {source} has no {what} `{name}`; {hint}"))
    }

    /// Writes it on standard error, and returns the exit status.
    pub fn report(self, console: &mut CommandOutput<'_>) -> Exit {
        // If standard error cannot be written, only the exit code remains.
        let (_, exit) = match self {
            CommandFailure::Invalid(format, diagnostics) => {
                (report::write(console, format, &diagnostics), Exit::Invalid)
            }
            CommandFailure::Usage(message) => (report_failure(console, Format::Text, &message), Exit::Usage),
            CommandFailure::Failed(format, message) => {
                (report_failure(console, format, &message), Exit::Failure)
            }
            CommandFailure::Unreachable(format, message) => {
                (report_failure(console, format, &message), Exit::Unreachable)
            }
            CommandFailure::Output(error) if error.kind() == io::ErrorKind::BrokenPipe => {
                (Ok(()), Exit::Success)
            }
            CommandFailure::Output(error) => {
                (report_failure(console, Format::Text, &error.to_string()), Exit::Failure)
            }
        };
        exit
    }
}

/// Maps an error of a library to a failure, for `map_err`.
pub fn failed<E: Display>(format: Format) -> impl Fn(E) -> CommandFailure {
    move |error| CommandFailure::failed(format, error)
}

impl From<io::Error> for CommandFailure {
    fn from(error: io::Error) -> CommandFailure {
        CommandFailure::Output(error)
    }
}

fn report_failure(console: &mut CommandOutput<'_>, format: Format, message: &str) -> io::Result<()> {
    match format {
        Format::Text => writeln!(console.err, "error: {message}"),
        Format::Json => writeln!(console.err, "{}", json!({"severity": "error", "message": message})),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn reported(failure: CommandFailure) -> (Exit, String) {
        let (mut out, mut err) = (Vec::new(), Vec::new());
        let exit = failure.report(&mut CommandOutput::plain(&mut out, &mut err));
        assert!(out.is_empty());
        (exit, String::from_utf8(err).unwrap())
    }

    #[test]
    fn a_closed_pipe_is_no_failure() {
        let closed = io::Error::from(io::ErrorKind::BrokenPipe);
        assert_eq!(reported(closed.into()), (Exit::Success, String::new()));
    }

    #[test]
    fn failures_are_reported_in_the_requested_format() {
        let failed = |format| CommandFailure::Failed(format, "no room".into());
        assert_eq!(reported(failed(Format::Text)), (Exit::Failure, "error: no room\n".into()));
        let (_, line) = reported(failed(Format::Json));
        assert_eq!(line, "{\"severity\":\"error\",\"message\":\"no room\"}\n");
    }
}
