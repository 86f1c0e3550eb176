//! Log lines as messages of the host they belong to.
//!
//! The thread that writes a line publishes it: in simulated time the order of lines among the
//! messages of a run is therefore the same in each run. Every thread of a run in real time has its
//! own publisher, so that threads do not wait for each other.

use std::cell::RefCell;
use std::fmt::Write;
use std::sync::{Arc, Mutex, TryLockError};
use std::time::SystemTime;

use narukom::{Hub, Publisher, Timestamp};
use prost_types::Timestamp as ProtoTimestamp;
use tracing::Event;

use crate::record::{Record, RecordTime};
use monas_config::Severity;
use monas_core::activity_context as context;
use monas_core::module::log_bridge;
use monas_core::records::LOG;
use monas_core::records::foxglove::Log;
use monas_core::records::foxglove::log::Level;

/// The publisher's name for lines.
const PUBLISHER: &str = "log";

/// Returns the present time of a run in real time.
type RunTime = Box<dyn Fn() -> Timestamp + Send>;

/// The hosts for which a thread works, and to which lines written meanwhile belong.
#[derive(Clone)]
pub struct LogHosts {
    state: Arc<Mutex<LogPublisherState>>,
}

/// Publishes lines as messages.
struct LogPublisherState {
    hosts: Vec<(Hub, Option<Publisher<Log>>)>,
    /// The time of the run, unless time is simulated.
    clock: Option<RunTime>,
    /// Allocated with the first line.
    record: Option<Box<Record>>,
}

thread_local! {
    static CURRENT: RefCell<Option<Arc<Mutex<LogPublisherState>>>> = const { RefCell::new(None) };
}

impl LogHosts {
    /// For a run in simulated time.
    pub fn simulated<'h>(hubs: impl IntoIterator<Item = &'h Hub>) -> LogHosts {
        LogHosts::new(hubs, None)
    }

    /// For one thread of a run in real time.
    pub fn real<'h>(
        hubs: impl IntoIterator<Item = &'h Hub>,
        now: impl Fn() -> Timestamp + Send + 'static,
    ) -> LogHosts {
        LogHosts::new(hubs, Some(Box::new(now)))
    }

    fn new<'h>(hubs: impl IntoIterator<Item = &'h Hub>, clock: Option<RunTime>) -> LogHosts {
        let hosts = hubs.into_iter().map(|hub| (hub.clone(), None)).collect();
        LogHosts { state: Arc::new(Mutex::new(LogPublisherState { hosts, clock, record: None })) }
    }

    /// Until the guard is dropped, this thread works for these hosts.
    pub fn begin(&self) -> LogHostsGuard {
        LogHostsGuard(CURRENT.replace(Some(self.state.clone())))
    }

    /// Runs a function on this thread for these hosts.
    pub fn during<T>(&self, work: impl FnOnce() -> T) -> T {
        let _hosted = self.begin();
        work()
    }
}

/// Restores the previous hosts of this thread.
pub struct LogHostsGuard(Option<Arc<Mutex<LogPublisherState>>>);

impl Drop for LogHostsGuard {
    fn drop(&mut self) {
        CURRENT.replace(self.0.take());
    }
}

/// Publishes an event on its host if this thread works for that host. Events raised while a line is
/// being published are not published.
pub(crate) fn publish(event: &Event<'_>) {
    // The thread-local is destroyed already when the thread ends.
    let state = CURRENT.try_with(|state| state.try_borrow().ok().and_then(|state| state.clone()));
    let Ok(Some(state)) = state else { return };
    match state.try_lock() {
        Ok(mut state) => state.publish(event),
        // Formatting a value has panicked before; the next line starts over.
        Err(TryLockError::Poisoned(state)) => state.into_inner().publish(event),
        Err(TryLockError::WouldBlock) => {}
    }
}

impl LogPublisherState {
    fn publish(&mut self, event: &Event<'_>) {
        let LogPublisherState { hosts, clock, record } = self;
        let record = record.get_or_insert_with(|| Box::new(Record::new()));
        record.take(event);
        let now = context::simulated().or(clock.as_ref().map(|now| now()));
        let host = match hosts.as_mut_slice() {
            [one] => Some(one),
            several => several.iter_mut().find(|(hub, _)| hub.host() == record.robot.as_str()),
        };
        let (Some((hub, publisher)), Some(now)) = (host, now) else { return };
        if publisher.is_none() {
            // A hub may lack the topic; then lines are not published.
            *publisher = hub.publisher(LOG, PUBLISHER).ok();
        }
        let metadata = event.metadata();
        let index = (metadata.target() != log_bridge::TARGET).then(|| (metadata.file(), metadata.line()));
        let (file, line) = index.unwrap_or_default();
        let make = |log: &mut Log| {
            fill(log, record);
            log.file.push_str(file.unwrap_or_default());
            log.line = line.unwrap_or_default();
        };
        publisher.iter_mut().for_each(|publisher| publisher.publish_with(make, now));
    }
}

fn fill(log: &mut Log, record: &Record) {
    log.timestamp = Some(timestamp(record.time));
    log.set_level(level(record.severity));
    log.message.push_str(record.message.as_str().trim_start());
    if let Some(cycle) = record.cycle {
        // Writing to the text cannot fail.
        let _ = write!(log.message, " cycle={cycle}");
    }
    log.name.push_str(record.agent.as_str());
    if !record.agent.as_str().is_empty() && !record.activity.as_str().is_empty() {
        log.name.push('/');
    }
    log.name.push_str(record.activity.as_str());
}

fn timestamp(time: RecordTime) -> ProtoTimestamp {
    let since = match time {
        RecordTime::Simulated(moment) => moment.since(Timestamp::ZERO),
        // A clock before 1970 is wrong.
        RecordTime::Wall(time) => time.duration_since(SystemTime::UNIX_EPOCH).unwrap_or_default(),
    };
    ProtoTimestamp { seconds: since.as_secs() as i64, nanos: since.subsec_nanos() as i32 }
}

fn level(severity: Severity) -> Level {
    match severity {
        Severity::FatalError => Level::Fatal,
        Severity::Error => Level::Error,
        Severity::Warning => Level::Warning,
        Severity::Info => Level::Info,
        Severity::ExtraInfo | Severity::ExtraExtraInfo => Level::Debug,
    }
}
