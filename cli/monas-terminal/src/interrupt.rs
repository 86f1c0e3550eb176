//! Ctrl-C and other signals: the first ends the run in order, a later one ends the process.

use std::io;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, AtomicU64, AtomicUsize, Ordering};
use std::time::Duration;

use signal_hook::consts::{SIGINT, SIGTERM};
use signal_hook::{flag, low_level};

use crate::{CommandOutput, Exit, WallClock};

/// The time after the first signal in which others belong to it: programs such as `timeout` send a
/// signal to the process and to its group, and the terminal sends Ctrl-C to the group as well.
const REPETITION_TIME: Duration = Duration::from_millis(250);

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

    /// An interrupt that SIGINT, SIGTERM or SIGHUP sets; a signal after [`REPETITION_TIME`] ends
    /// the process.
    ///
    /// # Errors
    /// The system refuses a signal handler.
    fn on_signals() -> io::Result<Interrupt> {
        let interrupt = Interrupt::default();
        let (clock, first) = (WallClock::start(), Arc::new(AtomicU64::new(0)));
        for signal in SIGNALS {
            let status = i32::from(Exit::Interrupted(signal as u8).code());
            let first = first.clone();
            let end_if_repeated = move || {
                if is_repeated(&first, clock.elapsed()) {
                    low_level::exit(status);
                }
            };
            #[expect(unsafe_code, reason = "a signal handler is registered with the system")]
            // SAFETY: the handler reads the monotonic clock, accesses an atomic number and may end
            // the process by `_exit`. All of these are async-signal-safe.
            unsafe {
                low_level::register(signal, end_if_repeated)?;
            }
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

/// Whether a signal at this time is not the first, nor one that belongs to it. `first` is the time
/// of the first signal in nanoseconds, 0 before it.
fn is_repeated(first: &AtomicU64, now: Duration) -> bool {
    let now = u64::try_from(now.as_nanos()).unwrap_or(u64::MAX).max(1);
    match first.compare_exchange(0, now, Ordering::Relaxed, Ordering::Relaxed) {
        Ok(_) => false,
        Err(first) => Duration::from_nanos(now.saturating_sub(first)) >= REPETITION_TIME,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn signals_soon_after_the_first_belong_to_it() {
        let first = AtomicU64::new(0);
        let repeated =
            [0, 1, 249, 250, 900].map(|after| is_repeated(&first, Duration::from_millis(5000 + after)));
        assert_eq!(repeated, [false, false, false, true, true]);
    }
}
