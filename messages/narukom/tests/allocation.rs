//! In the steady state publishing, delivering and reading do not allocate; and hostile bytes cause
//! no allocation.
#![allow(clippy::unwrap_used, reason = "a test that cannot go on fails")]

mod counting;
mod messages;

use std::time::Duration;

use counting::allocations;
use messages::*;
use narukom::{ErrorKind, FieldValue, Publication, Timestamp};

/// Rings, pools and lists grow until every slot has been used once; then nothing grows.
fn check_steady(mut cycle: impl FnMut(u64)) {
    (1..=2000).for_each(&mut cycle);
    let (count, _) = allocations(|| (2001..=4000).for_each(&mut cycle));
    assert_eq!(count, 0, "allocations in 2000 cycles");
}

#[test]
fn a_cycle_does_not_allocate() {
    let hub = hub();
    let (mut one, mut other, mut region) =
        (hub.blackboard("one"), hub.blackboard("other"), hub.blackboard("one"));
    let mut body = hub.publisher(STATE, "body").unwrap();
    let state = hub.topic("test/state").unwrap();
    let mut sum = 0;
    check_steady(|number| {
        body.publish(Mark::new(number), at(number));
        for blackboard in [&mut one, &mut other] {
            blackboard.process_messages(at(number));
            sum += blackboard.read(STATE).map_or(0, |mark| mark.number);
            sum += blackboard.signals(SIGNAL).map(|mark| mark.number).sum::<u64>();
            sum += blackboard.recent(DATA, Duration::from_millis(2)).map(|mark| mark.number).sum::<u64>();
            sum += blackboard.nearest(DATA, at(number - 1)).map_or(0, |mark| mark.number);
            sum += blackboard.around(DATA, at(number - 1)).map_or(0, |marks| marks.before.number);
            blackboard.publish(SIGNAL, Mark::new(number)).unwrap();
            blackboard.publish_with(DATA, |mark| mark.number = number).unwrap();
            blackboard.edit(state, |mark| mark.set_field(0, FieldValue::Uint(number)).unwrap()).unwrap();
            region.adopt(blackboard);
            sum += region.read(STATE).map_or(0, |mark| mark.number);
            blackboard.publish_all(at(number));
        }
    });
    assert!(sum > 0);
}

#[test]
fn messages_of_another_host_do_not_allocate() {
    let hub = hub();
    let mut reader = hub.blackboard("reader");
    let mut mate = hub.receiver("mate", "vision", "test/data").unwrap();
    let mut bytes = Vec::new();
    let mut sum = 0;
    check_steady(|number| {
        encode(&Mark::new(number), &mut bytes);
        mate.receive_bytes(&bytes, arrival(number, at(number))).unwrap();
        reader.process_messages(at(number));
        sum += reader.from(mate.host()).read(DATA).map_or(0, |mark| mark.number);
        sum += reader.from(mate.host()).nearest(DATA, at(number)).map_or(0, |mark| mark.number);
    });
    assert!(sum > 0);
}

#[test]
fn bytes_in_and_out_do_not_allocate() {
    let hub = hub();
    let mut publisher = hub.publisher_by_name("test/data", "cli").unwrap();
    let mut tap = hub.encoded_subscriber("test/*").unwrap();
    hub.observe(Box::new(|publication: Publication<'_>| assert!(!publication.bytes().is_empty())));
    let mut bytes = Vec::new();
    check_steady(|number| {
        encode(&Mark::new(number), &mut bytes);
        publisher.publish_bytes(&bytes, at(number)).unwrap();
        assert_eq!(tap.next_encoded().unwrap().bytes(), bytes);
    });
}

#[test]
fn encodings_that_are_kept_for_a_while_are_made_in_the_memory_of_earlier_ones() {
    let hub = hub();
    let mut publisher = hub.publisher(DATA, "body").unwrap();
    let mut tap = hub.encoded_subscriber("test/data").unwrap();
    // As a link keeps those that it may have to retransmit.
    let mut kept = std::collections::VecDeque::with_capacity(4);
    check_steady(|number| {
        publisher.publish(Mark::new(number), at(number));
        if kept.len() == 4 {
            kept.pop_front();
        }
        let encoding = tap.next_encoded().unwrap().into_shared();
        assert!(!encoding.as_ref().is_empty());
        kept.push_back(encoding);
    });
}

#[test]
fn a_large_message_is_built_in_the_memory_of_an_earlier_one() {
    let hub = hub();
    let (mut giver, mut taker) = (hub.publisher(STATE, "giver").unwrap(), hub.blackboard("taker"));
    let text = "x".repeat(1 << 20);
    check_steady(|number| {
        giver.publish_with(
            |mark| {
                assert!(mark.text.is_empty(), "it begins with nothing set");
                mark.number = number;
                mark.text.push_str(&text[..if number < 100 { 1 << 20 } else { 1 << 10 }]);
            },
            at(number),
        );
        taker.process_messages(at(number));
        assert_eq!(taker.read(STATE).unwrap().number, number);
    });
}

#[test]
fn a_length_that_is_claimed_reserves_nothing() {
    let hub = hub();
    let mut publisher = hub.publisher_by_name("test/state", "stranger").unwrap();
    // Field 2, a string of `length` bytes, of which one is present.
    for length in [1 << 20, 1 << 30, u64::from(u32::MAX), 1 << 40, i64::MAX as u64, u64::MAX] {
        let mut bytes = vec![0x12];
        varint(length, &mut bytes);
        bytes.push(b'x');
        let (_, allocated) = allocations(|| {
            let error = publisher.publish_bytes(&bytes, at(1)).unwrap_err();
            assert_eq!(error.kind(), ErrorKind::Malformed);
        });
        assert!(allocated < 4096, "{allocated} bytes for a claim of {length}");
    }
    assert!(hub.latest(hub.topic("test/state").unwrap()).is_none(), "nothing of it is published");
}

fn varint(mut number: u64, bytes: &mut Vec<u8>) {
    while number >= 0x80 {
        bytes.push(number as u8 | 0x80);
        number >>= 7;
    }
    bytes.push(number as u8);
}

fn encode(mark: &Mark, bytes: &mut Vec<u8>) {
    use narukom::AnyMessage as _;
    bytes.clear();
    mark.encode_to(bytes);
}

#[test]
fn idle_topics_cost_a_cycle_no_memory() {
    let hub = hub();
    let mut robot = hub.blackboard("robot");
    robot.subscribe("**").unwrap();
    let (count, _) = allocations(|| {
        for millis in 1..=1000 {
            robot.process_messages(at(millis));
            robot.publish_all(Timestamp::MAX);
        }
    });
    assert_eq!(count, 0);
}
