//! The guarantees of the protocol, on random networks in simulated time.
#![allow(clippy::unwrap_used, reason = "a test that cannot go on fails")]

mod network;

use std::time::Duration;

use monas_link::SendBudget;
use narukom::Timestamp;
use network::*;
use proptest::prelude::*;

const STATE: usize = 0;
const LOOSE_STATE: usize = 3;
const RELIABLE: [usize; 3] = [0, 1, 2];
const ALL: usize = 5;

/// An event in a network.
#[derive(Clone, Copy, Debug)]
enum Turn {
    Publish {
        node: usize,
        topic: usize,
        count: u8,
    },
    Wait(u64),
    /// The node is disconnected.
    Part(usize),
    Heal,
    Restart(usize),
}

fn turns(nodes: usize) -> impl Strategy<Value = Vec<Turn>> {
    let publish =
        (0..nodes, 0..ALL, 1_u8..20).prop_map(|(node, topic, count)| Turn::Publish { node, topic, count });
    let turn = prop_oneof![
        8 => publish,
        6 => (1_u64..400).prop_map(Turn::Wait),
        1 => (0..nodes).prop_map(Turn::Part),
        1 => Just(Turn::Heal),
        1 => (0..nodes).prop_map(Turn::Restart),
    ];
    proptest::collection::vec(turn, 1..40)
}

fn play(network: &mut Network, turns: &[Turn]) {
    for turn in turns {
        match *turn {
            Turn::Publish { node, topic, count } => (0..count).for_each(|_| network.publish(node, topic)),
            Turn::Wait(millis) => network.run(millis),
            Turn::Part(node) => network.parts[node] = 1 + node as u8,
            Turn::Heal => network.parts.fill(0),
            Turn::Restart(node) => {
                network.restart(node);
                // Messages delivered to others belong to another incarnation.
                let name = network.nodes[node].host().clone();
                network.run(200);
                network.given.iter_mut().for_each(|given| given.retain(|one| one.host != name));
            }
        }
        network.check_counters();
    }
}

/// Restores the network, and waits for as long as the protocol guarantees.
fn heal(network: &mut Network) {
    network.parts.fill(0);
    network.faults = CALM;
    network.run(2 * 200 + 4 * 40 + 4);
}

/// Waits until no node takes an earlier incarnation of a host for the current one, which a late
/// Hello may cause.
fn outlive_what_is_late(network: &mut Network) {
    network.run(3 * 200 + 2 * 200);
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 60, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn everything_adds_up_and_states_are_equal(turns in turns(3), seed in any::<u8>()) {
        let mut network = Network::of(3, 64, ROUGH, seed);
        play(&mut network, &turns);
        heal(&mut network);
        if turns.iter().any(|turn| matches!(turn, Turn::Restart(_))) {
            outlive_what_is_late(&mut network);
        }
        network.check_counters();
        for reader in 0..3 {
            for sender in (0..3).filter(|sender| *sender != reader) {
                let host = ["a", "b", "c"][sender];
                for topic in [STATE, LOOSE_STATE] {
                    let published = network.published[sender][topic];
                    let read = network.numbers(reader, host, topic).last().copied();
                    prop_assert!(published == 0 || read == Some(published), "{read:?} of {published} of {host}");
                }
                for topic in RELIABLE {
                    let path = &network.settings[sender].send[topic].path;
                    let got = network.received(reader, host, path);
                    prop_assert_eq!((got.held, got.missing), (0, 0), "{} of {}: {:?}", path, host, got);
                }
            }
        }
    }

    #[test]
    fn no_message_is_duplicated_or_out_of_order(turns in turns(2), seed in any::<u8>()) {
        let turns: Vec<Turn> = turns.into_iter().filter(|turn| !matches!(turn, Turn::Restart(_))).collect();
        let mut network = Network::of(2, 64, ROUGH, seed);
        play(&mut network, &turns);
        heal(&mut network);
        for (reader, host) in [(0, "b"), (1, "a")] {
            for topic in 0..ALL {
                let numbers = network.numbers(reader, host, topic);
                prop_assert!(numbers.is_sorted_by(|one, next| one < next), "{numbers:?}");
                network.check_publishers(reader, host, topic);
                let got = network.received(reader, host, &network.settings[0].send[topic].path);
                prop_assert_eq!(got.delivered as usize, numbers.len());
            }
        }
    }

    #[test]
    fn no_window_is_over_budget(turns in turns(2), seed in any::<u8>(), packets in 4_u32..40) {
        let budget = SendBudget { packets, window: Duration::from_millis(1000), payload: 128 };
        let settings = ["a", "b"].map(|name| {
            let mut one = settings(name, topics(64));
            one.budget = Some(budget);
            one
        });
        // Including restarts: a process that was killed does not know what it had sent.
        let mut network = Network::new(settings.into(), ROUGH, seed);
        play(&mut network, &turns);
        network.run(3000);
        for log in &network.log {
            prop_assert!(log.iter().all(|(_, size)| *size <= budget.payload));
            for (first, (start, _)) in log.iter().enumerate() {
                let end = *start + budget.window;
                let inside = log[first..].iter().take_while(|(at, _)| *at <= end).count();
                prop_assert!(inside <= packets as usize, "{inside} packets from {start} on");
            }
        }
        network.check_counters();
    }
}

