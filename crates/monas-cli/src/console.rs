//! Where a command writes, and what it may show there.

use std::io::Write;

use indicatif::MultiProgress;

use crate::process::Log;

/// Standard output and standard error as a command sees them.
pub(crate) struct Console<'a> {
    /// Results.
    pub(crate) out: &'a mut dyn Write,
    /// Diagnostics and progress.
    pub(crate) err: &'a mut dyn Write,
    /// Whether colours are welcome in results.
    pub(crate) colour_out: bool,
    /// Whether colours are welcome in diagnostics.
    pub(crate) colour_err: bool,
    /// Where progress is drawn, if a person watches standard error.
    pub(crate) bars: Option<MultiProgress>,
    /// Whether Ctrl-C is for this command.
    pub(crate) catches_signals: bool,
    /// The log of this process, if it is this command's.
    pub(crate) log: Option<Log>,
}

impl<'a> Console<'a> {
    /// Two writers with nobody watching.
    pub(crate) fn plain(out: &'a mut dyn Write, err: &'a mut dyn Write) -> Console<'a> {
        Console {
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
