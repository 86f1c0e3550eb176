//! The log of this process: on standard error, and in the files that `--log` configures.

use std::io::{self, Write};
use std::path::PathBuf;

use indicatif::MultiProgress;
use monas::logger::{self, LogSettings, Logger, Severity};
use monas_tape::ExistingFile;
use tracing_subscriber::filter::{LevelFilter, Targets};
use tracing_subscriber::prelude::*;
use tracing_subscriber::{Registry, reload};

/// The default of MONAS_LOG: this level and graver ones. Warnings of zenoh do not concern a
/// run, and failures are reported as errors of the link.
fn usual(level: LevelFilter) -> Targets {
    Targets::new().with_default(level).with_target("zenoh", LevelFilter::ERROR)
}

/// The log of this process: filtered lines on standard error, and the log that `--log` configures.
#[derive(Clone)]
pub struct ProcessLog {
    logger: Logger,
    filter: reload::Handle<Targets, Registry>,
    bars: MultiProgress,
    /// Whether MONAS_LOG or an option chose what is logged on standard error.
    is_chosen: bool,
}

impl ProcessLog {
    /// Starts the log on standard error, above progress bars.
    pub fn begin(bars: &MultiProgress) -> Option<ProcessLog> {
        let asked = std::env::var("MONAS_LOG");
        let is_chosen = asked.is_ok();
        let asked = asked.map_or(Ok(usual(LevelFilter::WARN)), |text| text.parse());
        let mistake = asked.as_ref().err().map(ToString::to_string);
        let filter = asked.unwrap_or_else(|_| usual(LevelFilter::WARN));
        let (filter, handle) = reload::Layer::new(filter);
        let above = bars.clone();
        let writer = move || ProgressAwareStderr(above.clone());
        let lines = tracing_subscriber::fmt::layer().with_writer(writer).with_ansi(false).without_time();
        let (layer, logger) = logger::layer();
        // This fails only if a program that calls this library has installed its own log, which
        // stays.
        let is_ours =
            tracing_subscriber::registry().with(lines.with_filter(filter)).with(layer).try_init().is_ok();
        if let Some(mistake) = mistake {
            tracing::warn!("MONAS_LOG is invalid, warnings and errors are logged: {mistake}");
        }
        is_ours.then(|| ProcessLog { logger, filter: handle, bars: bars.clone(), is_chosen })
    }

    /// Logs lines of this level and graver ones on standard error, unless MONAS_LOG is set.
    pub fn limit(&mut self, level: LevelFilter) {
        if !std::mem::replace(&mut self.is_chosen, true) {
            // This fails only after the log has ended.
            let _ = self.filter.reload(usual(level));
        }
    }

    /// Flushes and ends the log.
    pub fn end(&self) {
        self.logger.end();
    }

    /// From now on, publishes lines of at least this severity on the hosts of the run.
    pub fn publish(&self, least_grave: Severity) {
        self.logger.publish(least_grave);
    }

    /// Starts the configured log. It replaces the lines on standard error unless MONAS_LOG or an
    /// option chose them.
    /// Returns the path of its file, which differs from the configured one if that exists.
    pub fn write(&self, settings: LogSettings, existing: ExistingFile) -> io::Result<Option<PathBuf>> {
        let bars = self.bars.clone();
        let file = self.logger.begin_with(settings, existing, move |lines| {
            // If standard error is closed there is nowhere to report that.
            let _ = ProgressAwareStderr(bars.clone()).write_all(lines);
        })?;
        if !self.is_chosen {
            // This fails only after the log has ended.
            let _ = self.filter.reload(Targets::new());
        }
        Ok(file)
    }
}

/// Standard error; progress bars are hidden during writes.
struct ProgressAwareStderr(MultiProgress);

impl Write for ProgressAwareStderr {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        self.0.suspend(|| io::stderr().write_all(bytes).map(|()| bytes.len()))
    }

    fn flush(&mut self) -> io::Result<()> {
        io::stderr().flush()
    }
}
