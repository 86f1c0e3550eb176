//! Messages of other hosts: received by a link, read by host, and never mixed with those published
//! here.
#![allow(clippy::unwrap_used, clippy::panic, reason = "a test that cannot go on fails")]

use std::sync::{Arc, Mutex};
use std::time::Duration;

use crate::messages::*;
use narukom::{
    Blackboard, ErrorKind, HOST_LIMIT, HostId, Hub, Observer, Publication, REMOTE_PUBLISHER_LIMIT, Receiver,
    RemoteHeader, SIGNAL_DEPTH, Timestamp, TopicSlot,
};

fn mark(number: u64) -> Box<Mark> {
    Box::new(Mark::new(number))
}

/// Receives a state, a signal and a data message with the number.
struct Mate {
    receivers: [Receiver; 3],
}

impl Mate {
    fn new(hub: &Hub, host: &str) -> Mate {
        let paths = ["test/state", "test/signal", "test/data"];
        Mate { receivers: paths.map(|path| hub.receiver(host, "vision", path).unwrap()) }
    }

    fn host(&self) -> HostId {
        self.receivers[0].host()
    }

    fn publish_number(&mut self, number: u64) {
        for receiver in &mut self.receivers {
            receiver.receive(mark(number), arrival(number, at(number))).unwrap();
        }
    }
}

/// The numbers on a blackboard from a host: state, signals, data.
fn numbers_of(blackboard: &Blackboard, host: HostId) -> (Option<u64>, Vec<u64>, Vec<u64>) {
    let view = blackboard.from(host);
    let state = view.read(STATE).map(|mark| mark.number);
    let signals = view.signals(SIGNAL).map(|mark| mark.number).collect();
    (state, signals, view.recent(DATA, Duration::MAX).map(|mark| mark.number).collect())
}

const NOTHING: (Option<u64>, Vec<u64>, Vec<u64>) = (None, Vec::new(), Vec::new());

#[test]
fn hosts_are_read_apart() {
    let hub = hub();
    let (mut left, mut right) = (Mate::new(&hub, "left"), Mate::new(&hub, "right"));
    let mut reader = hub.blackboard("reader");
    publish_everywhere(&mut hub.blackboard("giver"), 1, at(1));
    left.publish_number(2);
    right.publish_number(3);
    assert_eq!(numbers_of(&reader, left.host()), NOTHING, "received is not delivered");
    reader.process_messages(at(4));
    assert_eq!(numbers(&reader), (Some(1), vec![1], vec![1]));
    assert_eq!(numbers_of(&reader, HostId::LOCAL), (Some(1), vec![1], vec![1]));
    assert_eq!(numbers_of(&reader, left.host()), (Some(2), vec![2], vec![2]));
    assert_eq!(numbers_of(&reader, right.host()), (Some(3), vec![3], vec![3]));
    left.publish_number(5);
    reader.process_messages(at(5));
    assert_eq!(numbers_of(&reader, left.host()), (Some(5), vec![5], vec![2, 5]));
    assert_eq!(numbers_of(&reader, right.host()), (Some(3), vec![], vec![3]));
}

#[test]
fn own_messages_are_this_hosts_alone() {
    let hub = hub();
    let host = hub.host_id("left").unwrap();
    let mut robot = hub.blackboard("robot");
    robot.publish(STATE, Mark::new(1)).unwrap();
    robot.publish(DATA, Mark::new(1)).unwrap();
    assert_eq!(numbers_of(&robot, host), NOTHING);
    assert_eq!(robot.from(HostId::LOCAL).read(STATE).unwrap().number, 1);
}

#[test]
fn a_host_can_be_read_before_its_first_message() {
    let hub = hub();
    let mut reader = hub.blackboard("reader");
    let host = hub.host_id("left").unwrap();
    assert_eq!(numbers_of(&reader, host), NOTHING);
    let mut left = Mate::new(&hub, "left");
    assert_eq!(left.host(), host);
    left.publish_number(1);
    reader.process_messages(at(1));
    assert_eq!(numbers_of(&reader, host), (Some(1), vec![1], vec![1]));
    assert_eq!(hub.hosts().iter().map(|name| name.to_string()).collect::<Vec<_>>(), ["robot", "left"]);
    assert_eq!(hub.hosts_of(hub.topic("test/state").unwrap()), [host]);
    assert_eq!(hub.hosts_of(hub.topic("other/state").unwrap()), []);
}

#[test]
fn late_readers_get_a_hosts_state_and_history_and_no_signal() {
    let hub = hub();
    let mut left = Mate::new(&hub, "left");
    left.publish_number(1);
    let mut late = hub.blackboard("late");
    late.process_messages(at(2));
    assert_eq!(numbers_of(&late, left.host()), (Some(1), vec![], vec![1]));
}

