//! The product of several robots: their classes of states, the messages in channels, and the last
//! message that each has received.

use std::collections::btree_map::Entry;
use std::collections::{BTreeMap, VecDeque};

use yase_explore::{ExplorationProgress, StepCause, Trace};

use super::Channels;
use super::composed_robot::{Behaviour, ComposedRobot, FieldSetting};
use super::content_table::{ContentTable, NEVER_SENT};
use crate::check_settings::CheckSettings;
use crate::conformance::graph::{LabelledEdge, Observable};

/// A route of a message from one robot to another.
#[derive(Clone, Debug)]
pub(crate) struct MessageRoute {
    pub(crate) from: usize,
    /// Index into the sender's sent messages.
    pub(crate) sent_message: usize,
    pub(crate) to: usize,
    /// Indices into the receiver's received messages.
    pub(crate) received_messages: Vec<usize>,
    /// The one of them whose arrival a trigger waits for.
    pub(crate) waited: Option<usize>,
    /// Index of its channel.
    channel: usize,
}

/// The routes between robots.
pub(crate) fn passages(robots: &[ComposedRobot]) -> Vec<MessageRoute> {
    let mut found: Vec<MessageRoute> = Vec::new();
    let mut channels: Vec<(usize, usize)> = Vec::new();
    for (to, receiver) in robots.iter().enumerate() {
        for (from, sender) in robots.iter().enumerate() {
            for (sent_message, sent) in sender.sent.iter().enumerate() {
                let is_same = |&received: &usize| {
                    let called = &receiver.received[received].called;
                    called.host == sender.host && called.name.means(&sent.name)
                };
                let received_messages: Vec<usize> = (0..receiver.received.len()).filter(is_same).collect();
                if received_messages.is_empty() {
                    continue;
                }
                let channel = channels.iter().position(|it| *it == (from, to)).unwrap_or_else(|| {
                    channels.push((from, to));
                    channels.len() - 1
                });
                let waited =
                    received_messages.iter().copied().find(|&it| receiver.received[it].event.is_some());
                found.push(MessageRoute { from, sent_message, to, received_messages, waited, channel });
            }
        }
    }
    found
}

/// A state of the composition.
#[derive(Clone, PartialEq, Eq, PartialOrd, Ord, Debug)]
pub(crate) struct GlobalState {
    /// The class of each robot.
    pub(crate) classes: Vec<usize>,
    /// The content that each has received last, by passage.
    pub(crate) newest: Vec<u32>,
    /// The content that was sent last, by passage.
    last_sent: Vec<u32>,
    /// The messages in transit, by channel: routes and contents.
    channels: Vec<Vec<(usize, u32)>>,
}

/// A transition between two states of the composition.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub(crate) enum GlobalEvent {
    /// A robot makes a step without a message.
    Step { robot: usize, edge: LabelledEdge },
    /// A message arrives; a receiver that waits for it makes a step.
    Arrival { passage: usize, edge: Option<LabelledEdge> },
    /// A message in transit is lost.
    Loss { passage: usize },
}

/// An edge of the product.
#[derive(Clone, Copy, Debug)]
pub(crate) struct ProductEdge {
    pub(crate) from: usize,
    pub(crate) to: usize,
    pub(crate) by: GlobalEvent,
}

/// The explored product.
pub(crate) struct GlobalProduct<'a> {
    pub(crate) robots: &'a [ComposedRobot],
    pub(crate) behaviours: &'a [Behaviour],
    pub(crate) passages: &'a [MessageRoute],
    channels: Channels,
    pub(crate) contents: ContentTable<'a>,
    pub(crate) states: Vec<GlobalState>,
    pub(crate) edges: Vec<ProductEdge>,
    /// The predecessor of each state on a shortest path.
    predecessor: Vec<Option<(usize, GlobalEvent)>>,
    /// The states whose successors were not all explored.
    pub(crate) open_ended: Vec<usize>,
    /// The first edge by which a message arrived that no state reads, by route.
    pub(crate) dropped: BTreeMap<usize, usize>,
    /// The first edge by which a channel overflowed, by the route of the dropped message.
    pub(crate) overflows: BTreeMap<usize, usize>,
}

