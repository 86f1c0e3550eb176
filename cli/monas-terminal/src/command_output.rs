//! The streams of a command.

use std::cell::RefCell;
use std::collections::BTreeSet;
use std::io::{self, Write};
use std::rc::Rc;

use clap::ColorChoice;
use indicatif::MultiProgress;

use super::ProcessLog;

/// Standard output and standard error of a command, and their capabilities.
pub struct CommandOutput<'a> {
    /// Results.
    pub out: &'a mut dyn Write,
    /// Diagnostics and progress.
    pub err: &'a mut dyn Write,
    /// Whether results may be coloured.
    pub colour_out: bool,
    /// Whether diagnostics may be coloured.
    pub colour_err: bool,
    /// Progress bars, if standard error is a terminal.
    pub bars: Option<MultiProgress>,
    /// Whether the command handles signals.
    pub catches_signals: bool,
    /// The log of this process, if the command owns it.
    pub log: Option<ProcessLog>,
    /// Whether only results and errors are printed.
    pub quiet: bool,
    /// The codes of the printed diagnostics, if standard error is a terminal.
    pub codes: Option<Rc<RefCell<BTreeSet<&'static str>>>>,
}

impl<'a> CommandOutput<'a> {
    /// Two streams without a terminal.
    pub fn plain(out: &'a mut dyn Write, err: &'a mut dyn Write) -> CommandOutput<'a> {
        CommandOutput {
            out,
            err,
            colour_out: false,
            colour_err: false,
            bars: None,
            catches_signals: false,
            log: None,
            quiet: false,
            codes: None,
        }
    }

    /// Standard error, for what is neither a result nor a diagnostic; nothing with `--quiet`.
    pub fn remarks(&mut self) -> Box<dyn Write + '_> {
        match self.quiet {
            true => Box::new(io::sink()),
            false => Box::new(&mut *self.err),
        }
    }

    /// Uses colours or not; `Auto` keeps what was found out about the streams.
    pub fn paint(&mut self, colours: ColorChoice) {
        if colours != ColorChoice::Auto {
            (self.colour_out, self.colour_err) =
                (colours == ColorChoice::Always, colours == ColorChoice::Always);
        }
    }

    /// Names the command that explains the codes of the printed diagnostics.
    pub fn name_explanations(&mut self) -> io::Result<()> {
        let codes: Vec<&str> = self.codes.iter().flat_map(|codes| codes.take()).collect();
        match codes.as_slice() {
            [] => Ok(()),
            [code] => writeln!(self.remarks(), "`monas explain {code}` says more about this diagnostic"),
            [first, ..] => writeln!(
                self.remarks(),
                "`monas explain CODE` says more about {}; for example `monas explain {first}`",
                codes.join(", ")
            ),
        }
    }
}
