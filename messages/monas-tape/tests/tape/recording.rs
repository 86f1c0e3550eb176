//! Published messages are read back.

use std::collections::BTreeMap;
use std::io::{self, Write};

use crate::ball::*;
use monas_tape::{Channel, Decoder, ErrorKind, Recording, Tape, Value, read};
use narukom::prost::Message as _;

/// Host, publisher, topic, sequence, milliseconds and distance of a message.
type Line = (String, String, String, u32, u64, f64);

fn lines(recording: &Recording) -> Vec<Line> {
    let messages = recording.messages().unwrap().map(|message| message.unwrap());
    messages
        .map(|message| {
            let channel = message.channel;
            let millis = message.published.as_nanos() / 1_000_000;
            let ball = Ball::decode(message.bytes).unwrap();
            let (host, publisher, topic) = (&channel.host, &channel.publisher, &channel.topic);
            (host.clone(), publisher.clone(), topic.clone(), message.sequence, millis, ball.distance)
        })
        .collect()
}

fn line(host: &str, publisher: &str, topic: &str, sequence: u32, millis: u64) -> Line {
    (host.into(), publisher.into(), topic.into(), sequence, millis, f64::from(sequence))
}

#[test]
fn every_message_is_read_in_order_of_publication() {
    let recording = Recording::from_bytes(recorded(2));
    let mut expected = Vec::new();
    for number in 1..=2 {
        for host in ["robot_1", "robot_2"] {
            let millis = 100 * u64::from(number);
            expected.push(line(host, "vision", "soccer/ball", number, millis));
            expected.push(line(host, "vision", "soccer/sighting", number, millis));
            expected.push(line(host, "body", "soccer/ball", number, millis + 50));
        }
    }
    assert_eq!(lines(&recording), expected);
    assert!(recording.is_finished());
}

#[test]
fn channels_carry_kind_and_schema() {
    let recording = Recording::from_bytes(recorded(1));
    let messages: Vec<_> = recording.messages().unwrap().map(|message| message.unwrap()).collect();
    let kinds: Vec<_> = messages.iter().map(|message| &*message.channel.kind).collect();
    assert_eq!(kinds[..3], ["state", "data", "state"]);
    for message in &messages {
        assert_eq!(message.channel.message_type(), "tape.test.Ball");
        assert_eq!(message.channel.schema.data, SCHEMA);
        assert_eq!(message.received, message.published);
    }
}

/// The schema of the tests describes the message.
#[test]
fn the_schema_describes_the_ball() {
    let set = prost_types::FileDescriptorSet::decode(SCHEMA).unwrap();
    assert_eq!(set.encode_to_vec(), SCHEMA);
    let file = &set.file[0];
    assert_eq!((file.package(), file.message_type[0].name()), ("tape.test", "Ball"));
    assert_eq!(file.message_type[0].field[0].name(), "distance");
}

#[test]
fn two_recordings_of_one_run_are_equal() {
    assert!(recorded(30) == recorded(30));
    assert!(recorded(30) != recorded(31));
}

#[test]
fn a_file_is_written_and_read() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("run.mcap");
    let tape = Tape::create(&path).unwrap();
    let hub = hub("robot");
    hub.observe(Box::new(tape.clone()));
    play(std::slice::from_ref(&hub), 3);
    assert_eq!(tape.finish().unwrap(), 9);
    assert_eq!(lines(&read(&path).unwrap()).len(), 9);
}

#[test]
fn files_that_cannot_be_opened_are_named() {
    let error = read("/nowhere/run.mcap").unwrap_err();
    assert_eq!((error.kind(), error.to_string().contains("/nowhere/run.mcap")), (ErrorKind::File, true));
    let error = Tape::create("/nowhere/run.mcap").unwrap_err();
    assert_eq!((error.kind(), error.to_string().contains("/nowhere/run.mcap")), (ErrorKind::File, true));
}

#[test]
fn facts_and_files_are_part_of_the_tape() {
    let output = Shared::default();
    let tape = Tape::to_writer(output.clone()).unwrap();
    tape.describe("run", &BTreeMap::from([("seed".to_owned(), "7".to_owned())])).unwrap();
    tape.attach("match.xml", "text/xml", b"<match/>").unwrap();
    tape.finish().unwrap();
    let bytes = output.bytes();
    let summary = mcap::Summary::read(&bytes).unwrap().unwrap();
    let facts = mcap::read::metadata(&bytes, &summary.metadata_indexes[0]).unwrap();
    assert_eq!((&*facts.name, &*facts.metadata["seed"]), ("run", "7"));
    let file = mcap::read::attachment(&bytes, &summary.attachment_indexes[0]).unwrap();
    assert_eq!((&*file.name, &*file.media_type, &*file.data), ("match.xml", "text/xml", &b"<match/>"[..]));
}

