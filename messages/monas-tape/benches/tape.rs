//! Cost and throughput of recording: `cargo bench -p monas-tape`.
//!
//! Machines are shared and differ: all contestants of a table take turns in one run of several
//! rounds, and the table shows the median over the rounds, with the smallest and the largest.
//! `monas tape replay` prints the speed of replay at its end.
#![allow(clippy::disallowed_methods, reason = "a benchmark reads the clock")]
#![allow(clippy::unwrap_used, reason = "a benchmark that cannot go on stops")]

#[path = "../tests/tape/ball.rs"]
mod ball;

use std::hint::black_box;
use std::io::{self, Write};
use std::time::Instant;

use ball::{Ball, SEEN, hub};
use monas_tape::{Decoder, Recording, Tape};
use narukom::{
    AnyMessage, Data, FieldDescriptor, FieldError, FieldKind, FieldValue, Hub, Message, MessageDescriptor,
    Reflect, Timestamp, topic,
};
use rustix::time::{ClockId, clock_gettime};

/// A large message, such as a picture.
#[derive(Clone, PartialEq, narukom::prost::Message)]
#[prost(prost_path = "narukom::prost")]
struct Picture {
    #[prost(bytes = "vec", tag = "1")]
    pixels: Vec<u8>,
}

static PICTURE: MessageDescriptor = MessageDescriptor {
    full_name: "tape.bench.Picture",
    name: "Picture",
    fields: &[FieldDescriptor { name: "pixels", tag: 1, kind: FieldKind::Bytes }],
    file_descriptor_set: b"",
};

impl Reflect for Picture {
    fn descriptor(&self) -> &'static MessageDescriptor {
        &PICTURE
    }

    fn field(&self, _index: usize) -> FieldValue<'_> {
        FieldValue::Bytes(&self.pixels)
    }

    fn set_field(&mut self, _index: usize, _value: FieldValue<'_>) -> Result<(), FieldError> {
        Err(FieldError::NoSuchField)
    }

    fn message_mut(&mut self, _index: usize) -> Option<&mut dyn AnyMessage> {
        None
    }
}

impl Message for Picture {
    const DESCRIPTOR: &'static MessageDescriptor = &PICTURE;
}

topic! {
    /// A camera image.
    CAMERA: Data<Picture, 4> = "bench/camera";
}

/// Rounds per contestant.
const ROUNDS: usize = 7;
/// Small messages per round; they fit into the tape's queue, so that no publisher waits for the
/// disk.
const SMALL_MESSAGES: u64 = 50_000;
/// Bytes of large messages per round.
const LARGE_BYTES: usize = 512 << 20;

fn main() {
    let rounds = if std::env::args().any(|argument| argument == "--bench") { ROUNDS } else { 1 };
    println!("processor time of the publisher, ns a message of 200 bytes; median (least to most)");
    let [alone, observed, recorded] = costs(rounds);
    print_row("published, no observer", &alone);
    print_row("published, an idle observer", &observed);
    print_row("published, a tape records", &recorded);
    println!("  the tape takes {:.0} ns\n", median(&recorded) - median(&alone));

    println!("to a file, MB/s of messages until the last is written; median (least to most)");
    for size in [200, 64 << 10, 1 << 20] {
        let total = if size == 200 { LARGE_BYTES / 8 } else { LARGE_BYTES };
        let rates: Vec<f64> =
            (0..rounds).map(|_| throughput(size, total / if rounds == 1 { 64 } else { 1 })).collect();
        print_row(&format!("{size} bytes each"), &rates);
    }

    println!("\nreading, messages of 9 bytes a microsecond; median (least to most)");
    let bytes = small_tape();
    let recording = Recording::from_bytes(bytes);
    let read = |act: &dyn Fn(&Recording) -> u64| -> Vec<f64> {
        let rate = |_| {
            let begun = Instant::now();
            let count = act(&recording);
            count as f64 / begun.elapsed().as_secs_f64() / 1e6
        };
        (0..rounds).map(rate).collect()
    };
    print_row(
        "found",
        &read(&|recording| recording.messages().unwrap().filter(|one| black_box(one).is_ok()).count() as u64),
    );
    print_row("taken apart", &read(&taken_apart));
}

