//! An exploration with observations of each step.
//!
//! [`explore_labelled`] explores as [`explore`](super::explore) does, and maps the
//! [`StepObservation`] of every step to a letter: two steps between the same states are one only if
//! their letters are equal. Conditions that no guard reads can be evaluated too: they are decided
//! after the step, consistently with the values that guards have read of the same messages.
//!
//! Two options make it smaller or more precise than an exploration:
//!
//! - **Idle** composites do nothing: their activities do not return, their timers do not expire,
//!   their guards do not hold. They exclude regions that cannot affect the result; every path found
//!   is a path of the complete chart.
//! - **A clock model** counts time. An activity returns when its declared duration has passed, a
//!   timer expires when it is due, both before time advances; events and messages occur at any
//!   time. Time advances in ticks, which is exact if every delay is a multiple of a tick.

use std::collections::btree_map::Entry;
use std::collections::{BTreeMap, BTreeSet, VecDeque};
use std::sync::Arc;
use std::time::Duration;

use super::host::ChoosingHost;
use super::search::advance_and_step;
use super::{
    Environment, ExplorationLimits, ExplorationProgress, ExplorationStop, QUEUED, StepCause, Trace, TraceStep,
};
use yase::CompiledChart;
use yase::expression::{EventId, ScriptId};
use yase::state_key::{RelevantState, StateKey};
use yase::statechart::{NodeId, TransitionId};
use yase::{Machine, Status};

/// Maximum number of alternatives of one step.
const MAX_ALTERNATIVES: usize = 4_096;

/// Options and observations of a labelled exploration.
pub struct StepLabeler<'w> {
    /// The number of conditions evaluated after each step. They are numbered after the scripts of
    /// the chart.
    pub conditions: u32,
    /// The composites in which nothing happens.
    pub idle: Vec<NodeId>,
    /// The counting of time; `None` ignores time.
    pub pace: Option<ClockModel>,
    /// Maps a step to its letter.
    pub letter: Box<dyn FnMut(&StepObservation<'_>) -> u64 + 'w>,
}

/// The counting of time.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub struct ClockModel {
    /// The unit of all delays.
    pub tick: Duration,
    /// Maximum number of ticks between steps when nothing is due; longer times are equivalent.
    pub longest: u64,
}

/// The observable effects of a step.
#[derive(Clone, Copy, Debug)]
pub struct StepObservation<'s> {
    /// Its cause.
    pub cause: &'s StepCause,
    /// The segments taken, in order.
    pub taken: &'s [TransitionId],
    /// The discarded events: neither consumed nor kept.
    pub dropped: &'s [EventId],
    /// The values that guards have read, in order: each condition once per blackboard.
    pub decisions: &'s [(ScriptId, bool)],
    /// The nodes that are active after it.
    pub configuration: &'s [NodeId],
    /// The nodes that were entered.
    pub entered: &'s [NodeId],
    /// The nodes that were exited.
    pub left: &'s [NodeId],
    /// The events that were offered.
    pub events: &'s [EventId],
    /// The values of the additional conditions.
    pub conditions: &'s [bool],
}

/// Something that is in progress in a state.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Debug)]
pub enum PendingEvent {
    /// The activity of a state is running.
    Return(NodeId),
    /// A timer is set, by its index in [`CompiledChart::timers`].
    Expiry(usize),
}

/// A reachable state.
#[derive(Clone, Debug)]
pub struct LabelledState {
    /// Status of the machine.
    pub status: Status,
    /// The active nodes, composites before their children.
    pub configuration: Vec<NodeId>,
    /// Running activities and timers.
    pub pending: Vec<PendingEvent>,
}

/// A step between reachable states.
#[derive(Clone, Debug)]
pub struct LabelledStep {
    /// Its source state, by index; `None` for the start.
    pub from: Option<usize>,
    /// Its target state, by index.
    pub to: usize,
    /// Its letter.
    pub letter: u64,
    /// The number of ticks since the previous step.
    pub elapsed: u64,
    /// The activity or timer whose end caused it.
    pub ends: Option<PendingEvent>,
    step: usize,
}

/// The result of a labelled exploration.
#[derive(Clone, Debug)]
pub struct LabelledGraph {
    chart: Arc<CompiledChart>,
    stop: Option<ExplorationStop>,
    overflowing: BTreeSet<EventId>,
    states: Vec<LabelledState>,
    steps: Vec<LabelledStep>,
    texts: Vec<TraceStep>,
}

impl LabelledGraph {
    /// Whether the exploration is complete.
    pub fn is_finished(&self) -> bool {
        self.stop.is_none()
    }

