//! From one thread to eight that block.

use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::{Arc, mpsc};
use std::thread;
use std::time::Duration;

use narukom::{Publisher, Retention, Timestamp, Topic};
use tokio::sync::broadcast;

use crate::latency::{Latest, Pace, Sleeper, assert_sent, checked, fill, made, newer, now, pause, small};
use crate::messages::{LARGE, Large, SMALL, Small, hub};
use crate::table::{Contestant, Selection, percentiles, run};

const READERS: usize = 8;
const PACE: Pace = Pace { count: 500, gap: Duration::from_micros(150) };

/// A message of 64 bytes to eight readers; every reader's latency counts.
pub(crate) fn eight(selection: &Selection) {
    let send = |publisher: &mut Publisher<Small>| publisher.publish(small(), Timestamp::ZERO);
    let mut contestants = vec![narukom(SMALL, send, |small| small.sent)];
    contestants.extend(others(small, |small: &Small| small.sent));
    run(selection, "One thread to eight, blocking, 64 bytes", &["p50 µs", "p99 µs"], contestants);
}

/// The same with a mebibyte, which all share and each looks at.
pub(crate) fn eight_large(selection: &Selection) {
    let send = |publisher: &mut Publisher<Large>| publisher.publish_with(fill, Timestamp::ZERO);
    let mut contestants = vec![narukom(LARGE, send, checked)];
    contestants.extend(others(|| Arc::new(made()), |large: &Arc<Large>| checked(large)));
    run(selection, "One thread to eight, blocking, 1 MiB", &["p50 µs", "p99 µs"], contestants);
}

fn narukom<K: Retention>(
    topic: Topic<K>,
    send: fn(&mut Publisher<K::Message>),
    sent: fn(&K::Message) -> u64,
) -> Contestant<'static>
where
    Topic<K>: Copy + Send + 'static,
{
    let round = move || {
        let hub = hub(0);
        let mut publisher = hub.publisher(topic, "body").unwrap();
        let sleeper = Sleeper::new(&hub);
        let receivers = (0..READERS).map(|_| {
            let (mut reader, mut sleeper, mut last) = (hub.blackboard("reader"), sleeper.another(), 0);
            reader.read(topic);
            move || {
                sleeper.enter();
                newer(&mut reader, topic, &mut last, sent, thread::park)
            }
        });
        one_to_many(|| send(&mut publisher), receivers.collect())
    };
    ("narukom, a waker that unparks", Box::new(round))
}

/// The contestants of other crates.
fn others<M: Clone + Default + Send + Sync + 'static>(
    make: fn() -> M,
    sent: fn(&M) -> u64,
) -> Vec<Contestant<'static>> {
    vec![
        (
            "tokio broadcast",
            Box::new(move || {
                let (sender, _) = broadcast::channel(8);
                let receivers = (0..READERS).map(|_| {
                    let mut receiver = sender.subscribe();
                    move || receiver.blocking_recv().map_or(0, |message| sent(&message))
                });
                let receivers = receivers.collect();
                one_to_many(|| assert_sent(sender.send(make())), receivers)
            }),
        ),
        (
            "crossbeam-channel",
            Box::new(move || {
                let channels: Vec<_> = (0..READERS).map(|_| crossbeam_channel::bounded::<M>(8)).collect();
                let (senders, receivers): (Vec<_>, Vec<_>) = channels.into_iter().unzip();
                let receivers = receivers
                    .into_iter()
                    .map(|receiver| move || receiver.recv().map_or(0, |message| sent(&message)));
                let send = || {
                    let message = make();
                    senders.iter().for_each(|sender| assert_sent(sender.send(message.clone())));
                };
                one_to_many(send, receivers.collect())
            }),
        ),
        (
            "std mpsc",
            Box::new(move || {
                let channels: Vec<_> = (0..READERS).map(|_| mpsc::sync_channel::<M>(8)).collect();
                let (senders, receivers): (Vec<_>, Vec<_>) = channels.into_iter().unzip();
                let receivers = receivers
                    .into_iter()
                    .map(|receiver| move || receiver.recv().map_or(0, |message| sent(&message)));
                let send = || {
                    let message = make();
                    senders.iter().for_each(|sender| assert_sent(sender.send(message.clone())));
                };
                one_to_many(send, receivers.collect())
            }),
        ),
        (
            "arc-swap and Condvar",
            Box::new(move || {
                let latest = Latest::new(M::default());
                let receivers = (0..READERS).map(|_| {
                    let (latest, mut seen) = (&latest, 0);
                    move || sent(&latest.wait(&mut seen))
                });
                one_to_many(|| latest.store(make()), receivers.collect())
            }),
        ),
    ]
}

/// A round: `send` sends one message to all on this thread, each of `receivers` waits for one on a
/// separate thread.
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
