//! Breadth-first search.

use std::collections::{BTreeMap, VecDeque};
use std::sync::Arc;

use super::host::ChoosingHost;
use super::row_interner::RowInterner;
use super::{
    Coverage, Edge, Environment, Exploration, ExplorationLimits, ExplorationProgress, ExplorationStop,
    ExploredState, FailedStep, QUEUED, StepCause, TraceStep,
};
use yase::CompiledChart;
use yase::state_key::RelevantState;
use yase::statechart::NodeId;
use yase::{Chooser, Machine, MachineError, Status};
use yase::{Host, Outcome};

/// Maximum number of alternatives of one step.
const MAX_ALTERNATIVES: usize = 2_048;

/// Explores a chart in an environment, within limits; a number is one of states.
pub fn explore<'l>(
    chart: &Arc<CompiledChart>,
    surroundings: &mut Environment<'_>,
    limits: impl Into<ExplorationLimits<'l>>,
) -> Exploration {
    explore_relevant(chart, surroundings, &limits.into(), RelevantState::new(chart))
}

/// The same with a given relevance of distinctions.
pub(crate) fn explore_relevant(
    chart: &Arc<CompiledChart>,
    surroundings: &mut Environment<'_>,
    limits: &ExplorationLimits<'_>,
    sight: RelevantState,
) -> Exploration {
    let Environment { events, messages, allows, effects } = surroundings;
    let machine = Machine::new(chart.clone());
    let mut search = StateSpaceSearch {
        events,
        messages: *messages,
        limit: limits.states,
        relevance: sight,
        found: empty_exploration(chart),
        host: ChoosingHost::new(&mut **allows, effects),
        next: machine.clone(),
        numbers: RowInterner::default(),
        steps: RowInterner::default(),
        row: Vec::new(),
        choices: Vec::new(),
        known_edges: BTreeMap::new(),
        open: VecDeque::new(),
        bytes: 0,
    };
    search.step(None, &machine, (0, &StepCause::Start));
    while let Some((number, machine)) = search.open.pop_front() {
        if let Some(stop) = limits.stop(search.progress()) {
            search.found.stop = Some(stop);
            break;
        }
        search.known_edges.clear();
        for (cause, one) in search.moves(&machine) {
            search.step(Some(number), &machine, (cause, &one));
        }
    }
    search.found
}

fn empty_exploration(chart: &Arc<CompiledChart>) -> Exploration {
    let nodes = vec![false; chart.statechart().nodes().len()].into_boxed_slice();
    let transitions = vec![false; chart.statechart().transitions().len()].into_boxed_slice();
    Exploration {
        chart: chart.clone(),
        stop: None,
        overflowing: Default::default(),
        states: Vec::new(),
        initial: Default::default(),
        edges: Vec::new(),
        steps: Vec::new(),
        failures: Vec::new(),
        coverage: Coverage {
            entered: nodes.clone(),
            left: nodes,
            taken: transitions.clone(),
            held: transitions,
        },
    }
}

struct StateSpaceSearch<'s, 'a> {
    events: &'s [String],
    messages: bool,
    limit: usize,
    relevance: RelevantState,
    found: Exploration,
    host: ChoosingHost<'s, 'a>,
    /// The machine that executes steps.
    next: Machine,
    /// The states, by their keys.
    numbers: RowInterner,
    /// The distinct steps, as words.
    steps: RowInterner,
    /// Buffer for a key or a step.
    row: Vec<u32>,
    /// The options that the last step took, and their numbers.
    choices: Vec<(u32, u32)>,
    /// The edges out of the state that is being expanded, by target and activity that returned.
    known_edges: BTreeMap<(usize, Option<NodeId>), usize>,
    /// The frontier: discovered states that have not been expanded.
    open: VecDeque<(usize, Machine)>,
    /// The estimated memory of the states that were found, in bytes.
    bytes: usize,
}

/// The choices of one step.
#[derive(Clone, Default)]
struct ChoicePlan {
    decisions: Vec<bool>,
    choices: Vec<u32>,
}

/// A cause with its number.
type NumberedCause<'c> = (u32, &'c StepCause);

