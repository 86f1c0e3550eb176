//! A search for those who ask what happens in steps, and not only which states there are.
//!
//! [`watch`] goes the ways that [`explore`](super::explore) goes, and keeps of every step what the caller makes of it: its [`Seen`] becomes a letter, and two steps between the
//! same states are one only if their letters are equal. Conditions that no guard has may be asked for: they are decided after the step, in agreement with what guards
//! have read of the same messages.
//!
//! Two things make it smaller or sharper than an exploration:
//!
//! - **Idle** composites do nothing: their activities do not return, their timers do not expire, what their guards ask does not hold. Whoever knows that a region
//!   cannot matter to what is asked leaves it out so, and the ways that are found are ways of the whole chart.
//! - **A pace**: then time is counted. An activity returns when its declared duration is over, a timer expires when it is due, both before time goes on; events and
//!   messages come at any time. Time goes on in whole ticks, which is exact if every delay is a whole number of them.

use std::collections::BTreeMap;
use std::collections::VecDeque;
use std::collections::btree_map::Entry;
use std::sync::Arc;
use std::time::Duration;

use super::host::Chosen;
use super::search::go;
use super::{Move, Step, Surroundings, Trace};
use crate::chart::Chart;
use crate::expression::{EventId, ScriptId};
use crate::machine::explored::{Key, Sight};
use crate::machine::{Machine, Status};
use crate::statechart::{NodeId, TransitionId};

/// So many ways are tried in which one step may go.
const WAYS: usize = 4_096;

/// What is asked beside what a chart does by itself.
pub struct Watch<'w> {
    /// How many conditions are asked after each step. They are numbered from behind the scripts of the chart.
    pub conditions: u32,
    /// The composites in which nothing happens.
    pub idle: Vec<NodeId>,
    /// How time is counted; left out, if it is not said.
    pub pace: Option<Pace>,
    /// What a step is to whoever asks.
    pub letter: Box<dyn FnMut(&Seen<'_>) -> u64 + 'w>,
}

/// How time is counted.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub struct Pace {
    /// The unit of all delays.
    pub tick: Duration,
    /// So many ticks are as good as any more, where nothing is due.
    pub longest: u64,
}

/// What a step has shown.
#[derive(Clone, Copy, Debug)]
pub struct Seen<'s> {
    /// Why it happened.
    pub cause: &'s Move,
    /// The segments that were taken, in order.
    pub taken: &'s [TransitionId],
    /// The events that nobody took, now or later.
    pub dropped: &'s [EventId],
    /// What guards have read, in order: each condition once for each blackboard on which it was read.
    pub decisions: &'s [(ScriptId, bool)],
    /// The nodes that are active after it.
    pub configuration: &'s [NodeId],
    /// The nodes that were entered.
    pub entered: &'s [NodeId],
    /// The nodes that were left.
    pub left: &'s [NodeId],
    /// The events that were offered.
    pub events: &'s [EventId],
    /// The values of the conditions that were asked for.
    pub conditions: &'s [bool],
}

/// What goes on in a state until something comes of it.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Debug)]
pub enum Pending {
    /// The activity of a state runs.
    Return(NodeId),
    /// A timer is set, by its place among [`Chart::timers`].
    Expiry(usize),
}

/// A state that was found.
#[derive(Clone, Debug)]
pub struct WatchedState {
    /// What the machine does.
    pub status: Status,
    /// The nodes that are active, composites before what is in them.
    pub configuration: Vec<NodeId>,
    /// What goes on.
    pub pending: Vec<Pending>,
}

/// A step that was found.
#[derive(Clone, Debug)]
pub struct WatchedStep {
    /// Where it begins, by the state's number; none for the start.
    pub from: Option<usize>,
    /// Where it ends.
    pub to: usize,
    /// What it is to whoever asked.
    pub letter: u64,
    /// How many ticks have gone by since the step before.
    pub elapsed: u64,
    /// What came to its end by it.
    pub ends: Option<Pending>,
    step: usize,
}

