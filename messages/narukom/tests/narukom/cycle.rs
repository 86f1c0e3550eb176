//! A cycle is a transaction: what a blackboard shows, and when.
#![allow(clippy::unwrap_used, clippy::panic, reason = "a test that cannot go on fails")]

use crate::messages::*;
use narukom::{ErrorKind, FieldValue, Timestamp};

#[test]
fn own_messages_are_read_at_once() {
    let mut robot = hub().blackboard("robot");
    robot.publish(STATE, Mark::new(1)).unwrap();
    robot.publish(SIGNAL, Mark::new(2)).unwrap();
    robot.publish(DATA, Mark::new(3)).unwrap();
    assert_eq!(numbers(&robot), (Some(1), vec![2], vec![3]));
}

#[test]
fn messages_of_others_come_when_they_are_published_and_delivered() {
    let hub = hub();
    let (mut giver, mut taker) = (hub.blackboard("giver"), hub.blackboard("taker"));
    let nothing = (None, vec![], vec![]);
    taker.process_messages(at(1));
    giver.publish(STATE, Mark::new(1)).unwrap();
    giver.publish(SIGNAL, Mark::new(1)).unwrap();
    giver.publish(DATA, Mark::new(1)).unwrap();
    assert_eq!(numbers(&taker), nothing, "written is not published");
    taker.process_messages(at(2));
    assert_eq!(numbers(&taker), nothing, "written is not published");
    giver.publish_all(at(3));
    assert_eq!(numbers(&taker), nothing, "published is not delivered");
    taker.process_messages(at(4));
    assert_eq!(numbers(&taker), (Some(1), vec![1], vec![1]));
}

#[test]
fn readers_report_their_last_seen_publication() {
    let hub = hub();
    let (mut writer, mut reader) = (hub.blackboard("writer"), hub.blackboard("reader"));
    let mut subscriber = hub.subscriber("**").unwrap();
    writer.publish(STATE, Mark::new(1)).unwrap();
    assert!(writer.has_unpublished());
    writer.publish(STATE, Mark::new(2)).unwrap();
    writer.publish_all(at(1));
    assert!(!writer.has_unpublished());
    assert_eq!((reader.position(), subscriber.position()), (0, 0), "they have not looked yet");
    reader.process_messages(at(2));
    while subscriber.next_sample().is_some() {}
    assert_eq!((reader.position(), subscriber.position()), (2, 2));
    assert_eq!(hub.blackboard("late").position(), 2, "signals from before are not for it");
}

#[test]
fn a_first_read_finds_what_the_last_delivery_would_have_brought() {
    let hub = hub();
    let (mut giver, mut taker) = (hub.blackboard("giver"), hub.blackboard("taker"));
    publish_everywhere(&mut giver, 1, at(1));
    taker.process_messages(at(2));
    publish_everywhere(&mut giver, 2, at(3));
    assert_eq!(numbers(&taker), (Some(1), vec![1], vec![1]));
    taker.process_messages(at(4));
    assert_eq!(numbers(&taker), (Some(2), vec![2], vec![1, 2]));
}

#[test]
fn late_readers_get_states_and_histories_but_no_signals() {
    let hub = hub();
    let mut giver = hub.blackboard("giver");
    publish_everywhere(&mut giver, 1, at(1));
    let mut late = hub.blackboard("late");
    assert_eq!(numbers(&late), (None, vec![], vec![]), "nothing comes without a delivery");
    late.process_messages(at(2));
    assert_eq!(numbers(&late), (Some(1), vec![], vec![1]));
}

#[test]
fn reading_twice_gives_the_same() {
    let hub = hub();
    let (mut giver, mut taker) = (hub.blackboard("giver"), hub.blackboard("taker"));
    publish_everywhere(&mut giver, 1, at(1));
    taker.process_messages(at(1));
    assert_eq!(numbers(&taker), numbers(&taker));
}

#[test]
fn own_messages_come_back_once() {
    let mut robot = hub().blackboard("robot");
    robot.interest(robot.slot("test/data").unwrap());
    for number in 1..=3 {
        publish_everywhere(&mut robot, number, at(number));
        robot.process_messages(at(number));
    }
    let (state, _, data) = numbers(&robot);
    assert_eq!((state, data), (Some(3), vec![1, 2, 3]));
}

#[test]
fn own_states_are_replaced_by_later_ones_of_others() {
    let hub = hub();
    let (mut one, mut other) = (hub.blackboard("one"), hub.blackboard("other"));
    one.publish(STATE, Mark::new(1)).unwrap();
    one.publish_all(at(1));
    other.publish(STATE, Mark::new(2)).unwrap();
    other.publish_all(at(2));
    assert_eq!(one.read(STATE).unwrap().number, 1);
    one.process_messages(at(3));
    assert_eq!(one.read(STATE).unwrap().number, 2);
    one.publish(STATE, Mark::new(3)).unwrap();
    one.process_messages(at(4));
    assert_eq!(one.read(STATE).unwrap().number, 3, "unpublished own writes stay over a delivery");
}

#[test]
fn messages_published_together_arrive_together_and_in_order() {
    let hub = hub();
    let (mut giver, mut taker) = (hub.blackboard("giver"), hub.blackboard("taker"));
    let slots = ["test/signal", "test/data", "test/state"].map(|path| hub.topic(path).unwrap());
    slots.iter().for_each(|slot| taker.interest(*slot));
    publish_everywhere(&mut giver, 1, at(1));
    giver.publish(SIGNAL, Mark::new(2)).unwrap();
    giver.publish_all(at(2));
    taker.process_messages(at(3));
    let [signal, data, state] = slots;
    assert_eq!(taker.arrivals().collect::<Vec<_>>(), [state, signal, data, signal]);
    taker.process_messages(at(4));
    assert_eq!(taker.arrivals().count(), 0);
}

