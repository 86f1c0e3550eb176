//! The memory of N topics and M readers, as documented in the crate.
#![allow(clippy::unwrap_used, clippy::panic, reason = "a test that cannot go on fails")]

mod counting;
mod messages;

use std::ops::RangeInclusive;

use counting::live;
use messages::*;
use narukom::{Blackboard, Data, Hub, Retention, Signal, State, TopicDeclaration};

const TOPICS: usize = 200;
const READERS: usize = 20;
const DEPTH: usize = 16;

fn declarations<K: Retention>() -> Vec<TopicDeclaration> {
    let paths = (0..TOPICS).map(|number| &*format!("memory/topic_{number}").leak());
    paths.map(|path| TopicDeclaration::new::<K>(path, "test")).collect()
}

/// Publishes messages of 1000 bytes with these numbers on every topic; after each, `fetches`
/// decides which readers poll.
fn publish(
    hub: &Hub,
    readers: &mut [Blackboard],
    numbers: RangeInclusive<u64>,
    fetches: impl Fn(usize, u64) -> bool,
) {
    let paths: Vec<_> = hub.topics().iter().map(|topic| topic.path()).collect();
    for number in numbers {
        for path in &paths {
            let message = Mark { number, text: "x".repeat(1000) };
            hub.publisher_by_name(path, "body").unwrap().publish(Box::new(message), at(number)).unwrap();
        }
        let who_fetch = readers.iter_mut().enumerate().filter(|(index, _)| fetches(*index, number));
        who_fetch.for_each(|(_, reader)| reader.process_messages(at(number)));
    }
}

/// The bytes that a hub and its readers take after many messages.
fn taken<K: Retention>(fetches: impl Fn(usize, u64) -> bool + Copy) -> (i64, i64) {
    let declarations = declarations::<K>();
    let before = live();
    let hub = Hub::new("robot", &declarations).unwrap();
    let mut readers: Vec<_> = (0..READERS).map(|_| hub.blackboard("reader")).collect();
    readers.iter_mut().for_each(|reader| drop(reader.subscribe("**").unwrap()));
    publish(&hub, &mut readers, 1..=100, fetches);
    let early = live() - before;
    publish(&hub, &mut readers, 101..=200, fetches);
    (early, live() - before)
}

/// A message of 1000 bytes of text, with its two reference counts.
const MESSAGE: i64 = 1000 + 16 + 24 + 8;

/// The documented limit: the hub's messages, the readers' references and entries, and a constant
/// per topic.
fn stated(depth: usize, extra: i64) -> i64 {
    let (topics, readers, depth) = (TOPICS as i64, READERS as i64, depth.next_power_of_two() as i64);
    let hub = topics * (512 + depth * (96 + MESSAGE));
    let blackboards = readers * topics * (32 + 160 + depth.max(4) * 64);
    let arrivals = readers * topics * depth * 16 * 2;
    hub + blackboards + arrivals + extra + 200_000
}

#[test]
fn states_take_the_documented_memory_in_long_runs() {
    let (early, late) = taken::<State<Mark>>(|_, _| true);
    assert!(late <= stated(narukom::STATE_DEPTH, 0), "{late} of {}", stated(narukom::STATE_DEPTH, 0));
    assert!(late <= early + 10_000, "{early}, then {late}");
}

#[test]
fn histories_take_the_documented_memory_in_long_runs() {
    let (early, late) = taken::<Data<Mark, DEPTH>>(|_, _| true);
    assert!(late <= stated(DEPTH, 0), "{late} of {}", stated(DEPTH, 0));
    assert!(late <= early + 10_000, "{early}, then {late}");
}

#[test]
fn readers_that_never_fetch_hold_on_to_no_more_than_one_history_each() {
    let held = TOPICS as i64 * DEPTH as i64 * MESSAGE;
    // They have fetched once, after a full history, and never do again.
    let (early, late) = taken::<Data<Mark, DEPTH>>(|_, number| number == DEPTH as u64);
    assert!(late <= stated(DEPTH, held), "{late} of {}", stated(DEPTH, held));
    assert!(late <= early + 10_000, "{early}, then {late}");
}

#[test]
fn signals_of_readers_that_never_fetch_do_not_pile_up() {
    let (early, late) = taken::<Signal<Mark>>(|_, _| false);
    assert!(late <= stated(narukom::SIGNAL_DEPTH, 0), "{late} of {}", stated(narukom::SIGNAL_DEPTH, 0));
    assert!(late <= early + 10_000, "{early}, then {late}");
}

#[test]
fn a_hub_of_idle_topics_and_its_readers_take_little() {
    let declarations = declarations::<Data<Mark, 1024>>();
    let before = live();
    let hub = Hub::new("robot", &declarations).unwrap();
    let hub_takes = live() - before;
    let reader = hub.blackboard("reader");
    let reader_takes = live() - before - hub_takes;
    assert!(hub_takes <= 512 * TOPICS as i64 + 20_000, "{hub_takes}");
    assert!(reader_takes <= 24 * TOPICS as i64 + 2_000, "{reader_takes}");
    drop(reader);
}
