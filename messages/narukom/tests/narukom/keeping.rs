//! The three retention kinds: state, signal, data.
#![allow(clippy::unwrap_used, clippy::panic, reason = "a test that cannot go on fails")]

use std::time::Duration;

use crate::messages::*;
use narukom::{AnySample, Blackboard, Timestamp};

fn signals(blackboard: &Blackboard) -> Vec<u64> {
    blackboard.signals(SIGNAL).map(|mark| mark.number).collect()
}

fn signal(blackboard: &mut Blackboard, number: u64) {
    blackboard.publish(SIGNAL, Mark::new(number)).unwrap();
}

#[test]
fn each_reader_sees_a_signal_in_one_cycle() {
    let hub = hub();
    let (mut giver, mut quick, mut slow) =
        (hub.blackboard("giver"), hub.blackboard("quick"), hub.blackboard("slow"));
    let mut seen = Vec::new();
    for number in 1..=3 {
        signal(&mut giver, number);
        giver.publish_all(at(number));
        quick.process_messages(at(number));
        seen.push(signals(&quick));
    }
    quick.process_messages(at(4));
    slow.process_messages(at(4));
    assert_eq!(seen, [[1], [2], [3]]);
    assert_eq!(signals(&quick), []);
    assert_eq!(signals(&slow), [1, 2, 3]);
    slow.process_messages(at(5));
    assert_eq!(signals(&slow), []);
}

#[test]
fn the_newest_signal_is_read_as_the_topic() {
    let hub = hub();
    let (mut giver, mut taker) = (hub.blackboard("giver"), hub.blackboard("taker"));
    signal(&mut giver, 1);
    signal(&mut giver, 2);
    giver.publish_all(at(1));
    taker.process_messages(at(1));
    assert_eq!(taker.read(SIGNAL).unwrap().number, 2);
    taker.process_messages(at(2));
    assert!(taker.read(SIGNAL).is_none());
}

#[test]
fn an_own_signal_that_was_read_at_once_does_not_come_again() {
    let mut robot = hub().blackboard("robot");
    signal(&mut robot, 1);
    assert_eq!(signals(&robot), [1]);
    robot.publish_all(at(1));
    robot.process_messages(at(2));
    assert_eq!(signals(&robot), []);
}

#[test]
fn an_unread_own_signal_is_in_the_next_delivery() {
    let mut robot = hub().blackboard("robot");
    signal(&mut robot, 1);
    robot.publish_all(at(1));
    robot.process_messages(at(2));
    assert_eq!(signals(&robot), [1]);
    robot.process_messages(at(3));
    assert_eq!(signals(&robot), []);
}

#[test]
fn a_peeked_own_signal_is_in_the_next_delivery() {
    let mut robot = hub().blackboard("robot");
    let slot = robot.slot("test/signal").unwrap();
    assert!(robot.shown(slot).is_none(), "the topic has no reader");
    robot.interest(slot);
    signal(&mut robot, 1);
    assert_eq!(robot.shown(slot).and_then(|sample| sample.downcast::<Mark>()).unwrap().number, 1);
    robot.publish_all(at(1));
    robot.process_messages(at(2));
    assert_eq!(signals(&robot), [1]);
}

#[test]
fn only_own_signals_written_after_the_last_read_are_delivered_again() {
    let mut robot = hub().blackboard("robot");
    signal(&mut robot, 1);
    assert_eq!(signals(&robot), [1]);
    signal(&mut robot, 2);
    robot.publish_all(at(1));
    robot.process_messages(at(2));
    assert_eq!(signals(&robot), [2]);
}

#[test]
fn blackboards_of_one_name_see_each_others_signals() {
    let hub = hub();
    let (mut left, mut right) = (hub.blackboard("goalie"), hub.blackboard("goalie"));
    signal(&mut left, 1);
    assert_eq!(signals(&left), [1]);
    left.publish_all(at(1));
    left.process_messages(at(1));
    right.process_messages(at(1));
    assert_eq!((signals(&left), signals(&right)), (vec![], vec![1]));
}

/// A blackboard with data published at 10, 20, 20 and 40 ms under the numbers 1 to 4.
fn history() -> Blackboard {
    let hub = hub();
    let (mut giver, mut taker) = (hub.blackboard("giver"), hub.blackboard("taker"));
    for (number, millis) in [(1, 10), (2, 20), (3, 20), (4, 40)] {
        giver.publish(DATA, Mark::new(number)).unwrap();
        giver.publish_all(at(millis));
    }
    taker.process_messages(at(50));
    taker
}

#[test]
fn histories_keep_messages_of_one_moment_apart() {
    let taker = history();
    let all: Vec<_> = taker.recent(DATA, Duration::from_secs(1)).map(|mark| mark.number).collect();
    assert_eq!(all, [1, 2, 3, 4]);
}