#[test]
fn retained_messages_arrive_completely_and_in_order() {
    let mut network = Network::of(2, 4096, CALM, 7);
    network.run(500);
    network.faults = ROUGH;
    for _ in 0..1000 {
        RELIABLE[1..].iter().for_each(|topic| network.publish(0, *topic));
        network.run(2);
    }
    heal(&mut network);
    for topic in [1, 2] {
        assert!(network.numbers(1, "a", topic).into_iter().eq(1..=1000), "topic {topic}");
    }
    let got = network.received(1, "a", "test/data");
    assert_eq!((got.delivered, got.gaps, got.missing), (1000, 0, 0));
    assert!(got.duplicates > 0, "the network doubles: {got:?}");
}

#[test]
fn a_partition_longer_than_what_is_kept_leaves_a_counted_gap() {
    let mut network = Network::of(2, 64, CALM, 7);
    network.run(500);
    network.publish(0, 1);
    network.run(10);
    network.parts[1] = 1;
    (0..100).for_each(|_| network.publish(0, 1));
    network.run(5000);
    heal(&mut network);
    let got = network.received(1, "a", "test/signal");
    assert_eq!((got.delivered, got.gaps, got.last), (1 + 64, 36, 101));
    assert_eq!(network.numbers(1, "a", 1)[1..], (38..=101).collect::<Vec<_>>());
}

#[test]
fn late_readers_get_the_state_and_no_signals() {
    let mut network = Network::of(2, 64, CALM, 7);
    network.parts[1] = 1;
    for topic in 0..ALL {
        (0..3).for_each(|_| network.publish(0, topic));
    }
    network.run(1000);
    heal(&mut network);
    let given: Vec<Vec<u64>> = (0..ALL).map(|topic| network.numbers(1, "a", topic)).collect();
    assert_eq!(given, [vec![3], vec![], vec![], vec![3], vec![]]);
    network.publish(0, 1);
    network.run(10);
    assert_eq!(network.numbers(1, "a", 1), [4]);
}

#[test]
fn a_killed_host_is_received_at_once_after_its_restart() {
    let mut network = Network::of(2, 64, CALM, 7);
    network.run(500);
    (0..5).for_each(|_| network.publish(0, 1));
    network.run(10);
    network.restart(0);
    network.run(5);
    (0..2).for_each(|_| network.publish(0, 1));
    network.run(10);
    assert_eq!(network.numbers(1, "a", 1), [1, 2, 3, 4, 5, 1, 2]);
    let got = network.received(1, "a", "test/signal");
    assert_eq!((got.delivered, got.gaps, got.start, got.last), (2, 0, 0, 2), "of its second life");
}

#[test]
fn urgent_topics_go_first_when_the_budget_is_short() {
    let budget = SendBudget { packets: 10, window: Duration::from_secs(1), payload: 128 };
    let mut settings = ["a", "b"].map(|name| settings(name, topics(64)));
    settings[0].budget = Some(budget);
    let mut network = Network::new(settings.into(), CALM, 7);
    network.run(3000);
    for topic in (0..ALL).rev() {
        (0..4).for_each(|_| network.publish(0, topic));
    }
    network.run(1500);
    // Signals (1, 2) have been sent, and the history (5) waits.
    assert_eq!(network.numbers(1, "a", 1), [1, 2, 3, 4]);
    assert!(network.numbers(1, "a", 2).len() < 4);
    assert!(network.nodes[0].counters().waits > 0);
    network.run(10_000);
    assert_eq!(network.numbers(1, "a", 2), [1, 2, 3, 4]);
}

#[test]
fn with_a_budget_states_are_equal_within_four_beats() {
    let budget = SendBudget { packets: 60, window: Duration::from_secs(1), payload: 512 };
    for phase in 0..20 {
        let mut network = Network::new(["a", "b"].map(|name| settings(name, topics(64))).into(), CALM, 7);
        network.settings.iter_mut().for_each(|one| one.budget = Some(budget));
        network.restart(0);
        network.run(1500);
        network.restart(1);
        network.run(1500 + 10 * phase);
        network.parts[1] = 1;
        // Of one incarnation or of the next, which the other side does not know yet.
        if phase % 2 == 0 {
            network.restart(0);
        }
        network.run(1100);
        (0..3).for_each(|_| [STATE, LOOSE_STATE].iter().for_each(|topic| network.publish(0, *topic)));
        network.run(100);
        network.parts.fill(0);
        network.run(4 * 200 + 4);
        for topic in [STATE, LOOSE_STATE] {
            assert_eq!(network.numbers(1, "a", topic).last(), Some(&3), "phase {phase}");
        }
    }
}

