//! The layer that receives events, and the thread that writes them.

use std::fmt;
use std::io::{self, Write};
use std::path::PathBuf;
use std::sync::atomic::{AtomicU8, Ordering};
use std::sync::{Arc, Mutex, OnceLock, PoisonError};
use std::thread::{self, JoinHandle};

use tracing::level_filters::LevelFilter;
use tracing::subscriber::Interest;
use tracing::{Event, Metadata, Subscriber};
use tracing_subscriber::Layer;
use tracing_subscriber::layer::{Context, Filter};

use super::log_hosts;
use super::output::{ConsoleWriter, OutputBatch, Outputs};
use super::queue::RecordQueue;
use crate::record::Record;
use monas_config::LogSettings;
use monas_config::Severity;
use monas_files::ExistingFile;

/// A layer that does nothing until its logger begins, and that logger.
pub fn layer<S: Subscriber + for<'a> tracing_subscriber::registry::LookupSpan<'a>>() -> (impl Layer<S>, Logger)
{
    let shared = Arc::new(LoggerShared {
        begun: OnceLock::new(),
        written: MinimumSeverity::default(),
        published: MinimumSeverity::default(),
        thread: Mutex::new(None),
    });
    let layer = LogLayer { shared: shared.clone() };
    let wanted = SeverityFilter { shared: shared.clone() };
    (layer.with_filter(wanted), Logger { shared })
}

/// Controls a log. Clones refer to the same log.
#[derive(Clone)]
pub struct Logger {
    shared: Arc<LoggerShared>,
}

/// The layer that receives events.
struct LogLayer {
    shared: Arc<LoggerShared>,
}

struct LoggerShared {
    begun: OnceLock<OpenLog>,
    /// Severities written to the file or the console.
    written: MinimumSeverity,
    /// Severities published on the hosts.
    published: MinimumSeverity,
    thread: Mutex<Option<JoinHandle<()>>>,
}

/// An open log.
struct OpenLog {
    settings: LogSettings,
    outputs: Outputs,
    queue: RecordQueue,
}

impl Logger {
    /// Starts writing. The console is standard error. The layer must be installed before, since
    /// `tracing` queries the wanted events when the log begins. Returns the path of the file: that
    /// of the settings, or one with a number in its name if that exists.
    ///
    /// # Errors
    /// The file cannot be created, the system cannot create a thread, or the log was started
    /// already.
    pub fn begin(&self, settings: LogSettings) -> io::Result<Option<PathBuf>> {
        self.begin_with(settings, ExistingFile::Keep, |lines| {
            // A failure to write to the console cannot be reported.
            let _ = io::stderr().write_all(lines);
        })
    }

    /// As [`begin`](Logger::begin), with a function that receives console output as whole lines.
    /// `existing` decides what happens to a file that exists.
    ///
    /// # Errors
    /// As in [`begin`](Logger::begin).
    pub fn begin_with(
        &self,
        settings: LogSettings,
        existing: ExistingFile,
        console: impl Fn(&[u8]) + Send + Sync + 'static,
    ) -> io::Result<Option<PathBuf>> {
        let again = || io::Error::new(io::ErrorKind::AlreadyExists, "the log was started already");
        if self.shared.begun.get().is_some() {
            return Err(again());
        }
        let console: ConsoleWriter = Box::new(console);
        let outputs = Outputs::open(&settings, existing, console)?;
        let path = outputs.path().map(PathBuf::from);
        let least_grave = settings.verbosity.max(Severity::Error);
        let begun = OpenLog { settings, outputs, queue: RecordQueue::new() };
        self.shared.begun.set(begun).map_err(|_| again())?;
        let shared = self.shared.clone();
        let thread = thread::Builder::new().name("logger".into()).spawn(move || shared.write_all())?;
        *self.shared.thread.lock().unwrap_or_else(PoisonError::into_inner) = Some(thread);
        self.shared.written.include(least_grave);
        Ok(path)
    }

    /// From now on, publishes messages of at least this severity on
    /// [`LOG`](monas_core::records::LOG) of the host they belong to, independent of the settings
    /// for file and console, so that they are recorded, cross links and are visible to tools. This
    /// covers agents, their activities and the threads of a `Talws`; other
    /// messages of a program belong to no host. In simulated time they are published in the course
    /// of the simulation; a [`RunHash`](monas_core::RunHash) does not include them.
    pub fn publish(&self, least_grave: Severity) {
        self.shared.published.include(least_grave);
    }

