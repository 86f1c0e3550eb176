//! Whoever sends what: nothing panics, nothing grows, and figures add up.
#![allow(clippy::unwrap_used, reason = "a test that cannot go on fails")]

mod network;

use std::sync::Arc;

use monas_link::Packet;
use narukom::Moment;
use network::*;
use proptest::prelude::*;

fn packet(from: &str, path: Option<&str>, stamp: &[u8], payload: &[u8]) -> Packet {
    Packet {
        from: from.into(),
        to: None,
        path: path.map(Arc::from),
        stamp: stamp.into(),
        payload: payload.into(),
        priority: 4,
        is_reliable: true,
    }
}

/// What two honest links have said to each other.
fn said() -> Vec<Packet> {
    let mut network = Network::of(2, 64, CALM, 3);
    let mut said = Vec::new();
    for millis in 0..900_u64 {
        network.millis = millis;
        (0..ALL).filter(|_| millis % 100 == 0).for_each(|topic| network.publish(0, topic));
        for node in 0..2 {
            let now = network.now(node);
            while let Some(packet) = network.nodes[node].poll(now) {
                let now = network.now(1 - node);
                // One in three is lost, so that there are repairs.
                if said.len() % 3 != 2 {
                    network.nodes[1 - node].handle(&packet, now);
                }
                said.push(packet);
            }
        }
    }
    said
}

const ALL: usize = 5;

proptest! {
    #![proptest_config(ProptestConfig { cases: 100, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn no_bytes_do_harm(
        packets in proptest::collection::vec(
            (any::<bool>(), proptest::collection::vec(any::<u8>(), 0..40), proptest::collection::vec(any::<u8>(), 0..60)),
            1..30,
        ),
    ) {
        let mut network = Network::of(1, 64, CALM, 3);
        for (is_message, stamp, payload) in packets {
            network.nodes[0].handle(&packet("b", is_message.then_some("test/state"), &stamp, &payload), Moment::ZERO);
        }
        network.run(500);
        network.check_counters();
    }

    #[test]
    fn no_change_of_what_is_said_does_harm(
        edits in proptest::collection::vec((0_usize..10_000, 0_usize..200, any::<u8>()), 0..40),
        order in proptest::collection::vec(0_usize..10_000, 0..60),
    ) {
        let mut packets = said();
        let count = packets.len();
        for (which, place, value) in edits {
            let packet = &mut packets[which % count];
            let part = if place % 2 == 0 { &mut packet.stamp } else { &mut packet.payload };
            let mut bytes = part.to_vec();
            if let Some(byte) = bytes.get_mut(place / 2) {
                *byte = value;
            }
            *part = bytes.into();
        }
        let mut network = Network::of(2, 64, CALM, 4);
        for (step, which) in (0..count).chain(order.into_iter().map(|which| which % count)).enumerate() {
            for node in 0..2 {
                network.millis = step as u64;
                let now = network.now(node);
                network.nodes[node].handle(&packets[which], now);
                network.fetch(node);
            }
        }
        network.run(500);
        network.check_counters();
    }
}

#[test]
fn hosts_that_are_made_up_push_each_other_out() {
    let mut network = Network::of(1, 64, CALM, 3);
    let hello: Vec<Packet> = said().into_iter().filter(|packet| packet.path.is_none()).take(1).collect();
    for number in 0..10_000 {
        let packet = Packet { from: format!("host_{number}").into(), ..hello[0].clone() };
        network.nodes[0].handle(&packet, Moment::from_nanos(number));
    }
    assert_eq!(network.nodes[0].peers().count(), 64);
    network.run(500);
    assert!(network.log[0].iter().all(|(_, size)| *size <= 60 << 10));
    assert!(
        network.log[0].len() <= 50,
        "a Hello and a Beat in 25 ms answer them all: {}",
        network.log[0].len()
    );
}

#[test]
fn a_host_that_never_fills_a_gap_fills_no_memory() {
    let mut network = Network::of(2, 64, CALM, 3);
    network.run(500);
    let mut sent = Vec::new();
    for _ in 0..10_000 {
        network.publish(0, 1);
        let now = network.now(0);
        while let Some(packet) = network.nodes[0].poll(now) {
            sent.push(packet);
        }
    }
    // Every second one never comes.
    for packet in sent.iter().step_by(2) {
        let now = network.now(1);
        network.nodes[1].handle(packet, now);
        network.fetch(1);
        assert!(network.received(1, "a", "test/signal").held <= 1024);
    }
    network.check_counters();
    assert!(network.received(1, "a", "test/signal").gaps > 3000);
}

#[test]
fn links_of_another_version_are_told_apart() {
    let mut network = Network::of(1, 64, CALM, 3);
    // Field 1, the version, is 2.
    network.nodes[0].handle(&packet("b", None, &[], &[0x08, 0x02]), Moment::ZERO);
    assert_eq!(network.nodes[0].counters().foreign, 1);
    let mismatches = network.nodes[0].mismatches();
    assert_eq!(mismatches[0].host, "b");
    assert_eq!(mismatches[0].text, "speaks version 2 of the protocol, and this link version 1");
    assert_eq!(network.nodes[0].peers().count(), 0);
}