#[test]
fn a_link_with_a_budget_is_silent_in_its_first_window_and_reports_its_use() {
    let budget = SendBudget { packets: 4, window: Duration::from_secs(1), payload: 512 };
    let mut settings = ["a", "b"].map(|name| settings(name, topics(64)));
    settings[0].budget = Some(budget);
    let mut network = Network::new(settings.into(), CALM, 7);
    (0..10).for_each(|_| network.publish(0, 1));
    network.run(1000);
    assert_eq!(network.log[0].len(), 0);
    assert_eq!(network.nodes[0].counters().waits, 1);
    network.run(2);
    let spent = network.nodes[0].spent(network.now(0)).unwrap();
    assert_eq!((spent.packets, spent.budget), (4, budget));
    assert_eq!(spent.next, network.log[0][0].0 + budget.window + Duration::from_nanos(1));
    assert_eq!(network.nodes[1].spent(network.now(1)), None);
}

#[test]
fn messages_beyond_the_budget_are_counted_and_not_sent() {
    let budget = SendBudget { packets: 100, window: Duration::from_secs(1), payload: 128 };
    let mut one = settings("a", topics(64));
    one.budget = Some(budget);
    let mut network = Network::new(vec![one, settings("b", topics(64))], CALM, 7);
    let publication = monas_link::OutgoingPublication {
        publisher: "vision",
        sequence: 1,
        published: Timestamp::ZERO,
        payload: vec![0; 128].into(),
    };
    network.nodes[0].publish(1, publication);
    network.run(1000);
    let sent = network.nodes[0].counters().sent.into_iter().find(|one| one.0 == "test/signal").unwrap().1;
    assert_eq!((sent.taken, sent.oversize, sent.sent), (1, 1, 0));
}

#[test]
fn clocks_are_compared() {
    let mut network = Network::of(2, 64, Faults { delay: 5, ..CALM }, 7);
    network.ahead = vec![Duration::from_secs(1000), Duration::from_secs(7)];
    network.run(3000);
    let offset = network.nodes[1].clock_offset("a").unwrap();
    let error = (offset.ahead - 993_000_000_000).unsigned_abs();
    assert!(error <= offset.round_trip / 2, "{offset:?}");
    assert!(offset.round_trip <= 11_000_000, "{offset:?}");
    network.publish(0, 1);
    network.run(20);
    let given = network.given[1].last().unwrap();
    assert_eq!(given.published, Timestamp::from_secs_f64(1003.0));
    let error = given.local.distance(Timestamp::from_secs_f64(10.0));
    assert!(error <= Duration::from_millis(6), "{error:?}");
}

#[test]
fn the_clock_of_a_stepped_run_is_learned_at_any_phase_of_a_step() {
    for (grain, phase) in [10, 25].into_iter().flat_map(|grain| (0..grain).map(move |phase| (grain, phase))) {
        let mut network = Network::of(2, 64, CALM, 7);
        network.grain[0] = grain;
        network.ahead[0] = Duration::from_secs(60);
        network.run(1000 + phase);
        network.restart(1);
        network.run(3000);
        let offset = network.nodes[1].clock_offset("a");
        let offset =
            offset.unwrap_or_else(|| panic!("nothing is learned, {phase} ms into a step of {grain}"));
        let error = (offset.ahead - 60_000_000_000).unsigned_abs();
        assert!(
            error <= offset.round_trip / 2 + grain * 1_000_000,
            "{offset:?}, {phase} ms into a step of {grain}"
        );
        assert!(offset.round_trip <= 20_000_000, "{offset:?}, {phase} ms into a step of {grain}");
    }
}

#[test]
fn an_unknown_session_does_not_block_the_next() {
    let turns = [
        Turn::Publish { node: 0, topic: 0, count: 7 },
        Turn::Publish { node: 1, topic: 0, count: 8 },
        Turn::Wait(1),
        Turn::Restart(0),
    ];
    for seed in 0..=255 {
        let mut network = Network::of(3, 64, ROUGH, seed);
        play(&mut network, &turns);
        heal(&mut network);
        outlive_what_is_late(&mut network);
        for (reader, host, published) in [(0, "b", 8), (2, "b", 8)] {
            let read = network.numbers(reader, host, STATE).last().copied();
            assert_eq!(read, Some(published), "{host} by {reader}, seed {seed}");
        }
    }
}
