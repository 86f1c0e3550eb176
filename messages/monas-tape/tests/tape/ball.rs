//! A message with its schema, topics, and a run to record.
#![allow(dead_code, unreachable_pub)]

use std::io::{self, Write};
use std::sync::{Arc, Mutex};

use monas_tape::Tape;
use narukom::{
    AnyMessage, Data, FieldDescriptor, FieldError, FieldKind, FieldValue, Hub, Message, MessageDescriptor,
    Reflect, State, Timestamp, topic,
};

/// Position of a ball.
#[derive(Clone, Copy, PartialEq, narukom::prost::Message)]
#[prost(prost_path = "narukom::prost")]
pub struct Ball {
    #[prost(double, tag = "1")]
    pub distance: f64,
}

/// `package tape.test; message Ball { double distance = 1; }` as a serialised descriptor set.
pub const SCHEMA: &[u8] =
    b"\x0a9\x0a\x0aball.proto\x12\x09tape.test\x22\x18\x0a\x04Ball\x12\x10\x0a\x08distance\x18\x01 \x01(\x01b\x06proto3";

static BALL: MessageDescriptor = MessageDescriptor {
    full_name: "tape.test.Ball",
    name: "Ball",
    fields: &[FieldDescriptor { name: "distance", tag: 1, kind: FieldKind::F64 }],
    file_descriptor_set: SCHEMA,
};

impl Reflect for Ball {
    fn descriptor(&self) -> &'static MessageDescriptor {
        &BALL
    }

    fn field(&self, _index: usize) -> FieldValue<'_> {
        FieldValue::Float(self.distance)
    }

    fn set_field(&mut self, _index: usize, _value: FieldValue<'_>) -> Result<(), FieldError> {
        Err(FieldError::NoSuchField)
    }

    fn message_mut(&mut self, _index: usize) -> Option<&mut dyn AnyMessage> {
        None
    }
}

impl Message for Ball {
    const DESCRIPTOR: &'static MessageDescriptor = &BALL;
}

topic! {
    /// The ball.
    pub SEEN: State<Ball> = "soccer/ball";
    /// Each sighting of the ball.
    pub SIGHTING: Data<Ball, 4> = "soccer/sighting";
}

/// The time `millis` milliseconds after the start.
pub fn at(millis: u64) -> Timestamp {
    Timestamp::from_nanos(millis * 1_000_000)
}

/// A hub with the topics above.
pub fn hub(host: &str) -> Hub {
    Hub::with_linked_topics(host).unwrap()
}

/// A buffer that can be read while it is being written.
#[derive(Clone, Default)]
pub struct Shared(Arc<Mutex<Vec<u8>>>);

impl Shared {
    pub fn bytes(&self) -> Vec<u8> {
        self.0.lock().unwrap().clone()
    }
}

impl Write for Shared {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        self.0.lock().unwrap().write(bytes)
    }

    fn flush(&mut self) -> io::Result<()> {
        Ok(())
    }
}

/// Publishes a ball every 100 ms on two hosts, by two publishers.
pub fn play(hubs: &[Hub], count: u64) {
    let mut agents: Vec<_> = hubs.iter().map(|hub| hub.blackboard("vision")).collect();
    let mut bodies: Vec<_> = hubs.iter().map(|hub| hub.publisher(SEEN, "body").unwrap()).collect();
    for number in 1..=count {
        for (agent, body) in agents.iter_mut().zip(&mut bodies) {
            let ball = Ball { distance: number as f64 };
            agent.publish(SEEN, ball).unwrap();
            agent.publish(SIGHTING, ball).unwrap();
            agent.publish_all(at(100 * number));
            body.publish(ball, at(100 * number + 50));
        }
    }
}

/// A finished recording of such a run.
pub fn recorded(count: u64) -> Vec<u8> {
    let output = Shared::default();
    let tape = Tape::to_writer(output.clone()).unwrap();
    let hubs = [hub("robot_1"), hub("robot_2")];
    hubs.iter().for_each(|hub| hub.observe(Box::new(tape.clone())));
    play(&hubs, count);
    assert_eq!(tape.finish().unwrap(), count * 6);
    output.bytes()
}
