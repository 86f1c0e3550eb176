//! All storage is bounded, and losses are counted.
#![allow(clippy::unwrap_used, clippy::panic, reason = "a test that cannot go on fails")]

use crate::messages::*;
use narukom::{ErrorKind, OUTBOX_LIMIT, SIGNAL_DEPTH};

#[test]
fn a_slow_reader_of_data_loses_the_oldest_and_counts_them() {
    let hub = hub();
    let (mut giver, mut slow) = (hub.publisher(DATA, "giver").unwrap(), hub.blackboard("slow"));
    numbers(&slow);
    (1..=3).for_each(|number| giver.publish(Mark::new(number), at(number)));
    slow.process_messages(at(3));
    assert_eq!(slow.lost(DATA), 0);
    (4..=10).for_each(|number| giver.publish(Mark::new(number), at(number)));
    slow.process_messages(at(10));
    assert_eq!(numbers(&slow).2, [7, 8, 9, 10]);
    assert_eq!(slow.lost(DATA), 3);
    assert_eq!(slow.lost_at(slow.slot("test/data").unwrap()), 3);
}

#[test]
fn a_slow_reader_of_signals_loses_the_oldest_and_counts_them() {
    let hub = hub();
    let (mut giver, mut slow) = (hub.publisher(SIGNAL, "giver").unwrap(), hub.blackboard("slow"));
    numbers(&slow);
    let count = SIGNAL_DEPTH as u64 + 5;
    (1..=count).for_each(|number| giver.publish(Mark::new(number), at(number)));
    slow.process_messages(at(count));
    assert_eq!(numbers(&slow).1, (6..=count).collect::<Vec<_>>());
    assert_eq!(slow.lost(SIGNAL), 5);
}

#[test]
fn a_state_never_loses_its_last_value() {
    let hub = hub();
    let (mut giver, mut slow) = (hub.publisher(STATE, "giver").unwrap(), hub.blackboard("slow"));
    numbers(&slow);
    for round in 1..=3 {
        (1..=1000).for_each(|number| giver.publish(Mark::new(round * number), at(number)));
        slow.process_messages(at(1000));
        assert_eq!(numbers(&slow).0, Some(round * 1000));
        slow.process_messages(at(1001));
        assert_eq!(numbers(&slow).0, Some(round * 1000));
    }
    assert_eq!(slow.lost(STATE), 0);
}

#[test]
fn a_reader_that_never_drains_slows_no_other() {
    let hub = hub();
    let (never, mut quick) = (hub.blackboard("never"), hub.blackboard("quick"));
    numbers(&never);
    numbers(&quick);
    let mut giver = hub.blackboard("giver");
    for number in 1..=5000 {
        publish_everywhere(&mut giver, number, at(number));
        quick.process_messages(at(number));
        let (state, signals, data) = numbers(&quick);
        assert_eq!((state, signals, data.last()), (Some(number), vec![number], Some(&number)));
    }
    assert_eq!((quick.lost(DATA), quick.lost(SIGNAL)), (0, 0));
    assert_eq!(numbers(&never), (None, vec![], vec![]));
}

#[test]
fn more_publications_than_are_remembered_by_topic_are_delivered_all_the_same() {
    let hub = hub();
    let mut slow = hub.blackboard("slow");
    numbers(&slow);
    let mut giver = hub.blackboard("giver");
    giver.publish(DATA, Mark::new(1)).unwrap();
    giver.publish_all(at(1));
    let mut other = hub.publisher(ELSE, "noise").unwrap();
    (0..5000).for_each(|_| other.publish(Other::default(), at(2)));
    giver.publish(SIGNAL, Mark::new(2)).unwrap();
    giver.publish_all(at(3));
    slow.process_messages(at(3));
    assert_eq!(numbers(&slow), (None, vec![2], vec![1]));
    let arrivals: Vec<_> = slow.arrivals().collect();
    assert_eq!(arrivals, ["test/data", "test/signal"].map(|path| hub.topic(path).unwrap()));
}

#[test]
fn too_many_written_messages_are_rejected() {
    let mut robot = hub().blackboard("robot");
    for number in 0..OUTBOX_LIMIT as u64 {
        robot.publish(SIGNAL, Mark::new(number)).unwrap();
    }
    let error = robot.publish(SIGNAL, Mark::new(0)).unwrap_err();
    assert_eq!(error.kind(), ErrorKind::OutboxFull);
    assert!(error.to_string().contains("robot"), "{error}");
    robot.publish_all(at(1));
    robot.publish(SIGNAL, Mark::new(0)).unwrap();
}

#[test]
fn own_messages_do_not_pile_up_without_deliveries() {
    let mut robot = hub().blackboard("robot");
    for number in 1..=1000 {
        publish_everywhere(&mut robot, number, at(number));
    }
    let (state, signals, data) = numbers(&robot);
    assert_eq!((state, data), (Some(1000), vec![997, 998, 999, 1000]));
    assert_eq!(signals.len(), SIGNAL_DEPTH);
}