impl StateSpaceSearch<'_, '_> {
    fn progress(&self) -> ExplorationProgress {
        let edges = self.found.edges.len() * size_of::<Edge>();
        let frontier = self.open.front().map_or(0, |(_, machine)| machine.estimated_bytes());
        ExplorationProgress {
            states: self.found.states.len(),
            open: self.open.len(),
            bytes: self.bytes
                + edges
                + frontier * self.open.len()
                + self.numbers.bytes()
                + 2 * self.steps.bytes(),
        }
    }

    /// The possible causes of the next step, each with its number.
    fn moves(&self, machine: &Machine) -> Vec<(u32, StepCause)> {
        if machine.status() != Status::Running {
            return Vec::new();
        }
        let returns = machine.running().into_iter().map(|activation| activation.node);
        let mut moves: Vec<(u32, StepCause)> =
            returns.map(|node| (node.0 << 2 | 1, StepCause::Return(node))).collect();
        moves.extend(
            machine.timers_set().into_iter().map(|timer| ((timer as u32) << 2 | 2, StepCause::Timer(timer))),
        );
        // an event that is already queued would only lengthen the queue
        let events = self.events.iter().enumerate().filter(|(_, event)| !machine.is_waiting(event));
        moves.extend(events.map(|(index, event)| ((index as u32) << 2 | 3, StepCause::Event(event.clone()))));
        moves.extend(self.messages.then_some((4, StepCause::Messages)));
        moves
    }

    /// Executes all alternatives of a step.
    fn step(&mut self, from: Option<usize>, machine: &Machine, cause: NumberedCause<'_>) {
        let mut plans = vec![ChoicePlan::default()];
        let mut tried = 0;
        while let Some(plan) = plans.pop() {
            if tried == MAX_ALTERNATIVES {
                self.found.stop = Some(ExplorationStop::Alternatives);
                return;
            }
            tried += 1;
            self.next.copy_from(machine);
            self.host.begin(&plan.decisions);
            let result = take_step(&mut self.next, cause.1, plan.choices.clone(), &mut self.host);
            self.choices.clear();
            self.choices.extend_from_slice(self.next.chooser().choices());
            self.push_alternatives(&plan, &mut plans);
            self.add_reached(from, cause, result);
        }
    }

    /// Adds the alternatives after the planned choices.
    fn push_alternatives(&mut self, plan: &ChoicePlan, plans: &mut Vec<ChoicePlan>) {
        let decisions = self.host.step_decisions();
        for index in plan.decisions.len()..decisions.len() {
            if decisions[index].is_free {
                let before = decisions[..index].iter().map(|decision| decision.value);
                let other = before.chain([!decisions[index].value]).collect();
                plans.push(ChoicePlan { decisions: other, choices: plan.choices.clone() });
            }
        }
        for index in plan.choices.len()..self.choices.len() {
            let before = self.choices[..index].iter().map(|&(chosen, _)| chosen);
            plans.extend((1..self.choices[index].1).map(|other| {
                let choices = before.clone().chain([other]).collect();
                ChoicePlan { decisions: plan.decisions.clone(), choices }
            }));
        }
    }

    fn add_reached(
        &mut self,
        from: Option<usize>,
        cause: NumberedCause<'_>,
        result: Result<(), MachineError>,
    ) {
        self.record_coverage();
        if let Err(error) = result {
            return self.fail(from, cause.1, &error);
        }
        let cut = self.next.limit_queues(QUEUED);
        let is_exact = cut.is_empty() && from.is_none_or(|from| self.found.states[from].is_exact);
        if !cut.is_empty() {
            self.found.overflowing.extend(cut);
            self.found.stop.get_or_insert(ExplorationStop::Queues);
        }
        self.next.write_key(&self.relevance, &mut self.row);
        let known = self.numbers.find(&self.row);
        if known.is_none() && self.found.states.len() >= self.limit {
            self.found.stop = Some(ExplorationStop::States);
            return;
        }
        let to = self.numbers.number(&self.row);
        let step = self.number_of_step(cause);
        if known.is_none() {
            self.add((from, step), is_exact);
        }
        let returned = match cause.1 {
            StepCause::Return(node) => Some(*node),
            _ => None,
        };
        match from {
            Some(from) => {
                let does_something = !self.host.notes.taken.is_empty();
                self.connect(Edge { from, to, does_something, returned, step });
            }
            None => {
                self.found.initial.insert(to);
            }
        }
    }

