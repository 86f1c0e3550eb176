//! A lock-free index of publications, which readers check before they take the hub's lock.

use std::sync::atomic::{AtomicU64, Ordering};

use crate::hub_state::HOST_LIMIT;
use crate::sample::{Channel, HostId, TopicSlot};

/// The number of recent publications whose channels are stored.
const STORED_CHANNELS: usize = 14;

/// The number of low bits of a publication's number that are stored beside its channel.
const NUMBER_BITS: u32 = 24;

/// A host's number has 8 bits, a topic's 32.
const _: () = assert!(HOST_LIMIT <= 1 << 8);

/// The number of the last publication, and the channels of the last few.
///
/// A polling reader compares one number, and takes the lock only if something was published that it
/// reads. All of it is in one aligned cache line (two, since processors fetch them in pairs), so
/// that polling readers do not slow down holders of the lock.
#[repr(align(128))]
#[repr(C)]
pub(crate) struct PublicationIndex {
    last: AtomicU64,
    /// The low bits and the channel of the last publication, stored beside its number: a reader
    /// that keeps pace needs nothing else.
    newest: AtomicU64,
    known: [AtomicU64; STORED_CHANNELS],
}

/// The channels of a range of publications.
#[derive(Clone, Copy)]
pub(crate) struct RecentChannels {
    channels: [u64; STORED_CHANNELS],
    count: usize,
}

impl PublicationIndex {
    pub(crate) fn new() -> PublicationIndex {
        PublicationIndex {
            last: AtomicU64::new(0),
            newest: AtomicU64::new(0),
            known: [const { AtomicU64::new(0) }; STORED_CHANNELS],
        }
    }

    /// The number of the last publication that readers can fetch.
    #[inline]
    pub(crate) fn last(&self) -> u64 {
        self.last.load(Ordering::Acquire)
    }

    /// Records a publication; readers see it after [`advance_to`](PublicationIndex::advance_to).
    /// The caller must hold the hub's lock.
    #[inline]
    pub(crate) fn record(&self, number: u64, channel: Channel) {
        let index = (number % STORED_CHANNELS as u64) as usize;
        let packed = packed(number, channel);
        self.known[index].store(packed, Ordering::Release);
        self.newest.store(packed, Ordering::Release);
    }

    /// The channel of publication number `last`, if no later one is recorded.
    #[inline]
    pub(crate) fn channel_of_last(&self, last: u64) -> Option<Channel> {
        let packed = self.newest.load(Ordering::Acquire);
        // The low bits repeat after this many publications: they can belong to another publication
        // only if it is recorded but cannot be fetched yet.
        (is_of(packed, last) && self.last() == last).then(|| unpacked(packed))
    }

    /// Lets readers fetch all publications up to this one. The caller must hold the hub's lock.
    #[inline]
    pub(crate) fn advance_to(&self, number: u64) {
        self.last.store(number, Ordering::Release);
    }

    /// The channels of the publications with numbers from after `since` to `last`; `None` if they
    /// are no longer known.
    #[inline]
    pub(crate) fn recent(&self, since: u64, last: u64) -> Option<RecentChannels> {
        let count =
            usize::try_from(last.checked_sub(since)?).ok().filter(|count| *count <= STORED_CHANNELS)?;
        let mut recent = RecentChannels { channels: [0; STORED_CHANNELS], count };
        for (number, channel) in (since + 1..=last).zip(&mut recent.channels) {
            *channel = self.known[(number % STORED_CHANNELS as u64) as usize].load(Ordering::Acquire);
            // The slot was overwritten by a later publication.
            if !is_of(*channel, number) {
                return None;
            }
        }
        // The slot holds a publication that is complete or about to be; it cannot be so late that
        // the low bits of its number repeat.
        (self.last() - since < 1 << (NUMBER_BITS - 1)).then_some(recent)
    }
}

impl RecentChannels {
    /// In order of publication.
    #[inline]
    pub(crate) fn channels(&self) -> impl Iterator<Item = Channel> {
        self.channels[..self.count].iter().map(|packed| unpacked(*packed))
    }
}