#[test]
fn histories_are_read_by_age() {
    let taker = history();
    let recent = |millis| -> Vec<u64> {
        taker.recent(DATA, Duration::from_millis(millis)).map(|mark| mark.number).collect()
    };
    assert_eq!(recent(9), []);
    assert_eq!(recent(10), [4]);
    assert_eq!(recent(30), [2, 3, 4]);
    assert_eq!(recent(40), [1, 2, 3, 4]);
}

#[test]
fn histories_are_read_by_time() {
    let taker = history();
    let number = |mark: Option<narukom::Sample<'_, Mark>>| mark.map(|mark| mark.number);
    let nearest = |millis| number(taker.nearest(DATA, at(millis)));
    let not_newer = |millis| number(taker.nearest_not_newer(DATA, at(millis)));
    let not_older = |millis| number(taker.nearest_not_older(DATA, at(millis)));
    assert_eq!([0, 10, 14, 20, 29, 31, 99].map(nearest), [1, 1, 1, 3, 3, 4, 4].map(Some));
    assert_eq!(nearest(15), Some(1), "of two equally near the earlier");
    assert_eq!([9, 10, 19, 20, 39, 40].map(not_newer), [None, Some(1), Some(1), Some(3), Some(3), Some(4)]);
    assert_eq!([10, 11, 20, 21, 40, 41].map(not_older), [Some(1), Some(2), Some(2), Some(4), Some(4), None]);
}

#[test]
fn own_data_is_in_the_history_before_its_delivery() {
    let mut taker = history();
    taker.publish(DATA, Mark::new(5)).unwrap();
    let all: Vec<_> = taker.recent(DATA, Duration::from_secs(1)).map(|mark| mark.number).collect();
    assert_eq!(all, [2, 3, 4, 5], "no more than the depth");
    assert_eq!(taker.nearest(DATA, at(49)).unwrap().number, 5);
    assert_eq!(taker.nearest(DATA, at(42)).unwrap().number, 4);
    assert_eq!(taker.nearest_not_older(DATA, at(41)).unwrap().number, 5);
}

#[test]
fn own_messages_that_wait_do_not_exceed_what_a_topic_keeps() {
    let hub = hub();
    let mut robot = hub.blackboard("robot");
    let (state, data) = (robot.slot("test/state").unwrap(), robot.slot("test/data").unwrap());
    let depth = hub.declaration(data).unwrap().depth() as u64;
    let numbers = |samples: &mut dyn Iterator<Item = &AnySample>| -> Vec<u64> {
        samples.map(|sample| sample.downcast::<Mark>().unwrap().number).collect()
    };
    robot.publish(STATE, Mark::new(1)).unwrap();
    robot.publish(STATE, Mark::new(2)).unwrap();
    assert_eq!(numbers(&mut robot.samples(state)), [2]);
    for number in 1..=depth + 2 {
        robot.publish(DATA, Mark::new(number)).unwrap();
    }
    let kept: Vec<u64> = (3..=depth + 2).collect();
    assert_eq!(numbers(&mut robot.samples(data)), kept);
    let recent: Vec<u64> = robot.recent(DATA, Duration::from_secs(1)).map(|mark| mark.number).collect();
    assert_eq!(recent, kept);
    assert_eq!(robot.nearest_not_older(DATA, Timestamp::ZERO).unwrap().number, 3);
    // Messages that a region took over count too, and messages that it hides do not.
    let mut region = hub.blackboard("region");
    region.publish(DATA, Mark::new(99)).unwrap();
    region.adopt(&robot);
    region.publish(DATA, Mark::new(depth + 3)).unwrap();
    let kept: Vec<u64> = (4..=depth + 3).collect();
    assert_eq!(numbers(&mut region.samples(data)), kept);
    // All are published.
    robot.publish_all(at(1));
    region.publish_all(at(1));
    let mut reader = hub.blackboard("reader");
    reader.process_messages(at(1));
    assert_eq!(numbers(&mut reader.samples(data)).last(), Some(&(depth + 3)));
}

#[test]
fn histories_are_sorted_by_time() {
    let hub = hub();
    let mut taker = hub.blackboard("taker");
    taker.read(DATA);
    let mut giver = hub.publisher(DATA, "giver").unwrap();
    for millis in [30, 10, 20, 10] {
        giver.publish(Mark::new(millis), at(millis));
    }
    taker.process_messages(at(40));
    let all: Vec<_> = taker.recent(DATA, Duration::from_secs(1)).map(|mark| mark.header.sequence).collect();
    assert_eq!(all, [2, 4, 3, 1], "equal moments stay in order");
}