#[test]
fn a_finished_tape_takes_nothing() {
    let output = Shared::default();
    let tape = Tape::to_writer(output.clone()).unwrap();
    let hub = hub("robot");
    hub.observe(Box::new(tape.clone()));
    tape.finish().unwrap();
    let bytes = output.bytes();
    play(&[hub], 3);
    assert_eq!(output.bytes(), bytes);
    assert_eq!(tape.finish().unwrap_err().kind(), ErrorKind::Finished);
    assert_eq!(tape.attach("a", "b", b"").unwrap_err().kind(), ErrorKind::Finished);
}

/// Accepts a number of bytes, then fails: a full disk.
struct Full(usize);

impl Write for Full {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        self.0 = self.0.checked_sub(bytes.len()).ok_or(io::ErrorKind::StorageFull)?;
        Ok(bytes.len())
    }

    fn flush(&mut self) -> io::Result<()> {
        Ok(())
    }
}

#[test]
fn a_full_disk_stops_the_recording_and_not_the_run() {
    let tape = Tape::to_writer(Full(2000)).unwrap();
    let hub = hub("robot");
    hub.observe(Box::new(tape.clone()));
    play(std::slice::from_ref(&hub), 100);
    assert_eq!(hub.subscriber("soccer/ball").unwrap().next_sample().unwrap().header.sequence, 100);
    let error = tape.finish().unwrap_err();
    assert_eq!(error.kind(), ErrorKind::File);
}

#[test]
fn a_crash_handler_has_the_chunk_closed() {
    let (sender, written) = std::sync::mpsc::channel();
    let tape = Tape::to_writer(ChannelWriter(sender)).unwrap();
    let hub = hub("robot");
    hub.observe(Box::new(tape.clone()));
    hub.publisher(SEEN, "vision").unwrap().publish(Ball { distance: 1.25 }, at(0));
    let flush = tape.crash_flush();
    assert!(!flush.is_done());
    flush.request();
    await_ball(&written, 1.25);
    while !flush.is_done() {
        std::hint::spin_loop();
    }
}

#[test]
fn what_comes_from_other_hosts_is_recorded_too() {
    let output = Shared::default();
    let tape = Tape::to_writer(output.clone()).unwrap();
    let here = hub("here");
    here.observe(Box::new(tape.clone()));
    let mut receiver = here.receiver("there", "vision", "soccer/ball").unwrap();
    let arrival = narukom::RemoteHeader { sequence: 5, published: at(900), local: at(90), received: at(100) };
    receiver.receive(Box::new(Ball { distance: 2.0 }), arrival).unwrap();
    here.publisher(SEEN, "vision").unwrap().publish(Ball { distance: 3.0 }, at(110));
    tape.finish().unwrap();
    let recording = Recording::from_bytes(output.bytes());
    let messages: Vec<_> = recording.messages().unwrap().map(|message| message.unwrap()).collect();
    let [received, own] = &messages[..] else { panic!("two messages: {messages:?}") };
    assert_eq!((&*received.channel.host, received.channel.received_by.as_deref()), ("there", Some("here")));
    assert_eq!((received.sequence, received.published, received.received), (5, at(90), at(100)));
    assert_eq!((&*own.channel.host, own.channel.received_by.as_deref(), own.sequence), ("here", None, 1));
}

#[test]
fn parts_of_one_publisher_are_distinguished() {
    let output = Shared::default();
    let tape = Tape::to_writer(output.clone()).unwrap();
    let hub = hub("robot");
    hub.observe(Box::new(tape.clone()));
    let mut first = hub.publisher(SEEN, "vision").unwrap();
    let mut third = hub.publisher(SEEN, "vision").unwrap().of_part(2);
    first.publish(Ball { distance: 1.0 }, at(10));
    third.publish(Ball { distance: 2.0 }, at(20));
    first.publish(Ball { distance: 3.0 }, at(30));
    tape.finish().unwrap();
    let recording = Recording::from_bytes(output.bytes());
    let messages: Vec<_> = recording.messages().unwrap().map(|message| message.unwrap()).collect();
    let said = messages.iter().map(|message| {
        let Channel { publisher, part, .. } = &*message.channel;
        (publisher.as_str(), *part, message.sequence)
    });
    assert_eq!(said.collect::<Vec<_>>(), [("vision", 0, 1), ("vision", 2, 2), ("vision", 0, 3)]);
}