/// Explores the product of the robots within the limits of the settings.
pub(crate) fn product<'a>(
    robots: &'a [ComposedRobot],
    behaviours: &'a [Behaviour],
    passages: &'a [MessageRoute],
    channels: Channels,
    settings: &'a CheckSettings,
) -> GlobalProduct<'a> {
    let found = GlobalProduct {
        robots,
        behaviours,
        passages,
        channels,
        contents: ContentTable::new(robots, passages),
        states: Vec::new(),
        edges: Vec::new(),
        predecessor: Vec::new(),
        open_ended: Vec::new(),
        dropped: BTreeMap::new(),
        overflows: BTreeMap::new(),
    };
    let mut search = CompositionSearch { found, numbers: BTreeMap::new(), open: VecDeque::new(), settings };
    search.run();
    search.found
}

struct CompositionSearch<'a> {
    found: GlobalProduct<'a>,
    numbers: BTreeMap<GlobalState, usize>,
    open: VecDeque<usize>,
    settings: &'a CheckSettings,
}

/// A successor: the event that leads there, and the message dropped by a full channel.
struct GlobalSuccessor {
    global: GlobalState,
    by: GlobalEvent,
    is_dropped: bool,
    crowded: Option<usize>,
}

impl<'a> CompositionSearch<'a> {
    fn run(&mut self) {
        let (robots, passages) = (self.found.behaviours, self.found.passages);
        let channels = passages.iter().map(|passage| passage.channel + 1).max().unwrap_or(0);
        let begin = GlobalState {
            classes: robots.iter().map(Behaviour::begin).collect(),
            newest: vec![NEVER_SENT; passages.len()],
            last_sent: vec![NEVER_SENT; passages.len()],
            channels: vec![Vec::new(); channels],
        };
        self.number(begin, None);
        while let Some(state) = self.open.pop_front() {
            let progress = self.progress();
            if progress.bytes > self.settings.bytes || self.settings.observer.stops(progress) {
                // unexplored states count as harmless
                self.found.open_ended.push(state);
                self.found.open_ended.extend(self.open.drain(..));
                return;
            }
            for next in self.successors(&self.found.states[state].clone()) {
                self.arrive(state, next);
            }
        }
    }

    fn progress(&self) -> ExplorationProgress {
        let of_state = |state: &GlobalState| {
            let on_way: usize = state.channels.iter().map(Vec::len).sum();
            size_of::<GlobalState>()
                + 8 * (state.classes.len() + state.newest.len())
                + 24 * (state.channels.len() + on_way)
        };
        let states = self.found.states.len();
        // each state is kept twice: in order, and by its content
        let bytes = self.found.states.last().map_or(0, of_state) * 2 * states
            + self.found.edges.len() * size_of::<ProductEdge>();
        ExplorationProgress { states, open: self.open.len(), bytes }
    }

    fn arrive(&mut self, from: usize, next: GlobalSuccessor) {
        let Some(to) = self.number(next.global, Some((from, next.by))) else {
            if self.found.open_ended.last() != Some(&from) {
                self.found.open_ended.push(from);
            }
            return;
        };
        let edge = self.found.edges.len();
        self.found.edges.push(ProductEdge { from, to, by: next.by });
        if let (true, GlobalEvent::Arrival { passage, .. }) = (next.is_dropped, next.by) {
            self.found.dropped.entry(passage).or_insert(edge);
        }
        if let Some(lost) = next.crowded {
            self.found.overflows.entry(lost).or_insert(edge);
        }
    }

    fn number(&mut self, global: GlobalState, came: Option<(usize, GlobalEvent)>) -> Option<usize> {
        let count = self.found.states.len();
        match self.numbers.entry(global) {
            Entry::Occupied(known) => Some(*known.get()),
            Entry::Vacant(_) if count >= self.settings.states => None,
            Entry::Vacant(entry) => {
                self.found.states.push(entry.key().clone());
                entry.insert(count);
                self.found.predecessor.push(came);
                self.open.push_back(count);
                Some(count)
            }
        }
    }

    fn successors(&mut self, global: &GlobalState) -> Vec<GlobalSuccessor> {
        let behaviours = self.found.behaviours;
        let mut found = Vec::new();
        // all robots start one after the other before any other event, so that messages sent during
        // the start of one reach those already started
        let starting = (0..behaviours.len()).find(|&it| behaviours[it].is_begin(global.classes[it]));
        let robots = starting.map_or(0..behaviours.len(), |robot| robot..robot + 1);
        robots.for_each(|robot| self.own_steps(global, robot, &mut found));
        if starting.is_none() {
            (0..global.channels.len()).for_each(|channel| self.arrivals(global, channel, &mut found));
        }
        found
    }