#[test]
fn an_empty_history_answers_nothing() {
    let mut taker = hub().blackboard("taker");
    taker.process_messages(at(1));
    assert!(taker.nearest(DATA, at(1)).is_none());
    assert!(taker.nearest_not_newer(DATA, Timestamp::MAX).is_none());
    assert!(taker.nearest_not_older(DATA, Timestamp::ZERO).is_none());
    assert_eq!(taker.recent(DATA, Duration::MAX).count(), 0);
}

#[test]
fn a_state_is_found_however_many_followed_since_the_last_delivery() {
    let hub = hub();
    let (mut giver, mut late) = (hub.publisher(STATE, "giver").unwrap(), hub.blackboard("late"));
    giver.publish(Mark::new(1), at(1));
    late.process_messages(at(1));
    (2..=50).for_each(|number| giver.publish(Mark::new(number), at(number)));
    let first = late.read(STATE).unwrap().number;
    assert!(first > 1, "the value of the last delivery is no longer held");
    assert_eq!(late.read(STATE).unwrap().number, first, "nothing moves during a cycle");
    late.process_messages(at(50));
    assert_eq!(late.read(STATE).unwrap().number, 50);
}

/// The numbers of the history with an age limit, at a time at which nothing is published.
fn aged(blackboard: &mut Blackboard, millis: u64) -> Vec<u64> {
    blackboard.process_messages(at(millis));
    blackboard.recent(AGED, Duration::MAX).map(|mark| mark.number).collect()
}

#[test]
fn histories_are_bounded_by_age_and_by_depth() {
    let hub = hub();
    let (mut giver, mut taker) = (hub.publisher(AGED, "giver").unwrap(), hub.blackboard("taker"));
    (1..=6).for_each(|number| giver.publish(Mark::new(number), at(number * 10)));
    assert_eq!(aged(&mut taker, 60), [3, 4, 5, 6], "by depth");
    assert_eq!(aged(&mut taker, 80), [3, 4, 5, 6], "50 ms is not more than 50 ms");
    assert_eq!(aged(&mut taker, 91), [5, 6], "by age");
    assert_eq!(taker.nearest(AGED, at(0)).unwrap().number, 5);
    assert!(taker.nearest_not_newer(AGED, at(40)).is_none());
    assert_eq!(aged(&mut taker, 110), [6]);
    assert_eq!(taker.read(AGED).unwrap().number, 6);
    assert_eq!(aged(&mut taker, 111), []);
    assert!(taker.read(AGED).is_none(), "the newest is too old as well");
    assert_eq!(taker.lost(AGED), 0, "what is too old is not lost");
    giver.publish(Mark::new(7), at(112));
    assert_eq!(aged(&mut taker, 112), [7]);
}

#[test]
fn own_data_that_waits_grows_too_old_as_well() {
    let mut robot = hub().blackboard("robot");
    robot.process_messages(at(10));
    robot.publish(AGED, Mark::new(1)).unwrap();
    assert_eq!(aged(&mut robot, 60), [1]);
    assert_eq!(aged(&mut robot, 61), []);
}

#[test]
fn a_time_lies_between_its_neighbours() {
    let taker = history();
    let around = |millis| {
        let marks = taker.around(DATA, at(millis))?;
        Some((marks.before.number, marks.after.number, marks.share))
    };
    assert_eq!(around(15), Some((1, 2, 0.5)));
    assert_eq!(around(25), Some((3, 4, 0.25)));
    assert_eq!(around(10), Some((1, 1, 0.0)));
    assert_eq!(around(20), Some((3, 3, 0.0)), "of several at one moment the last");
    assert_eq!(around(40), Some((4, 4, 0.0)));
    assert_eq!((around(9), around(41)), (None, None), "nothing is known outside");
}

#[test]
fn messages_of_one_moment_are_all_kept_by_every_way_that_keeps_several() {
    let hub = hub();
    let (mut giver, mut taker) = (hub.blackboard("giver"), hub.blackboard("taker"));
    (1..=4).for_each(|number| {
        giver.publish(SIGNAL, Mark::new(number)).unwrap();
        giver.publish(DATA, Mark::new(number)).unwrap();
    });
    giver.publish_all(at(7));
    taker.process_messages(at(7));
    assert_eq!(numbers(&taker), (None, vec![1, 2, 3, 4], vec![1, 2, 3, 4]));
}

#[test]
fn messages_too_old_for_a_full_history_are_dropped() {
    let hub = hub();
    let (mut giver, mut taker) = (hub.publisher(DATA, "giver").unwrap(), hub.blackboard("taker"));
    [10, 20, 30, 40, 5].into_iter().for_each(|millis| {
        giver.publish(Mark::new(millis), at(millis));
        taker.process_messages(at(50));
        taker.read(DATA);
    });
    let all: Vec<_> = taker.recent(DATA, Duration::MAX).map(|mark| mark.number).collect();
    assert_eq!(all, [10, 20, 30, 40]);
}
