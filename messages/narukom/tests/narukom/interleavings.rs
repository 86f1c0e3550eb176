//! Blackboards write, publish, process, read and take over values in random order, and must agree
//! with a naive model.
//!
//! The model keeps every message ever published, and computes from that what a blackboard shows.
#![allow(clippy::unwrap_used, clippy::panic, reason = "a test that cannot go on fails")]

use crate::messages::*;
use narukom::{Blackboard, Hub, SIGNAL_DEPTH, STATE_DEPTH};
use proptest::prelude::*;

const BOARDS: usize = 3;

#[derive(Clone, Copy, PartialEq, Debug)]
enum TestedKind {
    State,
    Signal,
    Data,
}

const KINDS: [TestedKind; 3] = [TestedKind::State, TestedKind::Signal, TestedKind::Data];

impl TestedKind {
    /// The number of messages that the hub holds.
    fn depth(self) -> usize {
        match self {
            TestedKind::State => STATE_DEPTH,
            TestedKind::Signal => SIGNAL_DEPTH,
            TestedKind::Data => 4,
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
    let span = 0..KINDS.len();
    prop_oneof![
        4 => (board.clone(), span.clone()).prop_map(|(board, index)| Step::Write(board, index)),
        1 => (board.clone(), span.clone(), 1..90_usize).prop_map(|(board, position, count)| Step::Burst(board, position, count)),
        3 => board.clone().prop_map(Step::Publish),
        3 => board.clone().prop_map(Step::Process),
        4 => (board.clone(), span).prop_map(|(board, kind)| Step::Read(board, kind)),
        1 => (board.clone(), board).prop_map(|(board, other)| Step::Adopt(board, other)),
    ]
}

/// A message that was published.
#[derive(Clone, Copy)]
struct PublishedMessage {
    order: u64,
    board: usize,
    nth: u64,
    value: u64,
}

/// A message that a blackboard wrote and the hub has not delivered.
#[derive(Clone, Copy)]
struct OwnMessage {
    value: u64,
    nth: u64,
    sent: bool,
    hidden: bool,
}

/// One topic on a blackboard.
#[derive(Clone, Default)]
struct TopicState {
    attached: bool,
    cursor: usize,
    items: Vec<u64>,
    lost: u64,
    own: Vec<OwnMessage>,
    inherited: Vec<u64>,
    written: u64,
    seen: u64,
}

#[derive(Clone, Default)]
struct BoardState {
    since: u64,
    delivered: u64,
    states: [TopicState; 3],
    /// The retention kinds of the unpublished messages, in the order in which they were written.
    outbox: Vec<usize>,
}

#[derive(Default)]
struct Model {
    order: u64,
    logs: [Vec<PublishedMessage>; 3],
    boards: [BoardState; BOARDS],
}

impl TopicState {
    fn visible_own(&self) -> impl Iterator<Item = u64> {
        let own = self.own.iter().filter(|own| !own.hidden).map(|own| own.value);
        self.inherited.iter().copied().chain(own)
    }

    fn accept(&mut self, kind: TestedKind, entry: PublishedMessage, reader: usize) {
        match kind {
            TestedKind::State => self.items = vec![entry.value],
            TestedKind::Signal if entry.board == reader && entry.nth <= self.seen => {}
            TestedKind::Signal => self.items.push(entry.value),
            TestedKind::Data => {
                self.items.push(entry.value);
                let surplus = self.items.len().saturating_sub(kind.depth());
                self.items.drain(..surplus);
            }
        }
    }
}

impl Model {
    fn write(&mut self, board: usize, index: usize, value: u64) {
        let state = &mut self.boards[board].states[index];
        state.written += 1;
        state.own.push(OwnMessage { value, nth: state.written, sent: false, hidden: false });
        self.boards[board].outbox.push(index);
    }

    fn publish(&mut self, board: usize) {
        for index in std::mem::take(&mut self.boards[board].outbox) {
            let state = &mut self.boards[board].states[index];
            let own = state.own.iter_mut().find(|own| !own.sent).unwrap();
            own.sent = true;
            self.order += 1;
            self.logs[index].push(PublishedMessage {
                order: self.order,
                board,
                nth: own.nth,
                value: own.value,
            });
        }
        for (kind, state) in KINDS.iter().zip(&mut self.boards[board].states) {
            let kept = if *kind == TestedKind::State { 1 } else { kind.depth() };
            while state.own.len() > kept && state.own[0].sent {
                state.own.remove(0);
            }
        }
    }

    /// The messages of a topic that the hub still holds, and the index of the first.
    fn ring(&self, index: usize) -> (usize, &[PublishedMessage]) {
        let first = self.logs[index].len().saturating_sub(KINDS[index].depth());
        (first, &self.logs[index][first..])
    }

    fn process(&mut self, board: usize) {
        for (index, kind) in KINDS.into_iter().enumerate() {
            let (first, ring) = self.ring(index);
            let ring = ring.to_vec();
            let state = &mut self.boards[board].states[index];
            state.own.retain(|own| !own.sent);
            state.inherited.clear();
            if kind == TestedKind::Signal {
                state.items.clear();
            }
            if !state.attached {
                continue;
            }
            if kind != TestedKind::State {
                state.lost += first.saturating_sub(state.cursor) as u64;
            }
            for entry in &ring[state.cursor.saturating_sub(first)..] {
                state.accept(kind, *entry, board);
            }
            state.cursor = first + ring.len();
        }
        let board = &mut self.boards[board];
        board.since = board.since.max(board.delivered);
        board.delivered = self.order;
    }

    fn attach(&mut self, board: usize, index: usize) {
        let (first, ring) = self.ring(index);
        let (ring, known) = (ring.to_vec(), self.boards[board].clone());
        let state = &mut self.boards[board].states[index];
        let begin = if KINDS[index] == TestedKind::Signal { known.since } else { 0 };
        state.attached = true;
        state.lost = 0;
        state.items.clear();
        for entry in ring.iter().filter(|entry| entry.order > begin && entry.order <= known.delivered) {
            state.accept(KINDS[index], *entry, board);
        }
        // If the hub no longer holds the state of that time, begin with the oldest that it holds.
        let had_a_value = self.logs[index].first().is_some_and(|entry| entry.order <= known.delivered);
        let state = &mut self.boards[board].states[index];
        if KINDS[index] == TestedKind::State && state.items.is_empty() && had_a_value {
            state.items = vec![ring[0].value];
        }
        let late = |entry: &PublishedMessage| entry.order > known.delivered.max(begin);
        state.cursor = first + ring.iter().position(late).unwrap_or(ring.len());
    }

    fn read(&mut self, board: usize, index: usize) -> (Vec<u64>, u64) {
        if !self.boards[board].states[index].attached {
            self.attach(board, index);
        }
        let state = &mut self.boards[board].states[index];
        state.seen = state.written;
        let mut values = state.items.clone();
        values.extend(state.visible_own());
        let depth = match KINDS[index] {
            TestedKind::State => 1,
            TestedKind::Signal => usize::MAX,
            TestedKind::Data => 4,
        };
        (values.split_off(values.len().saturating_sub(depth)), state.lost)
    }

    fn adopt(&mut self, board: usize, other: usize) {
        let other = self.boards[other].clone();
        self.boards[board].since = other.since;
        self.boards[board].delivered = other.delivered;
        for (index, theirs) in other.states.iter().enumerate() {
            let state = &mut self.boards[board].states[index];
            state.own.iter_mut().for_each(|own| own.hidden = true);
            state.inherited.clear();
            if KINDS[index] != TestedKind::Signal {
                state.inherited.extend(theirs.visible_own());
            }
            if theirs.attached {
                (state.attached, state.cursor, state.lost) = (true, theirs.cursor, theirs.lost);
                state.items = theirs.items.clone();
            } else if state.attached {
                self.attach(board, index);
            }
        }
    }
}

/// The real blackboard: the values and the losses of a topic.
fn read(board: &Blackboard, index: usize) -> (Vec<u64>, u64) {
    match KINDS[index] {
        TestedKind::State => {
            (board.read(STATE).map(|mark| mark.number).into_iter().collect(), board.lost(STATE))
        }
        TestedKind::Signal => (board.signals(SIGNAL).map(|mark| mark.number).collect(), board.lost(SIGNAL)),
        TestedKind::Data => {
            let age = std::time::Duration::MAX;
            (board.recent(DATA, age).map(|mark| mark.number).collect(), board.lost(DATA))
        }
    }
}

fn write(board: &mut Blackboard, index: usize, value: u64) {
    let written = match KINDS[index] {
        TestedKind::State => board.publish(STATE, Mark::new(value)),
        TestedKind::Signal => board.publish(SIGNAL, Mark::new(value)),
        TestedKind::Data => board.publish(DATA, Mark::new(value)),
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

    fn write(&mut self, board: usize, index: usize) {
        self.value += 1;
        write(&mut self.boards[board], index, self.value);
        self.model.write(board, index, self.value);
    }

    fn publish(&mut self, board: usize, time: u64) {
        self.boards[board].publish_all(at(time));
        self.model.publish(board);
    }

    fn take(&mut self, step: Step, time: u64) {
        match step {
            Step::Write(board, index) => self.write(board, index),
            Step::Burst(board, position, count) => {
                (0..count).for_each(|_| self.write(board, position));
                self.publish(board, time);
            }
            Step::Publish(board) => self.publish(board, time),
            Step::Process(board) => {
                self.boards[board].process_messages(at(time));
                self.model.process(board);
            }
            Step::Read(board, kind) => {
                assert_eq!(
                    read(&self.boards[board], kind),
                    self.model.read(board, kind),
                    "{board} {:?}",
                    KINDS[kind]
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
            for index in 0..KINDS.len() {
                comparison.take(Step::Read(board, index), 1000);
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
