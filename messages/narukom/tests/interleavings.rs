//! Blackboards write, publish, process, read and take over values in random order, and must agree
//! with a naive model.
//!
//! The model keeps every message ever published, and computes from that what a blackboard shows.
#![allow(clippy::unwrap_used, clippy::panic, reason = "a test that cannot go on fails")]

mod messages;

use messages::*;
use narukom::{Blackboard, Hub, SIGNAL_DEPTH, STATE_DEPTH};
use proptest::prelude::*;

const BOARDS: usize = 3;

#[derive(Clone, Copy, PartialEq, Debug)]
enum Way {
    State,
    Signal,
    Data,
}

const WAYS: [Way; 3] = [Way::State, Way::Signal, Way::Data];

impl Way {
    /// The number of messages that the hub holds.
    fn depth(self) -> usize {
        match self {
            Way::State => STATE_DEPTH,
            Way::Signal => SIGNAL_DEPTH,
            Way::Data => 4,
        }
    }
}

#[derive(Clone, Copy, Debug)]
enum Step {
    Write(usize, usize),
    /// Writes and publishes that many messages in one cycle.
    Burst(usize, usize, usize),
    Publish(usize),
    Process(usize),
    Read(usize, usize),
    Adopt(usize, usize),
}

fn step() -> impl Strategy<Value = Step> {
    let board = 0..BOARDS;
    let way = 0..WAYS.len();
    prop_oneof![
        4 => (board.clone(), way.clone()).prop_map(|(board, way)| Step::Write(board, way)),
        1 => (board.clone(), way.clone(), 1..90_usize).prop_map(|(board, way, count)| Step::Burst(board, way, count)),
        3 => board.clone().prop_map(Step::Publish),
        3 => board.clone().prop_map(Step::Process),
        4 => (board.clone(), way).prop_map(|(board, way)| Step::Read(board, way)),
        1 => (board.clone(), board).prop_map(|(board, other)| Step::Adopt(board, other)),
    ]
}

/// A message that was published.
#[derive(Clone, Copy)]
struct Published {
    order: u64,
    board: usize,
    nth: u64,
    value: u64,
}

/// A message that a blackboard wrote and the hub has not delivered.
#[derive(Clone, Copy)]
struct Own {
    value: u64,
    nth: u64,
    sent: bool,
    hidden: bool,
}

/// One topic on a blackboard.
#[derive(Clone, Default)]
struct Shelf {
    attached: bool,
    cursor: usize,
    items: Vec<u64>,
    lost: u64,
    own: Vec<Own>,
    inherited: Vec<u64>,
    written: u64,
    seen: u64,
}

#[derive(Clone, Default)]
struct Board {
    since: u64,
    delivered: u64,
    shelves: [Shelf; 3],
    /// The retention kinds of the unpublished messages, in the order in which they were written.
    outbox: Vec<usize>,
}

#[derive(Default)]
struct Model {
    order: u64,
    logs: [Vec<Published>; 3],
    boards: [Board; BOARDS],
}

impl Shelf {
    fn visible_own(&self) -> impl Iterator<Item = u64> {
        let own = self.own.iter().filter(|own| !own.hidden).map(|own| own.value);
        self.inherited.iter().copied().chain(own)
    }

    fn accept(&mut self, way: Way, entry: Published, reader: usize) {
        match way {
            Way::State => self.items = vec![entry.value],
            Way::Signal if entry.board == reader && entry.nth <= self.seen => {}
            Way::Signal => self.items.push(entry.value),
            Way::Data => {
                self.items.push(entry.value);
                let surplus = self.items.len().saturating_sub(way.depth());
                self.items.drain(..surplus);
            }
        }
    }
}

impl Model {
    fn write(&mut self, board: usize, way: usize, value: u64) {
        let shelf = &mut self.boards[board].shelves[way];
        shelf.written += 1;
        shelf.own.push(Own { value, nth: shelf.written, sent: false, hidden: false });
        self.boards[board].outbox.push(way);
    }

