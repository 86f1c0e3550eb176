//! Functions for the runtime of statecharts: edits, and regions that take over values.
#![allow(clippy::unwrap_used, clippy::panic, reason = "a test that cannot go on fails")]

use crate::messages::*;
use narukom::{Blackboard, ErrorKind, FieldValue, Hub, TopicSlot};

fn slot(hub: &Hub, path: &str) -> TopicSlot {
    hub.topic(path).unwrap()
}

fn set_number(blackboard: &mut Blackboard, slot: TopicSlot, number: u64) {
    blackboard.edit(slot, |message| message.set_field(0, FieldValue::Uint(number)).unwrap()).unwrap();
}

/// The messages that a subscriber created before `act` receives.
fn published(hub: &Hub, act: impl FnOnce()) -> Vec<Mark> {
    let mut subscriber = hub.subscriber("test/**").unwrap();
    while subscriber.next_sample().is_some() {}
    act();
    let samples = std::iter::from_fn(|| subscriber.next_sample());
    samples.map(|sample| sample.downcast::<Mark>().unwrap().message.clone()).collect()
}

#[test]
fn edits_change_a_copy_of_the_newest_and_are_published_once() {
    let hub = hub();
    let state = slot(&hub, "test/state");
    let (mut giver, mut region) = (hub.blackboard("giver"), hub.blackboard("region"));
    giver.publish(STATE, Mark { number: 1, text: "kept".into() }).unwrap();
    giver.publish_all(at(1));
    region.process_messages(at(1));
    let marks = published(&hub, || {
        set_number(&mut region, state, 2);
        assert_eq!(region.read(STATE).unwrap().number, 2, "seen at once");
        set_number(&mut region, state, 3);
        region.publish_all(at(2));
        region.publish_all(at(3));
    });
    assert_eq!(marks, [Mark { number: 3, text: "kept".into() }]);
    giver.process_messages(at(3));
    assert_eq!(giver.read(STATE).unwrap().number, 3);
}

#[test]
fn an_edit_without_a_message_begins_with_nothing_set() {
    let hub = hub();
    let mut region = hub.blackboard("region");
    set_number(&mut region, slot(&hub, "test/state"), 4);
    assert_eq!(region.read(STATE), Some(&Mark::new(4)));
}

#[test]
fn an_edit_after_publication_begins_a_new_message() {
    let hub = hub();
    let state = slot(&hub, "test/state");
    let mut region = hub.blackboard("region");
    let marks = published(&hub, || {
        set_number(&mut region, state, 1);
        region.publish_all(at(1));
        region.edit(state, |message| message.set_field(1, FieldValue::Text("new")).unwrap()).unwrap();
        region.publish_all(at(2));
    });
    assert_eq!(marks, [Mark::new(1), Mark { number: 1, text: "new".into() }]);
}

#[test]
fn edits_and_publications_keep_their_order() {
    let hub = hub();
    let state = slot(&hub, "test/state");
    let mut region = hub.blackboard("region");
    let marks = published(&hub, || {
        set_number(&mut region, state, 1);
        region.publish(STATE, Mark::new(2)).unwrap();
        region.edit(state, |message| message.set_field(1, FieldValue::Text("on two")).unwrap()).unwrap();
        region.publish_all(at(1));
    });
    assert_eq!(marks, [Mark::new(1), Mark::new(2), Mark { number: 2, text: "on two".into() }]);
}

#[test]
fn an_edit_does_not_touch_what_others_hold() {
    let hub = hub();
    let state = slot(&hub, "test/state");
    let (mut region, mut other) = (hub.blackboard("region"), hub.blackboard("other"));
    for number in 1..20 {
        set_number(&mut region, state, number);
        region.publish_all(at(number));
        region.process_messages(at(number));
        other.process_messages(at(number));
        assert_eq!(other.read(STATE).unwrap().number, number);
        set_number(&mut region, state, 1000);
        assert_eq!(other.read(STATE).unwrap().number, number);
        assert_eq!(region.read(STATE).unwrap().number, 1000);
    }
}

#[test]
fn an_edit_of_no_topic_is_an_error() {
    let mut region = hub().blackboard("region");
    let error = region.edit(TopicSlot::new(99), |_| panic!("there is no message")).unwrap_err();
    assert_eq!(error.kind(), ErrorKind::UndeclaredTopic);
    assert!(region.latest(TopicSlot::new(99)).is_none());
}

#[test]
fn an_edit_is_no_interest() {
    let hub = hub();
    let mut region = hub.blackboard("region");
    set_number(&mut region, slot(&hub, "test/state"), 4);
    assert_eq!(region.topics_read(), []);
}

