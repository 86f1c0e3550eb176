//! A naive interpreter of statecharts that follows the rules directly: sets of nodes, recursion and
//! clones. Derived data is recomputed whenever it is needed.

mod actions;
mod arrivals;
mod entry;
mod evaluation;
mod firing;
mod log_lines;
mod segments;
mod selection;
mod steps;
mod transitions;
mod tree;

use std::collections::{BTreeMap, BTreeSet};

use yase::statechart::{NodeId, Statechart, TransitionId};
use yase::{Activation, Outcome, ScopeId, Semantics, Timestamp, TopicId};

use crate::chooser::ReferenceChooser;
use crate::script::Interpreter;
use crate::test_host::{TOPICS, TestHost};
use transitions::StaticPath;
use tree::Tree;

/// A failure that stops the chart.
#[derive(Clone, Debug, PartialEq)]
pub(crate) enum Failure {
    /// No branch of that CHOICE is open.
    NoBranch(NodeId),
    /// Too many micro-steps, or steps at one moment.
    Endless,
}

#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Occurrence {
    event: String,
    number: u32,
    raised: bool,
    expiry: Option<(ScopeId, String)>,
}

/// An event held until running activities return: the transitions it selected, and whether it is
/// offered again.
#[derive(Clone, Debug)]
struct Held {
    occurrence: Occurrence,
    paths: Vec<StaticPath>,
    offer: bool,
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
    moment: Timestamp,
    announced: bool,
    /// The state that the timer is bound to.
    bound: Option<NodeId>,
}

/// Record of a micro-step for its log line.
#[derive(Clone, Debug, Default)]
struct Line {
    exits: Vec<NodeId>,
    effects: Vec<String>,
    taken: Vec<TransitionId>,
    entries: Vec<NodeId>,
    reads: Vec<(TransitionId, Option<bool>)>,
}

pub(crate) struct Stepper<'c> {
    chart: &'c Statechart,
    tree: Tree,
    semantics: Semantics,
    pub(crate) chooser: ReferenceChooser,
    running_chart: bool,
    now: Timestamp,
    due: bool,
    active: BTreeSet<NodeId>,
    jobs: BTreeMap<NodeId, Job>,
    job_count: u64,
    timers: BTreeMap<(ScopeId, String), Deadline>,
    timer_numbers: Vec<(ScopeId, String)>,
    /// Timers started by the effects of the current compound transition, to be bound to its target.
    unbound: Vec<(ScopeId, String)>,
    records: BTreeMap<NodeId, Vec<NodeId>>,
    /// The regions that have arrived, each at a JOIN or an exit point.
    arrivals: BTreeSet<(NodeId, NodeId)>,
    /// The transitions of this micro-step.
    taken: Vec<StaticPath>,
    /// ANDs entered by segments, whose other regions are entered last.
    late: Vec<NodeId>,
    /// Composites whose active children were exited, which count as complete.
    vacated: BTreeSet<NodeId>,
    completions: Vec<NodeId>,
    count: u32,
    raised: Vec<Occurrence>,
    arrived: Vec<Occurrence>,
    deferred: Vec<Occurrence>,
    held: Vec<Held>,
    pending: Vec<(StaticPath, Option<String>)>,
    erred: BTreeSet<(TransitionId, ScopeId)>,
    stale: BTreeSet<(TransitionId, ScopeId)>,
    written: BTreeSet<ScopeId>,
    waiting: BTreeSet<NodeId>,
    /// Candidates of this micro-step: transitions, and the state at which each was found.
    found: Vec<(NodeId, StaticPath)>,
    /// The active leaves from which a candidate was found, outward.
    closed: BTreeSet<NodeId>,
    /// The active leaves when the micro-step began.
    leaves: Vec<NodeId>,
    /// Segments whose guards failed in this micro-step; each failure is reported once.
    reported: BTreeSet<TransitionId>,
    /// Weighted segments that the chooser picked in this micro-step.
    drawn: Vec<TransitionId>,
    line: Line,
    micro_steps: u32,
    did_something: bool,
    instant: Timestamp,
    steps_at_instant: u32,
    /// The root has reached its END; active states remain to be exited.
    ended: bool,
    /// TERMINATE was reached in this micro-step.
    terminates: bool,
    /// The failure during the start, which the first step reports.
    failure: Option<Failure>,
    before: BTreeSet<NodeId>,
}

