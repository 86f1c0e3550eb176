//! All that robots can do together: their classes of states, what is on its way between them, and what each has heard last.

use std::collections::btree_map::Entry;
use std::collections::{BTreeMap, VecDeque};

use yase::explore::{Move, Trace};

use super::Channels;
use super::contents::{Contents, MISSING};
use super::robot::{Behaviour, Robot, Setting};
use crate::check::conformance::graph::{Shows, Way};

/// A message that passes from one robot to another.
#[derive(Clone, Debug)]
pub(super) struct Passage {
    pub(super) from: usize,
    /// By place among what the one says.
    pub(super) saying: usize,
    pub(super) to: usize,
    /// By places among what the other hears.
    pub(super) hearings: Vec<usize>,
    /// That of them which waits for its arrival.
    pub(super) waited: Option<usize>,
    /// The channel that it goes by.
    channel: usize,
}

/// Which messages pass between robots.
pub(super) fn passages(robots: &[Robot]) -> Vec<Passage> {
    let mut found: Vec<Passage> = Vec::new();
    let mut channels: Vec<(usize, usize)> = Vec::new();
    for (to, hearer) in robots.iter().enumerate() {
        for (from, speaker) in robots.iter().enumerate() {
            for (saying, said) in speaker.sayings.iter().enumerate() {
                let hears = |&hearing: &usize| {
                    let called = &hearer.hearings[hearing].called;
                    called.host == speaker.name && called.word.means(&said.word)
                };
                let hearings: Vec<usize> = (0..hearer.hearings.len()).filter(hears).collect();
                if hearings.is_empty() {
                    continue;
                }
                let channel = channels.iter().position(|it| *it == (from, to)).unwrap_or_else(|| {
                    channels.push((from, to));
                    channels.len() - 1
                });
                let waited = hearings.iter().copied().find(|&it| hearer.hearings[it].event.is_some());
                found.push(Passage { from, saying, to, hearings, waited, channel });
            }
        }
    }
    found
}

/// A state of all together.
#[derive(Clone, PartialEq, Eq, PartialOrd, Ord, Debug)]
pub(super) struct Global {
    /// The class of each robot.
    pub(super) classes: Vec<usize>,
    /// What each has heard last, by passage.
    newest: Vec<u32>,
    /// What was said last, by passage.
    said: Vec<u32>,
    /// What is on its way, by channel: passages and contents.
    channels: Vec<Vec<(usize, u32)>>,
}

/// What leads from one state of all to another.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub(super) enum Happening {
    /// A robot makes a step of its own.
    Step { robot: usize, way: Way },
    /// What was on its way arrives; who waits for it makes a step.
    Arrival { passage: usize, way: Option<Way> },
    /// What was on its way is lost.
    Loss { passage: usize },
}

/// A step of all.
#[derive(Clone, Copy, Debug)]
pub(super) struct Edge {
    pub(super) from: usize,
    pub(super) to: usize,
    pub(super) by: Happening,
}

/// All that was found.
pub(super) struct Product<'a> {
    pub(super) robots: &'a [Robot],
    pub(super) behaviours: &'a [Behaviour],
    pub(super) passages: &'a [Passage],
    channels: Channels,
    pub(super) states: Vec<Global>,
    pub(super) edges: Vec<Edge>,
    /// Where each state was reached from.
    came: Vec<Option<(usize, Happening)>>,
    /// The states of which not every successor is known.
    pub(super) open_ended: Vec<usize>,
    /// The first edge by which a message arrived that nobody took, by passage.
    pub(super) dropped: BTreeMap<usize, usize>,
    /// The first edge by which a channel was too full, by the passage of what it lost.
    pub(super) crowded: BTreeMap<usize, usize>,
}

/// Finds out what robots do together, looking at no more than `limit` states.
pub(super) fn product<'a>(
    robots: &'a [Robot],
    behaviours: &'a [Behaviour],
    passages: &'a [Passage],
    channels: Channels,
    limit: usize,
) -> Product<'a> {
    let found = Product {
        robots,
        behaviours,
        passages,
        channels,
        states: Vec::new(),
        edges: Vec::new(),
        came: Vec::new(),
        open_ended: Vec::new(),
        dropped: BTreeMap::new(),
        crowded: BTreeMap::new(),
    };
    let mut search = Search {
        found,
        contents: Contents::new(robots, passages),
        numbers: BTreeMap::new(),
        open: VecDeque::new(),
        limit,
    };
    search.run();
    search.found
}

struct Search<'a> {
    found: Product<'a>,
    contents: Contents<'a>,
    numbers: BTreeMap<Global, usize>,
    open: VecDeque<usize>,
    limit: usize,
}