    fn own_steps(&mut self, global: &GlobalState, robot: usize, found: &mut Vec<GlobalSuccessor>) {
        let behaviours = self.found.behaviours;
        for &edge in &behaviours[robot].graph.edges[global.classes[robot]] {
            let interface = behaviours[robot].step_interface(&edge);
            let comes_by_channel = interface.receives.is_some_and(|message| self.is_routed(robot, message));
            if comes_by_channel || !self.found.contents.allow(robot, &interface.conditions, &global.newest) {
                continue;
            }
            let (global, crowded) = self.apply_step(global.clone(), robot, edge);
            found.push(GlobalSuccessor {
                global,
                by: GlobalEvent::Step { robot, edge },
                is_dropped: false,
                crowded,
            });
        }
    }

    /// Whether a robot sends a message that a robot receives.
    fn is_routed(&self, robot: usize, message: usize) -> bool {
        self.found.passages.iter().any(|it| it.to == robot && it.received_messages.contains(&message))
    }

    /// The arrivals that are possible next in a channel. If the chart already holds a message of
    /// that kind, it stays in the channel, and later messages may overtake it.
    fn arrivals(&mut self, global: &GlobalState, channel: usize, found: &mut Vec<GlobalSuccessor>) {
        let arrives = |&(passage, _): &(usize, u32)| !self.is_blocked(global, passage);
        let Some(index) = global.channels[channel].iter().position(arrives) else { return };
        let mut there = global.clone();
        let (passage, content) = there.channels[channel].remove(index);
        if self.found.channels.may_lose && !self.found.is_local(passage) {
            let (global, by) = (there.clone(), GlobalEvent::Loss { passage });
            found.push(GlobalSuccessor { global, by, is_dropped: false, crowded: None });
        }
        there.newest[passage] = content;
        let edges = self.receiving_steps(&there, passage);
        if edges.is_empty() {
            let (global, by) = (there, GlobalEvent::Arrival { passage, edge: None });
            found.push(GlobalSuccessor { global, by, is_dropped: false, crowded: None });
            return;
        }
        let (behaviours, to) = (self.found.behaviours, self.found.passages[passage].to);
        for edge in edges {
            let interface = behaviours[to].step_interface(&edge);
            if self.found.contents.allow(to, &interface.conditions, &there.newest) {
                let (global, crowded) = self.apply_step(there.clone(), to, edge);
                let by = GlobalEvent::Arrival { passage, edge: Some(edge) };
                found.push(GlobalSuccessor { global, by, is_dropped: interface.drops, crowded });
            }
        }
    }

    /// The steps that a robot may make when an awaited message arrives.
    fn receiving_steps(&self, global: &GlobalState, passage: usize) -> Vec<LabelledEdge> {
        let &MessageRoute { to, waited, .. } = &self.found.passages[passage];
        let behaviour = &self.found.behaviours[to];
        let receives =
            |edge: &&LabelledEdge| waited.is_some() && behaviour.step_interface(edge).receives == waited;
        behaviour.graph.edges[global.classes[to]].iter().filter(receives).copied().collect()
    }

    /// Whether the chart already holds a message of the kind, so that it is offered no other. A
    /// chart that has ended waits for nothing.
    fn is_blocked(&self, global: &GlobalState, passage: usize) -> bool {
        let &MessageRoute { to, waited, .. } = &self.found.passages[passage];
        let has_ended = self.found.behaviours[to].graph.ends[global.classes[to]];
        waited.is_some() && !has_ended && self.receiving_steps(global, passage).is_empty()
    }

    /// Applies a step of a robot and enqueues the messages it sends. Returns the message that a
    /// full channel dropped.
    fn apply_step(
        &mut self,
        mut global: GlobalState,
        robot: usize,
        edge: LabelledEdge,
    ) -> (GlobalState, Option<usize>) {
        let behaviours = self.found.behaviours;
        global.classes[robot] = edge.to;
        let mut crowded = None;
        for (message, settings) in &behaviours[robot].step_interface(&edge).sends {
            crowded = crowded.or(self.send(&mut global, robot, *message, settings));
        }
        (global, crowded)
    }

