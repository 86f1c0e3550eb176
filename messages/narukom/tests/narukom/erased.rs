//! Topics known at run time only: subscriptions by pattern, publishers by name, messages as bytes,
//! encoded subscribers, and inspection without reading.
#![allow(clippy::unwrap_used, clippy::panic, reason = "a test that cannot go on fails")]

use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::{Arc, Mutex};

use crate::messages::*;
use narukom::prost::bytes::{Buf, BufMut};
use narukom::prost::encoding::{DecodeContext, WireType};
use narukom::{
    AnyMessage, ENCODED_LIMIT, ErrorKind, FieldError, FieldValue, Hub, Message, MessageDescriptor,
    Publication, Reflect, State, TopicDeclaration, prost,
};

fn bytes_of(number: u64) -> Vec<u8> {
    let mut bytes = Vec::new();
    Mark::new(number).encode_to(&mut bytes);
    bytes
}

#[test]
fn a_pattern_subscribes_to_every_topic_that_it_fits() {
    let hub = hub();
    let (mut giver, mut taker) = (hub.blackboard("giver"), hub.blackboard("taker"));
    let slots = taker.subscribe("test/**").unwrap();
    assert_eq!(slots, hub.matching("test/*").unwrap());
    assert_eq!(slots.len(), 4);
    assert_eq!(taker.topics_read(), slots);
    publish_everywhere(&mut giver, 1, at(1));
    publish_everywhere(&mut giver, 2, at(2));
    taker.process_messages(at(3));
    assert_eq!(taker.arrivals().count(), 6);
    let numbers = |path: &str| -> Vec<u64> {
        let samples = taker.samples(hub.topic(path).unwrap());
        samples.map(|sample| sample.downcast::<Mark>().unwrap().number).collect()
    };
    assert_eq!(numbers("test/state"), [2]);
    assert_eq!(numbers("test/signal"), [1, 2]);
    assert_eq!(numbers("test/data"), [1, 2]);
    let error = taker.subscribe("test/stat").unwrap_err();
    assert_eq!(error.kind(), ErrorKind::UndeclaredTopic);
    assert_eq!(taker.subscribe("Test").unwrap_err().kind(), ErrorKind::BadPath);
}

#[test]
fn fields_are_found_by_name() {
    let mut mark = Mark::new(3);
    assert!(matches!(mark.field_by_name("number"), FieldValue::Uint(3)));
    assert!(matches!(mark.field_by_name("nothing"), FieldValue::Missing));
    mark.set_field_by_name("text", FieldValue::Text("far")).unwrap();
    assert_eq!(mark.text, "far");
    let error = mark.set_field_by_name("nothing", FieldValue::Missing).unwrap_err();
    assert_eq!(error, FieldError::NoSuchField);
}

#[test]
fn messages_are_published_by_name_as_values_and_as_bytes() {
    let hub = hub();
    let mut taker = hub.blackboard("taker");
    let mut publisher = hub.publisher_by_name("test/data", "cli").unwrap();
    assert_eq!(publisher.topic().path(), "test/data");
    publisher.publish(Box::new(Mark::new(1)), at(1)).unwrap();
    publisher.publish_bytes(&bytes_of(2), at(2)).unwrap();
    taker.process_messages(at(3));
    assert_eq!(numbers(&taker).2, [1, 2]);
    let header = taker.sample(DATA).unwrap().header;
    assert_eq!((header.sequence, header.published), (2, at(2)));
    assert_eq!(&*hub.publisher_name(header.publisher).unwrap(), "cli");
    taker.publish_bytes("test/data", &bytes_of(3)).unwrap();
    assert_eq!(numbers(&taker).2, [1, 2, 3], "own messages are read at once");
}

#[test]
fn messages_of_another_type_are_rejected() {
    let hub = hub();
    let error = hub.publisher_by_name("test/stat", "cli").unwrap_err();
    assert_eq!(error.kind(), ErrorKind::UndeclaredTopic);
    assert!(error.to_string().contains("did you mean `test/state`"), "{error}");
    let mut publisher = hub.publisher_by_name("test/state", "cli").unwrap();
    let error = publisher.publish(Box::new(Other::default()), at(1)).unwrap_err();
    assert_eq!(error.kind(), ErrorKind::WrongType);
    let mut robot = hub.blackboard("robot");
    assert_eq!(robot.publish_bytes("nowhere", &[]).unwrap_err().kind(), ErrorKind::UndeclaredTopic);
    let too_many = vec![0; ENCODED_LIMIT + 1];
    // Field 1 as a string, a string that is not UTF-8, a field number 0, a truncated number, too
    // many bytes.
    let refused: [&[u8]; 5] = [&[0x0a, 1, b'x'], &[0x12, 1, 0xff], &[0, 0], &[0x08, 0x80], &too_many];
    for bytes in refused {
        for error in [
            publisher.publish_bytes(bytes, at(1)).unwrap_err(),
            robot.publish_bytes("test/state", bytes).unwrap_err(),
        ] {
            assert_eq!(error.kind(), ErrorKind::Malformed);
            assert!(error.to_string().contains("test/state"), "{error}");
        }
    }
    robot.publish_all(at(1));
    assert!(hub.latest(hub.topic("test/state").unwrap()).is_none());
}

