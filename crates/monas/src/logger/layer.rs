//! The layer that takes events, and the thread that writes them.

use std::fmt;
use std::io::{self, Write};
use std::sync::atomic::{AtomicU8, Ordering};
use std::sync::{Arc, Mutex, OnceLock, PoisonError};
use std::thread::{self, JoinHandle};

use tracing::level_filters::LevelFilter;
use tracing::subscriber::Interest;
use tracing::{Event, Metadata, Subscriber};
use tracing_subscriber::Layer;
use tracing_subscriber::layer::{Context, Filter};

use super::output::{Batch, Console, Outputs};
use super::queue::Queue;
use super::record::{Record, Severity};
use super::settings::Settings;
use super::topic;

/// A layer that does nothing until its logger begins, and that logger.
pub fn layer<S: Subscriber + for<'a> tracing_subscriber::registry::LookupSpan<'a>>() -> (impl Layer<S>, Logger)
{
    let shared = Arc::new(Shared {
        begun: OnceLock::new(),
        written: Reach::default(),
        published: Reach::default(),
        thread: Mutex::new(None),
    });
    let layer = LogLayer { shared: shared.clone() };
    let wanted = Wanted { shared: shared.clone() };
    (layer.with_filter(wanted), Logger { shared })
}

/// Has a log written. Clones are handles to the same.
#[derive(Clone)]
pub struct Logger {
    shared: Arc<Shared>,
}

/// Takes the events that are logged.
struct LogLayer {
    shared: Arc<Shared>,
}

struct Shared {
    begun: OnceLock<Begun>,
    /// What is written into the file or onto the console.
    written: Reach,
    /// What is published on the hosts.
    published: Reach,
    thread: Mutex<Option<JoinHandle<()>>>,
}

/// A log that is being written.
struct Begun {
    settings: Settings,
    outputs: Outputs,
    queue: Queue,
}

impl Logger {
    /// Begins to write. The console is standard error. The layer has its place by then: `tracing` asks for what is wanted when the log begins.
    ///
    /// # Errors
    /// The file cannot be made, the system gives no thread, or it has begun before.
    pub fn begin(&self, settings: Settings) -> io::Result<()> {
        self.begin_with(settings, |lines| {
            // If nobody sees the console there is nobody to tell.
            let _ = io::stderr().write_all(lines);
        })
    }

    /// As [`begin`](Logger::begin); what the console shows goes to a function, whole lines at a time.
    ///
    /// # Errors
    /// As in [`begin`](Logger::begin).
    pub fn begin_with(
        &self,
        settings: Settings,
        console: impl Fn(&[u8]) + Send + Sync + 'static,
    ) -> io::Result<()> {
        let again = || io::Error::new(io::ErrorKind::AlreadyExists, "the log has begun before");
        if self.shared.begun.get().is_some() {
            return Err(again());
        }
        let console: Console = Box::new(console);
        let outputs = Outputs::open(&settings, console)?;
        let least_grave = settings.verbosity.max(Severity::Error);
        let begun = Begun { settings, outputs, queue: Queue::new() };
        self.shared.begun.set(begun).map_err(|_| again())?;
        let shared = self.shared.clone();
        let thread = thread::Builder::new().name("logger".into()).spawn(move || shared.write_all())?;
        *self.shared.thread.lock().unwrap_or_else(PoisonError::into_inner) = Some(thread);
        self.shared.written.reach_to(least_grave);
        Ok(())
    }

    /// From now on, what is so grave or graver is published on [`LOG`](crate::records::LOG) of the host that it is about, whatever is written elsewhere and whether anything
    /// is: so it is recorded, crosses links, and is seen by who looks on. That is what agents, their activities and the threads of a [`Talws`](crate::Talws) say; what the rest of a program says
    /// belongs to no host. In simulated time it is published in the course of the simulation, and no [`RunHash`](crate::RunHash) counts it.
    pub fn publish(&self, least_grave: Severity) {
        self.shared.published.reach_to(least_grave);
    }

    /// Writes all that has been said, and no more after that.
    pub fn end(&self) {
        let thread = self.shared.thread.lock().unwrap_or_else(PoisonError::into_inner).take();
        let (Some(thread), Some(begun)) = (thread, self.shared.begun.get()) else { return };
        self.shared.written.reach_nothing();
        begun.queue.end();
        // It only panics where the console does; then there is nothing more to write to.
        let _ = thread.join();
    }
}

impl Shared {
    /// What the logger's thread does.
    fn write_all(&self) {
        let Some(Begun { outputs, queue, .. }) = self.begun.get() else { return };
        queue.emptied_here();
        let mut batch = Batch::default();
        loop {
            while queue.next(|record| outputs.add(record, &mut batch)) {}
            self.tell_dropped(&mut batch);
            outputs.write(&mut batch);
            if !queue.sleep() {
                return;
            }
        }
    }

    fn tell_dropped(&self, batch: &mut Batch) {
        let Some(Begun { outputs, queue, .. }) = self.begun.get() else { return };
        let dropped = queue.take_dropped();
        if dropped > 0 {
            outputs.add(
                &Record::of_logger(format_args!("{dropped} messages were dropped here: they came too fast")),
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
            topic::publish(event);
        }
    }
}

impl Shared {
    /// Writes an event, or leaves it to the logger's thread.
    fn write(&self, event: &Event<'_>) {
        let Some(Begun { settings, outputs, queue }) = self.begun.get() else { return };
        if Severity::of(*event.metadata().level()).is_urgent() {
            let mut record = Record::new();
            record.take(event);
            let mut batch = Batch::default();
            outputs.add(&record, &mut batch);
            return outputs.write(&mut batch);
        }
        queue.put(|record| {
            record.take(event);
            settings.wants_of(record.agent.as_str(), record.activity.as_str())
        });
    }
}

/// Says which events are wanted before anything is made of them.
struct Wanted {
    shared: Arc<Shared>,
}

impl Wanted {
    fn level(&self) -> LevelFilter {
        self.shared.written.level().max(self.shared.published.level())
    }
}

/// The least grave events that are wanted for something: none at first.
#[derive(Debug)]
struct Reach(AtomicU8);

/// Stands for no severity.
const NOTHING: u8 = u8::MAX;

impl Default for Reach {
    fn default() -> Reach {
        Reach(AtomicU8::new(NOTHING))
    }
}

impl Reach {
    fn reach_to(&self, least_grave: Severity) {
        self.set(least_grave.number());
    }

    fn reach_nothing(&self) {
        self.set(NOTHING);
    }

    fn set(&self, number: u8) {
        self.0.store(number, Ordering::Relaxed);
        tracing::callsite::rebuild_interest_cache();
    }

    fn level(&self) -> LevelFilter {
        match self.0.load(Ordering::Relaxed) {
            NOTHING => LevelFilter::OFF,
            0 | 1 => LevelFilter::ERROR,
            2 => LevelFilter::INFO,
            3 => LevelFilter::DEBUG,
            _ => LevelFilter::TRACE,
        }
    }
}

impl<S> Filter<S> for Wanted {
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
