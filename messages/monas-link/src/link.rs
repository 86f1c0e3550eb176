//! A running link: a thread between a hub and a transport.

use std::collections::hash_map::RandomState;
use std::fmt;
use std::hash::{BuildHasher, Hasher};
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::thread::{self, JoinHandle};
use std::time::Duration;

use narukom::{HostId, Hub, Timestamp, Waker};

use crate::bridge::HubBridge;
use crate::error::{Error, ErrorKind};
use crate::inbox::PacketInbox;
use crate::protocol::{BudgetUsage, ClockOffset, Counters, Mismatch, Packet};
use crate::settings::LinkSettings;

/// The longest sleep of the thread, so that it follows the clock of a test.
const LONGEST_WAIT: Duration = Duration::from_millis(100);

/// The most received packets that are handled before something is sent: under any load the link
/// still sends and can be stopped.
const MAX_PACKETS_PER_ROUND: usize = 256;

/// Carries packets. It puts received packets into the [`PacketInbox`] that it was created with.
pub trait Transport: Send {
    /// Sends a packet without blocking on any receiver. It may be lost; the protocol requests it
    /// again.
    ///
    /// # Errors
    /// The packet is not sent.
    fn send(&mut self, packet: &Packet) -> Result<(), Error>;

    /// The longest message that it carries, in bytes, with its stamp. Longer ones are counted as
    /// [`oversize`](crate::SentCounters::oversize).
    fn largest(&self) -> usize {
        usize::MAX
    }
}

/// A running link. Dropping it stops the link.
pub struct Link {
    inbox: Arc<PacketInbox>,
    shared: Arc<LinkShared>,
    state: Arc<LinkState>,
    thread: Option<JoinHandle<()>>,
}

struct LinkShared {
    stops: AtomicBool,
    report: Mutex<LinkReport>,
}

/// Status of a link.
#[derive(Clone, PartialEq, Eq, Default, Debug)]
pub struct LinkReport {
    /// The counters.
    pub counters: Counters,
    /// Declarations that differ from those of other hosts.
    pub mismatches: Vec<Mismatch>,
    /// The other hosts: when each was last heard, and its clock offset.
    pub peers: Vec<(String, Timestamp, Option<ClockOffset>)>,
    /// Use of the budget; `None` without a budget.
    pub spent: Option<BudgetUsage>,
    /// Packets dropped because they arrived faster than they were handled.
    pub overrun: u64,
    /// Packets in memory shared with their senders.
    pub shared: u64,
}

impl Link {
    /// Starts a link. `connect` creates the transport, `clock` returns the time of the hub's run.
    ///
    /// Publications are sent when the link is [woken](Link::waker), and with the next beat at the
    /// latest.
    ///
    /// # Errors
    ///
    /// The settings do not fit the hub, or the transport or a thread cannot be created.
    pub fn start(
        hub: &Hub,
        settings: LinkSettings,
        connect: impl FnOnce(&HubBridge, Arc<PacketInbox>) -> Result<Box<dyn Transport>, Error>,
        clock: impl Fn() -> Timestamp + Send + 'static,
    ) -> Result<Link, Error> {
        // A number that differs from earlier incarnations: the hasher of the standard library is
        // randomly seeded.
        let incarnation = RandomState::new().build_hasher().finish();
        let mut bridge = HubBridge::new(hub, settings, incarnation)?;
        let inbox = Arc::new(PacketInbox::default());
        let transport = connect(&bridge, inbox.clone())?;
        bridge.set_largest(transport.largest());
        let shared = Arc::new(LinkShared { stops: AtomicBool::new(false), report: Mutex::default() });
        let worker = LinkWorker {
            bridge,
            transport,
            clock: Box::new(clock),
            inbox: inbox.clone(),
            shared: shared.clone(),
            next_report: Timestamp::ZERO,
            next_poll: Timestamp::ZERO,
        };
        let state = Arc::new(LinkState(Mutex::new(Some(worker))));
        let (receiving, reporting) = (state.clone(), state.clone());
        let (waiting, stops) = (inbox.clone(), shared.clone());
        let name = format!("{} link", hub.host());
        let thread = thread::Builder::new()
            .name(name)
            .spawn(move || state.run_worker(&waiting, &stops.stops))
            .map_err(|error| Error::new(ErrorKind::Thread, format!("no thread for the link: {error}")))?;
        inbox.set_taker(Box::new(move || receiving.take_in()));
        Ok(Link { inbox, shared, state: reporting, thread: Some(thread) })
    }

