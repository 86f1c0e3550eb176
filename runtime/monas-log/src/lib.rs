//! The logger of the thesis (4.1.6): messages of agents and of Monas, to a file and the console.
//!
//! Activities write with the macros of [`tracing`], as Rust libraries do. The thesis's five kinds
//! of messages are its levels:
//!
//! | thesis | written with | shown as |
//! |---|---|---|
//! | `FatalError` | [`fatal!`](crate::fatal) | `FATAL` |
//! | `Error` | `tracing::error!` | `ERROR` |
//! | `Info` | `tracing::info!`; also `tracing::warn!`, which the thesis does not have | `INFO`, `WARN` |
//! | `ExtraInfo` | `tracing::debug!` | `DEBUG` |
//! | `ExtraExtraInfo` | `tracing::trace!` | `TRACE` |
//!
//! Each line states the robot, agent, activity and cycle that wrote it, and the time: in simulated
//! time that of the simulation, so that equal runs write equal lines.
//!
//! ```text
//! 2026-03-01T14:00:07.310552Z INFO  [blue-2 behavior/BehaviorGoalie #733] ball at 0.41 m
//! ```
//!
//! # Cost
//!
//! The thread of an agent only writes the text of a message into a preallocated record of 1 KiB (a
//! longer text is cut and ends with `…`). It does not allocate, block or do any output. Times,
//! colours, JSON and files are handled by the logger's thread. If that falls behind, messages are
//! dropped and the log states how many.
//!
//! Errors and fatal errors are the exception: no filter drops them, and they are in the file when
//! the call returns, even if the process dies right after.
//!
//! # Settings
//!
//! The settings of the thesis (Listing 4.5), in XML or TOML:
//!
//! | element | means |
//! |---|---|
//! | `MessageLogFile` | the file; if it exists, the next free name is taken; without this element no file is written |
//! | `MessageLogCerr` | `1` for the console too |
//! | `MessageLogCerrColor` | `1` for colours there |
//! | `MessageLogFilter` | the activities or agents whose messages are logged, or `all` |
//! | `LogFileVerbosityLevel` | 0 or less fatal errors, 1 errors, 2 info, 3 extra info, 4 all; errors are always written |
//! | `MessageLogFormat` | `text`, or `json` for a JSON object a line; the thesis does not have it |
//!
//! # Recording
//!
//! A logger may also [publish](Logger::publish) lines: on [`LOG`](monas_core::records::LOG)
//! (`monas/log`) of the host they belong to, as `foxglove.Log`. Recordings then contain them in
//! order with the other messages, and `monas topic echo monas/log` shows them live. The command
//! publishes messages of severity `Info` and above, or the severity given with `--log`.
//!
//! # Example
//!
//! Monas sets no global subscriber, so a program installs the logger's [`layer`] itself; the
//! command `monas run --log logger.xml` does.
//!
//! ```
//! use monas_log::LogSettings;
//! use tracing_subscriber::prelude::*;
//!
//! let folder = tempfile::tempdir()?;
//! let (layer, logger) = monas_log::layer();
//! tracing_subscriber::registry().with(layer).init();
//! logger.begin(LogSettings { file: Some(folder.path().join("log.txt")), ..LogSettings::default() })?;
//! tracing::info!(distance = 0.41, "ball seen");
//! monas_log::fatal!("no camera");
//! logger.end();
//! let log = std::fs::read_to_string(folder.path().join("log.txt"))?;
//! assert!(log.contains("INFO  ball seen distance=0.41"));
//! assert!(log.contains("FATAL no camera"));
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

mod layer;
mod lines;
mod log_hosts;
mod output;
mod queue;
mod record;

pub use layer::{Logger, layer};
pub use log_hosts::{LogHosts, LogHostsGuard};
pub use monas_config::{LogFormat, LogSettings, Severity};
pub use monas_files::ExistingFile;

/// Writes a message in the name of an activity or another component: the thesis's `WriteMsg`. Code
/// called by the runtime uses the macros of [`tracing`] instead.
pub fn write(name: &str, message: &dyn std::fmt::Display, severity: Severity) {
    match severity {
        Severity::FatalError => tracing::error!(fatal = true, activity = name, "{message}"),
        Severity::Error => tracing::error!(activity = name, "{message}"),
        Severity::Warning => tracing::warn!(activity = name, "{message}"),
        Severity::Info => tracing::info!(activity = name, "{message}"),
        Severity::ExtraInfo => tracing::debug!(activity = name, "{message}"),
        Severity::ExtraExtraInfo => tracing::trace!(activity = name, "{message}"),
    }
}

/// Logs a fatal error: one that the process does not survive, or not in a usable state. Takes the
/// arguments of the macros of [`tracing`].
///
/// ```
/// monas_log::fatal!(port = 9559, "the robot's body does not answer");
/// ```
#[macro_export]
macro_rules! fatal {
    ($($words:tt)+) => {
        $crate::tracing::error!(fatal = true, $($words)+)
    };
}

#[doc(hidden)]
pub use tracing;
