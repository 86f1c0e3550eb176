//! From one thread to another.
//!
//! A sender waits between messages, so that a blocking receiver is asleep, and each message carries
//! its time of sending.

use std::sync::atomic::{AtomicU64, Ordering};
use std::sync::{Arc, Condvar, Mutex, mpsc};
use std::thread;
use std::time::{Duration, Instant};

use arc_swap::ArcSwap;
use narukom::{Blackboard, HostId, Retention, Timestamp, Topic, TopicSlot};
use tokio::sync::broadcast;

use crate::messages::{LARGE, LARGE_SIZE, Large, SMALL, Small, hub};
use crate::table::{Contestant, Selection, percentiles, run};

const COLUMNS: [&str; 2] = ["p50 µs", "p99 µs"];

/// Nanoseconds since the benchmark first read the clock, never 0.
pub(crate) fn now() -> u64 {
    static START: std::sync::OnceLock<Instant> = std::sync::OnceLock::new();
    START.get_or_init(Instant::now).elapsed().as_nanos() as u64 + 1
}

/// Waits without sleeping.
pub(crate) fn pause(length: Duration) {
    let end = now() + length.as_nanos() as u64;
    while now() < end {
        std::hint::spin_loop();
    }
}

/// The number of messages, and their interval.
#[derive(Clone, Copy)]
pub(crate) struct Pace {
    pub(crate) count: usize,
    pub(crate) gap: Duration,
}

/// A round: `send` sends one message on this thread, `receive` waits for one on another, and
/// returns its time of sending.
pub(crate) fn one_to_one(
    pace: Pace,
    mut send: impl FnMut(),
    mut receive: impl FnMut() -> u64 + Send,
) -> Vec<f64> {
    let received = AtomicU64::new(0);
    let latencies = thread::scope(|scope| {
        let receiver = scope.spawn(|| {
            let mut latencies = Vec::with_capacity(pace.count);
            for _ in 0..pace.count {
                let sent = receive();
                latencies.push(now() - sent);
                received.fetch_add(1, Ordering::Release);
            }
            latencies
        });
        for number in 0..pace.count as u64 {
            pause(pace.gap);
            send();
            // One at a time: a latest value may be overwritten, and a queue may hide a delay.
            while received.load(Ordering::Acquire) <= number {
                std::hint::spin_loop();
            }
        }
        receiver.join().unwrap_or_default()
    });
    percentiles(latencies)
}

pub(crate) fn small() -> Small {
    Small { sent: now(), ..Small::default() }
}

/// Asserts that the receiver still exists.
pub(crate) fn assert_sent<T, E>(sent: Result<T, E>) {
    assert!(sent.is_ok());
}

/// The receiver polls.
pub(crate) fn polling(selection: &Selection) {
    const PACE: Pace = Pace { count: 4000, gap: Duration::from_micros(3) };
    let contestants: Vec<Contestant<'_>> = vec![
        (
            "narukom",
            Box::new(|| {
                let hub = hub(0);
                let (mut publisher, mut reader) =
                    (hub.publisher(SMALL, "body").unwrap(), hub.blackboard("reader"));
                reader.read(SMALL);
                let mut last = 0;
                one_to_one(
                    PACE,
                    || publisher.publish(small(), Timestamp::ZERO),
                    || newer(&mut reader, SMALL, &mut last, |small| small.sent, std::hint::spin_loop),
                )
            }),
        ),
        (
            "tokio broadcast",
            Box::new(|| {
                let (sender, mut receiver) = broadcast::channel(8);
                one_to_one(
                    PACE,
                    || assert_sent(sender.send(small())),
                    || poll(|| receiver.try_recv().ok()).sent,
                )
            }),
        ),
        (
            "crossbeam-channel",
            Box::new(|| {
                let (sender, receiver) = crossbeam_channel::bounded(8);
                one_to_one(
                    PACE,
                    || assert_sent(sender.send(small())),
                    || poll(|| receiver.try_recv().ok()).sent,
                )
            }),
        ),
        (
            "std mpsc",
            Box::new(|| {
                let (sender, receiver) = mpsc::sync_channel(8);
                one_to_one(
                    PACE,
                    || assert_sent(sender.send(small())),
                    move || poll(|| receiver.try_recv().ok()).sent,
                )
            }),
        ),
        (
            "arc-swap",
            Box::new(|| {
                let latest = ArcSwap::from_pointee(Small::default());
                let mut last = 0;
                one_to_one(
                    PACE,
                    || latest.store(Arc::new(small())),
                    || {
                        last = poll(|| Some(latest.load().sent).filter(|sent| *sent != last));
                        last
                    },
                )
            }),
        ),
    ];
    run(selection, "Two threads, polling, 64 bytes", &COLUMNS, contestants);
}