#[test]
fn a_region_takes_over_delivered_and_unpublished_values() {
    let hub = hub();
    let mut giver = hub.blackboard("giver");
    let (mut parent, mut region) = (hub.blackboard("chart"), hub.blackboard("chart"));
    publish_everywhere(&mut giver, 1, at(1));
    parent.process_messages(at(1));
    set_number(&mut parent, slot(&hub, "test/state"), 2);
    parent.publish(DATA, Mark::new(2)).unwrap();
    region.adopt(&parent);
    assert_eq!(numbers(&region), (Some(2), vec![1], vec![1, 2]));
    assert_eq!(region.now(), at(1));
}

#[test]
fn a_region_publishes_nothing_that_it_took_over() {
    let hub = hub();
    let (mut parent, mut region) = (hub.blackboard("chart"), hub.blackboard("chart"));
    parent.publish(STATE, Mark::new(1)).unwrap();
    region.adopt(&parent);
    assert_eq!(published(&hub, || region.publish_all(at(1))), []);
    assert_eq!(published(&hub, || parent.publish_all(at(1))), [Mark::new(1)]);
}

#[test]
fn earlier_writes_of_a_region_are_published_but_not_read() {
    let hub = hub();
    let (parent, mut region) = (hub.blackboard("chart"), hub.blackboard("chart"));
    region.publish(STATE, Mark::new(1)).unwrap();
    region.adopt(&parent);
    assert_eq!(region.read(STATE), None);
    region.publish(DATA, Mark::new(2)).unwrap();
    assert_eq!(published(&hub, || region.publish_all(at(1))), [Mark::new(1), Mark::new(2)]);
}

#[test]
fn nothing_is_delivered_twice_after_inheriting() {
    let hub = hub();
    let (mut giver, mut parent, mut region) =
        (hub.blackboard("giver"), hub.blackboard("p"), hub.blackboard("r"));
    numbers(&region);
    publish_everywhere(&mut giver, 1, at(1));
    parent.process_messages(at(1));
    numbers(&parent);
    publish_everywhere(&mut parent, 2, at(1));
    region.adopt(&parent);
    assert_eq!(numbers(&region).2, [1, 2]);
    region.process_messages(at(2));
    assert_eq!(numbers(&region), (Some(2), vec![2], vec![1, 2]));
    region.process_messages(at(3));
    assert_eq!(numbers(&region), (Some(2), vec![], vec![1, 2]));
}

#[test]
fn taking_over_goes_back_to_what_the_other_knows() {
    let hub = hub();
    let (mut giver, mut parent, mut region) =
        (hub.blackboard("giver"), hub.blackboard("p"), hub.blackboard("r"));
    numbers(&region);
    publish_everywhere(&mut giver, 1, at(1));
    parent.process_messages(at(1));
    publish_everywhere(&mut giver, 2, at(2));
    region.process_messages(at(2));
    assert_eq!(numbers(&region).0, Some(2));
    region.adopt(&parent);
    assert_eq!(numbers(&region), (Some(1), vec![1], vec![1]));
    region.process_messages(at(3));
    assert_eq!(numbers(&region), (Some(2), vec![2], vec![1, 2]));
}

#[test]
fn taken_over_values_are_no_interest_until_they_are_read() {
    let hub = hub();
    let (parent, mut region) = (hub.blackboard("p"), hub.blackboard("r"));
    numbers(&parent);
    region.read(STATE);
    region.adopt(&parent);
    assert_eq!(region.topics_read(), [slot(&hub, "test/state")]);
    region.signals(SIGNAL).count();
    assert!(region.is_read(slot(&hub, "test/signal")));
}

#[test]
fn a_blackboard_of_another_hub_is_not_taken_over() {
    let (mut one, mut other) = (hub().blackboard("one"), hub().blackboard("other"));
    other.publish(STATE, Mark::new(1)).unwrap();
    one.adopt(&other);
    assert_eq!(one.read(STATE), None);
}

#[test]
fn a_draft_that_a_region_took_over_is_not_changed_under_it() {
    let hub = hub();
    let state = slot(&hub, "test/state");
    let (mut parent, mut region) = (hub.blackboard("p"), hub.blackboard("r"));
    set_number(&mut parent, state, 1);
    region.adopt(&parent);
    set_number(&mut parent, state, 2);
    assert_eq!((parent.read(STATE).unwrap().number, region.read(STATE).unwrap().number), (2, 1));
    assert_eq!(published(&hub, || parent.publish_all(at(1))), [Mark::new(2)]);
}
