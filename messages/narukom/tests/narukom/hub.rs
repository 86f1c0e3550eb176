//! The hub: start checks, subscribers, observers, wakers, publishers.
#![allow(clippy::unwrap_used, clippy::panic, reason = "a test that cannot go on fails")]

use std::sync::{Arc, Mutex};

use crate::messages::*;
use narukom::{
    Data, ErrorKind, HostId, Hub, Publication, Retention, State, Subscriber, TOPICS, TopicDeclaration,
    TopicSlot,
};

fn start_error(declarations: &[TopicDeclaration]) -> (ErrorKind, String) {
    let error = Hub::new("robot", declarations).unwrap_err();
    (error.kind(), error.to_string())
}

fn declared<K: Retention>(path: &'static str, module: &'static str) -> TopicDeclaration {
    TopicDeclaration::new::<K>(path, module)
}

#[test]
fn linked_topics_are_found_and_sorted() {
    assert!(!TOPICS.is_empty());
    let hub = hub();
    let paths: Vec<_> = hub.topics().iter().map(|topic| topic.path()).collect();
    assert_eq!(paths, ["other/state", "test/aged", "test/data", "test/signal", "test/state"]);
    for (number, path) in (0..).zip(paths) {
        assert_eq!(hub.topic(path), Some(TopicSlot::new(number)));
    }
    assert_eq!(hub.host(), "robot");
    let data = hub.declaration(hub.topic("test/data").unwrap()).unwrap();
    assert_eq!((data.kind().to_string(), data.depth(), data.descriptor().name), ("data".into(), 4, "Mark"));
    assert!(data.module().ends_with("messages"));
}

#[test]
fn two_types_on_a_topic_are_refused_with_both_names() {
    let (kind, text) =
        start_error(&[declared::<State<Mark>>("a", "vision"), declared::<State<Other>>("a", "motion")]);
    assert_eq!(kind, ErrorKind::TypesDiffer);
    for name in ["`a`", "narukom.test.Mark", "vision", "narukom.test.Other", "motion"] {
        assert!(text.contains(name), "{text}");
    }
}

#[test]
fn two_ways_of_keeping_a_topic_are_refused() {
    let (kind, text) =
        start_error(&[declared::<State<Mark>>("a", "one"), declared::<Data<Mark, 3>>("a", "other")]);
    assert_eq!(kind, ErrorKind::KindsDiffer);
    assert!(text.contains("state") && text.contains("data of depth 3"), "{text}");
    let (kind, _) =
        start_error(&[declared::<Data<Mark, 2>>("a", "one"), declared::<Data<Mark, 3>>("a", "other")]);
    assert_eq!(kind, ErrorKind::KindsDiffer);
    let (kind, text) =
        start_error(&[declared::<Data<Mark, 2, 500>>("a", "one"), declared::<Data<Mark, 2>>("a", "other")]);
    assert_eq!(kind, ErrorKind::KindsDiffer);
    assert!(text.contains("data of depth 2 and 500 ms in one"), "{text}");
}

#[test]
fn equal_declarations_are_one_topic() {
    let twice = [declared::<State<Mark>>("a", "one"), declared::<State<Mark>>("a", "other")];
    assert_eq!(Hub::new("robot", &twice).unwrap().topics().len(), 1);
}

#[test]
fn ill_formed_paths_are_refused() {
    let (kind, text) = start_error(&[declared::<State<Mark>>("Soccer", "vision")]);
    assert_eq!(kind, ErrorKind::BadPath);
    assert!(text.contains("Soccer") && text.contains("vision"), "{text}");
}

#[test]
fn a_thousand_topics_are_distinguished() {
    let paths: Vec<&'static str> = (0..1000).map(|number| &*format!("topic_{number}").leak()).collect();
    let declarations: Vec<_> = paths.iter().map(|path| declared::<State<Mark>>(path, "test")).collect();
    let hub = Hub::new("robot", &declarations).unwrap();
    for path in paths {
        let slot = hub.topic(path).unwrap();
        assert_eq!(hub.declaration(slot).unwrap().path(), path);
    }
    assert_eq!(hub.topic("topic_1000"), None);
}

#[test]
fn a_hub_without_topics_answers() {
    let hub = Hub::new("robot", []).unwrap();
    let mut blackboard = hub.blackboard("agent");
    blackboard.process_messages(at(1));
    assert!(blackboard.read(STATE).is_none());
    assert!(blackboard.publish(STATE, Mark::new(1)).is_err());
    assert!(hub.publisher(STATE, "body").is_err());
}

fn marks(subscriber: &mut Subscriber) -> Vec<u64> {
    let samples = std::iter::from_fn(|| subscriber.next_sample());
    samples.map(|sample| sample.downcast::<Mark>().map_or(0, |mark| mark.number)).collect()
}

#[test]
fn subscribers_get_everything_in_order_of_publication() {
    let hub = hub();
    let mut subscriber = hub.subscriber("test/*").unwrap();
    let mut giver = hub.blackboard("giver");
    giver.publish(SIGNAL, Mark::new(1)).unwrap();
    giver.publish(DATA, Mark::new(2)).unwrap();
    giver.publish(SIGNAL, Mark::new(3)).unwrap();
    giver.publish(STATE, Mark::new(4)).unwrap();
    giver.publish(ELSE, Other::default()).unwrap();
    giver.publish_all(at(1));
    giver.publish(STATE, Mark::new(5)).unwrap();
    giver.publish_all(at(2));
    assert_eq!(marks(&mut subscriber), [1, 2, 3, 4, 5]);
    assert_eq!(marks(&mut subscriber), []);
    assert_eq!(subscriber.topics().count(), 4);
}