fn taken_apart(recording: &Recording) -> u64 {
    let mut decoder = Decoder::new();
    let messages = recording.messages().unwrap().map(Result::unwrap);
    messages.filter(|one| decoder.decode(&one.channel, one.bytes).is_ok()).count() as u64
}

fn costs(rounds: usize) -> [Vec<f64>; 3] {
    let mut costs = [const { Vec::new() }; 3];
    for _ in 0..rounds {
        let alone = hub("robot");
        costs[0].push(cost(&alone));
        let observed = hub("robot");
        observed.observe(Box::new(|_: narukom::Publication<'_>| {}));
        costs[1].push(cost(&observed));
        let recorded = hub("robot");
        let tape = Tape::to_writer(io::sink()).unwrap();
        recorded.observe(Box::new(tape.clone()));
        costs[2].push(cost(&recorded));
        tape.finish().unwrap();
    }
    costs
}

/// The publisher's cost of a message, in addition to creating it.
fn cost(hub: &Hub) -> f64 {
    let mut publisher = hub.publisher(CAMERA, "camera").unwrap();
    let publish = |publisher: &mut narukom::Publisher<Picture>, count: u64| {
        for number in 0..count {
            publisher.publish_with(|picture| picture.pixels.resize(200, 1), Timestamp::from_nanos(number));
        }
    };
    publish(&mut publisher, 1_000);
    let begun = processor_time();
    publish(&mut publisher, SMALL_MESSAGES);
    (processor_time() - begun) / SMALL_MESSAGES as f64 * 1e9
}

/// The processor time of this thread, in seconds.
fn processor_time() -> f64 {
    let time = clock_gettime(ClockId::ThreadCPUTime);
    time.tv_sec as f64 + time.tv_nsec as f64 / 1e9
}

/// Throughput to a file, in megabytes per second of messages of one size.
fn throughput(size: usize, total: usize) -> f64 {
    let folder = tempfile::tempdir().unwrap();
    let hub = hub("robot");
    let tape = Tape::create(folder.path().join("bench.mcap")).unwrap();
    hub.observe(Box::new(tape.clone()));
    let mut publisher = hub.publisher(CAMERA, "camera").unwrap();
    let begun = Instant::now();
    let count = total / size;
    for number in 0..count as u64 {
        publisher
            .publish_with(|picture| picture.pixels.resize(size, 1), Timestamp::from_nanos(number * 1_000));
    }
    assert_eq!(tape.finish().unwrap(), count as u64);
    (count * size) as f64 / begun.elapsed().as_secs_f64() / 1e6
}

/// A tape of small messages with a schema.
fn small_tape() -> Vec<u8> {
    let memory = ball::Shared::default();
    let tape = Tape::to_writer(memory.clone()).unwrap();
    let hub = hub("robot");
    hub.observe(Box::new(tape.clone()));
    let mut publisher = hub.publisher(SEEN, "vision").unwrap();
    for number in 0..200_000 {
        publisher.publish(Ball { distance: number as f64 }, Timestamp::from_nanos(number * 1_000_000));
    }
    tape.finish().unwrap();
    memory.bytes()
}

fn median(figures: &[f64]) -> f64 {
    let mut sorted = figures.to_vec();
    sorted.sort_by(f64::total_cmp);
    sorted[sorted.len() / 2]
}

fn print_row(what: &str, figures: &[f64]) {
    let min = figures.iter().copied().fold(f64::INFINITY, f64::min);
    let max = figures.iter().copied().fold(0.0, f64::max);
    println!("  {what:35} {:8.1} ({min:.1} to {max:.1})", median(figures));
    io::stdout().flush().unwrap();
}