    /// Wakes the link when something is published; to be passed to [`narukom::Hub::set_waker`].
    pub fn waker(&self) -> Arc<dyn Waker> {
        let inbox = self.inbox.clone();
        Arc::new(move |_, host: HostId| {
            // Received messages are not forwarded.
            if host == HostId::LOCAL {
                inbox.wake();
            }
        })
    }

    /// The status of the link: the current one, or while the link is busy the last one, at most 100
    /// ms old.
    pub fn report(&self) -> LinkReport {
        self.state.update_report();
        self.shared.report.lock().unwrap_or_else(PoisonError::into_inner).clone()
    }

    /// Stops the link and returns its final status.
    pub fn stop(mut self) -> LinkReport {
        self.end();
        self.report()
    }

    fn end(&mut self) {
        self.shared.stops.store(true, Ordering::SeqCst);
        self.inbox.wake();
        // A thread that panicked has already reported it.
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

/// The worker, used by one thread at a time: the link's thread, or a thread of the transport that
/// has received a packet and finds the worker idle, which saves a context switch. Only the link's
/// thread sends, since sending may take long.
struct LinkState(Mutex<Option<LinkWorker>>);

struct LinkWorker {
    bridge: HubBridge,
    transport: Box<dyn Transport>,
    clock: Box<dyn Fn() -> Timestamp + Send>,
    inbox: Arc<PacketInbox>,
    shared: Arc<LinkShared>,
    next_report: Timestamp,
    /// When the link's thread polls again if it is not woken.
    next_poll: Timestamp,
}

impl LinkState {
    /// Handles received packets if the worker is idle. Returns `false` if the link's thread must be
    /// woken, for that or for packets that result from it.
    fn take_in(&self) -> bool {
        let Ok(mut worker_slot) = self.0.try_lock() else { return false };
        let Some(worker) = worker_slot.as_mut() else { return true };
        worker.take_in();
        worker.inbox.is_empty() && worker.bridge.poll_at() >= worker.next_poll
    }

    /// Updates the status if the worker is idle.
    fn update_report(&self) {
        if let Ok(mut worker_slot) = self.0.try_lock() {
            worker_slot.iter_mut().for_each(|worker| worker.update_report((worker.clock)()));
        }
    }

    /// The link's thread.
    fn run_worker(&self, inbox: &PacketInbox, stops: &AtomicBool) {
        while !stops.load(Ordering::SeqCst) {
            let wait = self.lock_worker().as_mut().map_or(Duration::ZERO, LinkWorker::work);
            if !wait.is_zero() && inbox.is_empty() {
                inbox.wait(wait);
            }
        }
        // The transport is dropped after the lock is released: its threads may be waiting for the
        // lock, and it for them.
        let worker = self.lock_worker().take();
        worker.into_iter().for_each(LinkWorker::end);
    }

    fn lock_worker(&self) -> MutexGuard<'_, Option<LinkWorker>> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

impl LinkWorker {
    /// Does all pending work; returns the time until there is more.
    fn work(&mut self) -> Duration {
        let now = (self.clock)();
        self.pump();
        if now >= self.next_report {
            self.next_report = now + LONGEST_WAIT;
            self.update_report(now);
        }
        self.next_poll = self.bridge.poll_at();
        self.next_poll.since((self.clock)()).min(LONGEST_WAIT)
    }

    fn end(mut self) {
        self.pump();
        self.update_report((self.clock)());
    }

    fn take_in(&mut self) {
        for packet in (0..MAX_PACKETS_PER_ROUND).map_while(|_| self.inbox.take()) {
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

    fn update_report(&self, now: Timestamp) {
        let node = self.bridge.node();
        let peer = |(name, heard): (&Arc<str>, Timestamp)| (name.to_string(), heard, node.clock_offset(name));
        let report = LinkReport {
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