#[test]
fn headers_keep_the_senders_clock_beside_this_ones() {
    let hub = hub();
    let mut left = hub.receiver("left", "vision", "test/state").unwrap();
    let come = RemoteHeader { sequence: 41, published: at(5000), local: at(20), received: at(23) };
    left.receive(mark(1), come).unwrap();
    let mut reader = hub.blackboard("reader");
    reader.process_messages(at(25));
    let header = *reader.from(left.host()).sample(STATE).unwrap().header;
    assert_eq!((header.sequence, header.published), (41, at(5000)));
    assert_eq!((header.local, header.received), (at(20), at(23)));
    assert_eq!(&*hub.host_name(header.host).unwrap(), "left");
    assert_eq!(&*hub.publisher_name(header.publisher).unwrap(), "vision");
}

#[test]
fn histories_of_all_hosts_are_read_by_this_hosts_clock() {
    let hub = hub();
    let mut left = hub.receiver("left", "vision", "test/data").unwrap();
    // The sender's clock is an hour ahead, and the second message overtakes the first.
    let hour = Duration::from_secs(3600);
    for (sequence, local) in [(2, at(20)), (1, at(10)), (3, at(30))] {
        let come = RemoteHeader { sequence, published: local + hour, local, received: at(40) };
        left.receive(mark(sequence), come).unwrap();
    }
    let mut reader = hub.blackboard("reader");
    reader.process_messages(at(40));
    let view = reader.from(left.host());
    let all: Vec<_> = view.recent(DATA, Duration::MAX).map(|mark| mark.number).collect();
    assert_eq!(all, [1, 2, 3]);
    assert_eq!(view.nearest(DATA, at(14)).unwrap().number, 1);
    assert_eq!(view.nearest(DATA, at(16)).unwrap().number, 2);
    assert_eq!(view.nearest_not_newer(DATA, at(29)).unwrap().number, 2);
    assert_eq!(view.nearest_not_older(DATA, at(21)).unwrap().number, 3);
    assert_eq!(view.around(DATA, at(25)).unwrap().share, 0.5);
    let recent: Vec<_> = view.recent(DATA, Duration::from_millis(10)).map(|mark| mark.number).collect();
    assert_eq!(recent, [3]);
}

#[test]
fn losses_are_counted_host_by_host() {
    let hub = hub();
    let (mut left, mut right) = (Mate::new(&hub, "left"), Mate::new(&hub, "right"));
    let mut slow = hub.blackboard("slow");
    [left.host(), right.host()].into_iter().for_each(|host| drop(numbers_of(&slow, host)));
    let count = SIGNAL_DEPTH as u64 + 3;
    (1..=count).for_each(|number| left.publish_number(number));
    right.publish_number(1);
    slow.process_messages(at(count));
    let view = slow.from(left.host());
    assert_eq!((view.lost(STATE), view.lost(SIGNAL), view.lost(DATA)), (0, 3, count - 4));
    assert_eq!(view.read(STATE).unwrap().number, count, "a state never loses its last value");
    assert_eq!(slow.from(right.host()).lost(SIGNAL), 0);
    assert_eq!(slow.lost(SIGNAL), 0);
}

#[test]
fn arrivals_are_reported_per_host() {
    let hub = hub();
    let mut left = Mate::new(&hub, "left");
    let mut reader = hub.blackboard("reader");
    numbers(&reader);
    numbers_of(&reader, left.host());
    left.publish_number(1);
    reader.process_messages(at(1));
    let paths = ["test/state", "test/signal", "test/data"].map(|path| hub.topic(path).unwrap());
    assert_eq!(reader.arrivals().count(), 0);
    assert_eq!(reader.from(left.host()).arrivals().collect::<Vec<_>>(), paths);
}

#[test]
fn topics_read_of_any_host_are_remembered_once() {
    let hub = hub();
    let host = hub.host_id("left").unwrap();
    let reader = hub.blackboard("reader");
    reader.from(host).read(STATE);
    reader.read(STATE);
    let state = hub.topic("test/state").unwrap();
    assert!(reader.is_read(state));
    assert_eq!(reader.topics_read(), [state]);
}

#[test]
fn a_region_takes_over_what_was_delivered_from_other_hosts() {
    let hub = hub();
    let mut left = Mate::new(&hub, "left");
    let (mut outer, mut inner) = (hub.blackboard("chart"), hub.blackboard("chart"));
    numbers_of(&outer, left.host());
    left.publish_number(1);
    outer.process_messages(at(1));
    left.publish_number(2);
    inner.adopt(&outer);
    assert_eq!(numbers_of(&inner, left.host()), (Some(1), vec![1], vec![1]));
    inner.process_messages(at(2));
    assert_eq!(numbers_of(&inner, left.host()), (Some(2), vec![2], vec![1, 2]));
    inner.adopt(&outer);
    assert_eq!(numbers_of(&inner, left.host()), (Some(1), vec![1], vec![1]));
}