    fn publish(&mut self, board: usize) {
        for way in std::mem::take(&mut self.boards[board].outbox) {
            let shelf = &mut self.boards[board].shelves[way];
            let own = shelf.own.iter_mut().find(|own| !own.sent).unwrap();
            own.sent = true;
            self.order += 1;
            self.logs[way].push(Published { order: self.order, board, nth: own.nth, value: own.value });
        }
        for (way, shelf) in WAYS.iter().zip(&mut self.boards[board].shelves) {
            let kept = if *way == Way::State { 1 } else { way.depth() };
            while shelf.own.len() > kept && shelf.own[0].sent {
                shelf.own.remove(0);
            }
        }
    }

    /// The messages of a topic that the hub still holds, and the index of the first.
    fn ring(&self, way: usize) -> (usize, &[Published]) {
        let first = self.logs[way].len().saturating_sub(WAYS[way].depth());
        (first, &self.logs[way][first..])
    }

    fn process(&mut self, board: usize) {
        for (way, kind) in WAYS.into_iter().enumerate() {
            let (first, ring) = self.ring(way);
            let ring = ring.to_vec();
            let shelf = &mut self.boards[board].shelves[way];
            shelf.own.retain(|own| !own.sent);
            shelf.inherited.clear();
            if kind == Way::Signal {
                shelf.items.clear();
            }
            if !shelf.attached {
                continue;
            }
            if kind != Way::State {
                shelf.lost += first.saturating_sub(shelf.cursor) as u64;
            }
            for entry in &ring[shelf.cursor.saturating_sub(first)..] {
                shelf.accept(kind, *entry, board);
            }
            shelf.cursor = first + ring.len();
        }
        let board = &mut self.boards[board];
        board.since = board.since.max(board.delivered);
        board.delivered = self.order;
    }

    fn attach(&mut self, board: usize, way: usize) {
        let (first, ring) = self.ring(way);
        let (ring, known) = (ring.to_vec(), self.boards[board].clone());
        let shelf = &mut self.boards[board].shelves[way];
        let begin = if WAYS[way] == Way::Signal { known.since } else { 0 };
        shelf.attached = true;
        shelf.lost = 0;
        shelf.items.clear();
        for entry in ring.iter().filter(|entry| entry.order > begin && entry.order <= known.delivered) {
            shelf.accept(WAYS[way], *entry, board);
        }
        // If the hub no longer holds the state of that time, begin with the oldest that it holds.
        let had_a_value = self.logs[way].first().is_some_and(|entry| entry.order <= known.delivered);
        let shelf = &mut self.boards[board].shelves[way];
        if WAYS[way] == Way::State && shelf.items.is_empty() && had_a_value {
            shelf.items = vec![ring[0].value];
        }
        let late = |entry: &Published| entry.order > known.delivered.max(begin);
        shelf.cursor = first + ring.iter().position(late).unwrap_or(ring.len());
    }

    fn read(&mut self, board: usize, way: usize) -> (Vec<u64>, u64) {
        if !self.boards[board].shelves[way].attached {
            self.attach(board, way);
        }
        let shelf = &mut self.boards[board].shelves[way];
        shelf.seen = shelf.written;
        let mut values = shelf.items.clone();
        values.extend(shelf.visible_own());
        let depth = match WAYS[way] {
            Way::State => 1,
            Way::Signal => usize::MAX,
            Way::Data => 4,
        };
        // Own messages are shown even when they exceed the depth.
        let own = shelf.visible_own().count().max(1);
        let shown = if WAYS[way] == Way::State { 1 } else { depth.max(own) };
        (values.split_off(values.len().saturating_sub(shown)), shelf.lost)
    }

    fn adopt(&mut self, board: usize, other: usize) {
        let other = self.boards[other].clone();
        self.boards[board].since = other.since;
        self.boards[board].delivered = other.delivered;
        for (way, theirs) in other.shelves.iter().enumerate() {
            let shelf = &mut self.boards[board].shelves[way];
            shelf.own.iter_mut().for_each(|own| own.hidden = true);
            shelf.inherited.clear();
            if WAYS[way] != Way::Signal {
                shelf.inherited.extend(theirs.visible_own());
            }
            if theirs.attached {
                (shelf.attached, shelf.cursor, shelf.lost) = (true, theirs.cursor, theirs.lost);
                shelf.items = theirs.items.clone();
            } else if shelf.attached {
                self.attach(board, way);
            }
        }
    }
}

