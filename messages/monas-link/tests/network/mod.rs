//! A network in simulated time that loses, delays, duplicates and reorders packets, and can be
//! partitioned.
#![allow(dead_code, unreachable_pub)]

use std::collections::BTreeMap;
use std::time::Duration;

use monas_link::{
    AccessList, LinkTopic, Node, NodeSettings, OutgoingPublication, Packet, ReceivedCounters,
    ReceivedMessage, Reliability, Schema,
};
use narukom::{Message, Random, RetentionKind, Timestamp};

/// Faults of the network.
#[derive(Clone, Copy, Debug)]
pub struct Faults {
    /// Probability that a packet is lost, per receiver.
    pub loss: f64,
    /// Probability that it is duplicated.
    pub double: f64,
    /// Maximum delay in milliseconds, from 1; packets with longer delays are overtaken.
    pub delay: u64,
}

pub const CALM: Faults = Faults { loss: 0.0, double: 0.0, delay: 1 };
pub const ROUGH: Faults = Faults { loss: 0.3, double: 0.1, delay: 40 };

/// Nodes and the network between them. Time advances in milliseconds.
pub struct Network {
    pub nodes: Vec<Node>,
    pub settings: Vec<NodeSettings>,
    /// Offset of each node's clock from simulation time.
    pub ahead: Vec<Duration>,
    /// Each node's clock advances in steps of this many milliseconds, as that of a simulated run
    /// does.
    pub grain: Vec<u64>,
    /// The partition of each node: nodes with equal numbers are connected.
    pub parts: Vec<u8>,
    pub faults: Faults,
    pub millis: u64,
    /// When each node sent, and how many bytes.
    pub log: Vec<Vec<(Timestamp, usize)>>,
    /// The messages delivered to each node.
    pub given: Vec<Vec<ReceivedMessage>>,
    flying: BTreeMap<(u64, u64), (usize, Packet)>,
    flown: u64,
    random: Random,
    /// The messages of each node on each topic, in its current incarnation.
    pub published: Vec<Vec<u64>>,
}

/// A topic of the tests.
pub fn topic(
    path: &str,
    kind: RetentionKind,
    depth: usize,
    reliability: Reliability,
    priority: u8,
) -> LinkTopic {
    let descriptor = monas_link::example::Ball::DESCRIPTOR;
    LinkTopic {
        path: path.into(),
        kind,
        depth,
        type_name: descriptor.full_name.into(),
        schema: Schema::of(descriptor),
        reliability,
        priority,
    }
}

/// The publisher of the message with this number, and its number for that publisher.
fn published_as(number: u64) -> (&'static str, u64) {
    (["left", "right"][(number % 2) as usize], number.div_ceil(2))
}

/// One of each retention kind, reliable and best-effort.
pub fn topics(depth: usize) -> Vec<LinkTopic> {
    use Reliability::{BestEffort, Reliable};
    vec![
        topic("test/state", RetentionKind::State, 8.min(depth), Reliable, 3),
        topic("test/signal", RetentionKind::Signal, depth, Reliable, 1),
        topic("test/data", RetentionKind::Data, depth, Reliable, 5),
        topic("loose/state", RetentionKind::State, 8.min(depth), BestEffort, 3),
        topic("loose/signal", RetentionKind::Signal, depth, BestEffort, 2),
    ]
}

/// Settings of a node that sends and receives all topics.
pub fn settings(host: &str, topics: Vec<LinkTopic>) -> NodeSettings {
    NodeSettings {
        host: host.into(),
        incarnation: 1,
        send: topics.clone(),
        receive: topics,
        access: AccessList::open(),
        accepts_unlinked: false,
        budget: None,
        beat: Duration::from_millis(200),
    }
}

impl Network {
    pub fn new(settings: Vec<NodeSettings>, faults: Faults, seed: u8) -> Network {
        let count = settings.len();
        Network {
            nodes: settings.iter().map(|one| Node::new(one.clone()).unwrap()).collect(),
            ahead: vec![Duration::ZERO; count],
            grain: vec![1; count],
            parts: vec![0; count],
            faults,
            millis: 0,
            log: vec![Vec::new(); count],
            given: vec![Vec::new(); count],
            flying: BTreeMap::new(),
            flown: 0,
            random: Random::from_seed([seed; 32]),
            published: settings.iter().map(|one| vec![0; one.send.len()]).collect(),
            settings,
        }
    }

    /// `count` hosts with all topics: `a`, `b`, ...
    pub fn of(count: usize, depth: usize, faults: Faults, seed: u8) -> Network {
        let names = ["a", "b", "c", "d"];
        Network::new(names[..count].iter().map(|name| settings(name, topics(depth))).collect(), faults, seed)
    }