    /// Writes all pending messages, and none after that.
    pub fn end(&self) {
        let thread = self.shared.thread.lock().unwrap_or_else(PoisonError::into_inner).take();
        let (Some(thread), Some(begun)) = (thread, self.shared.begun.get()) else { return };
        self.shared.written.exclude_all();
        begun.queue.end();
        // It panics only if the console writer does; then there is nothing to write to.
        let _ = thread.join();
    }
}

impl LoggerShared {
    /// The loop of the logger's thread.
    fn write_all(&self) {
        let Some(OpenLog { outputs, queue, .. }) = self.begun.get() else { return };
        queue.set_consumer_thread();
        let mut batch = OutputBatch::default();
        loop {
            while queue.next(|record| outputs.add(record, &mut batch)) {}
            self.report_dropped(&mut batch);
            outputs.write(&mut batch);
            if !queue.sleep() {
                return;
            }
        }
    }

    fn report_dropped(&self, batch: &mut OutputBatch) {
        let Some(OpenLog { outputs, queue, .. }) = self.begun.get() else { return };
        let dropped = queue.take_dropped();
        if dropped > 0 {
            outputs.add(
                &Record::of_logger(format_args!(
                    "{dropped} messages were dropped here: the rate was too high"
                )),
                batch,
            );
        }
    }
}

impl<S: Subscriber> Layer<S> for LogLayer {
    fn on_event(&self, event: &Event<'_>, _: Context<'_, S>) {
        let level = event.metadata().level();
        if *level <= self.shared.written.level() {
            self.shared.write(event);
        }
        if *level <= self.shared.published.level() {
            log_hosts::publish(event);
        }
    }
}

impl LoggerShared {
    /// Writes an event, or queues it for the logger's thread.
    fn write(&self, event: &Event<'_>) {
        let Some(OpenLog { settings, outputs, queue }) = self.begun.get() else { return };
        if crate::record::severity_of(*event.metadata().level()).is_urgent() {
            let mut record = Record::new();
            record.take(event);
            let mut batch = OutputBatch::default();
            outputs.add(&record, &mut batch);
            return outputs.write(&mut batch);
        }
        queue.put(|record| {
            record.take(event);
            settings.wants_of(record.agent.as_str(), record.activity.as_str())
        });
    }
}

/// Filters events by severity before they are formatted.
struct SeverityFilter {
    shared: Arc<LoggerShared>,
}

impl SeverityFilter {
    fn level(&self) -> LevelFilter {
        self.shared.written.level().max(self.shared.published.level())
    }
}

/// The minimum severity of wanted events; none at first.
#[derive(Debug)]
struct MinimumSeverity(AtomicU8);

/// No severity.
const NO_SEVERITY: u8 = u8::MAX;

impl Default for MinimumSeverity {
    fn default() -> MinimumSeverity {
        MinimumSeverity(AtomicU8::new(NO_SEVERITY))
    }
}

impl MinimumSeverity {
    fn include(&self, least_grave: Severity) {
        self.set(least_grave.number());
    }

    fn exclude_all(&self) {
        self.set(NO_SEVERITY);
    }

    fn set(&self, number: u8) {
        self.0.store(number, Ordering::Relaxed);
        tracing::callsite::rebuild_interest_cache();
    }

    fn level(&self) -> LevelFilter {
        match self.0.load(Ordering::Relaxed) {
            NO_SEVERITY => LevelFilter::OFF,
            0 | 1 => LevelFilter::ERROR,
            2 => LevelFilter::INFO,
            3 => LevelFilter::DEBUG,
            _ => LevelFilter::TRACE,
        }
    }
}

impl<S> Filter<S> for SeverityFilter {
    fn enabled(&self, metadata: &Metadata<'_>, _: &Context<'_, S>) -> bool {
        *metadata.level() <= self.level()
    }

    fn callsite_enabled(&self, metadata: &'static Metadata<'static>) -> Interest {
        if *metadata.level() <= self.level() { Interest::always() } else { Interest::never() }
    }

    fn max_level_hint(&self) -> Option<LevelFilter> {
        Some(self.level())
    }
}

impl fmt::Debug for Logger {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let settings = self.shared.begun.get().map(|begun| &begun.settings);
        f.debug_struct("Logger").field("settings", &settings).finish_non_exhaustive()
    }
}