#[test]
fn unknown_fields_are_skipped() {
    let mut robot = hub().blackboard("robot");
    let mut bytes = bytes_of(7);
    bytes.extend([0x78, 1]);
    robot.publish_bytes("test/state", &bytes).unwrap();
    assert_eq!(robot.read(STATE), Some(&Mark::new(7)));
}

#[test]
fn bytes_that_were_refused_leave_no_trace_in_the_next_message() {
    let hub = hub();
    let mut publisher = hub.publisher_by_name("test/state", "cli").unwrap();
    let mut taker = hub.blackboard("taker");
    for number in 1..=30 {
        // The number is decoded before the string is rejected.
        let mut bytes = bytes_of(99);
        bytes.extend([0x12, 1, 0xff]);
        assert!(publisher.publish_bytes(&bytes, at(number)).is_err());
        publisher.publish_bytes(&[], at(number)).unwrap();
        taker.process_messages(at(number));
        assert_eq!(taker.read(STATE), Some(&Mark::new(0)));
    }
}

#[test]
fn inspection_does_not_create_a_reader() {
    let hub = hub();
    let (mut giver, mut robot) = (hub.blackboard("giver"), hub.blackboard("robot"));
    let [state, signal] = ["test/state", "test/signal"].map(|path| hub.topic(path).unwrap());
    let peek = |robot: &narukom::Blackboard, slot| {
        robot.peek(slot).map(|sample| sample.downcast::<Mark>().unwrap().number)
    };
    publish_everywhere(&mut giver, 1, at(1));
    assert_eq!(peek(&robot, state), None, "published is not delivered");
    robot.process_messages(at(1));
    assert_eq!(peek(&robot, state), Some(1));
    assert_eq!(robot.topics_read(), []);
    robot.process_messages(at(2));
    assert_eq!(robot.arrivals().count(), 0);
    // An own signal that a tool inspects is still delivered.
    robot.publish(SIGNAL, Mark::new(2)).unwrap();
    assert_eq!(peek(&robot, signal), Some(2));
    robot.publish_all(at(2));
    robot.process_messages(at(3));
    assert_eq!(robot.signals(SIGNAL).map(|mark| mark.number).collect::<Vec<_>>(), [2]);
    assert_eq!(robot.topics_read(), [signal]);
    assert_eq!(peek(&robot, signal), Some(2), "also of a topic that is read");
    assert_eq!(hub.latest(signal).unwrap().downcast::<Mark>().unwrap().number, 2);
}

/// A message that counts how often it is encoded.
#[derive(Clone, Default, Debug)]
struct Counted {
    times: Arc<AtomicUsize>,
}

impl prost::Message for Counted {
    fn encode_raw(&self, bytes: &mut impl BufMut) {
        self.times.fetch_add(1, Ordering::Relaxed);
        prost::encoding::bool::encode(1, &true, bytes);
    }

    fn merge_field(
        &mut self,
        tag: u32,
        wire_type: WireType,
        bytes: &mut impl Buf,
        context: DecodeContext,
    ) -> Result<(), prost::DecodeError> {
        prost::encoding::skip_field(wire_type, tag, bytes, context)
    }

    fn encoded_len(&self) -> usize {
        2
    }

    fn clear(&mut self) {
        self.times = Arc::default();
    }
}

static COUNTED: MessageDescriptor = MessageDescriptor {
    full_name: "narukom.test.Counted",
    name: "Counted",
    fields: &[],
    file_descriptor_set: b"counted",
};

impl Reflect for Counted {
    fn descriptor(&self) -> &'static MessageDescriptor {
        &COUNTED
    }

    fn field(&self, _index: usize) -> FieldValue<'_> {
        FieldValue::Missing
    }

    fn set_field(&mut self, _index: usize, _value: FieldValue<'_>) -> Result<(), FieldError> {
        Err(FieldError::NoSuchField)
    }

    fn message_mut(&mut self, _index: usize) -> Option<&mut dyn AnyMessage> {
        None
    }
}

impl Message for Counted {
    const DESCRIPTOR: &'static MessageDescriptor = &COUNTED;
}

const COUNTED_TOPIC: narukom::Topic<State<Counted>> = narukom::Topic::new("counted");

fn counted_hub() -> Hub {
    let declarations = [TopicDeclaration::new::<State<Counted>>("counted", "test")];
    Hub::new("robot", &declarations).unwrap()
}