#[test]
fn unsupported_elements_are_rejected_by_name() {
    let hub = hub();
    let refused = |host: &str, path: &str| {
        let error = hub.receiver(host, "vision", path).unwrap_err();
        (error.kind(), error.to_string())
    };
    let (kind, text) = refused("left", "test/stat");
    assert_eq!(kind, ErrorKind::UndeclaredTopic);
    assert!(text.contains("test/state"), "{text}");
    let (kind, text) = refused("robot", "test/state");
    assert_eq!(kind, ErrorKind::OwnHost);
    assert!(text.contains("robot") && text.contains("vision"), "{text}");
    let mut left = hub.receiver("left", "vision", "test/state").unwrap();
    let error = left.receive(Box::new(Other::default()), arrival(1, at(1))).unwrap_err();
    assert_eq!(error.kind(), ErrorKind::WrongType);
    let error = left.receive_bytes(&[0xff], arrival(1, at(1))).unwrap_err();
    assert_eq!(error.kind(), ErrorKind::Malformed);
    assert!(error.to_string().contains("test/state") && error.to_string().contains("narukom.test.Mark"));
}

#[test]
fn names_that_others_invent_are_bounded() {
    let hub = hub();
    for number in 1..HOST_LIMIT {
        hub.host_id(&format!("host_{number}")).unwrap();
    }
    assert_eq!(hub.host_id("host_1").unwrap().index(), 1, "known ones are still found");
    assert_eq!(hub.host_id("one_more").unwrap_err().kind(), ErrorKind::TooMany);
    for number in 0..REMOTE_PUBLISHER_LIMIT {
        hub.receiver("host_1", &format!("publisher_{number}"), "test/state").unwrap();
    }
    let error = hub.receiver("host_1", "one_more", "test/state").unwrap_err();
    assert_eq!(error.kind(), ErrorKind::TooMany);
    assert!(error.to_string().contains("one_more"), "{error}");
    hub.publisher(STATE, "one of ours").unwrap();
}

/// Records what it sees, and whether it came from another host.
struct Watch(Arc<Mutex<Vec<(String, bool, u64)>>>);

impl Watch {
    fn note(&mut self, publication: Publication<'_>, received: bool) {
        let number = publication.sample.downcast::<Mark>().unwrap().number;
        self.0.lock().unwrap().push((publication.host.to_owned(), received, number));
    }
}

impl Observer for Watch {
    fn observe(&mut self, publication: Publication<'_>) {
        self.note(publication, false);
    }

    fn observe_received(&mut self, publication: Publication<'_>) {
        self.note(publication, true);
    }
}

#[test]
fn observers_and_wakers_receive_messages_of_other_hosts() {
    let hub = hub();
    let (seen, woken) = (Arc::new(Mutex::new(Vec::new())), Arc::new(Mutex::new(Vec::new())));
    hub.observe(Box::new(Watch(seen.clone())));
    let bell = woken.clone();
    hub.set_waker(Arc::new(move |slot: TopicSlot, host: HostId| bell.lock().unwrap().push((slot, host))));
    let mut left = hub.receiver("left", "vision", "test/state").unwrap();
    left.receive(mark(1), arrival(1, at(1))).unwrap();
    hub.publisher(STATE, "body").unwrap().publish(Mark::new(2), at(2));
    let expected = [("left".to_owned(), true, 1), ("robot".to_owned(), false, 2)];
    assert_eq!(*seen.lock().unwrap(), expected);
    let topic = hub.topic("test/state").unwrap();
    assert_eq!(*woken.lock().unwrap(), [(topic, left.host()), (topic, HostId::LOCAL)]);
}

#[test]
fn subscribers_read_one_host() {
    let hub = hub();
    let mut left = Mate::new(&hub, "left");
    left.publish_number(1);
    let mut of_left = hub.subscriber_of(left.host(), "test/*").unwrap();
    let mut of_here = hub.subscriber("test/*").unwrap();
    left.publish_number(2);
    publish_everywhere(&mut hub.blackboard("giver"), 3, at(3));
    let numbers = |subscriber: &mut narukom::Subscriber| -> Vec<u64> {
        let samples = std::iter::from_fn(|| subscriber.next_sample());
        samples.map(|sample| sample.downcast::<Mark>().unwrap().number).collect()
    };
    assert_eq!(numbers(&mut of_left), [1, 2, 2, 2], "the state, and then all that comes");
    assert_eq!(numbers(&mut of_here), [3, 3, 3]);
}

#[test]
fn moments_at_the_ends_of_time_do_not_wrap() {
    let hub = hub();
    let mut left = hub.receiver("left", "vision", "test/data").unwrap();
    for (sequence, local) in [(1, Timestamp::ZERO), (2, Timestamp::MAX)] {
        let come = RemoteHeader { sequence, published: Timestamp::MAX, local, received: Timestamp::ZERO };
        left.receive(mark(sequence), come).unwrap();
    }
    let mut reader = hub.blackboard("reader");
    reader.process_messages(at(1));
    let view = reader.from(left.host());
    assert_eq!(view.nearest(DATA, at(1)).unwrap().number, 1);
    assert_eq!(view.nearest(DATA, Timestamp::MAX).unwrap().number, 2);
    assert_eq!(view.recent(DATA, Duration::MAX).count(), 2);
    assert!(view.around(DATA, at(1)).unwrap().share < 1e-9);
}
