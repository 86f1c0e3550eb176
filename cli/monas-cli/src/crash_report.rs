//! Reports of fatal faults: the activity that each thread has called last.
//!
//! A signal that ends the process, and a call of `exit` by an activity, are reported on standard
//! error, and the recording is passed to the system up to the fault. The handler neither allocates
//! nor takes a lock. Only Linux has it.

use std::sync::OnceLock;
use std::sync::atomic::{AtomicBool, Ordering};

use monas_tape::{CrashFlush, Tape};

/// The recording of the run.
static RECORDING: OnceLock<CrashFlush> = OnceLock::new();

/// Whether the command ends by itself.
static IS_ENDING: AtomicBool = AtomicBool::new(false);

/// Lets a fatal fault flush this recording. A process has one run.
pub(crate) fn flush_in_crash(tape: &Tape) {
    let _ = RECORDING.set(tape.crash_flush());
}

/// From now on, the end of the process is intended.
pub(crate) fn end() {
    IS_ENDING.store(true, Ordering::Relaxed);
}

#[cfg(target_os = "linux")]
pub(crate) use linux::CrashReport;

#[cfg(target_os = "linux")]
mod linux {
    use std::sync::atomic::Ordering;
    use std::time::Duration;

    use crash_handler::{CrashContext, CrashEventResult, CrashHandler, write_stderr};
    use monas::activity_name::ActivityName;
    use monas::call_slot::{self, LastCall};

    use super::{IS_ENDING, RECORDING};

    /// Interval and number of checks whether the recording has been flushed.
    const FLUSH_CHECK_INTERVAL: Duration = Duration::from_millis(5);
    const FLUSH_CHECKS: u32 = 100;

    /// Reports fatal faults while it exists.
    pub(crate) struct CrashReport {
        _handler: CrashHandler,
    }

    impl CrashReport {
        /// Installs the handlers; none if the system refuses.
        #[expect(unsafe_code, reason = "handlers of signals and of `exit` are registered with the system")]
        pub(crate) fn install() -> Option<CrashReport> {
            let on_crash = |context: &CrashContext| {
                report(name_of(context.siginfo.ssi_signo));
                // The signal ends the process as it would without this handler.
                CrashEventResult::Handled(false)
            };
            // SAFETY: the handler only reads atomics and static texts, writes to standard error and
            // sleeps, all of which a signal handler may do.
            let event = unsafe { crash_handler::make_crash_event(on_crash) };
            let handler = CrashHandler::attach(event)
                .inspect_err(|error| tracing::warn!("crashes will not be reported: {error}"))
                .ok()?;
            // SAFETY: the function is static and does not unwind.
            if unsafe { libc::atexit(on_exit) } != 0 {
                tracing::warn!("calls of `exit` will not be reported");
            }
            Some(CrashReport { _handler: handler })
        }
    }

    extern "C" fn on_exit() {
        if !IS_ENDING.load(Ordering::Relaxed) {
            report("a call of `exit`");
        }
    }

    fn name_of(signal: u32) -> &'static str {
        match i32::try_from(signal).unwrap_or_default() {
            libc::SIGABRT => "SIGABRT (abort)",
            libc::SIGBUS => "SIGBUS (access to memory that is not there)",
            libc::SIGFPE => "SIGFPE (arithmetic)",
            libc::SIGILL => "SIGILL (invalid instruction)",
            libc::SIGSEGV => "SIGSEGV (invalid access to memory)",
            libc::SIGTRAP => "SIGTRAP (trap)",
            _ => "a fatal signal",
        }
    }

    /// Writes what ended the process and where its threads were, then flushes the recording.
    fn report(cause: &'static str) {
        write_stderr("fatal: the process is ended by ");
        write_stderr(cause);
        write_stderr("\n");
        let mut is_known = false;
        call_slot::each(|one| {
            is_known |= one.is_current;
            if one.is_current {
                write_thread(one, "here: ");
            }
        });
        if !is_known {
            write_stderr("  here: a thread that has called no activity\n");
        }
        call_slot::each(|one| {
            if !one.is_current {
                write_thread(one, "another thread: ");
            }
        });
        flush_recording();
    }

    fn write_thread(one: LastCall, begin: &'static str) {
        let call = if one.is_running { "in activity " } else { "after activity " };
        let ActivityName { robot, agent, activity } = one.name;
        for part in ["  ", begin, call, robot, "/", agent, "/", activity, "\n"] {
            write_stderr(part);
        }
    }

    #[expect(clippy::disallowed_methods, reason = "the fault waits until the recording is written")]
    fn flush_recording() {
        let Some(recording) = RECORDING.get() else { return };
        recording.request();
        for _ in 0..FLUSH_CHECKS {
            if recording.is_done() {
                return write_stderr("  the recording reaches up to here\n");
            }
            std::thread::sleep(FLUSH_CHECK_INTERVAL);
        }
        write_stderr("  the recording may lack the last second\n");
    }
}