impl<'c> Stepper<'c> {
    /// `timer_numbers` gives the order of timers, which the rules leave open.
    pub(crate) fn new(
        chart: &'c Statechart,
        semantics: Semantics,
        chooser: ReferenceChooser,
        timer_numbers: Vec<(ScopeId, String)>,
    ) -> Stepper<'c> {
        Stepper {
            chart,
            tree: Tree::new(chart, semantics.order),
            semantics,
            chooser,
            running_chart: false,
            now: Timestamp::ZERO,
            due: false,
            active: BTreeSet::new(),
            jobs: BTreeMap::new(),
            job_count: 0,
            timers: BTreeMap::new(),
            timer_numbers,
            unbound: vec![],
            records: BTreeMap::new(),
            arrivals: BTreeSet::new(),
            taken: vec![],
            late: vec![],
            vacated: BTreeSet::new(),
            completions: vec![],
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
            found: vec![],
            closed: BTreeSet::new(),
            leaves: vec![],
            reported: BTreeSet::new(),
            drawn: vec![],
            line: Line::default(),
            micro_steps: 0,
            did_something: false,
            instant: Timestamp::ZERO,
            steps_at_instant: 0,
            ended: false,
            terminates: false,
            failure: None,
            before: BTreeSet::new(),
        }
    }

    pub(crate) fn is_active(&self, node: NodeId) -> bool {
        self.active.contains(&node)
    }
}

fn topic(name: &str) -> Option<TopicId> {
    TOPICS.iter().position(|other| *other == name).map(|index| TopicId(index as u32))
}

impl Interpreter for Stepper<'_> {
    fn start(&mut self, now: Timestamp, host: &mut TestHost) {
        self.now = now;
        self.instant = now;
        self.running_chart = true;
        self.due = true;
        self.begin_chart(host);
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
        let Some(job) = self.jobs.get_mut(&activation.node) else { return false };
        if !self.running_chart || job.number != activation.number {
            return false;
        }
        assert_eq!(job.phase, Phase::Running);
        job.phase = match outcome {
            Outcome::Done => Phase::Done,
            Outcome::Ongoing => Phase::Ongoing,
            Outcome::Failed => Phase::Failed,
        };
        let mut held = std::mem::take(&mut self.held);
        for Held { paths, offer, .. } in &mut held {
            let in_the_way = |path: &StaticPath| {
                self.exit_set(path).contains(&activation.node)
                    || path.sources.iter().any(|&source| self.region(source) == activation.region)
            };
            *offer |= paths.iter().any(in_the_way);
        }
        self.held = held;
        match outcome {
            Outcome::Failed => self.arrive("error.activity", None),
            Outcome::Done => self.completed(activation.node),
            Outcome::Ongoing => {}
        }
        self.due = true;
        true
    }

    fn resumed(&mut self, activation: Activation) -> bool {
        let about_to_be_left = self.pending.iter().any(|(path, _)| self.would_leave(path, activation.node));
        let Some(job) = self.jobs.get_mut(&activation.node) else { return false };
        assert_eq!((job.number, job.phase), (activation.number, Phase::Ongoing));
        if about_to_be_left {
            return false;
        }
        job.phase = Phase::Running;
        true
    }

    fn step(&mut self, now: Timestamp, host: &mut TestHost) -> Result<(), String> {
        self.now = now;
        match self.whole_step(host) {
            Ok(()) => Ok(()),
            Err(failure) => {
                self.halt(host);
                Err(self.describe(&failure))
            }
        }
    }

    fn needs_step(&self, now: Timestamp) -> bool {
        let waiting =
            !self.raised.is_empty() || !self.arrived.is_empty() || self.held.iter().any(|held| held.offer);
        self.running_chart
            && (self.due || waiting || self.next_deadline().is_some_and(|deadline| deadline <= now))
    }

    fn next_deadline(&self) -> Option<Timestamp> {
        if !self.running_chart {
            return None;
        }
        self.timers.values().filter(|deadline| !deadline.announced).map(|deadline| deadline.moment).min()
    }

    fn regions(&self) -> usize {
        self.tree.regions.len()
    }
}