#[test]
fn headers_have_sender_time_and_number() {
    let hub = hub();
    let (mut giver, mut taker) = (hub.blackboard("giver"), hub.blackboard("taker"));
    publish_everywhere(&mut giver, 1, at(1));
    publish_everywhere(&mut giver, 2, at(5));
    taker.process_messages(at(9));
    let header = taker.sample(STATE).unwrap().header;
    assert_eq!((header.published, header.received, header.sequence), (at(5), at(5), 2));
    assert_eq!(&*hub.publisher_name(header.publisher).unwrap(), "giver");
    assert_eq!(&*hub.host_name(header.host).unwrap(), "robot");
    assert_eq!(hub.declaration(header.topic).unwrap().path(), "test/state");
}

#[test]
fn an_own_message_has_no_sequence_until_it_is_published() {
    let mut robot = hub().blackboard("robot");
    robot.process_messages(at(3));
    robot.publish(STATE, Mark::new(1)).unwrap();
    let written = *robot.sample(STATE).unwrap().header;
    assert_eq!((written.sequence, written.published), (0, at(3)));
    robot.publish_all(at(4));
    let published = *robot.sample(STATE).unwrap().header;
    assert_eq!((published.sequence, published.published), (1, at(4)));
}

#[test]
fn sequences_count_by_publisher_and_topic_also_over_blackboards() {
    let hub = hub();
    let (mut left, mut right) = (hub.blackboard("goalie"), hub.blackboard("goalie"));
    publish_everywhere(&mut left, 1, at(1));
    publish_everywhere(&mut right, 2, at(2));
    publish_everywhere(&mut hub.blackboard("attacker"), 3, at(3));
    let mut taker = hub.blackboard("taker");
    taker.process_messages(at(4));
    let sequences: Vec<_> =
        taker.recent(DATA, at(4).since(Timestamp::ZERO)).map(|mark| mark.header.sequence).collect();
    assert_eq!(sequences, [1, 2, 1]);
}

#[test]
fn undeclared_topics_are_refused_with_the_nearest_name() {
    let mut robot = hub().blackboard("robot");
    let error = robot.publish(UNKNOWN, Mark::new(1)).unwrap_err();
    assert_eq!(error.kind(), ErrorKind::UndeclaredTopic);
    assert_eq!(error.to_string(), "the topic `test/stat` is not declared; did you mean `test/state`?");
    assert!(robot.read(UNKNOWN).is_none());
    let error = robot.publish_by_name("nowhere", Box::new(Mark::new(1))).unwrap_err();
    assert_eq!(error.to_string(), "the topic `nowhere` is not declared");
}

#[test]
fn topics_are_published_and_read_by_name() {
    let mut robot = hub().blackboard("robot");
    robot.publish_by_name("test/state", Box::new(Mark::new(7))).unwrap();
    let message = robot.latest(robot.slot("test/state").unwrap()).unwrap();
    assert!(matches!(message.field(0), FieldValue::Uint(7)));
    assert!(robot.slot("test/stat").is_none());
    let error = robot.publish_by_name("test/state", Box::new(Other::default())).unwrap_err();
    assert_eq!(error.kind(), ErrorKind::WrongType);
    assert!(error.to_string().contains("narukom.test.Other"), "{error}");
}

#[test]
fn reads_are_remembered() {
    let robot = hub().blackboard("robot");
    assert_eq!(robot.topics_read(), []);
    robot.read(STATE);
    let count = robot.read_count();
    robot.signals(SIGNAL).count();
    robot.read(STATE);
    let read = ["test/state", "test/signal"].map(|path| robot.slot(path).unwrap());
    assert_eq!(robot.topics_read(), read);
    assert_eq!(robot.read_since(count), read[1..]);
    assert_eq!((count, robot.read_count()), (1, 2));
    assert!(robot.is_read(read[0]));
    assert!(!robot.is_read(robot.slot("test/data").unwrap()));
}

#[test]
fn events_are_collected_in_order() {
    let mut robot = hub().blackboard("robot");
    robot.raise("found");
    robot.raise("lost");
    assert_eq!(robot.take_events(), ["found", "lost"]);
    assert!(robot.take_events().is_empty());
}

#[test]
fn chance_belongs_to_the_seed_or_else_to_the_names() {
    let hub = hub();
    let draw = |name: &str| hub.blackboard(name).random().uniform();
    assert_eq!(draw("one"), draw("one"));
    assert_ne!(draw("one"), draw("other"));
    let seeded = |seed| {
        let mut blackboard = hub.blackboard("one");
        blackboard.set_random([seed; 32]);
        blackboard.random().uniform()
    };
    assert_eq!(seeded(1), seeded(1));
    assert_ne!(seeded(1), seeded(2));
}

#[test]
fn a_request_to_return_is_seen_until_it_is_taken_back() {
    let robot = hub().blackboard("robot");
    let cancellation = robot.cancellation().clone();
    assert!(!robot.is_cancelled());
    cancellation.request();
    assert!(robot.is_cancelled() && cancellation.is_requested());
    robot.cancellation().withdraw();
    assert!(!robot.is_cancelled());
}
