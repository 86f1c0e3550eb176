//! The last publication of a hub, for readers that need no more.

use std::sync::Arc;

use crate::message::AnyMessage;
use crate::ring::{Entry, Origin};
use crate::sample::{AnySample, Header};

/// The last message that was published, whatever its topic.
///
/// Whoever reads in step with what is published finds here what it wants, in two cache lines beside the lock, where the way through the
/// hub's lock, the topic's ring and its entries is twice as long: each line that one core wrote costs another one the same wait.
#[derive(Default)]
pub(crate) struct Front {
    newest: Option<Newest>,
}

/// What readers look at first stands first.
#[repr(C)]
pub(crate) struct Newest {
    order: u64,
    message: Arc<dyn AnyMessage>,
    pub(crate) origin: Origin,
    pub(crate) header: Header,
}

impl Front {
    /// Puts a copy of the entry here. What was here before is given back.
    #[inline]
    pub(crate) fn put(&mut self, entry: &Entry) -> Option<Arc<dyn AnyMessage>> {
        let Entry { sample: AnySample { message, header }, order, origin, .. } = entry;
        let (order, message, origin, header) = (*order, message.clone(), *origin, *header);
        self.newest.replace(Newest { order, message, origin, header }).map(|before| before.message)
    }

    /// The publication of that number, if it is the last one.
    #[inline]
    pub(crate) fn publication(&self, number: u64) -> Option<&Newest> {
        self.newest.as_ref().filter(|newest| newest.order == number)
    }
}

impl Newest {
    #[inline]
    pub(crate) fn sample(&self) -> AnySample {
        AnySample { message: self.message.clone(), header: self.header }
    }
}

#[cfg(test)]
mod tests {
    use std::sync::mpsc::channel;
    use std::time::Duration;

    use crate::example::Ball;
    use crate::{Moment, Narukom, Signal, State, Topic, TopicDeclaration};

    const SEEN: Topic<State<Ball>> = Topic::new("test/seen");
    const KICKED: Topic<Signal<Ball>> = Topic::new("test/kicked");

    fn hub() -> Narukom {
        let declared = [
            TopicDeclaration::new::<State<Ball>>("test/seen", "test"),
            TopicDeclaration::new::<Signal<Ball>>("test/kicked", "test"),
        ];
        Narukom::new("robot", &declared).unwrap()
    }

    fn ball(distance: f64) -> Ball {
        Ball { distance, bearing: 0.0 }
    }

    #[test]
    #[allow(clippy::disallowed_methods, reason = "whoever waits for the lock does so on another thread")]
    fn who_is_one_publication_behind_does_not_wait_for_the_hubs_lock() {
        let hub = hub();
        let mut reader = hub.blackboard("reader");
        assert!(reader.read(SEEN).is_none());
        hub.publisher(SEEN, "body").unwrap().publish(ball(1.0), Moment::ZERO);
        let exchange = hub.exchange();
        let (sender, done) = channel();
        std::thread::scope(|scope| {
            scope.spawn(move || {
                reader.process_messages(Moment::ZERO);
                sender.send(reader.read(SEEN).map(|ball| ball.distance)).unwrap();
            });
            let read = done.recv_timeout(Duration::from_secs(20));
            drop(exchange);
            assert_eq!(read, Ok(Some(1.0)));
        });
    }

    #[test]
    fn a_signal_at_the_front_is_seen_once_and_not_by_who_came_later() {
        let hub = hub();
        let mut publisher = hub.publisher(KICKED, "body").unwrap();
        let mut early = hub.blackboard("early");
        assert!(early.read(KICKED).is_none());
        publisher.publish(ball(1.0), Moment::ZERO);
        let mut late = hub.blackboard("late");
        assert!(late.read(KICKED).is_none());
        for (times, reader) in [(1, &mut early), (0, &mut late)] {
            for seen in [times, 0, 0] {
                reader.process_messages(Moment::ZERO);
                assert_eq!((reader.signals(KICKED).count(), reader.arrivals().count()), (seen, seen));
            }
        }
        // One that is behind by two fetches both.
        publisher.publish(ball(2.0), Moment::ZERO);
        publisher.publish(ball(3.0), Moment::ZERO);
        early.process_messages(Moment::ZERO);
        let far: Vec<f64> = early.signals(KICKED).map(|sample| sample.distance).collect();
        assert_eq!((far, early.lost(KICKED)), (vec![2.0, 3.0], 0));
    }
}
