//! Lines as messages of the host that they are about.
//!
//! They are published by the thread that writes them: in simulated time their place among the messages of a run is then the same in each run. Every thread of a run in real time has a
//! publisher of its own, so that none waits for another.

use std::cell::RefCell;
use std::fmt::Write;
use std::sync::{Arc, Mutex, TryLockError};
use std::time::SystemTime;

use narukom::{Moment, Narukom, Publisher};
use prost_types::Timestamp;
use tracing::Event;

use super::context;
use super::record::{Record, Severity, Time};
use crate::module::forward;
use crate::records::LOG;
use crate::records::foxglove::Log;
use crate::records::foxglove::log::Level;
use crate::talws::Clock;

/// Under this name lines are published.
const PUBLISHER: &str = "log";

/// The hosts that somebody works for, to whom the lines belong that are written meanwhile.
#[derive(Clone)]
pub(crate) struct Hosting {
    desk: Arc<Mutex<Desk>>,
}

/// Where lines are made messages.
struct Desk {
    hosts: Vec<(Narukom, Option<Publisher<Log>>)>,
    /// Tells the time, where it is not simulated.
    clock: Option<Clock>,
    /// Made with the first line.
    record: Option<Box<Record>>,
}

thread_local! {
    static DESK: RefCell<Option<Arc<Mutex<Desk>>>> = const { RefCell::new(None) };
}

impl Hosting {
    /// For a run in simulated time.
    pub(crate) fn simulated<'h>(hubs: impl IntoIterator<Item = &'h Narukom>) -> Hosting {
        Hosting::new(hubs, None)
    }

    /// For one thread of a run in real time.
    pub(crate) fn real<'h>(hubs: impl IntoIterator<Item = &'h Narukom>, clock: Clock) -> Hosting {
        Hosting::new(hubs, Some(clock))
    }

    fn new<'h>(hubs: impl IntoIterator<Item = &'h Narukom>, clock: Option<Clock>) -> Hosting {
        let hosts = hubs.into_iter().map(|hub| (hub.clone(), None)).collect();
        Hosting { desk: Arc::new(Mutex::new(Desk { hosts, clock, record: None })) }
    }

    /// Until what is given is dropped, this thread works for these hosts.
    pub(crate) fn begin(&self) -> Hosted {
        Hosted(DESK.replace(Some(self.desk.clone())))
    }

    /// Does something for these hosts on this thread.
    pub(crate) fn during<T>(&self, work: impl FnOnce() -> T) -> T {
        let _hosted = self.begin();
        work()
    }
}

/// This thread works for some hosts; then for those of before.
pub(crate) struct Hosted(Option<Arc<Mutex<Desk>>>);

impl Drop for Hosted {
    fn drop(&mut self) {
        DESK.replace(self.0.take());
    }
}

/// Publishes an event on the host that it is about, if this thread works for that. What is said while a line is being published is not.
pub(super) fn publish(event: &Event<'_>) {
    // A thread that ends works for nobody.
    let desk = DESK.try_with(|desk| desk.try_borrow().ok().and_then(|desk| desk.clone()));
    let Ok(Some(desk)) = desk else { return };
    match desk.try_lock() {
        Ok(mut desk) => desk.publish(event),
        // Something that was to be shown has panicked here before; the next line begins anew.
        Err(TryLockError::Poisoned(desk)) => desk.into_inner().publish(event),
        Err(TryLockError::WouldBlock) => {}
    }
}

impl Desk {
    fn publish(&mut self, event: &Event<'_>) {
        let Desk { hosts, clock, record } = self;
        let record = record.get_or_insert_with(|| Box::new(Record::new()));
        record.take(event);
        let now = context::simulated().or(clock.map(|clock| clock.now()));
        let host = match hosts.as_mut_slice() {
            [one] => Some(one),
            several => several.iter_mut().find(|(hub, _)| hub.host() == record.robot.as_str()),
        };
        let (Some((hub, publisher)), Some(now)) = (host, now) else { return };
        if publisher.is_none() {
            // A program may have made its hubs of some topics only: then there is nobody who could look.
            *publisher = hub.publisher(LOG, PUBLISHER).ok();
        }
        let metadata = event.metadata();
        let place = (metadata.target() != forward::TARGET).then(|| (metadata.file(), metadata.line()));
        let (file, line) = place.unwrap_or_default();
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
    log.message.push_str(record.words.as_str().trim_start());
    if let Some(cycle) = record.cycle {
        // A text takes whatever it is given.
        let _ = write!(log.message, " cycle={cycle}");
    }
    log.name.push_str(record.agent.as_str());
    if !record.agent.as_str().is_empty() && !record.activity.as_str().is_empty() {
        log.name.push('/');
    }
    log.name.push_str(record.activity.as_str());
}

fn timestamp(time: Time) -> Timestamp {
    let since = match time {
        Time::Simulated(moment) => moment.since(Moment::ZERO),
        // Before 1970 there is no clock that is right.
        Time::Wall(time) => time.duration_since(SystemTime::UNIX_EPOCH).unwrap_or_default(),
    };
    Timestamp { seconds: since.as_secs() as i64, nanos: since.subsec_nanos() as i32 }
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