/// A successor: what leads there, and what was lost on the way because a channel was full.
struct Next {
    global: Global,
    by: Happening,
    is_dropped: bool,
    crowded: Option<usize>,
}

impl<'a> Search<'a> {
    fn run(&mut self) {
        let (robots, passages) = (self.found.behaviours, self.found.passages);
        let channels = passages.iter().map(|passage| passage.channel + 1).max().unwrap_or(0);
        let begin = Global {
            classes: robots.iter().map(Behaviour::begin).collect(),
            newest: vec![MISSING; passages.len()],
            said: vec![MISSING; passages.len()],
            channels: vec![Vec::new(); channels],
        };
        self.number(begin, None);
        while let Some(state) = self.open.pop_front() {
            for next in self.successors(&self.found.states[state].clone()) {
                self.arrive(state, next);
            }
        }
    }

    fn arrive(&mut self, from: usize, next: Next) {
        let Some(to) = self.number(next.global, Some((from, next.by))) else {
            if self.found.open_ended.last() != Some(&from) {
                self.found.open_ended.push(from);
            }
            return;
        };
        let edge = self.found.edges.len();
        self.found.edges.push(Edge { from, to, by: next.by });
        if let (true, Happening::Arrival { passage, .. }) = (next.is_dropped, next.by) {
            self.found.dropped.entry(passage).or_insert(edge);
        }
        if let Some(lost) = next.crowded {
            self.found.crowded.entry(lost).or_insert(edge);
        }
    }

    fn number(&mut self, global: Global, came: Option<(usize, Happening)>) -> Option<usize> {
        let count = self.found.states.len();
        match self.numbers.entry(global) {
            Entry::Occupied(known) => Some(*known.get()),
            Entry::Vacant(_) if count >= self.limit => None,
            Entry::Vacant(place) => {
                self.found.states.push(place.key().clone());
                place.insert(count);
                self.found.came.push(came);
                self.open.push_back(count);
                Some(count)
            }
        }
    }

    fn successors(&mut self, global: &Global) -> Vec<Next> {
        let behaviours = self.found.behaviours;
        let mut found = Vec::new();
        // what robots say while they start is heard by those that have started: all do, one after the other, before anything else
        let starting = (0..behaviours.len()).find(|&it| behaviours[it].is_begin(global.classes[it]));
        let robots = starting.map_or(0..behaviours.len(), |robot| robot..robot + 1);
        robots.for_each(|robot| self.own_steps(global, robot, &mut found));
        if starting.is_none() {
            (0..global.channels.len()).for_each(|channel| self.arrivals(global, channel, &mut found));
        }
        found
    }

    fn own_steps(&mut self, global: &Global, robot: usize, found: &mut Vec<Next>) {
        let behaviours = self.found.behaviours;
        for &way in &behaviours[robot].graph.ways[global.classes[robot]] {
            let deed = behaviours[robot].deed(&way);
            let comes_by_channel = deed.hears.is_some_and(|hearing| self.passes(robot, hearing));
            if comes_by_channel || !self.contents.allow(robot, &deed.asks, &global.newest) {
                continue;
            }
            let (global, crowded) = self.stepped(global.clone(), robot, way);
            found.push(Next { global, by: Happening::Step { robot, way }, is_dropped: false, crowded });
        }
    }

    /// Whether a robot of the composition says what another hears.
    fn passes(&self, robot: usize, hearing: usize) -> bool {
        self.found.passages.iter().any(|it| it.to == robot && it.hearings.contains(&hearing))
    }

    /// What comes next out of a channel. A message of which one waits in the chart already is taken behind that: it stays where it is, and others may come before it.
    fn arrivals(&mut self, global: &Global, channel: usize, found: &mut Vec<Next>) {
        let arrives = |&(passage, _): &(usize, u32)| !self.is_blocked(global, passage);
        let Some(place) = global.channels[channel].iter().position(arrives) else { return };
        let mut there = global.clone();
        let (passage, content) = there.channels[channel].remove(place);
        if self.found.channels.may_lose {
            let (global, by) = (there.clone(), Happening::Loss { passage });
            found.push(Next { global, by, is_dropped: false, crowded: None });
        }
        there.newest[passage] = content;
        let ways = self.ways_to_hear(&there, passage);
        if ways.is_empty() {
            let (global, by) = (there, Happening::Arrival { passage, way: None });
            found.push(Next { global, by, is_dropped: false, crowded: None });
            return;
        }
        let (behaviours, to) = (self.found.behaviours, self.found.passages[passage].to);
        for way in ways {
            let deed = behaviours[to].deed(&way);
            if self.contents.allow(to, &deed.asks, &there.newest) {
                let (global, crowded) = self.stepped(there.clone(), to, way);
                let by = Happening::Arrival { passage, way: Some(way) };
                found.push(Next { global, by, is_dropped: deed.drops, crowded });
            }
        }
    }

