//! Ctrl-C: once to end with what there is, twice to end at once.

use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

use crate::exit::Exit;

/// Whether somebody wants the run to end.
#[derive(Clone, Debug, Default)]
pub(crate) struct Interrupt(Arc<AtomicBool>);

impl Interrupt {
    /// An interrupt that Ctrl-C, or the signal to terminate, sets off; the second of them ends the process.
    ///
    /// Fails if the process catches signals already.
    pub(crate) fn on_signals() -> Result<Interrupt, ctrlc::Error> {
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
