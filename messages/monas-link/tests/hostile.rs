//! Arbitrary input: nothing panics, memory is bounded, and counters add up.
#![allow(clippy::unwrap_used, reason = "a test that cannot go on fails")]

mod network;

use std::sync::Arc;

use monas_link::Packet;
use narukom::Timestamp;
use network::*;
use proptest::prelude::*;

fn packet(from: &str, path: Option<&str>, stamp: &[u8], payload: &[u8]) -> Packet {
    Packet {
        from: from.into(),
        to: None,
        path: path.map(Arc::from),
        stamp: stamp.into(),
        payload: payload.to_vec().into(),
        priority: 4,
        is_reliable: true,
    }
}

/// The packets that two honest links have exchanged.
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
                // One in three is lost, so that there are retransmissions.
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
            network.nodes[0].handle(&packet("b", is_message.then_some("test/state"), &stamp, &payload), Timestamp::ZERO);
        }
        network.run(500);
        network.check_counters();
    }

    #[test]
    fn corrupted_packets_do_no_harm(
        edits in proptest::collection::vec((0_usize..10_000, 0_usize..200, any::<u8>()), 0..40),
        order in proptest::collection::vec(0_usize..10_000, 0..60),
    ) {
        let mut packets = said();
        let count = packets.len();
        for (which, index, value) in edits {
            let packet = &mut packets[which % count];
            let mut parts = [packet.stamp.to_vec(), packet.payload.to_vec()];
            if let Some(byte) = parts[index % 2].get_mut(index / 2) {
                *byte = value;
            }
            let [stamp, payload] = parts;
            (packet.stamp, packet.payload) = (stamp.into(), payload.into());
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
        network.nodes[0].handle(&packet, Timestamp::from_nanos(number));
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
    // Every second one never arrives.
    for packet in sent.iter().step_by(2) {
        let now = network.now(1);
        network.nodes[1].handle(packet, now);
        network.fetch(1);
        assert!(network.received(1, "a", "test/signal").held <= 1024);
    }
    network.check_counters();
    assert!(network.received(1, "a", "test/signal").gaps > 3000);
}

/// The stamp of a message of a link's first incarnation.
fn stamp(offer: u8, number: u8) -> Vec<u8> {
    let incarnation = 1_u64.to_le_bytes();
    [&[0x09][..], &incarnation, &[0x10, offer, 0x18, number]].concat()
}

#[test]
fn many_hosts_that_fill_no_gaps_fill_no_memory() {
    let mut network = Network::of(1, 64, CALM, 3);
    let hello = said().into_iter().find(|packet| packet.path.is_none()).unwrap();
    for host in 0..30 {
        let name = format!("host_{host}");
        network.nodes[0].handle(&Packet { from: name.as_str().into(), ..hello.clone() }, Timestamp::ZERO);
        for number in 2..5 {
            let message = packet(&name, Some("test/signal"), &stamp(1, number), &[0; 1 << 20]);
            network.nodes[0].handle(&message, Timestamp::ZERO);
            network.fetch(0);
        }
    }
    let held: u64 = network.nodes[0].counters().received.iter().map(|one| one.2.held).sum();
    assert!((48..=64).contains(&held), "{held} MiB");
    network.check_counters();
}

#[test]
fn lengths_that_cannot_be_are_malformed() {
    let mut network = Network::of(1, 64, CALM, 3);
    let endless = [0x1a, 0xff, 0xff, 0xff, 0xff, 0x0f];
    let long = "x".repeat(200);
    for bad in [
        packet("b", None, &[], &endless),
        packet("b", None, &[], &[0; (60 << 10) + 1]),
        packet("b", Some("test/signal"), &endless, &[]),
        packet("b", Some("test/signal"), &stamp(1, 0), &[]),
        packet(&long, None, &[], &[]),
        packet("", None, &[], &[]),
    ] {
        network.nodes[0].handle(&bad, Timestamp::ZERO);
    }
    assert_eq!(network.nodes[0].counters().malformed, 6);
    assert_eq!(network.nodes[0].peers().count(), 0);
}

#[test]
fn links_of_another_version_are_detected() {
    let mut network = Network::of(1, 64, CALM, 3);
    // Field 1, the version, is 2.
    network.nodes[0].handle(&packet("b", None, &[], &[0x08, 0x02]), Timestamp::ZERO);
    assert_eq!(network.nodes[0].counters().foreign, 1);
    let mismatches = network.nodes[0].mismatches();
    assert_eq!(mismatches[0].host, "b");
    assert_eq!(mismatches[0].text, "speaks version 2 of the protocol, and this link version 1");
    assert_eq!(network.nodes[0].peers().count(), 0);
}
