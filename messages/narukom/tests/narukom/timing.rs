//! Random publishers, hosts, delays and readers: every read by time must agree with a naive model,
//! and so must the counts of losses.
//!
//! The model keeps every message that ever arrived, sorts and scans. Histories with and without an
//! age limit are compared, of this host and of two others whose messages arrive late and out of
//! order.
#![allow(clippy::unwrap_used, clippy::panic, reason = "a test that cannot go on fails")]

use std::time::Duration;

use crate::messages::*;
use narukom::{
    AnyMessage as _, Blackboard, HostId, Hub, Publisher, Receiver, RemoteHeader, Sample, Timestamp,
};
use proptest::prelude::*;

const READERS: usize = 2;
const HOSTS: usize = 3;
/// The depth of both topics.
const DEPTH: usize = 4;
/// The age limit of one of them, in milliseconds.
const AGE: u64 = 50;

#[derive(Clone, Copy, Debug)]
enum Step {
    /// Host, whether on the topic with an age limit, and how many milliseconds ago.
    Publish(usize, bool, u64),
    Process(usize),
    /// Reader, host, whether the topic with an age limit, and how many milliseconds ago.
    Read(usize, usize, bool, u64),
    /// Time passes.
    Advance(u64),
}

fn step() -> impl Strategy<Value = Step> {
    prop_oneof![
        6 => (0..HOSTS, any::<bool>(), 0..40_u64).prop_map(|(host, aged, ago)| Step::Publish(host, aged, ago)),
        3 => (0..READERS).prop_map(Step::Process),
        4 => (0..READERS, 0..HOSTS, any::<bool>(), 0..120_u64)
            .prop_map(|(reader, host, aged, ago)| Step::Read(reader, host, aged, ago)),
        3 => (0..20_u64).prop_map(Step::Advance),
    ]
}

/// A message that arrived: when it was published, and its number.
type Arrival = (u64, u64);

/// One topic of one host as seen by a reader of the model.
#[derive(Clone, Default)]
struct TopicState {
    cursor: usize,
    items: Vec<Arrival>,
    lost: u64,
}

#[derive(Default)]
struct Model {
    /// By host and topic, in order of arrival.
    came: [[Vec<Arrival>; 2]; HOSTS],
    states: [[[TopicState; 2]; HOSTS]; READERS],
    /// The time of each reader's cycle.
    now: [u64; READERS],
}

impl Model {
    fn process(&mut self, reader: usize, now: u64) {
        self.now[reader] = now;
        for (states, came) in self.states[reader].iter_mut().zip(&self.came) {
            for (state, came) in states.iter_mut().zip(came) {
                let held = came.len().saturating_sub(DEPTH).max(state.cursor);
                state.lost += (held - state.cursor) as u64;
                for message in &came[held..] {
                    state.items.push(*message);
                    state.items.sort_by_key(|(published, _)| *published);
                    let surplus = state.items.len().saturating_sub(DEPTH);
                    state.items.drain(..surplus);
                }
                state.cursor = came.len();
            }
        }
    }

    /// The messages that a reader sees, oldest first.
    fn visible(&self, reader: usize, host: usize, aged: bool) -> Vec<Arrival> {
        let now = self.now[reader];
        let is_fresh = |published: u64| !aged || now.saturating_sub(published) <= AGE;
        let items = self.states[reader][host][usize::from(aged)].items.iter();
        items.copied().filter(|(published, _)| is_fresh(*published)).collect()
    }
}

/// The results of all reads by time for one time.
#[derive(PartialEq, Debug)]
struct TimedReads {
    all: Vec<u64>,
    newest: Option<u64>,
    not_newer: Option<u64>,
    not_older: Option<u64>,
    nearest: Option<u64>,
    around: Option<(u64, u64, f64)>,
    recent: Vec<u64>,
    lost: u64,
}

fn expected(model: &Model, (reader, host, aged): (usize, usize, bool), moment: u64, age: u64) -> TimedReads {
    let items = model.visible(reader, host, aged);
    let number = |came: Option<&Arrival>| came.map(|(_, number)| *number);
    let before = items.iter().rev().find(|(published, _)| *published <= moment);
    let after = items.iter().find(|(published, _)| *published >= moment);
    let later = items.iter().find(|(published, _)| *published > moment);
    let nearest = match (before, later) {
        (Some(before), Some(later)) if moment - before.0 > later.0 - moment => Some(later),
        (before, later) => before.or(later),
    };
    let share = |from: u64, to: u64| {
        if from == to { 0.0 } else { ((moment - from) * 1_000_000) as f64 / ((to - from) * 1_000_000) as f64 }
    };
    let around = match (before, later) {
        (Some(before), _) if before.0 == moment => Some((before.1, before.1, 0.0)),
        (Some(before), Some(later)) => Some((before.1, later.1, share(before.0, later.0))),
        _ => None,
    };
    let oldest = model.now[reader].saturating_sub(age);
    TimedReads {
        all: items.iter().map(|(_, number)| *number).collect(),
        newest: number(items.last()),
        not_newer: number(before),
        not_older: number(after),
        nearest: number(nearest),
        around,
        recent: items
            .iter()
            .filter(|(published, _)| *published >= oldest)
            .map(|(_, number)| *number)
            .collect(),
        lost: model.states[reader][host][usize::from(aged)].lost,
    }
}

