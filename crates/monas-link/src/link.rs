//! A link at work: a thread between a hub and a transport.

use std::collections::hash_map::RandomState;
use std::fmt;
use std::hash::{BuildHasher, Hasher};
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::thread::{self, JoinHandle};
use std::time::Duration;

use narukom::{HostId, Moment, Narukom, Waker};

use crate::bridge::Bridge;
use crate::error::{Error, ErrorKind};
use crate::inbox::Inbox;
use crate::protocol::{ClockOffset, Counters, Mismatch, Packet, Spent};
use crate::settings::LinkSettings;

/// The thread looks so often at least, so that a run of a test clock is not slept through.
const LONGEST_WAIT: Duration = Duration::from_millis(100);

/// Of what has come so much is taken before something is sent: however much comes, the link is heard and can be ended.
const ROUND: usize = 256;

/// Carries packets. What has come it puts into the [`Inbox`] that it was made with.
pub trait Transport: Send {
    /// Sends a packet, without waiting for anybody. It may be lost; the protocol asks again.
    ///
    /// # Errors
    /// The packet is not sent.
    fn send(&mut self, packet: &Packet) -> Result<(), Error>;

    /// The longest message that it carries, stamp included. Longer ones are counted as [`oversize`](crate::Sent::oversize).
    fn largest(&self) -> usize {
        usize::MAX
    }
}

/// A link that is running. It ends when it is dropped.
pub struct Link {
    inbox: Arc<Inbox>,
    shared: Arc<Shared>,
    desk: Arc<Desk>,
    thread: Option<JoinHandle<()>>,
}

struct Shared {
    stops: AtomicBool,
    report: Mutex<Report>,
}

/// What is known of a link.
#[derive(Clone, PartialEq, Eq, Default, Debug)]
pub struct Report {
    /// What was counted.
    pub counters: Counters,
    /// What differs from what other hosts know.
    pub mismatches: Vec<Mismatch>,
    /// The other hosts: when each was last heard, and how far its clock is from this one's.
    pub peers: Vec<(String, Moment, Option<ClockOffset>)>,
    /// How much of the budget is used up; none without one.
    pub spent: Option<Spent>,
    /// Packets that came faster than they were taken.
    pub overrun: u64,
    /// Packets that lay in memory shared with their senders.
    pub shared: u64,
}

impl Link {
    /// Starts a link. `connect` makes the transport, `clock` tells the time of the hub's run.
    ///
    /// What is published is sent when the link is [woken](Link::waker), and with the next beat at the latest.
    ///
    /// # Errors
    /// The settings do not fit the hub, the transport does not come up, or the system gives no thread.
    pub fn start(
        hub: &Narukom,
        settings: LinkSettings,
        connect: impl FnOnce(&Bridge, Arc<Inbox>) -> Result<Box<dyn Transport>, Error>,
        clock: impl Fn() -> Moment + Send + 'static,
    ) -> Result<Link, Error> {
        // A number that no earlier life has had; the standard library's hashes begin with one.
        let incarnation = RandomState::new().build_hasher().finish();
        let mut bridge = Bridge::new(hub, settings, incarnation)?;
        let inbox = Arc::new(Inbox::default());
        let transport = connect(&bridge, inbox.clone())?;
        bridge.set_largest(transport.largest());
        let shared = Arc::new(Shared { stops: AtomicBool::new(false), report: Mutex::default() });
        let worker = Worker {
            bridge,
            transport,
            clock: Box::new(clock),
            inbox: inbox.clone(),
            shared: shared.clone(),
            next_report: Moment::ZERO,
            comes_again: Moment::ZERO,
        };
        let desk = Arc::new(Desk(Mutex::new(Some(worker))));
        let (bringer, looker) = (desk.clone(), desk.clone());
        let (waiting, stops) = (inbox.clone(), shared.clone());
        let name = format!("{} link", hub.host());
        let thread = thread::Builder::new()
            .name(name)
            .spawn(move || desk.attend(&waiting, &stops.stops))
            .map_err(|error| Error::new(ErrorKind::Thread, format!("no thread for the link: {error}")))?;
        inbox.set_taker(Box::new(move || bringer.take_in()));
        Ok(Link { inbox, shared, desk: looker, thread: Some(thread) })
    }