#[test]
fn a_message_is_encoded_once_however_many_look_at_its_bytes() {
    let hub = counted_hub();
    let mut taps: Vec<_> = (0..3).map(|_| hub.encoded_subscriber("counted").unwrap()).collect();
    let lengths = Arc::new(Mutex::new(Vec::new()));
    for _ in 0..2 {
        let lengths = lengths.clone();
        hub.observe(Box::new(move |publication: Publication<'_>| {
            lengths.lock().unwrap().push(publication.bytes().len());
        }));
    }
    let mut publisher = hub.publisher(COUNTED_TOPIC, "body").unwrap();
    for number in 1..=30 {
        let times = Arc::new(AtomicUsize::new(0));
        publisher.publish(Counted { times: times.clone() }, at(number));
        taps.iter_mut().for_each(|tap| assert_eq!(tap.next_encoded().unwrap().bytes(), [8, 1]));
        assert_eq!(times.load(Ordering::Relaxed), 1, "message {number}");
    }
    assert_eq!(lengths.lock().unwrap().len(), 60);
}

#[test]
fn observers_alone_share_an_encoding_as_well() {
    let hub = counted_hub();
    for _ in 0..3 {
        hub.observe(Box::new(|publication: Publication<'_>| assert_eq!(publication.bytes(), [8, 1])));
    }
    let times = Arc::new(AtomicUsize::new(0));
    hub.publisher(COUNTED_TOPIC, "body").unwrap().publish(Counted { times: times.clone() }, at(1));
    assert_eq!(times.load(Ordering::Relaxed), 1);
}

#[test]
fn nothing_is_encoded_without_a_reader_of_bytes() {
    let hub = counted_hub();
    let mut tap = hub.encoded_subscriber("counted").unwrap();
    hub.observe(Box::new(|_: Publication<'_>| {}));
    let mut reader = hub.blackboard("reader");
    let times = Arc::new(AtomicUsize::new(0));
    hub.publisher(COUNTED_TOPIC, "body").unwrap().publish(Counted { times: times.clone() }, at(1));
    reader.process_messages(at(1));
    assert!(reader.read(COUNTED_TOPIC).is_some());
    let encoded = tap.next_encoded().unwrap();
    assert_eq!(encoded.message().descriptor().name, "Counted");
    assert_eq!(times.load(Ordering::Relaxed), 0);
}

#[test]
fn taps_get_everything_in_order_of_publication_and_count_what_they_lost() {
    let hub = hub();
    let mut giver = hub.blackboard("giver");
    publish_everywhere(&mut giver, 1, at(1));
    let mut tap = hub.encoded_subscriber("test/**").unwrap();
    assert_eq!(tap.topics().count(), 4);
    publish_everywhere(&mut giver, 2, at(2));
    let got: Vec<_> = std::iter::from_fn(|| tap.next_encoded())
        .map(|encoded| (hub.declaration(encoded.header.topic).unwrap().path(), encoded.bytes().to_vec()))
        .collect();
    let expected = [
        ("test/state", bytes_of(1)),
        ("test/state", bytes_of(2)),
        ("test/signal", bytes_of(2)),
        ("test/data", bytes_of(2)),
    ];
    assert_eq!(got, expected, "the latest state, and then all that comes");
    let mut data = hub.encoded_subscriber("test/data").unwrap();
    let mut publisher = hub.publisher(DATA, "body").unwrap();
    (1..=10).for_each(|number| publisher.publish(Mark::new(number), at(number)));
    assert_eq!(std::iter::from_fn(|| data.next_encoded()).count(), 4);
    assert_eq!(data.lost(), 6);
    assert!(hub.encoded_subscriber("nowhere").is_err());
}

#[test]
fn bytes_that_a_tap_holds_do_not_change() {
    let hub = hub();
    let mut tap = hub.encoded_subscriber("test/data").unwrap();
    let mut publisher = hub.publisher(DATA, "body").unwrap();
    let mut held = Vec::new();
    for number in 1..=50 {
        publisher.publish(Mark::new(number), at(number));
        held.push(tap.next_encoded().unwrap());
    }
    let expected: Vec<_> = (1..=50).map(bytes_of).collect();
    assert_eq!(held.iter().map(|encoded| encoded.bytes().to_vec()).collect::<Vec<_>>(), expected);
    let alone: Vec<_> = held.into_iter().map(narukom::EncodedMessage::into_shared).collect();
    (51..=100).for_each(|number| publisher.publish(Mark::new(number), at(number)));
    while tap.next_encoded().is_some_and(|encoded| !encoded.bytes().is_empty()) {}
    assert_eq!(alone.iter().map(|encoding| encoding.as_ref().to_vec()).collect::<Vec<_>>(), expected);
}

#[test]
fn uncollected_events_are_bounded_and_counted() {
    let mut robot = hub().blackboard("robot");
    (0..narukom::EVENT_LIMIT + 3).for_each(|number| robot.raise(&format!("event_{number}")));
    assert_eq!(robot.events_lost(), 3);
    let events = robot.take_events();
    assert_eq!((events.len(), events[0].as_str()), (narukom::EVENT_LIMIT, "event_3"));
}
