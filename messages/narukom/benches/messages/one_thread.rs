//! Publishing and reading in one thread.

use std::hint::black_box;
use std::sync::Arc;
use std::sync::mpsc;

use arc_swap::ArcSwap;
use narukom::Timestamp;
use narukom::prost::Message as _;
use tokio::sync::broadcast;

use crate::messages::{HISTORY, JOINTS, Joints, Small, hub};
use crate::table::{Contestant, Selection, nanos_each, run};

/// A message of 200 bytes is published and read.
pub(crate) fn publish_and_read(selection: &Selection) {
    let title = "One thread, ns to publish and read a message of 200 bytes";
    let contestants: Vec<Contestant<'_>> = vec![
        ("narukom, publisher to blackboard", publisher_to_blackboard()),
        ("narukom, blackboard to blackboard", blackboard_to_blackboard()),
        ("narukom, own message, a whole cycle", own_cycle()),
        ("tokio broadcast", tokio_broadcast()),
        ("crossbeam-channel", crossbeam()),
        ("std mpsc", std_mpsc()),
        ("arc-swap", arc_swapped()),
        ("prost, encode and decode", encoded()),
    ];
    run(selection, title, &["ns"], contestants);
}

type Round = Box<dyn FnMut() -> Vec<f64>>;

/// A round: `pass` receives the number of the message, and returns a number from the message that
/// was read.
fn round(mut pass: impl FnMut(u32) -> f64 + 'static) -> Round {
    let mut number = 0;
    Box::new(move || {
        let each = nanos_each(|| {
            number += 1;
            let read = pass(number);
            assert!(black_box(read) == f64::from(number), "{read} is not {number}");
        });
        vec![each]
    })
}

fn publisher_to_blackboard() -> Round {
    let hub = hub(0);
    let (mut publisher, mut reader) = (hub.publisher(JOINTS, "body").unwrap(), hub.blackboard("reader"));
    round(move |number| {
        let now = Timestamp::from_nanos(u64::from(number));
        publisher.publish(black_box(Joints::new(number)), now);
        reader.process_messages(now);
        reader.read(JOINTS).map_or(0.0, |joints| joints.a.a)
    })
}

fn blackboard_to_blackboard() -> Round {
    let hub = hub(0);
    let (mut writer, mut reader) = (hub.blackboard("writer"), hub.blackboard("reader"));
    round(move |number| {
        let now = Timestamp::from_nanos(u64::from(number));
        writer.process_messages(now);
        writer.publish(JOINTS, black_box(Joints::new(number))).unwrap();
        writer.publish_all(now);
        reader.process_messages(now);
        reader.read(JOINTS).map_or(0.0, |joints| joints.a.a)
    })
}

fn own_cycle() -> Round {
    let mut robot = hub(0).blackboard("robot");
    round(move |number| {
        let now = Timestamp::from_nanos(u64::from(number));
        robot.process_messages(now);
        robot.publish(JOINTS, black_box(Joints::new(number))).unwrap();
        let read = robot.read(JOINTS).map_or(0.0, |joints| joints.a.a);
        robot.publish_all(now);
        read
    })
}

fn tokio_broadcast() -> Round {
    let (sender, mut receiver) = broadcast::channel(8);
    round(move |number| {
        sender.send(black_box(Joints::new(number))).unwrap();
        receiver.try_recv().map_or(0.0, |joints| joints.a.a)
    })
}

fn crossbeam() -> Round {
    let (sender, receiver) = crossbeam_channel::bounded(8);
    round(move |number| {
        sender.send(black_box(Joints::new(number))).unwrap();
        receiver.try_recv().map_or(0.0, |joints| joints.a.a)
    })
}

fn std_mpsc() -> Round {
    let (sender, receiver) = mpsc::sync_channel(8);
    round(move |number| {
        sender.send(black_box(Joints::new(number))).unwrap();
        receiver.try_recv().map_or(0.0, |joints| joints.a.a)
    })
}

fn arc_swapped() -> Round {
    let latest = ArcSwap::from_pointee(Joints::new(0));
    round(move |number| {
        latest.store(Arc::new(black_box(Joints::new(number))));
        latest.load().a.a
    })
}

fn encoded() -> Round {
    let mut bytes = Vec::new();
    round(move |number| {
        bytes.clear();
        let _ = black_box(Joints::new(number)).encode(&mut bytes);
        Joints::decode(&*bytes).map_or(0.0, |joints| joints.a.a)
    })
}

/// A message is looked up by time in a history of 256.
pub(crate) fn nearest(selection: &Selection) {
    let hub = hub(0);
    let (mut publisher, mut reader) = (hub.publisher(HISTORY, "body").unwrap(), hub.blackboard("reader"));
    (1..=256).for_each(|n| {
        publisher.publish(Small { sent: n, ..Small::default() }, Timestamp::from_nanos(n * 1000))
    });
    reader.process_messages(Timestamp::from_nanos(256_000));
    // Times in random order, to defeat branch prediction.
    let mut random = 1_u64;
    let mut moment = move || {
        random = random.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        Timestamp::from_nanos((random >> 33) % 256_000)
    };
    let mut chance = moment;
    let contestants: Vec<Contestant<'_>> = vec![
        (
            "nearest",
            Box::new(|| {
                vec![nanos_each(|| {
                    let found = reader.nearest(HISTORY, moment());
                    assert!(black_box(found).is_some());
                })]
            }),
        ),
        (
            "the moment alone",
            Box::new(move || {
                vec![nanos_each(|| {
                    black_box(chance());
                })]
            }),
        ),
    ];
    run(selection, "History of 256, ns to find the message nearest to a moment", &["ns"], contestants);
}

/// A cycle among many idle topics.
pub(crate) fn idle_topics(selection: &Selection) {
    let cycle = |idle: usize| {
        let hub = hub(idle);
        let (mut publisher, mut reader) = (hub.publisher(JOINTS, "body").unwrap(), hub.blackboard("reader"));
        reader.subscribe("**").unwrap();
        round(move |number| {
            let now = Timestamp::from_nanos(u64::from(number));
            publisher.publish(black_box(Joints::new(number)), now);
            reader.process_messages(now);
            let read = reader.read(JOINTS).map_or(0.0, |joints| joints.a.a);
            reader.publish_all(now);
            read
        })
    };
    let contestants: Vec<Contestant<'_>> =
        vec![("no other topic", cycle(0)), ("10,000 idle topics, all subscribed to", cycle(10_000))];
    run(selection, "Idle topics, ns for a cycle with one message", &["ns"], contestants);
}