#[test]
fn late_subscribers_begin_with_the_states() {
    let hub = hub();
    publish_everywhere(&mut hub.blackboard("giver"), 1, at(1));
    publish_everywhere(&mut hub.blackboard("giver"), 2, at(2));
    assert_eq!(marks(&mut hub.subscriber("test/**").unwrap()), [2]);
}

#[test]
fn subscribers_count_what_they_lost() {
    let hub = hub();
    let mut subscriber = hub.subscriber("test/data").unwrap();
    let mut giver = hub.publisher(DATA, "giver").unwrap();
    (1..=10).for_each(|number| giver.publish(Mark::new(number), at(number)));
    assert_eq!(marks(&mut subscriber), [7, 8, 9, 10]);
    assert_eq!(subscriber.lost(), 6);
}

#[test]
fn patterns_that_fit_nothing_are_errors() {
    let error = hub().subscriber("test/stat").unwrap_err();
    assert_eq!(error.kind(), ErrorKind::UndeclaredTopic);
    assert!(error.to_string().contains("test/state"), "{error}");
    assert_eq!(hub().subscriber("Test").unwrap_err().kind(), ErrorKind::BadPath);
}

/// Notes of an observer: publisher, path and number of each message.
type Notes = Arc<Mutex<Vec<(String, &'static str, u64)>>>;

fn note(hub: &Hub) -> Notes {
    let notes = Notes::default();
    let writer = notes.clone();
    hub.observe(Box::new(move |publication: Publication<'_>| {
        let number = publication.sample.downcast::<Mark>().unwrap().number;
        let note = (publication.publisher.to_owned(), publication.topic.path(), number);
        writer.lock().unwrap().push(note);
    }));
    notes
}

#[test]
fn observers_see_every_message_once_in_order_of_publication() {
    let hub = hub();
    let (first, second) = (note(&hub), note(&hub));
    publish_everywhere(&mut hub.blackboard("agent"), 1, at(1));
    hub.publisher(STATE, "body").unwrap().publish(Mark::new(2), at(2));
    let expected = [
        ("agent", "test/state", 1),
        ("agent", "test/signal", 1),
        ("agent", "test/data", 1),
        ("body", "test/state", 2),
    ]
    .map(|(publisher, path, number)| (publisher.to_owned(), path, number));
    assert_eq!(*first.lock().unwrap(), expected);
    assert_eq!(*second.lock().unwrap(), expected);
}

#[test]
fn observers_see_complete_headers_and_may_read() {
    let hub = hub();
    let headers = Arc::new(Mutex::new(Vec::new()));
    let (writer, reader) = (headers.clone(), hub.clone());
    hub.observe(Box::new(move |publication: Publication<'_>| {
        let mut seen = reader.subscriber("test/state").unwrap();
        let latest = seen.next_sample().unwrap().header;
        assert_eq!(publication.host, "robot");
        writer.lock().unwrap().push((latest, publication.sample.header));
    }));
    let mut body = hub.publisher(STATE, "body").unwrap();
    (1..=2).for_each(|number| body.publish(Mark::new(number), at(number)));
    let headers = headers.lock().unwrap();
    assert!(headers.iter().all(|(latest, observed)| latest == observed));
    let sequences: Vec<_> = headers.iter().map(|(_, header)| (header.sequence, header.published)).collect();
    assert_eq!(sequences, [(1, at(1)), (2, at(2))]);
}

#[test]
fn observers_agree_with_the_order_of_threads() {
    let hub = hub();
    let notes = note(&hub);
    let mut subscriber = hub.subscriber("test/signal").unwrap();
    std::thread::scope(|scope| {
        for name in ["one", "two", "three"] {
            let mut publisher = hub.publisher(SIGNAL, name).unwrap();
            scope.spawn(move || (1..=20).for_each(|number| publisher.publish(Mark::new(number), at(number))));
        }
    });
    let seen = std::iter::from_fn(|| subscriber.next_sample());
    let seen: Vec<_> = seen
        .map(|sample| {
            let name = hub.publisher_name(sample.header.publisher).unwrap().to_string();
            (name, "test/signal", sample.header.sequence)
        })
        .collect();
    assert_eq!(seen.len(), 60);
    assert_eq!(*notes.lock().unwrap(), seen);
}

#[test]
fn wakers_are_called_when_the_messages_can_be_fetched() {
    let hub = hub();
    let woken = Arc::new(Mutex::new(Vec::new()));
    let (writer, reader) = (woken.clone(), Mutex::new(hub.blackboard("reader")));
    hub.set_waker(Arc::new(move |slot: TopicSlot, _: HostId| {
        let mut reader = reader.lock().unwrap();
        reader.process_messages(at(1));
        let number = reader.latest_sample(slot).unwrap().downcast::<Mark>().unwrap().number;
        writer.lock().unwrap().push((slot, number));
    }));
    let mut giver = hub.blackboard("giver");
    giver.publish(STATE, Mark::new(1)).unwrap();
    giver.publish(DATA, Mark::new(2)).unwrap();
    assert!(woken.lock().unwrap().is_empty());
    giver.publish_all(at(1));
    giver.publish_all(at(2));
    let slots = ["test/state", "test/data"].map(|path| hub.topic(path).unwrap());
    assert_eq!(*woken.lock().unwrap(), [(slots[0], 1), (slots[1], 2)]);
}

#[test]
fn handles_are_of_one_hub() {
    let hub = hub();
    let other = hub.clone();
    let mut taker = hub.blackboard("taker");
    publish_everywhere(&mut other.blackboard("giver"), 1, at(1));
    taker.process_messages(at(1));
    assert_eq!(numbers(&taker), (Some(1), vec![1], vec![1]));
}
