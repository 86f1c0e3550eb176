//! What readers look at before they take the hub's lock.

use std::sync::atomic::{AtomicU64, Ordering};

use crate::exchange::HOST_LIMIT;
use crate::sample::{Channel, HostId, TopicSlot};

/// Of so many publications it is known here on which channel they were.
const KNOWN: usize = 14;

/// So many bits of a publication's number stand beside its channel.
const NUMBER_BITS: u32 = 24;

/// A host's number has eight bits, a topic's 32.
const _: () = assert!(HOST_LIMIT <= 1 << 8);

/// The number of the last publication, and on which channels the last few were.
///
/// Whoever polls compares one number, and takes the lock only if something was published that it reads. All of it is one cache line (two,
/// since processors fetch them in pairs), of its own: those who poll do not slow down those who take the lock.
#[repr(align(128))]
#[repr(C)]
pub(crate) struct Head {
    last: AtomicU64,
    /// The number and the channel of the last publication, beside its number: who reads in step looks no further.
    newest: AtomicU64,
    known: [AtomicU64; KNOWN],
}

/// The channels of some publications.
#[derive(Clone, Copy)]
pub(crate) struct Recent {
    channels: [u64; KNOWN],
    count: usize,
}

impl Head {
    pub(crate) fn new() -> Head {
        Head {
            last: AtomicU64::new(0),
            newest: AtomicU64::new(0),
            known: [const { AtomicU64::new(0) }; KNOWN],
        }
    }

    /// The number of the last publication that readers can fetch.
    #[inline]
    pub(crate) fn last(&self) -> u64 {
        self.last.load(Ordering::Acquire)
    }

    /// A message was published; readers learn of it with [`move_to`](Head::move_to). For whoever has the hub's lock.
    #[inline]
    pub(crate) fn note(&self, number: u64, channel: Channel) {
        let place = (number % KNOWN as u64) as usize;
        let packed = packed(number, channel);
        self.known[place].store(packed, Ordering::Release);
        self.newest.store(packed, Ordering::Release);
    }

    /// On which channel publication number `last` was, if no later one is noted.
    #[inline]
    pub(crate) fn channel_of_last(&self, last: u64) -> Option<Channel> {
        let packed = self.newest.load(Ordering::Acquire);
        // The bits come again after so many publications: they are another one's only if that is noted and not yet there to be fetched.
        (is_of(packed, last) && self.last() == last).then(|| unpacked(packed))
    }

    /// Readers can fetch all publications up to this one. For whoever has the hub's lock.
    #[inline]
    pub(crate) fn move_to(&self, number: u64) {
        self.last.store(number, Ordering::Release);
    }

    /// On which channels the publications later than `since` were, up to `last`; none if that is no longer known.
    #[inline]
    pub(crate) fn recent(&self, since: u64, last: u64) -> Option<Recent> {
        let count = usize::try_from(last.checked_sub(since)?).ok().filter(|count| *count <= KNOWN)?;
        let mut recent = Recent { channels: [0; KNOWN], count };
        for (number, channel) in (since + 1..=last).zip(&mut recent.channels) {
            *channel = self.known[(number % KNOWN as u64) as usize].load(Ordering::Acquire);
            // A later one stands in its place.
            if !is_of(*channel, number) {
                return None;
            }
        }
        // What stands there was published by now or is about to be: so late that the bits of its number come again it is not.
        (self.last() - since < 1 << (NUMBER_BITS - 1)).then_some(recent)
    }
}

impl Recent {
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

/// Whether the number's bits stand there.
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
    use crate::{Moment, Narukom, State, Topic, TopicDeclaration};

    fn channel(topic: u32, host: u32) -> Channel {
        Channel { topic: TopicSlot::new(topic), host: HostId(host) }
    }

    #[test]
    fn the_last_publications_are_known_by_channel_and_earlier_ones_are_not() {
        let head = Head::new();
        assert_eq!(head.recent(0, 0).unwrap().channels().count(), 0);
        for number in 1..=40 {
            head.note(number, channel(number as u32 * 1000, number as u32 % 256));
            head.move_to(number);
        }
        let known: Vec<Channel> = head.recent(37, 40).unwrap().channels().collect();
        assert_eq!(known, [channel(38_000, 38), channel(39_000, 39), channel(40_000, 40)]);
        assert_eq!(head.recent(26, 40).unwrap().channels().count(), 14);
        assert!(head.recent(25, 40).is_none());
        // The reader was told of 30, and looks now.
        assert!(head.recent(29, 30).is_some() && head.recent(25, 26).is_none());
    }

    #[test]
    #[allow(clippy::disallowed_methods, reason = "whoever waits for the lock does so on another thread")]
    fn who_reads_nothing_of_what_was_published_does_not_wait_for_the_lock() {
        const READ: Topic<State<Ball>> = Topic::new("test/read");
        const OTHER: Topic<State<Ball>> = Topic::new("test/other");
        let declared =
            ["test/read", "test/other"].map(|path| TopicDeclaration::new::<State<Ball>>(path, "test"));
        let hub = Narukom::new("robot", &declared).unwrap();
        let (mut reader, mut subscriber) = (hub.blackboard("reader"), hub.subscriber("test/read").unwrap());
        assert!(reader.read(READ).is_none());
        let mut publisher = hub.publisher(OTHER, "body").unwrap();
        let (sender, done) = pipe();
        let exchange = {
            (0..KNOWN).for_each(|_| publisher.publish(Ball::default(), Moment::ZERO));
            hub.exchange()
        };
        std::thread::scope(|scope| {
            scope.spawn(move || {
                for _ in 0..2 {
                    reader.process_messages(Moment::ZERO);
                    assert!(subscriber.next_sample().is_none());
                }
                assert_eq!((reader.position(), subscriber.position()), (KNOWN as u64, KNOWN as u64));
                sender.send(()).unwrap();
            });
            let waited = done.recv_timeout(Duration::from_secs(20));
            drop(exchange);
            assert!(waited.is_ok(), "it waits for the lock");
        });
    }

    #[test]
    fn a_number_whose_bits_have_come_again_is_not_taken_for_an_earlier_one() {
        let head = Head::new();
        // a multiple of both the bits of a number and of the places
        let much_later = 5 + (1 << NUMBER_BITS) * KNOWN as u64;
        for number in [5, much_later] {
            head.note(number, channel(u32::MAX, 255));
            head.move_to(number);
        }
        assert!(head.recent(4, 5).is_none());
        let known = head.recent(much_later - 1, much_later).unwrap();
        assert_eq!(known.channels().collect::<Vec<_>>(), [channel(u32::MAX, 255)]);
    }
}
