//! Ctrl-C: the first ends the run in order, the second ends the process.

use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

use super::{CommandOutput, Exit, crash_report};

/// Whether the user has requested the end of the run.
#[derive(Clone, Debug, Default)]
pub(crate) struct Interrupt(Arc<AtomicBool>);

impl Interrupt {
    /// The interrupt for a run of this command.
    pub(crate) fn for_console(console: &CommandOutput<'_>) -> Result<Interrupt, ctrlc::Error> {
        if console.catches_signals { Interrupt::on_signals() } else { Ok(Interrupt::default()) }
    }

    /// An interrupt that SIGINT or SIGTERM sets; the second signal ends the process.
    ///
    /// # Errors
    /// The process has a signal handler already.
    fn on_signals() -> Result<Interrupt, ctrlc::Error> {
        let interrupt = Interrupt::default();
        let requested = interrupt.0.clone();
        ctrlc::set_handler(move || {
            if requested.swap(true, Ordering::Relaxed) {
                crash_report::end();
                std::process::exit(Exit::Interrupted.code().into());
            }
        })?;
        Ok(interrupt)
    }

    /// Whether the run shall end.
    pub(crate) fn is_requested(&self) -> bool {
        self.0.load(Ordering::Relaxed)
    }
}
