//! From one thread to eight that sleep.

use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::mpsc;
use std::thread;
use std::time::Duration;

use narukom::Moment;
use tokio::sync::broadcast;

use crate::latency::{Latest, Pace, Sleeper, assert_sent, newer, now, pause};
use crate::messages::{SMALL, Small, hub};
use crate::table::{Contestant, Selection, percentiles, run};

const READERS: usize = 8;
const PACE: Pace = Pace { count: 500, gap: Duration::from_micros(150) };

/// A message of 64 bytes to eight readers; every reader's latency counts.
pub(crate) fn eight(selection: &Selection) {
    let contestants: Vec<Contestant<'_>> = vec![
        (
            "narukom, a waker that unparks",
            Box::new(|| {
                let hub = hub(0);
                let mut publisher = hub.publisher(SMALL, "body").unwrap();
                let sleeper = Sleeper::new(&hub);
                let receivers = (0..READERS).map(|_| {
                    let (mut reader, mut sleeper, mut last) =
                        (hub.blackboard("reader"), sleeper.another(), 0);
                    reader.read(SMALL);
                    move || {
                        sleeper.enter();
                        newer(&mut reader, SMALL, &mut last, |small| small.sent, thread::park)
                    }
                });
                one_to_many(|| publisher.publish(small(), Moment::ZERO), receivers.collect())
            }),
        ),
        (
            "tokio broadcast",
            Box::new(|| {
                let (sender, _) = broadcast::channel(8);
                let receivers = (0..READERS).map(|_| {
                    let mut receiver = sender.subscribe();
                    move || receiver.blocking_recv().map_or(0, |small: Small| small.sent)
                });
                let receivers = receivers.collect();
                one_to_many(|| assert_sent(sender.send(small())), receivers)
            }),
        ),
        (
            "crossbeam-channel",
            Box::new(|| {
                let channels: Vec<_> = (0..READERS).map(|_| crossbeam_channel::bounded::<Small>(8)).collect();
                let (senders, receivers): (Vec<_>, Vec<_>) = channels.into_iter().unzip();
                let receivers = receivers
                    .into_iter()
                    .map(|receiver| move || receiver.recv().map_or(0, |small| small.sent));
                let send = || {
                    let message = small();
                    senders.iter().for_each(|sender| assert_sent(sender.send(message)));
                };
                one_to_many(send, receivers.collect())
            }),
        ),
        (
            "std mpsc",
            Box::new(|| {
                let channels: Vec<_> = (0..READERS).map(|_| mpsc::sync_channel::<Small>(8)).collect();
                let (senders, receivers): (Vec<_>, Vec<_>) = channels.into_iter().unzip();
                let receivers = receivers
                    .into_iter()
                    .map(|receiver| move || receiver.recv().map_or(0, |small| small.sent));
                let send = || {
                    let message = small();
                    senders.iter().for_each(|sender| assert_sent(sender.send(message)));
                };
                one_to_many(send, receivers.collect())
            }),
        ),
        (
            "arc-swap and Condvar",
            Box::new(|| {
                let latest = Latest::new(Small::default());
                let receivers = (0..READERS).map(|_| {
                    let (latest, mut seen) = (&latest, 0);
                    move || latest.wait(&mut seen).sent
                });
                one_to_many(|| latest.store(small()), receivers.collect())
            }),
        ),
    ];
    run(selection, "One thread to eight, blocking, 64 bytes", &["p50 µs", "p99 µs"], contestants);
}

fn small() -> Small {
    Small { sent: now(), ..Small::default() }
}

/// A round: `send` sends one message to all on this thread, each of `receivers` waits for one on a thread of its own.
fn one_to_many<R: FnMut() -> u64 + Send>(mut send: impl FnMut(), receivers: Vec<R>) -> Vec<f64> {
    let received = AtomicUsize::new(0);
    let readers = receivers.len();
    let latencies = thread::scope(|scope| {
        let threads: Vec<_> = receivers
            .into_iter()
            .map(|mut receive| {
                let received = &received;
                scope.spawn(move || {
                    let mut latencies = Vec::with_capacity(PACE.count);
                    for _ in 0..PACE.count {
                        let sent = receive();
                        latencies.push(now() - sent);
                        received.fetch_add(1, Ordering::Release);
                    }
                    latencies
                })
            })
            .collect();
        for number in 1..=PACE.count {
            pause(PACE.gap);
            send();
            while received.load(Ordering::Acquire) < number * readers {
                // The readers need the processors.
                thread::yield_now();
            }
        }
        threads.into_iter().flat_map(|thread| thread.join().unwrap_or_default()).collect()
    });
    percentiles(latencies)
}