    /// Wakes the link when something is published; to be given to [`Narukom::set_waker`].
    pub fn waker(&self) -> Arc<dyn Waker> {
        let inbox = self.inbox.clone();
        Arc::new(move |_, host: HostId| {
            // What has come is not sent on.
            if host == HostId::LOCAL {
                inbox.wake();
            }
        })
    }

    /// What is known of the link: now, or if it is at work when that was last told, at most 100 ms ago.
    pub fn report(&self) -> Report {
        self.desk.tell();
        self.shared.report.lock().unwrap_or_else(PoisonError::into_inner).clone()
    }

    /// Ends the link; what is known of it then.
    pub fn stop(mut self) -> Report {
        self.end();
        self.report()
    }

    fn end(&mut self) {
        self.shared.stops.store(true, Ordering::SeqCst);
        self.inbox.wake();
        // A thread that has panicked has said so.
        let _ = self.thread.take().map(JoinHandle::join);
    }
}

impl Drop for Link {
    fn drop(&mut self) {
        self.end();
    }
}

impl fmt::Debug for Link {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Link").finish_non_exhaustive()
    }
}

/// Where the work is done, by one at a time: the link's thread, or a thread of the transport that has brought something and finds nobody
/// there, which saves it the way through the link's thread. Sending is for the link's thread alone, since it may take its time.
struct Desk(Mutex<Option<Worker>>);

struct Worker {
    bridge: Bridge,
    transport: Box<dyn Transport>,
    clock: Box<dyn Fn() -> Moment + Send>,
    inbox: Arc<Inbox>,
    shared: Arc<Shared>,
    next_report: Moment,
    /// When the link's thread looks again if nobody wakes it.
    comes_again: Moment,
}

impl Desk {
    /// Takes what has come, if nobody is at work. False if the link's thread is to be woken, for that or for what follows from it.
    fn take_in(&self) -> bool {
        let Ok(mut place) = self.0.try_lock() else { return false };
        let Some(worker) = place.as_mut() else { return true };
        worker.take_in();
        worker.inbox.is_empty() && worker.bridge.poll_at() >= worker.comes_again
    }

    /// Tells what is known, if nobody is at work.
    fn tell(&self) {
        if let Ok(mut place) = self.0.try_lock() {
            place.iter_mut().for_each(|worker| worker.tell((worker.clock)()));
        }
    }

    /// The link's thread.
    fn attend(&self, inbox: &Inbox, stops: &AtomicBool) {
        while !stops.load(Ordering::SeqCst) {
            let wait = self.place().as_mut().map_or(Duration::ZERO, Worker::work);
            if !wait.is_zero() && inbox.is_empty() {
                inbox.wait(wait);
            }
        }
        // The transport ends after the lock is free: its threads may be waiting for it, and it for them.
        let worker = self.place().take();
        worker.into_iter().for_each(Worker::end);
    }

    fn place(&self) -> MutexGuard<'_, Option<Worker>> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

impl Worker {
    /// Does what there is to do; for how long there is nothing then.
    fn work(&mut self) -> Duration {
        let now = (self.clock)();
        self.pump();
        if now >= self.next_report {
            self.next_report = now + LONGEST_WAIT;
            self.tell(now);
        }
        self.comes_again = self.bridge.poll_at();
        self.comes_again.since((self.clock)()).min(LONGEST_WAIT)
    }

    fn end(mut self) {
        self.pump();
        self.tell((self.clock)());
    }

    fn take_in(&mut self) {
        for packet in (0..ROUND).map_while(|_| self.inbox.take()) {
            self.bridge.handle(&packet, (self.clock)());
        }
    }

    fn pump(&mut self) {
        self.take_in();
        while let Some(packet) = self.bridge.poll((self.clock)()) {
            if self.transport.send(&packet).is_err() {
                self.bridge.count_failed();
            }
        }
    }

    fn tell(&self, now: Moment) {
        let node = self.bridge.node();
        let peer = |(name, heard): (&Arc<str>, Moment)| (name.to_string(), heard, node.clock_offset(name));
        let report = Report {
            counters: node.counters(),
            mismatches: node.mismatches(),
            peers: node.peers().map(peer).collect(),
            spent: node.spent(now),
            overrun: self.inbox.dropped(),
            shared: self.inbox.shared(),
        };
        *self.shared.report.lock().unwrap_or_else(PoisonError::into_inner) = report;
    }
}