#[test]
fn an_overview_counts() {
    let overview = Recording::from_bytes(recorded(10)).overview().unwrap();
    assert!(overview.is_finished && overview.damages.is_empty());
    assert_eq!((overview.messages(), overview.span), (60, Some((at(100), at(1050)))));
    let first = &overview.channels[0];
    let Channel { host, topic, publisher, .. } = &*first.channel;
    assert_eq!((&**host, &**topic, &**publisher), ("robot_1", "soccer/ball", "body"));
    assert_eq!((first.messages, first.bytes, first.first_sequence), (10, 90, 1));
    assert_eq!(first.frequency(), Some(10.0));
}

#[test]
fn messages_are_taken_apart_by_the_schema_in_the_tape() {
    let recording = Recording::from_bytes(recorded(1));
    let message = recording.messages().unwrap().next().unwrap().unwrap();
    let mut decoder = Decoder::new();
    let value = decoder.decode(&message.channel, message.bytes).unwrap();
    assert_eq!(value, Value::Fields(vec![("distance".into(), Value::Float(1.0))]));
    let other = decoder.decode(&message.channel, &Ball { distance: 2.5 }.encode_to_vec()).unwrap();
    let differences = value.differences(&other);
    let [difference] = &differences[..] else { panic!("one: {differences:?}") };
    assert_eq!(difference.path, "distance");
    assert_eq!((difference.first, difference.second), (Some(&Value::Float(1.0)), Some(&Value::Float(2.5))));
    assert_eq!(value.differences(&value), []);
    let error = decoder.decode(&message.channel, b"\x09\x00").unwrap_err();
    assert_eq!(error.kind(), ErrorKind::Opaque);
}

/// Blocks until it is released.
struct Held(std::sync::mpsc::Receiver<()>, bool);

impl Write for Held {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        // Once the sender is dropped, it no longer blocks.
        self.1 = self.1 || self.0.recv().is_err();
        Ok(bytes.len())
    }

    fn flush(&mut self) -> io::Result<()> {
        Ok(())
    }
}

#[test]
fn in_real_time_a_slow_disk_delays_no_publisher_and_losses_are_counted() {
    let (hold, held) = std::sync::mpsc::channel();
    // The magic number and the header; then no more.
    (0..64).for_each(|_| hold.send(()).unwrap());
    let tape = Tape::to_writer_real_time(Held(held, false)).unwrap();
    let hub = hub("robot");
    hub.observe(Box::new(tape.clone()));
    let mut publisher = hub.publisher(SEEN, "vision").unwrap();
    let published = 400_000;
    for number in 0..published {
        publisher.publish(Ball::default(), at(10 * number));
    }
    let dropped = tape.dropped();
    assert!(dropped > 0, "the queue has an end");
    drop(hold);
    assert_eq!(tape.finish().unwrap() + dropped, published);
}

/// Forwards what is written to a channel.
struct ChannelWriter(std::sync::mpsc::Sender<Vec<u8>>);

impl Write for ChannelWriter {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        // The receiver may be gone when the tape ends.
        let _ = self.0.send(bytes.to_vec());
        Ok(bytes.len())
    }

    fn flush(&mut self) -> io::Result<()> {
        Ok(())
    }
}

/// Waits until a ball at that distance has been written.
fn await_ball(written: &std::sync::mpsc::Receiver<Vec<u8>>, distance: f64) {
    let (mut all, ball) = (Vec::new(), Ball { distance }.encode_to_vec());
    while !all.windows(ball.len()).any(|part| part == ball) {
        all.extend(written.recv_timeout(std::time::Duration::from_secs(20)).unwrap());
    }
}

#[test]
fn data_older_than_a_second_is_flushed() {
    // By the time of the run, only a message a second later ends a chunk.
    let (sender, written) = std::sync::mpsc::channel();
    let tape = Tape::to_writer(ChannelWriter(sender)).unwrap();
    let simulated = hub("robot");
    simulated.observe(Box::new(tape.clone()));
    let mut publisher = simulated.publisher(SEEN, "vision").unwrap();
    publisher.publish(Ball { distance: 1.25 }, at(0));
    publisher.publish(Ball { distance: 2.5 }, at(1000));
    await_ball(&written, 1.25);

    // In real time no message need follow.
    let (sender, written) = std::sync::mpsc::channel();
    let tape = Tape::to_writer_real_time(ChannelWriter(sender)).unwrap();
    let real = hub("robot");
    real.observe(Box::new(tape.clone()));
    real.publisher(SEEN, "vision").unwrap().publish(Ball { distance: 1.25 }, at(0));
    await_ball(&written, 1.25);
}
