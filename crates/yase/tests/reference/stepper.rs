//! A naive interpreter of statecharts, written from the rules, slow and obvious: no numbering, no tables, no bits. Everything is
//! searched for again whenever it is needed.

mod choice;
mod effect;
mod lines;
mod step;
mod tree;
mod truth;

use std::collections::{BTreeMap, BTreeSet};

use yase::statechart::{NodeId, Statechart, TransitionId};
use yase::{Activation, Moment, Outcome, RegionId, TopicId};

use crate::kit::script::Interpreter;
use crate::kit::world::{TOPICS, World};

/// How many micro-steps, and steps at one moment, are allowed.
pub(crate) const LIMIT: u32 = 40;

/// One way out of a state: its segments.
type Way = Vec<TransitionId>;

#[derive(Clone, Debug, PartialEq)]
struct Occurrence {
    event: String,
    number: u32,
    raised: bool,
    expiry: Option<(RegionId, String)>,
}

#[derive(Clone, Copy, Debug, PartialEq)]
enum Phase {
    Queued,
    Running,
    Ongoing,
    Failed,
    Done,
}

#[derive(Clone, Debug)]
struct Job {
    phase: Phase,
    number: u64,
    cancelled: bool,
}

#[derive(Clone, Debug)]
struct Deadline {
    moment: Moment,
    announced: bool,
}

/// What happens in a micro-step, for its line.
#[derive(Default)]
struct Line {
    exits: Vec<NodeId>,
    effects: Vec<String>,
    entries: Vec<NodeId>,
}

pub(crate) struct Stepper<'c> {
    chart: &'c Statechart,
    running_chart: bool,
    now: Moment,
    due: bool,
    active: BTreeSet<NodeId>,
    jobs: BTreeMap<NodeId, Job>,
    job_count: u64,
    timers: BTreeMap<(RegionId, String), Deadline>,
    count: u32,
    raised: Vec<Occurrence>,
    arrived: Vec<Occurrence>,
    deferred: Vec<Occurrence>,
    held: Vec<(Occurrence, Vec<Way>, bool)>,
    pending: Vec<(Way, Option<String>)>,
    erred: BTreeSet<(TransitionId, RegionId)>,
    stale: BTreeSet<(TransitionId, RegionId)>,
    written: BTreeSet<RegionId>,
    waiting: BTreeSet<NodeId>,
    line: Line,
    micro_steps: u32,
    did_something: bool,
    instant: Moment,
    steps_at_instant: u32,
}

impl<'c> Stepper<'c> {
    pub(crate) fn new(chart: &'c Statechart) -> Stepper<'c> {
        Stepper {
            chart,
            running_chart: false,
            now: Moment::ZERO,
            due: false,
            active: BTreeSet::new(),
            jobs: BTreeMap::new(),
            job_count: 0,
            timers: BTreeMap::new(),
            count: 0,
            raised: vec![],
            arrived: vec![],
            deferred: vec![],
            held: vec![],
            pending: vec![],
            erred: BTreeSet::new(),
            stale: BTreeSet::new(),
            written: BTreeSet::new(),
            waiting: BTreeSet::new(),
            line: Line::default(),
            micro_steps: 0,
            did_something: false,
            instant: Moment::ZERO,
            steps_at_instant: 0,
        }
    }
}

fn topic(name: &str) -> Option<TopicId> {
    TOPICS.iter().position(|other| *other == name).map(|index| TopicId(index as u32))
}
impl Interpreter for Stepper<'_> {
    fn start(&mut self, now: Moment, world: &mut World) {
        self.now = now;
        self.instant = now;
        self.running_chart = true;
        self.due = true;
        self.enter(Statechart::ROOT, world);
        self.enter_inside(Statechart::ROOT, Statechart::ROOT, world);
        let mut text = format!("{now} start");
        if !self.line.effects.is_empty() {
            text += &format!("; do {}", self.line.effects.join(", "));
        }
        world.say(format!("{text}; enter {}", self.names(&self.line.entries)));
    }

    fn event(&mut self, name: &str) {
        if self.running_chart {
            self.arrive(name, None);
        }
    }

    fn message(&mut self, topic: TopicId) {
        let name = TOPICS[topic.0 as usize];
        let readers = self.guards_that_read(name);
        let awaited = self.is_named(name, true);
        if !self.running_chart || readers.is_empty() && !awaited {
            return;
        }
        self.due = true;
        for key in &self.erred {
            if readers.contains(&key.0) {
                self.stale.insert(*key);
            }
        }
        if awaited {
            self.arrive(name, None);
        }
    }

    fn returned(&mut self, activation: Activation, outcome: Outcome) -> bool {
        if !self.running_chart {
            return false;
        }
        let job = self.jobs.get_mut(&activation.node).unwrap();
        assert_eq!((job.number, job.phase), (activation.number, Phase::Running));
        job.phase = match outcome {
            Outcome::Done => Phase::Done,
            Outcome::Ongoing => Phase::Ongoing,
            Outcome::Failed => Phase::Failed,
        };
        let mut held = std::mem::take(&mut self.held);
        for (_, ways, offer) in &mut held {
            let in_the_way = |way: &Way| {
                self.exits(way).contains(&activation.node)
                    || self.region(self.source(way)) == activation.region
            };
            *offer |= ways.iter().any(in_the_way);
        }
        self.held = held;
        if outcome == Outcome::Failed {
            self.arrive("error.activity", None);
        }
        self.due = true;
        true
    }

    fn resumed(&mut self, activation: Activation) -> bool {
        let about_to_be_left = self.pending.iter().any(|(way, _)| self.would_leave(way, activation.node));
        let job = self.jobs.get_mut(&activation.node).unwrap();
        assert_eq!((job.number, job.phase), (activation.number, Phase::Ongoing));
        if about_to_be_left {
            return false;
        }
        job.phase = Phase::Running;
        true
    }

    fn step(&mut self, now: Moment, world: &mut World) -> Result<(), String> {
        self.now = now;
        self.begin(world);
        loop {
            match self.micro_step(world) {
                Ok(true) => {}
                Ok(false) => break,
                Err(error) => {
                    self.halt(world);
                    return Err(error);
                }
            }
        }
        self.finish(world);
        Ok(())
    }

    fn needs_step(&self, now: Moment) -> bool {
        let waiting =
            !self.raised.is_empty() || !self.arrived.is_empty() || self.held.iter().any(|held| held.2);
        self.running_chart
            && (self.due || waiting || self.next_deadline().is_some_and(|deadline| deadline <= now))
    }

    fn next_deadline(&self) -> Option<Moment> {
        if !self.running_chart {
            return None;
        }
        self.timers.values().filter(|deadline| !deadline.announced).map(|deadline| deadline.moment).min()
    }

    fn regions(&self) -> usize {
        self.region_nodes().len()
    }
}
