//! The logger of the thesis (4.1.6): what agents and Monas itself have to say, into a file and onto the console.
//!
//! Activities write with the macros of [`tracing`], as Rust libraries do. The thesis's five kinds of messages are its levels:
//!
//! | thesis | written with | shown as |
//! |---|---|---|
//! | `FatalError` | [`fatal!`](crate::fatal) | `FATAL` |
//! | `Error` | `tracing::error!` | `ERROR` |
//! | `Info` | `tracing::info!`; also `tracing::warn!`, which the thesis does not know | `INFO`, `WARN` |
//! | `ExtraInfo` | `tracing::debug!` | `DEBUG` |
//! | `ExtraExtraInfo` | `tracing::trace!` | `TRACE` |
//!
//! A line says by itself which robot, agent, activity and cycle wrote it, and at which time: in simulated time that of the simulation, so that the
//! same run writes the same lines.
//!
//! ```text
//! 2026-03-01T14:00:07.310552Z INFO  [blue-2 behavior/BehaviorGoalie #733] ball at 0.41 m
//! ```
//!
//! # Who pays
//!
//! The thread of an agent only puts the words of a message into a record that is there already, of 1 KiB (a longer one is cut and ends with `…`). It allocates nothing,
//! waits for nobody, and writes nowhere. Times, colours, JSON and files are the work of the logger's thread. If that falls behind, messages are
//! dropped and the log says how many.
//!
//! Errors and fatal errors are the exception: no filter stops them, and they are in the file when the call returns, whatever happens to the process next.
//!
//! # Settings
//!
//! They are the thesis's (Listing 4.5), in XML or TOML:
//!
//! | element | means |
//! |---|---|
//! | `MessageLogFile` | the file, which is begun anew; none if it is not said |
//! | `MessageLogCerr` | `1` for the console too |
//! | `MessageLogCerrColor` | `1` for colours there |
//! | `MessageLogFilter` | the activities or agents whose messages are wanted, or `all` |
//! | `LogFileVerbosityLevel` | 0 fatal errors, 1 errors, 2 info, 3 extra info, 4 all; errors are always written |
//! | `MessageLogFormat` | `text`, or `json` for a JSON object a line; the thesis does not have it |
//!
//! # On the tape
//!
//! A logger may also [publish](Logger::publish) lines: on [`LOG`](crate::records::LOG) (`monas/log`) of the host that they are about, as `foxglove.Log`. So they stand in recordings
//! between the messages of their moment, and `monas topic echo monas/log` shows them live. The command does so with what is as grave as `Info`, or as `--log` asks for.
//!
//! # Example
//!
//! Monas sets nothing for the whole process, so a program puts the logger's [`layer`] where it wants it; the command `monas run --log logger.xml` does.
//!
//! ```
//! use monas::logger::{self, Settings};
//! use tracing_subscriber::prelude::*;
//!
//! let folder = tempfile::tempdir()?;
//! let (layer, logger) = logger::layer();
//! tracing_subscriber::registry().with(layer).init();
//! logger.begin(Settings { file: Some(folder.path().join("log.txt")), ..Settings::default() })?;
//! tracing::info!(distance = 0.41, "ball seen");
//! monas::fatal!("no camera");
//! logger.end();
//! let log = std::fs::read_to_string(folder.path().join("log.txt"))?;
//! assert!(log.contains("INFO  ball seen distance=0.41"));
//! assert!(log.contains("FATAL no camera"));
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

mod context;
mod layer;
mod lines;
mod output;
mod queue;
mod record;
mod settings;
mod topic;

pub(crate) use context::{Caller, Simulating, calling};
pub use layer::{Logger, layer};
pub use record::Severity;
pub use settings::{Format, Settings};
pub(crate) use topic::{Hosted, Hosting};

/// Writes a message in the name of an activity, or of whatever else: the thesis's `WriteMsg`. Code that knows its place uses the macros of
/// [`tracing`] instead.
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

/// Writes a fatal error to the log: one that the process will not survive, or not usefully. It takes what the macros of [`tracing`] take.
///
/// ```
/// monas::fatal!(port = 9559, "the robot's body does not answer");
/// ```
#[macro_export]
macro_rules! fatal {
    ($($words:tt)+) => {
        $crate::logger::tracing::error!(fatal = true, $($words)+)
    };
}

#[doc(hidden)]
pub use tracing;