/// What was found.
#[derive(Clone, Debug)]
pub struct Watched {
    chart: Arc<Chart>,
    is_finished: bool,
    states: Vec<WatchedState>,
    steps: Vec<WatchedStep>,
    texts: Vec<Step>,
}

impl Watched {
    /// Whether all there is was found.
    pub fn is_finished(&self) -> bool {
        self.is_finished
    }

    /// The states, in the order in which they were found.
    pub fn states(&self) -> &[WatchedState] {
        &self.states
    }

    /// The steps, those that start the chart first, each state's own side by side.
    pub fn steps(&self) -> &[WatchedStep] {
        &self.steps
    }

    /// Why a step happens and what is chosen in it, by its place; none if there is no such step.
    pub fn step(&self, place: usize) -> Option<&Step> {
        self.texts.get(self.steps.get(place)?.step)
    }

    /// A way from the start, by the places of its steps.
    pub fn trace_along(&self, way: &[usize]) -> Trace {
        let steps = way.iter().filter_map(|&place| self.texts.get(self.steps.get(place)?.step).cloned());
        Trace::new(self.chart.clone(), steps.collect())
    }
}

/// Finds out what a chart can do in surroundings, and keeps what happens in each step, looking at no more than `limit` states.
pub fn watch(
    chart: &Arc<Chart>,
    surroundings: &mut Surroundings<'_>,
    watch: &mut Watch<'_>,
    limit: usize,
) -> Watched {
    let idle = idle_regions(chart, &watch.idle);
    let found = Watched {
        chart: chart.clone(),
        is_finished: true,
        states: Vec::new(),
        steps: Vec::new(),
        texts: Vec::new(),
    };
    let mut search = Search {
        surroundings,
        watch,
        limit,
        sight: Sight::new(chart),
        idle,
        found,
        numbers: BTreeMap::new(),
        texts: BTreeMap::new(),
        known: BTreeMap::new(),
        open: VecDeque::new(),
    };
    let start = Place { number: None, machine: Machine::new(chart.clone()), clocks: Vec::new() };
    search.steps(&start, &Move::Start, 0);
    while let Some(place) = search.open.pop_front() {
        search.known.clear();
        for (cause, elapsed) in search.moves(&place) {
            search.steps(&place, &cause, elapsed);
        }
    }
    search.found
}

/// Whether nothing happens on a blackboard, by its number.
fn idle_regions(chart: &Chart, idle: &[NodeId]) -> Vec<bool> {
    let is_idle = |node: NodeId| {
        idle.contains(&node) || chart.statechart().ancestors(node).any(|outer| idle.contains(&outer))
    };
    chart.regions().map(|region| chart.region_node(region).is_some_and(is_idle)).collect()
}

struct Search<'s, 'a, 'w> {
    surroundings: &'s mut Surroundings<'a>,
    watch: &'s mut Watch<'w>,
    limit: usize,
    sight: Sight,
    /// Whether nothing happens on a blackboard, by its number.
    idle: Vec<bool>,
    found: Watched,
    numbers: BTreeMap<(Key, Box<[u64]>), usize>,
    texts: BTreeMap<Step, usize>,
    /// The steps of the state that is looked at.
    known: BTreeMap<(usize, u64, u64, Option<Pending>), usize>,
    open: VecDeque<Place>,
}

/// A state that has not been looked at.
struct Place {
    number: Option<usize>,
    machine: Machine,
    clocks: Vec<Clock>,
}

/// How long something will go on.
#[derive(Clone, Copy)]
struct Clock {
    of: Pending,
    /// Tells activations of one state apart.
    activation: u64,
    left: u64,
}

/// What is chosen in one step.
#[derive(Clone, Default)]
struct Plan {
    decisions: Vec<bool>,
    choices: Vec<u32>,
}