#[inline]
fn unpacked(packed: u64) -> Channel {
    Channel { topic: TopicSlot::new(packed as u32), host: HostId((packed >> 32) as u32 & 0xff) }
}

/// Whether the low bits are those of `number`.
#[inline]
fn is_of(packed: u64, number: u64) -> bool {
    packed >> (64 - NUMBER_BITS) == number & ((1 << NUMBER_BITS) - 1)
}

#[inline]
fn packed(number: u64, channel: Channel) -> u64 {
    (number << (64 - NUMBER_BITS)) | (u64::from(channel.host.0) << 32) | u64::from(channel.topic.number())
}

#[cfg(test)]
mod tests {
    use std::sync::mpsc::channel as pipe;
    use std::time::Duration;

    use super::*;
    use crate::example::Ball;
    use crate::{Hub, State, Timestamp, Topic, TopicDeclaration};

    fn channel(topic: u32, host: u32) -> Channel {
        Channel { topic: TopicSlot::new(topic), host: HostId(host) }
    }

    #[test]
    fn the_last_publications_are_known_by_channel_and_earlier_ones_are_not() {
        let head = PublicationIndex::new();
        assert_eq!(head.recent(0, 0).unwrap().channels().count(), 0);
        for number in 1..=40 {
            head.record(number, channel(number as u32 * 1000, number as u32 % 256));
            head.advance_to(number);
        }
        let known: Vec<Channel> = head.recent(37, 40).unwrap().channels().collect();
        assert_eq!(known, [channel(38_000, 38), channel(39_000, 39), channel(40_000, 40)]);
        assert_eq!(head.recent(26, 40).unwrap().channels().count(), 14);
        assert!(head.recent(25, 40).is_none());
        // The reader was notified of 30 and reads now.
        assert!(head.recent(29, 30).is_some() && head.recent(25, 26).is_none());
    }

    #[test]
    #[allow(clippy::disallowed_methods, reason = "the lock is awaited on another thread")]
    fn blackboards_without_new_messages_do_not_lock() {
        const READ: Topic<State<Ball>> = Topic::new("test/read");
        const OTHER: Topic<State<Ball>> = Topic::new("test/other");
        let declared =
            ["test/read", "test/other"].map(|path| TopicDeclaration::new::<State<Ball>>(path, "test"));
        let hub = Hub::new("robot", &declared).unwrap();
        let (mut reader, mut subscriber) = (hub.blackboard("reader"), hub.subscriber("test/read").unwrap());
        assert!(reader.read(READ).is_none());
        let mut publisher = hub.publisher(OTHER, "body").unwrap();
        let (sender, done) = pipe();
        let exchange = {
            (0..STORED_CHANNELS).for_each(|_| publisher.publish(Ball::default(), Timestamp::ZERO));
            hub.state()
        };
        std::thread::scope(|scope| {
            scope.spawn(move || {
                for _ in 0..2 {
                    reader.process_messages(Timestamp::ZERO);
                    assert!(subscriber.next_sample().is_none());
                }
                assert_eq!(
                    (reader.position(), subscriber.position()),
                    (STORED_CHANNELS as u64, STORED_CHANNELS as u64)
                );
                sender.send(()).unwrap();
            });
            let waited = done.recv_timeout(Duration::from_secs(20));
            drop(exchange);
            assert!(waited.is_ok(), "it waits for the lock");
        });
    }

    #[test]
    fn a_number_whose_bits_have_come_again_is_not_taken_for_an_earlier_one() {
        let head = PublicationIndex::new();
        // A multiple of both the range of the low bits and the number of slots.
        let much_later = 5 + (1 << NUMBER_BITS) * STORED_CHANNELS as u64;
        for number in [5, much_later] {
            head.record(number, channel(u32::MAX, 255));
            head.advance_to(number);
        }
        assert!(head.recent(4, 5).is_none());
        let known = head.recent(much_later - 1, much_later).unwrap();
        assert_eq!(known.channels().collect::<Vec<_>>(), [channel(u32::MAX, 255)]);
    }
}