    fn record_coverage(&mut self) {
        let (seen, notes) = (&mut self.found.coverage, &self.host.notes);
        notes.entered.iter().for_each(|node| seen.entered[node.0 as usize] = true);
        notes.left.iter().for_each(|node| seen.left[node.0 as usize] = true);
        notes.taken.iter().for_each(|segment| seen.taken[segment.0 as usize] = true);
        notes.held.iter().for_each(|segment| seen.held[segment.0 as usize] = true);
    }

    /// Keeps one of several steps that differ only in decisions, and none without effect.
    fn connect(&mut self, edge: Edge) {
        if edge.from == edge.to && !edge.does_something && edge.returned.is_none() {
            return;
        }
        let next = self.found.edges.len();
        match *self.known_edges.entry((edge.to, edge.returned)).or_insert(next) {
            number if number == next => self.found.edges.push(edge),
            index => self.found.edges[index].does_something |= edge.does_something,
        }
    }

    fn number_of_step(&mut self, cause: NumberedCause<'_>) -> usize {
        self.row.clear();
        self.row.push(cause.0);
        self.row.extend(self.choices.iter().map(|&(chosen, _)| chosen));
        self.row.push(u32::MAX);
        let decisions = self.host.step_decisions();
        self.row.extend(decisions.iter().map(|it| it.script.0 << 1 | u32::from(it.value)));
        let number = self.steps.number(&self.row);
        if number == self.found.steps.len() {
            let step = self.last_step(cause.1);
            self.found.steps.push(step);
        }
        number
    }

    fn last_step(&mut self, cause: &StepCause) -> TraceStep {
        TraceStep {
            cause: cause.clone(),
            decisions: self.host.step_decisions().iter().map(|it| (it.script, it.value)).collect(),
            choices: self.choices.iter().map(|&(chosen, _)| chosen).collect(),
        }
    }

    fn add(&mut self, came: (Option<usize>, usize), is_exact: bool) {
        let machine = self.next.clone();
        let state = ExploredState {
            configuration: machine.configuration(),
            status: machine.status(),
            running: machine.running().into_iter().map(|activation| activation.node).collect(),
            is_exact,
            predecessor: came,
        };
        let nodes = state.configuration.len() + state.running.len();
        self.bytes += size_of::<ExploredState>() + nodes * size_of::<NodeId>();
        self.found.states.push(state);
        self.open.push_back((self.found.states.len() - 1, machine));
    }

    /// A chart that writes may leave its cycle: the effect of writes is unknown.
    fn fail(&mut self, from: Option<usize>, cause: &StepCause, error: &MachineError) {
        if self.host.notes.wrote {
            return;
        }
        let step = self.last_step(cause);
        let mut cycle = error.cycle().to_vec();
        cycle.sort_unstable();
        let is_known = |it: &FailedStep| it.kind == error.kind() && it.cycle == cycle;
        if !self.found.failures.iter().any(is_known) {
            self.found.failures.push(FailedStep { from, step, kind: error.kind(), cycle });
        }
    }
}

/// Executes a step for a cause. Timers do not expire until they are chosen.
pub(crate) fn take_step(
    machine: &mut Machine,
    cause: &StepCause,
    choices: Vec<u32>,
    host: &mut ChoosingHost<'_, '_>,
) -> Result<(), MachineError> {
    advance_and_step(machine, cause, choices, host)?;
    machine.postpone_timers();
    Ok(())
}

/// Executes a step for a cause. Timers set by it have their real deadlines.
pub fn advance_and_step<H: Host>(
    machine: &mut Machine,
    cause: &StepCause,
    choices: Vec<u32>,
    host: &mut H,
) -> Result<(), MachineError> {
    let now = machine.next_moment();
    machine.set_chooser(Chooser::scripted(choices));
    match cause {
        StepCause::Start => machine.start(now, host),
        StepCause::Event(name) => {
            machine.dispatch_name(name);
        }
        StepCause::Return(node) => {
            if let Some(activation) = machine.running_at(*node) {
                machine.activity_returned(activation, Outcome::Done);
            }
        }
        StepCause::Timer(timer) => {
            machine.make_due(*timer);
        }
        StepCause::Messages => {}
    }
    machine.run_to_completion(now, host)?;
    Ok(())
}