    /// Why it is not complete.
    pub fn stop(&self) -> Option<ExplorationStop> {
        self.stop
    }

    /// The names of the events of which more may wait than are distinguished ([`QUEUED`]).
    pub fn overflowing(&self) -> Vec<&str> {
        self.overflowing.iter().map(|&event| self.chart.events().name(event)).collect()
    }

    /// The states in the order of their discovery.
    pub fn states(&self) -> &[LabelledState] {
        &self.states
    }

    /// The steps, initial steps first, grouped by source state.
    pub fn steps(&self) -> &[LabelledStep] {
        &self.steps
    }

    /// The cause and choices of a step, by its index; `None` if there is no such step.
    pub fn step(&self, index: usize) -> Option<&TraceStep> {
        self.texts.get(self.steps.get(index)?.step)
    }

    /// The trace of a path from the start, given by the indices of its steps.
    pub fn trace_along(&self, indices: &[usize]) -> Trace {
        let steps = indices.iter().filter_map(|&index| self.texts.get(self.steps.get(index)?.step).cloned());
        Trace::new(self.chart.clone(), steps.collect())
    }
}

/// Explores a chart in an environment and records the observations of each step, within limits; a
/// number is one of states.
pub fn explore_labelled<'l>(
    chart: &Arc<CompiledChart>,
    surroundings: &mut Environment<'_>,
    watch: &mut StepLabeler<'_>,
    limits: impl Into<ExplorationLimits<'l>>,
) -> LabelledGraph {
    let limits = limits.into();
    let idle = idle_regions(chart, &watch.idle);
    let found = LabelledGraph {
        chart: chart.clone(),
        stop: None,
        overflowing: BTreeSet::new(),
        states: Vec::new(),
        steps: Vec::new(),
        texts: Vec::new(),
    };
    let mut search = LabelledSearch {
        environment: surroundings,
        labeler: watch,
        limit: limits.states,
        relevance: RelevantState::new(chart),
        idle,
        found,
        numbers: BTreeMap::new(),
        texts: BTreeMap::new(),
        known: BTreeMap::new(),
        open: VecDeque::new(),
        bytes: 0,
    };
    let start = TimedState { number: None, machine: Machine::new(chart.clone()), clocks: Vec::new() };
    search.steps(&start, &StepCause::Start, 0);
    while let Some(state) = search.open.pop_front() {
        if let Some(stop) = limits.stop(search.progress()) {
            search.found.stop = Some(stop);
            break;
        }
        search.known.clear();
        for (cause, elapsed) in search.possible_causes(&state) {
            search.steps(&state, &cause, elapsed);
        }
    }
    search.found
}

/// Whether each blackboard lies in one of some composites, by index.
pub fn idle_regions(chart: &CompiledChart, idle: &[NodeId]) -> Vec<bool> {
    let is_idle = |node: NodeId| {
        idle.contains(&node) || chart.statechart().ancestors(node).any(|outer| idle.contains(&outer))
    };
    chart.regions().map(|region| chart.region_node(region).is_some_and(is_idle)).collect()
}

struct LabelledSearch<'s, 'a, 'w> {
    environment: &'s mut Environment<'a>,
    labeler: &'s mut StepLabeler<'w>,
    limit: usize,
    relevance: RelevantState,
    /// Whether a blackboard is idle, by index.
    idle: Vec<bool>,
    found: LabelledGraph,
    numbers: BTreeMap<(StateKey, Box<[u64]>), usize>,
    texts: BTreeMap<TraceStep, usize>,
    /// The steps of the state that is being expanded.
    known: BTreeMap<(usize, u64, u64, Option<PendingEvent>), usize>,
    open: VecDeque<TimedState>,
    /// The estimated memory of the states that were found, in bytes.
    bytes: usize,
}

/// A state that has not been expanded.
struct TimedState {
    number: Option<usize>,
    machine: Machine,
    clocks: Vec<PendingClock>,
}

/// The remaining time of an activity or timer.
#[derive(Clone, Copy)]
struct PendingClock {
    of: PendingEvent,
    /// Distinguishes activations of one state.
    activation: u64,
    left: u64,
}

/// The choices of one step.
#[derive(Clone, Default)]
struct LabelledChoicePlan {
    decisions: Vec<bool>,
    choices: Vec<u32>,
}