impl Search<'_, '_, '_> {
    /// What may happen next, and after how long.
    fn moves(&self, place: &Place) -> Vec<(Move, u64)> {
        let machine = &place.machine;
        if machine.status() != Status::Running {
            return Vec::new();
        }
        let is_timed = self.watch.pace.is_some();
        let next = place.clocks.iter().map(|clock| clock.left).min();
        let due = place.clocks.iter().filter(|clock| !is_timed || Some(clock.left) == next);
        let elapsed = if is_timed { next.unwrap_or(0) } else { 0 };
        let mut moves: Vec<(Move, u64)> = due.map(|clock| (clock.of.ending(), elapsed)).collect();
        // an event that waits already would only make the queue longer
        let events = self.surroundings.events.iter().filter(|event| !machine.is_waiting(event));
        let mut world: Vec<Move> = events.map(|event| Move::Event(event.clone())).collect();
        world.extend(self.surroundings.messages.then_some(Move::Messages));
        let last = self.watch.pace.map_or(0, |pace| next.unwrap_or(pace.longest).min(pace.longest));
        moves.extend((0..=last).flat_map(|elapsed| world.iter().map(move |cause| (cause.clone(), elapsed))));
        moves
    }

    /// Takes a step in every way in which it may go.
    fn steps(&mut self, from: &Place, cause: &Move, elapsed: u64) {
        let mut plans = vec![Plan::default()];
        let mut tried = 0;
        while let Some(plan) = plans.pop() {
            if tried == WAYS {
                self.found.is_finished = false;
                return;
            }
            tried += 1;
            self.step(from, cause, elapsed, &plan, &mut plans);
        }
    }

    fn step(&mut self, from: &Place, cause: &Move, elapsed: u64, plan: &Plan, plans: &mut Vec<Plan>) {
        let mut machine = from.machine.clone();
        let mut host = Chosen::new(&mut *self.surroundings.allows).with_idle(&self.idle);
        host.begin(&plan.decisions);
        let result = go(&mut machine, cause, plan.choices.clone(), &mut host);
        let own = host.decided().len();
        let first = machine.chart().scripts().len() as u32;
        let asked = (first..first + self.watch.conditions).map(|number| host.decide_beside(ScriptId(number)));
        let conditions: Vec<bool> = asked.collect();
        let decisions = host.decided().to_vec();
        let notes = host.notes;
        let choices = machine.chooser().choices().to_vec();
        branch(plan, &decisions.iter().map(|it| (it.value, it.is_free)).collect::<Vec<_>>(), &choices, plans);
        if result.is_err() {
            // A step that never comes to rest is no position of a run; `explore` tells of it.
            return;
        }
        let started = machine.timers_started();
        machine.put_timers_off();
        let configuration = machine.configuration();
        let step = Step {
            cause: cause.clone(),
            decisions: decisions.iter().take(own).map(|it| (it.script, it.value)).collect(),
            choices: choices.iter().map(|&(chosen, _)| chosen).collect(),
        };
        let letter = (self.watch.letter)(&Seen {
            cause,
            taken: &notes.taken,
            dropped: &notes.dropped,
            decisions: &step.decisions,
            configuration: &configuration,
            entered: &notes.entered,
            left: &notes.left,
            events: &notes.events,
            conditions: &conditions,
        });
        let clocks = self.clocks(&machine, &started, &from.clocks, elapsed);
        let place = Place { number: from.number, machine, clocks };
        self.arrive(place, configuration, letter, elapsed, step);
    }

    /// What goes on after a step, and for how long if time is counted.
    fn clocks(
        &self,
        machine: &Machine,
        started: &[(usize, Duration)],
        before: &[Clock],
        elapsed: u64,
    ) -> Vec<Clock> {
        let chart = machine.chart();
        let tick = self.watch.pace.map(|pace| pace.tick);
        let ticks = |time: Duration| tick.map_or(0, |tick| time.as_nanos().div_ceil(tick.as_nanos()) as u64);
        let goes_on = |of: Pending, activation: u64| {
            before.iter().find(|clock| clock.of == of && clock.activation == activation)
        };
        let is_idle = |region: crate::chart::RegionId| self.idle.get(region.index()) == Some(&true);
        let running = machine.running().into_iter().filter(|it| !is_idle(it.region)).map(|it| {
            let of = Pending::Return(it.node);
            let duration = chart.activity(it.node).and_then(|entry| entry.duration).unwrap_or_default();
            let left = goes_on(of, it.number)
                .map_or_else(|| ticks(duration), |clock| clock.left.saturating_sub(elapsed));
            Clock { of, activation: it.number, left }
        });
        let regions: Vec<_> = chart.timers().map(|(region, _)| region).collect();
        let set = machine.timers_set().into_iter().filter(|&timer| !is_idle(regions[timer])).map(|timer| {
            let of = Pending::Expiry(timer);
            let anew = started.iter().find(|(other, _)| *other == timer).map(|&(_, delay)| ticks(delay));
            let left = anew.or_else(|| goes_on(of, 0).map(|clock| clock.left.saturating_sub(elapsed)));
            Clock { of, activation: 0, left: left.unwrap_or(0) }
        });
        running.chain(set).collect()
    }

    /// Takes a step down that led to a place, which is numbered by where it came from.
    fn arrive(
        &mut self,
        Place { number: from, machine, clocks }: Place,
        configuration: Vec<NodeId>,
        letter: u64,
        elapsed: u64,
        step: Step,
    ) {
        let left: Box<[u64]> = match self.watch.pace {
            Some(_) => clocks.iter().map(|clock| clock.left).collect(),
            None => Box::default(),
        };
        let count = self.found.states.len();
        let to = match self.numbers.entry((machine.key(&self.sight), left)) {
            Entry::Occupied(known) => *known.get(),
            Entry::Vacant(_) if count >= self.limit => {
                self.found.is_finished = false;
                return;
            }
            Entry::Vacant(place) => {
                place.insert(count);
                let pending = clocks.iter().map(|clock| clock.of).collect();
                self.found.states.push(WatchedState { status: machine.status(), configuration, pending });
                self.open.push_back(Place { number: Some(count), machine, clocks });
                count
            }
        };
        let ends = Pending::ended_by(&step.cause);
        if let Entry::Vacant(place) = self.known.entry((to, letter, elapsed, ends)) {
            let texts = &mut self.found.texts;
            let step = *self.texts.entry(step).or_insert_with_key(|step| {
                texts.push(step.clone());
                texts.len() - 1
            });
            place.insert(self.found.steps.len());
            self.found.steps.push(WatchedStep { from, to, letter, elapsed, ends, step });
        }
    }
}