fn looked<K>(
    reader: &Blackboard,
    host: HostId,
    topic: narukom::Topic<K>,
    moment: Timestamp,
    age: Duration,
) -> TimedReads
where
    K: narukom::Timed<Message = Mark>,
{
    let view = reader.from(host);
    let number = |mark: Option<Sample<'_, Mark>>| mark.map(|mark| mark.number);
    let numbers = |age| view.recent(topic, age).map(|mark| mark.number).collect();
    TimedReads {
        all: numbers(Duration::MAX),
        newest: view.read(topic).map(|mark| mark.number),
        not_newer: number(view.nearest_not_newer(topic, moment)),
        not_older: number(view.nearest_not_older(topic, moment)),
        nearest: number(view.nearest(topic, moment)),
        around: view.around(topic, moment).map(|two| (two.before.number, two.after.number, two.share)),
        recent: numbers(age),
        lost: view.lost(topic),
    }
}

/// The real hub and the model, in lockstep.
struct Comparison {
    hub: Hub,
    own: [Publisher<Mark>; 2],
    others: Vec<[Receiver; 2]>,
    readers: Vec<Blackboard>,
    model: Model,
    now: u64,
    number: u64,
}

impl Comparison {
    fn new() -> Comparison {
        let hub = hub();
        let own = [hub.publisher(DATA, "body").unwrap(), hub.publisher(AGED, "body").unwrap()];
        let others = ["left", "right"]
            .map(|host| ["test/data", "test/aged"].map(|path| hub.receiver(host, "vision", path).unwrap()));
        let readers: Vec<_> = (0..READERS).map(|_| hub.blackboard("reader")).collect();
        let mut comparison = Comparison {
            own,
            others: others.into(),
            readers,
            model: Model::default(),
            now: 1000,
            number: 0,
            hub,
        };
        // All readers read everything from the start; late first reads are covered by another test.
        for reader in 0..READERS {
            comparison.take(Step::Process(reader));
            (0..HOSTS).for_each(|host| {
                [false, true].iter().for_each(|aged| comparison.read(reader, host, *aged, 0))
            });
        }
        comparison
    }

    fn host(&self, host: usize) -> HostId {
        if host == 0 { HostId::LOCAL } else { self.others[host - 1][0].host() }
    }

    fn publish(&mut self, host: usize, aged: bool, ago: u64) {
        self.number += 1;
        let (message, topic) = (Mark::new(self.number), usize::from(aged));
        let published = self.now - ago;
        if host == 0 {
            self.own[topic].publish(message, at(published));
        } else {
            let come = RemoteHeader {
                sequence: self.number,
                published: Timestamp::from_nanos(self.number),
                local: at(published),
                received: at(self.now),
            };
            let mut bytes = Vec::new();
            message.encode_to(&mut bytes);
            self.others[host - 1][topic].receive_bytes(&bytes, come).unwrap();
        }
        self.model.came[host][topic].push((published, self.number));
    }

    fn read(&mut self, reader: usize, host: usize, aged: bool, ago: u64) {
        let moment = self.now - ago;
        let (id, board, age) = (self.host(host), &self.readers[reader], Duration::from_millis(ago));
        let real = if aged {
            looked(board, id, AGED, at(moment), age)
        } else {
            looked(board, id, DATA, at(moment), age)
        };
        assert_eq!(real, expected(&self.model, (reader, host, aged), moment, ago), "{reader} {host} {aged}");
    }

    fn take(&mut self, step: Step) {
        match step {
            Step::Publish(host, aged, ago) => self.publish(host, aged, ago),
            Step::Process(reader) => {
                self.readers[reader].process_messages(at(self.now));
                self.model.process(reader, self.now);
            }
            Step::Read(reader, host, aged, ago) => self.read(reader, host, aged, ago),
            Step::Advance(millis) => self.now += millis,
        }
    }
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 300, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn reads_by_time_equal_the_model(steps in prop::collection::vec(step(), 1..150)) {
        let mut comparison = Comparison::new();
        steps.iter().for_each(|step| comparison.take(*step));
        assert_eq!(comparison.hub.hosts().len(), HOSTS);
    }
}
