//! A network in simulated time that loses, delays, doubles and overtakes, and can fall apart.
#![allow(dead_code, unreachable_pub)]

use std::collections::BTreeMap;
use std::time::Duration;

use monas_link::{
    AccessList, Delivery, LinkTopic, Node, NodeSettings, Packet, Publication, Received, Reliability, Schema,
};
use narukom::{Kind, Message, Moment, Random};

/// What happens to packets.
#[derive(Clone, Copy, Debug)]
pub struct Faults {
    /// How likely a packet is lost, for each who should get it.
    pub loss: f64,
    /// How likely it comes twice.
    pub double: f64,
    /// It takes from 1 to so many milliseconds; longer ones are overtaken.
    pub delay: u64,
}

pub const CALM: Faults = Faults { loss: 0.0, double: 0.0, delay: 1 };
pub const ROUGH: Faults = Faults { loss: 0.3, double: 0.1, delay: 40 };

/// Nodes and what is between them. Time goes in milliseconds.
pub struct Network {
    pub nodes: Vec<Node>,
    pub settings: Vec<NodeSettings>,
    /// By how much each node's clock is ahead of the world's.
    pub ahead: Vec<Duration>,
    /// Each node's clock jumps to the next multiple of so many milliseconds, as that of a simulated run does.
    pub grain: Vec<u64>,
    /// Who hears whom: nodes with equal numbers.
    pub parts: Vec<u8>,
    pub faults: Faults,
    pub millis: u64,
    /// When each node sent, and how many bytes.
    pub log: Vec<Vec<(Moment, usize)>>,
    /// What each node was given.
    pub given: Vec<Vec<Delivery>>,
    flying: BTreeMap<(u64, u64), (usize, Packet)>,
    flown: u64,
    random: Random,
    /// What was published by each node on each topic, in its present life.
    pub published: Vec<Vec<u64>>,
}

/// A topic of the tests.
pub fn topic(path: &str, kind: Kind, depth: usize, reliability: Reliability, priority: u8) -> LinkTopic {
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

/// Who publishes the message of this number, and which of its own it is.
fn published_as(number: u64) -> (&'static str, u64) {
    (["left", "right"][(number % 2) as usize], number.div_ceil(2))
}

/// One of each kind, reliable and not.
pub fn topics(depth: usize) -> Vec<LinkTopic> {
    use Reliability::{BestEffort, Reliable};
    vec![
        topic("test/state", Kind::State, 8.min(depth), Reliable, 3),
        topic("test/signal", Kind::Signal, depth, Reliable, 1),
        topic("test/data", Kind::Data, depth, Reliable, 5),
        topic("loose/state", Kind::State, 8.min(depth), BestEffort, 3),
        topic("loose/signal", Kind::Signal, depth, BestEffort, 2),
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
        guests: false,
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

    /// So many hosts with all topics: `a`, `b`, ...
    pub fn of(count: usize, depth: usize, faults: Faults, seed: u8) -> Network {
        let names = ["a", "b", "c", "d"];
        Network::new(names[..count].iter().map(|name| settings(name, topics(depth))).collect(), faults, seed)
    }

    pub fn now(&self, node: usize) -> Moment {
        let shown = self.millis.next_multiple_of(self.grain[node]);
        Moment::ZERO + Duration::from_millis(shown) + self.ahead[node]
    }

    /// Publishes the next message on a topic; it carries its number. Two publishers take turns.
    pub fn publish(&mut self, node: usize, topic: usize) {
        let number = &mut self.published[node][topic];
        *number += 1;
        let payload = number.to_le_bytes().to_vec().into();
        let (publisher, sequence) = published_as(*number);
        let published = self.now(node);
        self.nodes[node].publish(topic, Publication { publisher, sequence, published, payload });
    }

    /// Kills a node and starts it anew: it knows nothing of its earlier life.
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

    /// The numbers that a node was given of a topic of a host.
    pub fn numbers(&self, node: usize, host: &str, topic: usize) -> Vec<u64> {
        let given = self.given[node].iter().filter(|one| *one.host == *host && one.topic == topic);
        given.map(|one| u64::from_le_bytes(one.payload[..8].try_into().unwrap())).collect()
    }

    /// Fails if a message that a node was given is not the one that its publisher published with that number of its own.
    pub fn check_publishers(&self, node: usize, host: &str, topic: usize) {
        for one in self.given[node].iter().filter(|one| *one.host == *host && one.topic == topic) {
            let number = u64::from_le_bytes(one.payload[..8].try_into().unwrap());
            assert_eq!((one.publisher.as_str(), one.sequence), published_as(number));
        }
    }

    /// What a node has counted of a topic of a host.
    pub fn received(&self, node: usize, host: &str, path: &str) -> Received {
        let all = self.nodes[node].counters().received;
        all.iter().find(|one| one.0 == host && one.1 == path).map(|one| one.2).unwrap_or_default()
    }

    /// Fails if a figure of any node does not add up.
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