impl Pending {
    /// What ends it.
    fn ending(self) -> Move {
        match self {
            Pending::Return(node) => Move::Return(node),
            Pending::Expiry(timer) => Move::Timer(timer),
        }
    }

    fn ended_by(cause: &Move) -> Option<Pending> {
        match *cause {
            Move::Return(node) => Some(Pending::Return(node)),
            Move::Timer(timer) => Some(Pending::Expiry(timer)),
            _ => None,
        }
    }
}

/// The other ways in which a step may go.
fn branch(plan: &Plan, decisions: &[(bool, bool)], choices: &[(u32, u32)], plans: &mut Vec<Plan>) {
    for (index, &(value, is_free)) in decisions.iter().enumerate().skip(plan.decisions.len()) {
        if is_free {
            let before = decisions.iter().take(index).map(|&(value, _)| value);
            let decisions = before.chain([!value]).collect();
            plans.push(Plan { decisions, choices: plan.choices.clone() });
        }
    }
    for (index, &(_, options)) in choices.iter().enumerate().skip(plan.choices.len()) {
        plans.extend((1..options).map(|other| {
            let before = choices.iter().take(index).map(|&(chosen, _)| chosen);
            Plan { decisions: plan.decisions.clone(), choices: before.chain([other]).collect() }
        }));
    }
}