impl LabelledSearch<'_, '_, '_> {
    fn progress(&self) -> ExplorationProgress {
        let steps = self.found.steps.len() * size_of::<LabelledStep>();
        let frontier = self.open.front().map_or(0, |state| state.machine.estimated_bytes());
        ExplorationProgress {
            states: self.found.states.len(),
            open: self.open.len(),
            bytes: self.bytes + steps + frontier * self.open.len(),
        }
    }

    /// The possible causes of the next step, with the time until they occur.
    fn possible_causes(&self, state: &TimedState) -> Vec<(StepCause, u64)> {
        let machine = &state.machine;
        if machine.status() != Status::Running {
            return Vec::new();
        }
        let is_timed = self.labeler.pace.is_some();
        let next = state.clocks.iter().map(|clock| clock.left).min();
        let due = state.clocks.iter().filter(|clock| !is_timed || Some(clock.left) == next);
        let elapsed = if is_timed { next.unwrap_or(0) } else { 0 };
        let mut moves: Vec<(StepCause, u64)> = due.map(|clock| (clock.of.ending_cause(), elapsed)).collect();
        // an event that is already queued would only lengthen the queue
        let events = self.environment.events.iter().filter(|event| !machine.is_waiting(event));
        let mut world: Vec<StepCause> = events.map(|event| StepCause::Event(event.clone())).collect();
        world.extend(self.environment.messages.then_some(StepCause::Messages));
        let last = self.labeler.pace.map_or(0, |pace| next.unwrap_or(pace.longest).min(pace.longest));
        moves.extend((0..=last).flat_map(|elapsed| world.iter().map(move |cause| (cause.clone(), elapsed))));
        moves
    }

    /// Executes all alternatives of a step.
    fn steps(&mut self, from: &TimedState, cause: &StepCause, elapsed: u64) {
        let mut plans = vec![LabelledChoicePlan::default()];
        let mut tried = 0;
        while let Some(plan) = plans.pop() {
            if tried == MAX_ALTERNATIVES {
                self.found.stop = Some(ExplorationStop::Alternatives);
                return;
            }
            tried += 1;
            self.step(from, cause, elapsed, &plan, &mut plans);
        }
    }

    fn step(
        &mut self,
        from: &TimedState,
        cause: &StepCause,
        elapsed: u64,
        plan: &LabelledChoicePlan,
        plans: &mut Vec<LabelledChoicePlan>,
    ) {
        let mut machine = from.machine.clone();
        let Environment { allows, effects, .. } = &mut *self.environment;
        let mut host = ChoosingHost::new(&mut **allows, effects).with_idle(&self.idle);
        host.begin(&plan.decisions);
        let result = advance_and_step(&mut machine, cause, plan.choices.clone(), &mut host);
        let own = host.step_decisions().len();
        let first = machine.chart().scripts().len() as u32;
        let asked =
            (first..first + self.labeler.conditions).map(|number| host.decide_after_step(ScriptId(number)));
        let conditions: Vec<bool> = asked.collect();
        let decisions = host.step_decisions().to_vec();
        let notes = host.notes;
        let choices = machine.chooser().choices().to_vec();
        push_alternatives(
            plan,
            &decisions.iter().map(|it| (it.value, it.is_free)).collect::<Vec<_>>(),
            &choices,
            plans,
        );
        if result.is_err() {
            // A step that does not become stable leads to no state; `explore` reports it.
            return;
        }
        let cut = machine.limit_queues(QUEUED);
        if !cut.is_empty() {
            self.found.overflowing.extend(cut);
            self.found.stop.get_or_insert(ExplorationStop::Queues);
        }
        let started = machine.timers_started();
        machine.postpone_timers();
        let configuration = machine.configuration();
        let step = TraceStep {
            cause: cause.clone(),
            decisions: decisions.iter().take(own).map(|it| (it.script, it.value)).collect(),
            choices: choices.iter().map(|&(chosen, _)| chosen).collect(),
        };
        let letter = (self.labeler.letter)(&StepObservation {
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
        let to = TimedState { number: from.number, machine, clocks };
        self.arrive(to, configuration, letter, elapsed, step);
    }

    /// Activities and timers in progress after a step, with their remaining times if time is
    /// counted.
    fn clocks(
        &self,
        machine: &Machine,
        started: &[(usize, Duration)],
        before: &[PendingClock],
        elapsed: u64,
    ) -> Vec<PendingClock> {
        let chart = machine.chart();
        let tick = self.labeler.pace.map(|pace| pace.tick);
        let ticks = |time: Duration| tick.map_or(0, |tick| time.as_nanos().div_ceil(tick.as_nanos()) as u64);
        let goes_on = |of: PendingEvent, activation: u64| {
            before.iter().find(|clock| clock.of == of && clock.activation == activation)
        };
        let is_idle = |region: yase::ScopeId| self.idle.get(region.index()) == Some(&true);
        let running = machine.running().into_iter().filter(|it| !is_idle(it.region)).map(|it| {
            let of = PendingEvent::Return(it.node);
            let duration = chart.activity(it.node).and_then(|entry| entry.duration).unwrap_or_default();
            let left = goes_on(of, it.number)
                .map_or_else(|| ticks(duration), |clock| clock.left.saturating_sub(elapsed));
            PendingClock { of, activation: it.number, left }
        });
        let regions: Vec<_> = chart.timers().map(|(region, _)| region).collect();
        let set = machine.timers_set().into_iter().filter(|&timer| !is_idle(regions[timer])).map(|timer| {
            let of = PendingEvent::Expiry(timer);
            let anew = started.iter().find(|(other, _)| *other == timer).map(|&(_, delay)| ticks(delay));
            let left = anew.or_else(|| goes_on(of, 0).map(|clock| clock.left.saturating_sub(elapsed)));
            PendingClock { of, activation: 0, left: left.unwrap_or(0) }
        });
        running.chain(set).collect()
    }

    /// Records a step to a state; the state is numbered on its first visit.
    fn arrive(
        &mut self,
        TimedState { number: from, machine, clocks }: TimedState,
        configuration: Vec<NodeId>,
        letter: u64,
        elapsed: u64,
        step: TraceStep,
    ) {
        let left: Box<[u64]> = match self.labeler.pace {
            Some(_) => clocks.iter().map(|clock| clock.left).collect(),
            None => Box::default(),
        };
        let count = self.found.states.len();
        let key = machine.key(&self.relevance);
        let bytes = size_of_val(&*key) + size_of_val(&*left) + size_of::<LabelledState>() + 64;
        let to = match self.numbers.entry((key, left)) {
            Entry::Occupied(known) => *known.get(),
            Entry::Vacant(_) if count >= self.limit => {
                self.found.stop = Some(ExplorationStop::States);
                return;
            }
            Entry::Vacant(indices) => {
                indices.insert(count);
                let pending: Vec<PendingEvent> = clocks.iter().map(|clock| clock.of).collect();
                self.bytes += bytes + size_of_val(&*configuration) + size_of_val(&*pending);
                self.found.states.push(LabelledState { status: machine.status(), configuration, pending });
                self.open.push_back(TimedState { number: Some(count), machine, clocks });
                count
            }
        };
        let ends = PendingEvent::ended_by(&step.cause);
        if let Entry::Vacant(entry) = self.known.entry((to, letter, elapsed, ends)) {
            let texts = &mut self.found.texts;
            let step = *self.texts.entry(step).or_insert_with_key(|step| {
                texts.push(step.clone());
                texts.len() - 1
            });
            entry.insert(self.found.steps.len());
            self.found.steps.push(LabelledStep { from, to, letter, elapsed, ends, step });
        }
    }
}

impl PendingEvent {
    /// The cause of the step at its end.
    fn ending_cause(self) -> StepCause {
        match self {
            PendingEvent::Return(node) => StepCause::Return(node),
            PendingEvent::Expiry(timer) => StepCause::Timer(timer),
        }
    }

    fn ended_by(cause: &StepCause) -> Option<PendingEvent> {
        match *cause {
            StepCause::Return(node) => Some(PendingEvent::Return(node)),
            StepCause::Timer(timer) => Some(PendingEvent::Expiry(timer)),
            _ => None,
        }
    }
}

/// Adds the remaining alternatives of a step.
fn push_alternatives(
    plan: &LabelledChoicePlan,
    decisions: &[(bool, bool)],
    choices: &[(u32, u32)],
    plans: &mut Vec<LabelledChoicePlan>,
) {
    for (index, &(value, is_free)) in decisions.iter().enumerate().skip(plan.decisions.len()) {
        if is_free {
            let before = decisions.iter().take(index).map(|&(value, _)| value);
            let decisions = before.chain([!value]).collect();
            plans.push(LabelledChoicePlan { decisions, choices: plan.choices.clone() });
        }
    }
    for (index, &(_, options)) in choices.iter().enumerate().skip(plan.choices.len()) {
        plans.extend((1..options).map(|other| {
            let before = choices.iter().take(index).map(|&(chosen, _)| chosen);
            LabelledChoicePlan { decisions: plan.decisions.clone(), choices: before.chain([other]).collect() }
        }));
    }
}
