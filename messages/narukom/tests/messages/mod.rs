//! Messages, topics and hubs of the tests.
#![allow(dead_code, unreachable_pub)]

use narukom::{
    AnyMessage, Blackboard, Data, FieldDescriptor, FieldError, FieldKind, FieldValue, Hub, Message,
    MessageDescriptor, Reflect, RemoteHeader, Signal, State, Timestamp, Topic, topic,
};

/// A message with a number and a string.
#[derive(Clone, PartialEq, narukom::prost::Message)]
#[prost(prost_path = "narukom::prost")]
pub struct Mark {
    #[prost(uint64, tag = "1")]
    pub number: u64,
    #[prost(string, tag = "2")]
    pub text: String,
}

/// Another type of message.
#[derive(Clone, PartialEq, narukom::prost::Message)]
#[prost(prost_path = "narukom::prost")]
pub struct Other {}

impl Mark {
    pub fn new(number: u64) -> Mark {
        Mark { number, text: String::new() }
    }
}

static MARK: MessageDescriptor = MessageDescriptor {
    full_name: "narukom.test.Mark",
    name: "Mark",
    fields: &[
        FieldDescriptor { name: "number", tag: 1, kind: FieldKind::U64 },
        FieldDescriptor { name: "text", tag: 2, kind: FieldKind::Text },
    ],
    file_descriptor_set: b"mark",
};

static OTHER: MessageDescriptor = MessageDescriptor {
    full_name: "narukom.test.Other",
    name: "Other",
    fields: &[],
    file_descriptor_set: b"other",
};

impl Reflect for Mark {
    fn descriptor(&self) -> &'static MessageDescriptor {
        &MARK
    }

    fn field(&self, index: usize) -> FieldValue<'_> {
        match index {
            0 => FieldValue::Uint(self.number),
            1 => FieldValue::Text(&self.text),
            _ => FieldValue::Missing,
        }
    }

    fn set_field(&mut self, index: usize, value: FieldValue<'_>) -> Result<(), FieldError> {
        match (index, value) {
            (0, FieldValue::Uint(value)) => self.number = value,
            (1, FieldValue::Text(value)) => self.text = value.to_owned(),
            _ => return Err(FieldError::NoSuchField),
        }
        Ok(())
    }

    fn message_mut(&mut self, _index: usize) -> Option<&mut dyn AnyMessage> {
        None
    }
}

impl Reflect for Other {
    fn descriptor(&self) -> &'static MessageDescriptor {
        &OTHER
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

impl Message for Mark {
    const DESCRIPTOR: &'static MessageDescriptor = &MARK;
}

impl Message for Other {
    const DESCRIPTOR: &'static MessageDescriptor = &OTHER;
}

topic! {
    /// A state.
    pub STATE: State<Mark> = "test/state";
    /// A signal.
    pub SIGNAL: Signal<Mark> = "test/signal";
    /// A history of four.
    pub DATA: Data<Mark, 4> = "test/data";
    /// A history of four, of the last 50 milliseconds.
    pub AGED: Data<Mark, 4, 50> = "test/aged";
    /// A topic of another type.
    pub ELSE: State<Other> = "other/state";
}

/// A topic that no hub here declares.
pub const UNKNOWN: Topic<State<Mark>> = Topic::new("test/stat");

/// A hub with the topics above.
pub fn hub() -> Hub {
    Hub::with_linked_topics("robot").unwrap()
}

/// The time `millis` milliseconds after the start.
pub fn at(millis: u64) -> Timestamp {
    Timestamp::from_nanos(millis * 1_000_000)
}

/// The header of a message with no latency: the same time by all clocks.
pub fn arrival(sequence: u64, moment: Timestamp) -> RemoteHeader {
    RemoteHeader { sequence, published: moment, local: moment, received: moment }
}

/// Publishes a state, a signal and a data message with the number, in one cycle.
pub fn publish_everywhere(blackboard: &mut Blackboard, number: u64, now: Timestamp) {
    blackboard.publish(STATE, Mark::new(number)).unwrap();
    blackboard.publish(SIGNAL, Mark::new(number)).unwrap();
    blackboard.publish(DATA, Mark::new(number)).unwrap();
    blackboard.publish_all(now);
}

/// The numbers on a blackboard of each topic: state, signals, data.
pub fn numbers(blackboard: &Blackboard) -> (Option<u64>, Vec<u64>, Vec<u64>) {
    let state = blackboard.read(STATE).map(|mark| mark.number);
    let signals = blackboard.signals(SIGNAL).map(|mark| mark.number).collect();
    let age = std::time::Duration::from_secs(3600);
    let data = blackboard.recent(DATA, age).map(|mark| mark.number).collect();
    (state, signals, data)
}
