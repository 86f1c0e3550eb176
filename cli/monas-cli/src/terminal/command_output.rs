//! The streams of a command.

use std::io::Write;

use indicatif::MultiProgress;

use super::ProcessLog;

/// Standard output and standard error of a command, and their capabilities.
pub(crate) struct CommandOutput<'a> {
    /// Results.
    pub(crate) out: &'a mut dyn Write,
    /// Diagnostics and progress.
    pub(crate) err: &'a mut dyn Write,
    /// Whether results may be coloured.
    pub(crate) colour_out: bool,
    /// Whether diagnostics may be coloured.
    pub(crate) colour_err: bool,
    /// Progress bars, if standard error is a terminal.
    pub(crate) bars: Option<MultiProgress>,
    /// Whether the command handles signals.
    pub(crate) catches_signals: bool,
    /// The log of this process, if the command owns it.
    pub(crate) log: Option<ProcessLog>,
}

impl<'a> CommandOutput<'a> {
    /// Two streams without a terminal.
    pub(crate) fn plain(out: &'a mut dyn Write, err: &'a mut dyn Write) -> CommandOutput<'a> {
        CommandOutput {
            out,
            err,
            colour_out: false,
            colour_err: false,
            bars: None,
            catches_signals: false,
            log: None,
        }
    }
}
