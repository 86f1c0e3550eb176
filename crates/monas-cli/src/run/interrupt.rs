//! Ctrl-C: once to end with what there is, twice to end at once.

use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

use crate::console::Console;
use crate::exit::Exit;

/// Whether somebody wants the run to end.
#[derive(Clone, Debug, Default)]
pub(crate) struct Interrupt(Arc<AtomicBool>);

impl Interrupt {
    /// The interrupt for a run in this console.
    pub(crate) fn for_console(console: &Console<'_>) -> Result<Interrupt, ctrlc::Error> {
        if console.catches_signals { Interrupt::on_signals() } else { Ok(Interrupt::default()) }
    }

    /// An interrupt that Ctrl-C, or the signal to terminate, sets off; the second of them ends the process.
    ///
    /// Fails if the process catches signals already.
    fn on_signals() -> Result<Interrupt, ctrlc::Error> {
        let interrupt = Interrupt::default();
        let requested = interrupt.0.clone();
        ctrlc::set_handler(move || {
            if requested.swap(true, Ordering::Relaxed) {
                std::process::exit(Exit::Interrupted.code().into());
            }
        })?;
        Ok(interrupt)
    }

    /// Whether the run is to end.
    pub(crate) fn is_requested(&self) -> bool {
        self.0.load(Ordering::Relaxed)
    }
}
