//! Ctrl-C and other signals: the first ends the run in order, the second ends the process.

use std::io;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};

use signal_hook::consts::{SIGINT, SIGTERM};
use signal_hook::flag;

use crate::{CommandOutput, Exit};

/// Signals that end a run.
#[cfg(unix)]
const SIGNALS: [i32; 3] = [SIGINT, SIGTERM, signal_hook::consts::SIGHUP];
#[cfg(not(unix))]
const SIGNALS: [i32; 2] = [SIGINT, SIGTERM];

/// Whether the user has requested the end of the run.
#[derive(Clone, Debug, Default)]
pub struct Interrupt {
    is_requested: Arc<AtomicBool>,
    /// The last signal; 0 before the first.
    signal: Arc<AtomicUsize>,
}

impl Interrupt {
    /// The interrupt for a run of this command.
    pub fn for_console(console: &CommandOutput<'_>) -> io::Result<Interrupt> {
        if console.catches_signals { Interrupt::on_signals() } else { Ok(Interrupt::default()) }
    }

    /// An interrupt that SIGINT, SIGTERM or SIGHUP sets; the second signal ends the process.
    ///
    /// # Errors
    /// The system refuses a signal handler.
    fn on_signals() -> io::Result<Interrupt> {
        let interrupt = Interrupt::default();
        for signal in SIGNALS {
            // Handlers run in the order of their registration: the first signal finds the flag
            // unset.
            let status = i32::from(Exit::Interrupted(signal as u8).code());
            flag::register_conditional_shutdown(signal, status, interrupt.is_requested.clone())?;
            flag::register_usize(signal, interrupt.signal.clone(), signal as usize)?;
            flag::register(signal, interrupt.is_requested.clone())?;
        }
        Ok(interrupt)
    }

    /// Whether the run shall end.
    pub fn is_requested(&self) -> bool {
        self.is_requested.load(Ordering::Relaxed)
    }

    /// The exit status of a run that a signal has ended.
    pub fn exit(&self) -> Option<Exit> {
        let signal = self.signal.load(Ordering::Relaxed);
        self.is_requested().then(|| Exit::Interrupted(u8::try_from(signal).unwrap_or_default()))
    }
}