fn poll<T>(mut look: impl FnMut() -> Option<T>) -> T {
    loop {
        match look() {
            Some(found) => return found,
            None => std::hint::spin_loop(),
        }
    }
}

/// Waits for a blackboard to read a message other than the last one; `wait` is called in between.
pub(crate) fn newer<K: Retention>(
    reader: &mut Blackboard,
    topic: Topic<K>,
    last: &mut u64,
    sent: impl Fn(&K::Message) -> u64,
    wait: impl Fn(),
) -> u64 {
    loop {
        reader.process_messages(Timestamp::ZERO);
        match reader.read(topic).map(&sent) {
            Some(number) if number != *last => {
                *last = number;
                return number;
            }
            _ => wait(),
        }
    }
}

/// The receiver sleeps until it is woken.
pub(crate) fn blocking(selection: &Selection) {
    const PACE: Pace = Pace { count: 2000, gap: Duration::from_micros(60) };
    let contestants: Vec<Contestant<'_>> = vec![
        (
            "narukom, a waker that unparks",
            Box::new(|| {
                let hub = hub(0);
                let (mut publisher, mut reader) =
                    (hub.publisher(SMALL, "body").unwrap(), hub.blackboard("reader"));
                reader.read(SMALL);
                let (mut last, mut sleeper) = (0, Sleeper::new(&hub));
                one_to_one(
                    PACE,
                    || publisher.publish(small(), Timestamp::ZERO),
                    || {
                        sleeper.enter();
                        newer(&mut reader, SMALL, &mut last, |small| small.sent, thread::park)
                    },
                )
            }),
        ),
        (
            "tokio broadcast",
            Box::new(|| {
                let (sender, mut receiver) = broadcast::channel(8);
                one_to_one(
                    PACE,
                    || assert_sent(sender.send(small())),
                    || receiver.blocking_recv().map_or(0, |small: Small| small.sent),
                )
            }),
        ),
        (
            "crossbeam-channel",
            Box::new(|| {
                let (sender, receiver) = crossbeam_channel::bounded(8);
                one_to_one(
                    PACE,
                    || assert_sent(sender.send(small())),
                    || receiver.recv().map_or(0, |small: Small| small.sent),
                )
            }),
        ),
        (
            "std mpsc",
            Box::new(|| {
                let (sender, receiver) = mpsc::sync_channel(8);
                one_to_one(
                    PACE,
                    || assert_sent(sender.send(small())),
                    move || receiver.recv().map_or(0, |small: Small| small.sent),
                )
            }),
        ),
        (
            "arc-swap and Condvar",
            Box::new(|| {
                let latest = Latest::new(Small::default());
                let mut seen = 0;
                one_to_one(PACE, || latest.store(small()), || latest.wait(&mut seen).sent)
            }),
        ),
    ];
    run(selection, "Two threads, blocking, 64 bytes", &COLUMNS, contestants);
}