    /// What a robot may do when a message arrives that it waits for.
    fn ways_to_hear(&self, global: &Global, passage: usize) -> Vec<Way> {
        let &Passage { to, waited, .. } = &self.found.passages[passage];
        let behaviour = &self.found.behaviours[to];
        let hears = |way: &&Way| waited.is_some() && behaviour.deed(way).hears == waited;
        behaviour.graph.ways[global.classes[to]].iter().filter(hears).copied().collect()
    }

    /// Whether one of a kind waits in the chart already: then the chart is offered no other. One that has ended waits for nothing.
    fn is_blocked(&self, global: &Global, passage: usize) -> bool {
        let &Passage { to, waited, .. } = &self.found.passages[passage];
        let has_ended = self.found.behaviours[to].graph.ends[global.classes[to]];
        waited.is_some() && !has_ended && self.ways_to_hear(global, passage).is_empty()
    }

    /// A robot goes a way, and what it says is on its way. Gives what a full channel has lost by that, too.
    fn stepped(&mut self, mut global: Global, robot: usize, way: Way) -> (Global, Option<usize>) {
        let behaviours = self.found.behaviours;
        global.classes[robot] = way.to;
        let mut crowded = None;
        for (saying, settings) in &behaviours[robot].deed(&way).says {
            crowded = crowded.or(self.say(&mut global, robot, *saying, settings));
        }
        (global, crowded)
    }

    fn say(
        &mut self,
        global: &mut Global,
        robot: usize,
        saying: usize,
        settings: &[Setting],
    ) -> Option<usize> {
        let mut lost = None;
        let passages = self.found.passages;
        let meant = |it: &(usize, &Passage)| it.1.from == robot && it.1.saying == saying;
        for (number, passage) in passages.iter().enumerate().filter(meant) {
            let content = self.contents.changed(global.said[number], settings);
            global.said[number] = content;
            let channel = &mut global.channels[passage.channel];
            let waiting = channel.iter_mut().find(|(other, _)| *other == number);
            match waiting.filter(|_| passage.waited.is_none()) {
                // whoever only looks at the newest message misses nothing by not seeing the one before
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

impl Product<'_> {
    /// Whether everything was found.
    pub(super) fn is_finished(&self) -> bool {
        self.open_ended.is_empty() && self.behaviours.iter().all(|it| it.found.is_finished())
    }

    /// What happens on the shortest way to a state.
    pub(super) fn way_to(&self, mut state: usize) -> Vec<Happening> {
        let mut way = Vec::new();
        while let Some(Some((before, by))) = self.came.get(state) {
            way.push(*by);
            state = *before;
        }
        way.reverse();
        way
    }

    /// A way as text: the steps of each robot behind its name, as [`super::joint`] reads it.
    pub(super) fn told(&self, way: &[Happening]) -> String {
        let mut at: Vec<usize> = self.behaviours.iter().map(Behaviour::first_state).collect();
        let mut text = String::new();
        for happening in way {
            match *happening {
                Happening::Step { robot, way } => self.tell(robot, way, &mut at, &mut text),
                Happening::Arrival { passage, way } => {
                    let Passage { from, saying, to, .. } = &self.passages[passage];
                    let (from, to, name) = (&self.robots[*from], *to, *saying);
                    let said = from.sayings[name].word.name();
                    text += &format!("# `{said}` of {} comes to {}\n", from.name, self.robots[to].name);
                    if let Some(way) = way {
                        self.tell(to, way, &mut at, &mut text);
                    }
                }
                Happening::Loss { passage } => {
                    let Passage { from, saying, to, .. } = &self.passages[passage];
                    let said = self.robots[*from].sayings[*saying].word.name();
                    let (from, to) = (&self.robots[*from].name, &self.robots[*to].name);
                    text += &format!("# `{said}` of {from} to {to} is lost\n");
                }
            }
        }
        text
    }

    fn tell(&self, robot: usize, way: Way, at: &mut [usize], text: &mut String) {
        let (behaviour, name) = (&self.behaviours[robot], &self.robots[robot].name);
        let (steps, to) = behaviour.steps(at[robot], way.shows, way.to);
        at[robot] = to;
        let trace: Trace = behaviour.found.trace_along(&steps);
        let is_silent = way.shows == Shows::Nothing;
        for step in trace
            .steps()
            .iter()
            .filter(|step| !is_silent || step.cause != Move::Messages || !step.decisions.is_empty())
        {
            *text += &format!("{name}: {}", trace.text_of(step));
        }
        for (saying, _) in &behaviour.deed(&way).says {
            *text += &format!("  # says `{}`\n", self.robots[robot].sayings[*saying].word.name());
        }
    }
}