    fn send(
        &mut self,
        global: &mut GlobalState,
        robot: usize,
        message: usize,
        settings: &[FieldSetting],
    ) -> Option<usize> {
        let mut lost = None;
        let passages = self.found.passages;
        let meant = |it: &(usize, &MessageRoute)| it.1.from == robot && it.1.sent_message == message;
        for (number, passage) in passages.iter().enumerate().filter(meant) {
            let content = self.found.contents.changed(global.last_sent[number], settings);
            global.last_sent[number] = content;
            let channel = &mut global.channels[passage.channel];
            let waiting = channel.iter_mut().find(|(other, _)| *other == number);
            match waiting.filter(|_| passage.waited.is_none()) {
                // a receiver that reads only the newest message does not observe the skipped one
                Some(waiting) => waiting.1 = content,
                None => channel.push((number, content)),
            }
            if channel.len() > self.found.channels.capacity {
                lost = Some(channel.remove(0).0);
            }
        }
        lost
    }
}

impl GlobalProduct<'_> {
    /// Whether a message stays within a process.
    fn is_local(&self, passage: usize) -> bool {
        let MessageRoute { from, to, .. } = self.passages[passage];
        from != to && self.robots[from].host == self.robots[to].host
    }

    /// Whether everything was found.
    pub(crate) fn is_finished(&self) -> bool {
        self.open_ended.is_empty() && self.behaviours.iter().all(|it| it.found.is_finished())
    }

    /// The events on the shortest path to a state.
    pub(crate) fn path_to(&self, state: usize) -> Vec<GlobalEvent> {
        self.steps_to(state).into_iter().map(|(by, _)| by).collect()
    }

    /// The events on the shortest path to a state, each with the state that it leads to.
    pub(crate) fn steps_to(&self, mut state: usize) -> Vec<(GlobalEvent, usize)> {
        let mut indices = Vec::new();
        while let Some(Some((before, by))) = self.predecessor.get(state) {
            indices.push((*by, state));
            state = *before;
        }
        indices.reverse();
        indices
    }

    /// A path as text in the format of [`super::team_trace`].
    pub(crate) fn trace_text(&self, events: &[GlobalEvent]) -> String {
        let mut at: Vec<usize> = self.behaviours.iter().map(Behaviour::first_state).collect();
        let mut text = String::new();
        for happening in events {
            match *happening {
                GlobalEvent::Step { robot, edge } => self.write_step(robot, edge, &mut at, &mut text),
                GlobalEvent::Arrival { passage, edge } => {
                    let &MessageRoute { from, sent_message, to, .. } = &self.passages[passage];
                    let from = &self.robots[from];
                    let message = from.sent[sent_message].name.name();
                    text += &format!("# `{message}` of {} comes to {}\n", from.name, self.robots[to].name);
                    if let Some(edge) = edge {
                        self.write_step(to, edge, &mut at, &mut text);
                    }
                }
                GlobalEvent::Loss { passage } => {
                    let MessageRoute { from, sent_message, to, .. } = &self.passages[passage];
                    let message = self.robots[*from].sent[*sent_message].name.name();
                    let (from, to) = (&self.robots[*from].name, &self.robots[*to].name);
                    text += &format!("# `{message}` of {from} to {to} is lost\n");
                }
            }
        }
        text
    }

    fn write_step(&self, robot: usize, edge: LabelledEdge, at: &mut [usize], text: &mut String) {
        let (behaviour, name) = (&self.behaviours[robot], &self.robots[robot].name);
        let (steps, to) = behaviour.steps(at[robot], edge.observable, edge.to);
        at[robot] = to;
        let trace: Trace = behaviour.found.trace_along(&steps);
        let is_silent = edge.observable == Observable::Nothing;
        for step in trace
            .steps()
            .iter()
            .filter(|step| !is_silent || step.cause != StepCause::Messages || !step.decisions.is_empty())
        {
            *text += &format!("{name}: {}", trace.text_of(step));
        }
        for (message, _) in &behaviour.step_interface(&edge).sends {
            *text += &format!("  # says `{}`\n", self.robots[robot].sent[*message].name.name());
        }
    }
}