/// One MiB is created, passed on and read over the whole of its memory.
pub(crate) fn large(selection: &Selection) {
    const PACE: Pace = Pace { count: 300, gap: Duration::from_micros(100) };
    let contestants: Vec<Contestant<'_>> = vec![
        (
            "narukom, built in place",
            Box::new(|| {
                let hub = hub(0);
                let (mut publisher, mut reader) =
                    (hub.publisher(LARGE, "body").unwrap(), hub.blackboard("reader"));
                reader.read(LARGE);
                let (mut last, mut sleeper) = (0, Sleeper::new(&hub));
                one_to_one(
                    PACE,
                    || publisher.publish_with(fill, Timestamp::ZERO),
                    || {
                        sleeper.enter();
                        newer(&mut reader, LARGE, &mut last, checked, thread::park)
                    },
                )
            }),
        ),
        (
            "tokio broadcast",
            Box::new(|| {
                let (sender, mut receiver) = broadcast::channel(8);
                one_to_one(
                    PACE,
                    || assert_sent(sender.send(Arc::new(made()))),
                    || receiver.blocking_recv().map_or(0, |large: Arc<Large>| checked(&large)),
                )
            }),
        ),
        (
            "crossbeam-channel",
            Box::new(|| {
                let (sender, receiver) = crossbeam_channel::bounded(8);
                one_to_one(
                    PACE,
                    || assert_sent(sender.send(Arc::new(made()))),
                    || receiver.recv().map_or(0, |large: Arc<Large>| checked(&large)),
                )
            }),
        ),
        (
            "std mpsc",
            Box::new(|| {
                let (sender, receiver) = mpsc::sync_channel(8);
                one_to_one(
                    PACE,
                    || assert_sent(sender.send(Arc::new(made()))),
                    move || receiver.recv().map_or(0, |large: Arc<Large>| checked(&large)),
                )
            }),
        ),
        (
            // Like a state: so the next one is created in different memory.
            "std mpsc, the last one stays until the next",
            Box::new(|| {
                let (sender, receiver) = mpsc::sync_channel(8);
                let mut last: Option<Arc<Large>> = None;
                one_to_one(
                    PACE,
                    || assert_sent(sender.send(Arc::new(made()))),
                    move || {
                        let large: Arc<Large> = receiver.recv().unwrap();
                        checked(last.insert(large))
                    },
                )
            }),
        ),
        (
            "arc-swap and Condvar",
            Box::new(|| {
                let latest = Latest::new(Large::default());
                let mut seen = 0;
                one_to_one(PACE, || latest.store(made()), || checked(&latest.wait(&mut seen)))
            }),
        ),
    ];
    run(selection, "Two threads, blocking, 1 MiB", &COLUMNS, contestants);
}

/// Fills a message in the memory of an earlier one.
pub(crate) fn fill(large: &mut Large) {
    large.sent = now();
    large.content.resize(LARGE_SIZE, large.sent as u8);
}

pub(crate) fn made() -> Large {
    let sent = now();
    Large { sent, content: vec![sent as u8; LARGE_SIZE] }
}

/// The time of sending, if the message is complete.
pub(crate) fn checked(large: &Large) -> u64 {
    let mark = large.sent as u8;
    let ends = [large.content.first(), large.content.last()];
    assert!(large.sent == 0 || ends.iter().all(|end| *end == Some(&mark)));
    large.sent
}

/// Wakes one reader of a hub: the minimum that a runtime would do with a waker.
pub(crate) struct Sleeper {
    threads: Arc<Mutex<Vec<thread::Thread>>>,
    entered: bool,
}

impl Sleeper {
    pub(crate) fn new(hub: &narukom::Hub) -> Sleeper {
        let threads = Arc::new(Mutex::new(Vec::<thread::Thread>::new()));
        let sleepers = threads.clone();
        hub.set_waker(Arc::new(move |_: TopicSlot, _: HostId| {
            sleepers.lock().unwrap().iter().for_each(thread::Thread::unpark);
        }));
        Sleeper { threads, entered: false }
    }

    /// One more reader, woken like this one.
    pub(crate) fn another(&self) -> Sleeper {
        Sleeper { threads: self.threads.clone(), entered: false }
    }

    /// Makes the calling thread the one that is woken.
    pub(crate) fn enter(&mut self) {
        if !self.entered {
            self.threads.lock().unwrap().push(thread::current());
            self.entered = true;
        }
    }
}

/// The latest value with a condition variable.
pub(crate) struct Latest<T> {
    value: ArcSwap<T>,
    version: Mutex<u64>,
    bell: Condvar,
}

impl<T> Latest<T> {
    pub(crate) fn new(value: T) -> Latest<T> {
        Latest { value: ArcSwap::from_pointee(value), version: Mutex::new(0), bell: Condvar::new() }
    }

    pub(crate) fn store(&self, value: T) {
        self.value.store(Arc::new(value));
        *self.version.lock().unwrap() += 1;
        self.bell.notify_all();
    }

    pub(crate) fn wait(&self, seen: &mut u64) -> Arc<T> {
        let version =
            self.bell.wait_while(self.version.lock().unwrap(), |version| *version == *seen).unwrap();
        *seen = *version;
        self.value.load_full()
    }
}