    pub fn now(&self, node: usize) -> Timestamp {
        let shown = self.millis.next_multiple_of(self.grain[node]);
        Timestamp::ZERO + Duration::from_millis(shown) + self.ahead[node]
    }

    /// Publishes the next message on a topic; it contains its number. Two publishers take turns.
    pub fn publish(&mut self, node: usize, topic: usize) {
        let number = &mut self.published[node][topic];
        *number += 1;
        let payload = number.to_le_bytes().to_vec().into();
        let (publisher, sequence) = published_as(*number);
        let published = self.now(node);
        self.nodes[node].publish(topic, OutgoingPublication { publisher, sequence, published, payload });
    }

    /// Kills a node and restarts it without its earlier state.
    pub fn restart(&mut self, node: usize) {
        self.settings[node].incarnation += 1;
        self.nodes[node] = Node::new(self.settings[node].clone()).unwrap();
        self.published[node].fill(0);
        self.given[node].clear();
    }

    pub fn run(&mut self, millis: u64) {
        for _ in 0..millis {
            self.millis += 1;
            self.carry();
            for node in 0..self.nodes.len() {
                self.send(node);
            }
        }
    }

    fn carry(&mut self) {
        while let Some(entry) = self.flying.first_entry().filter(|entry| entry.key().0 <= self.millis) {
            let (to, packet) = entry.remove();
            let now = self.now(to);
            self.nodes[to].handle(&packet, now);
            self.fetch(to);
        }
    }

    pub fn fetch(&mut self, node: usize) {
        while let Some(delivery) = self.nodes[node].next_delivery() {
            self.given[node].push(delivery);
        }
    }

    fn send(&mut self, node: usize) {
        let now = self.now(node);
        while let Some(packet) = self.nodes[node].poll(now) {
            self.log[node].push((now, packet.stamp.len() + packet.payload.len()));
            for to in 0..self.nodes.len() {
                let is_meant = packet.to.as_ref().is_none_or(|name| *name == *self.nodes[to].host());
                if to != node && is_meant && self.parts[to] == self.parts[node] {
                    self.fly(to, &packet);
                }
            }
        }
    }

    fn fly(&mut self, to: usize, packet: &Packet) {
        if self.random.chance(self.faults.loss) {
            return;
        }
        let copies = 1 + u64::from(self.random.chance(self.faults.double));
        for _ in 0..copies {
            self.flown += 1;
            let arrival = self.millis + 1 + self.random.below(self.faults.delay);
            self.flying.insert((arrival, self.flown), (to, packet.clone()));
        }
    }

    /// The numbers of the messages of a host's topic delivered to a node.
    pub fn numbers(&self, node: usize, host: &str, topic: usize) -> Vec<u64> {
        let given = self.given[node].iter().filter(|one| *one.host == *host && one.topic == topic);
        given.map(|one| u64::from_le_bytes(one.payload[..8].try_into().unwrap())).collect()
    }

    /// Fails if a message delivered to a node is not the one that its publisher published with that
    /// number.
    pub fn check_publishers(&self, node: usize, host: &str, topic: usize) {
        for one in self.given[node].iter().filter(|one| *one.host == *host && one.topic == topic) {
            let number = u64::from_le_bytes(one.payload[..8].try_into().unwrap());
            assert_eq!((one.publisher.as_str(), one.sequence), published_as(number));
        }
    }

    /// A node's counters for a topic of a host.
    pub fn received(&self, node: usize, host: &str, path: &str) -> ReceivedCounters {
        let all = self.nodes[node].counters().received;
        all.iter().find(|one| one.0 == host && one.1 == path).map(|one| one.2).unwrap_or_default()
    }

    /// Fails if the counters of any node do not add up.
    pub fn check_counters(&self) {
        for node in &self.nodes {
            let counters = node.counters();
            for (path, sent) in &counters.sent {
                assert_eq!(
                    sent.taken,
                    sent.sent + sent.dropped + sent.oversize + sent.waiting,
                    "{path}: {sent:?}"
                );
            }
            for (host, path, got) in &counters.received {
                let seen = got.delivered + got.duplicates + got.late + got.refused + got.held;
                assert_eq!(got.arrived, seen, "{path} of {host}: {got:?}");
                let said = got.delivered + got.gaps + got.held + got.missing;
                assert_eq!(got.last - got.start, said, "{path} of {host}: {got:?}");
            }
        }
    }
}