/// The real blackboard: the values and the losses of a topic.
fn read(board: &Blackboard, way: usize) -> (Vec<u64>, u64) {
    match WAYS[way] {
        Way::State => (board.read(STATE).map(|mark| mark.number).into_iter().collect(), board.lost(STATE)),
        Way::Signal => (board.signals(SIGNAL).map(|mark| mark.number).collect(), board.lost(SIGNAL)),
        Way::Data => {
            let age = std::time::Duration::MAX;
            (board.recent(DATA, age).map(|mark| mark.number).collect(), board.lost(DATA))
        }
    }
}

fn write(board: &mut Blackboard, way: usize, value: u64) {
    let written = match WAYS[way] {
        Way::State => board.publish(STATE, Mark::new(value)),
        Way::Signal => board.publish(SIGNAL, Mark::new(value)),
        Way::Data => board.publish(DATA, Mark::new(value)),
    };
    written.unwrap();
}

/// The real blackboards and the model, step by step.
struct Comparison {
    boards: Vec<Blackboard>,
    model: Model,
    value: u64,
}

impl Comparison {
    fn new(hub: &Hub) -> Comparison {
        // Two of them publish under one name, as regions of a statechart do.
        let boards = ["chart", "chart", "other"].map(|name| hub.blackboard(name)).into();
        Comparison { boards, model: Model::default(), value: 0 }
    }

    fn write(&mut self, board: usize, way: usize) {
        self.value += 1;
        write(&mut self.boards[board], way, self.value);
        self.model.write(board, way, self.value);
    }

    fn publish(&mut self, board: usize, time: u64) {
        self.boards[board].publish_all(at(time));
        self.model.publish(board);
    }

    fn take(&mut self, step: Step, time: u64) {
        match step {
            Step::Write(board, way) => self.write(board, way),
            Step::Burst(board, way, count) => {
                (0..count).for_each(|_| self.write(board, way));
                self.publish(board, time);
            }
            Step::Publish(board) => self.publish(board, time),
            Step::Process(board) => {
                self.boards[board].process_messages(at(time));
                self.model.process(board);
            }
            Step::Read(board, way) => {
                assert_eq!(
                    read(&self.boards[board], way),
                    self.model.read(board, way),
                    "{board} {:?}",
                    WAYS[way]
                );
            }
            Step::Adopt(board, other) => {
                if let Ok([inner, outer]) = self.boards.get_disjoint_mut([board, other]) {
                    inner.adopt(outer);
                    self.model.adopt(board, other);
                }
            }
        }
    }
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 400, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn blackboards_equal_the_model(steps in prop::collection::vec(step(), 1..120)) {
        let hub = hub();
        let mut comparison = Comparison::new(&hub);
        for (time, step) in (1..).zip(&steps) {
            comparison.take(*step, time);
        }
        for board in 0..BOARDS {
            for way in 0..WAYS.len() {
                comparison.take(Step::Read(board, way), 1000);
            }
        }
    }
}

/// Readers on separate threads: nothing out of order, nothing twice, every loss counted.
#[test]
fn threads_see_every_message_once_or_count_it() {
    const COUNT: u64 = 2000;
    let hub = hub();
    let mut readers: Vec<_> = (0..3).map(|_| hub.blackboard("reader")).collect();
    readers.iter().for_each(|reader| drop(numbers(reader)));
    std::thread::scope(|scope| {
        for name in ["one", "two"] {
            let mut publisher = hub.publisher(SIGNAL, name).unwrap();
            scope.spawn(move || {
                (1..=COUNT).for_each(|number| publisher.publish(Mark::new(number), at(number)))
            });
        }
        for mut reader in readers.drain(..) {
            scope.spawn(move || {
                let mut last = [0; 8];
                let mut seen = 0;
                while seen + reader.lost(SIGNAL) < 2 * COUNT {
                    reader.process_messages(at(1));
                    for mark in reader.signals(SIGNAL) {
                        let last = &mut last[mark.header.publisher.index()];
                        assert!(mark.header.sequence > *last, "{} after {last}", mark.header.sequence);
                        *last = mark.header.sequence;
                        seen += 1;
                    }
                }
                assert_eq!(seen + reader.lost(SIGNAL), 2 * COUNT);
            });
        }
    });
}
