//! A run as others see it: its hubs, its time, and a way in for what is published from outside.

use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};
use std::sync::mpsc::{Receiver, RecvTimeoutError, SyncSender, TrySendError, sync_channel};
use std::time::Duration;

use narukom::{Moment, Narukom};

use super::clock::Clock;

/// Whoever publishes from outside does so under this name.
const PUBLISHER: &str = "outside";

/// So many messages from outside wait at most for the next moment of a simulated run.
const WAITING: usize = 64;

/// A run in simulated time that nobody advances for this long does not take what is handed in.
const PATIENCE: Duration = Duration::from_secs(2);

/// A run as those see it who look on: its hubs, and how far it is. It may be kept longer than the run.
#[derive(Clone)]
pub struct Overview {
    hubs: Vec<Narukom>,
    time: Time,
}

#[derive(Clone)]
enum Time {
    Real(Clock),
    Simulated(Arc<ShownMoment>, SyncSender<HandedIn>),
}

/// How far a simulated run is.
#[derive(Default)]
pub(super) struct ShownMoment(AtomicU64);

impl ShownMoment {
    pub(super) fn set(&self, moment: Moment) {
        self.0.store(moment.as_nanos(), Ordering::Release);
    }

    pub(super) fn get(&self) -> Moment {
        Moment::from_nanos(self.0.load(Ordering::Acquire))
    }
}

/// A message that waits for the next moment of a run.
struct HandedIn {
    hub: Narukom,
    path: String,
    bytes: Vec<u8>,
    answer: SyncSender<Result<(), String>>,
}

/// Where a simulated run finds what was handed in.
pub(super) struct Inlet {
    sender: SyncSender<HandedIn>,
    waiting: Receiver<HandedIn>,
}

impl Inlet {
    pub(super) fn new() -> Inlet {
        let (sender, waiting) = sync_channel(WAITING);
        Inlet { sender, waiting }
    }

    fn sender(&self) -> SyncSender<HandedIn> {
        self.sender.clone()
    }

    /// Publishes what waits; false if nothing did.
    pub(super) fn publish_waiting(&self, now: Moment) -> bool {
        let mut any = false;
        while let Ok(HandedIn { hub, path, bytes, answer }) = self.waiting.try_recv() {
            any = true;
            // Whoever has given up is not told.
            let _ = answer.try_send(publish(&hub, &path, &bytes, now));
        }
        any
    }
}

fn publish(hub: &Narukom, path: &str, bytes: &[u8], now: Moment) -> Result<(), String> {
    let publisher = hub.publisher_by_name(path, PUBLISHER);
    publisher.and_then(|mut publisher| publisher.publish_bytes(bytes, now)).map_err(|error| error.to_string())
}

impl Overview {
    pub(super) fn real(hubs: Vec<Narukom>, clock: Clock) -> Overview {
        Overview { hubs, time: Time::Real(clock) }
    }

    pub(super) fn simulated(hubs: Vec<Narukom>, shown: Arc<ShownMoment>, inlet: &Inlet) -> Overview {
        Overview { hubs, time: Time::Simulated(shown, inlet.sender()) }
    }

    /// The hubs of its hosts, and of the world if there is one.
    pub fn hubs(&self) -> &[Narukom] {
        &self.hubs
    }

    /// How far it is.
    pub fn now(&self) -> Moment {
        match &self.time {
            Time::Real(clock) => clock.now(),
            Time::Simulated(shown, _) => shown.get(),
        }
    }

    /// Whether its time is simulated.
    pub fn is_simulated(&self) -> bool {
        matches!(self.time, Time::Simulated(..))
    }

    /// Publishes the message that `bytes` encode on a topic of a host, as any agent there could: whoever records the run records it. In
    /// simulated time it waits for the next moment of the run.
    ///
    /// # Errors
    /// Why not: nobody knows the host or the topic, the bytes are no message of it, or the run stands still.
    pub fn publish(&self, host: &str, path: &str, bytes: &[u8]) -> Result<(), String> {
        let hub = self.hubs.iter().find(|hub| hub.host() == host);
        let hub = hub.ok_or_else(|| format!("no host is named `{host}`"))?;
        match &self.time {
            Time::Real(clock) => publish(hub, path, bytes, clock.now()),
            Time::Simulated(_, inlet) => {
                let (answer, answered) = sync_channel(1);
                let handed_in = HandedIn { hub: hub.clone(), path: path.into(), bytes: bytes.into(), answer };
                inlet.try_send(handed_in).map_err(|error| match error {
                    TrySendError::Full(_) => format!("{WAITING} messages from outside wait already"),
                    TrySendError::Disconnected(_) => "the run has ended".to_owned(),
                })?;
                answered.recv_timeout(PATIENCE).unwrap_or_else(|error| {
                    Err(match error {
                        RecvTimeoutError::Timeout => "the run stands still and takes nothing".to_owned(),
                        RecvTimeoutError::Disconnected => "the run has ended".to_owned(),
                    })
                })
            }
        }
    }
}

#[cfg(unix)]
impl monas_link::control::Observed for Overview {
    fn hubs(&self) -> &[Narukom] {
        Overview::hubs(self)
    }

    fn now(&self) -> Moment {
        Overview::now(self)
    }

    fn is_simulated(&self) -> bool {
        Overview::is_simulated(self)
    }

    fn publish(&self, host: &str, path: &str, bytes: &[u8]) -> Result<(), String> {
        Overview::publish(self, host, path, bytes)
    }
}

impl std::fmt::Debug for Overview {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "Overview({} hubs at {})", self.hubs.len(), self.now())
    }
}
