//! The search, breadth first.

use std::collections::BTreeMap;
use std::collections::VecDeque;
use std::sync::Arc;

use super::host::{Chosen, Notes};
use super::{Edge, Exploration, Failure, Move, State, Step, Surroundings};
use crate::chart::Chart;
use crate::host::Outcome;
use crate::machine::explored::Key;
use crate::machine::{Chooser, Machine, MachineError, Status};

/// So many ways are tried in which one step may go.
const WAYS: usize = 2_048;

/// Finds out what a chart can do in surroundings, looking at no more than `limit` states.
pub fn explore(chart: &Arc<Chart>, surroundings: &mut Surroundings<'_>, limit: usize) -> Exploration {
    let found = Exploration {
        chart: chart.clone(),
        is_finished: true,
        states: Vec::new(),
        initial: Default::default(),
        edges: Vec::new(),
        steps: Vec::new(),
        failures: Vec::new(),
        entered: Default::default(),
        left: Default::default(),
        taken: Default::default(),
        held: Default::default(),
    };
    let (numbers, steps, open) = (BTreeMap::new(), BTreeMap::new(), VecDeque::new());
    let mut search = Search { surroundings, limit, found, numbers, steps, open };
    search.step(None, &Machine::new(chart.clone()), &Move::Start);
    while let Some((number, machine)) = search.open.pop_front() {
        for cause in search.moves(&machine) {
            search.step(Some(number), &machine, &cause);
        }
    }
    search.found
}

struct Search<'s, 'a> {
    surroundings: &'s mut Surroundings<'a>,
    limit: usize,
    found: Exploration,
    /// The number of each state.
    numbers: BTreeMap<Key, usize>,
    /// The number of each step.
    steps: BTreeMap<Step, usize>,
    /// The states that were found and not yet looked at.
    open: VecDeque<(usize, Machine)>,
}

/// What is chosen in one step.
#[derive(Clone, Default)]
struct Plan {
    decisions: Vec<bool>,
    choices: Vec<u32>,
}

impl Search<'_, '_> {
    /// What may happen next.
    fn moves(&self, machine: &Machine) -> Vec<Move> {
        if machine.status() != Status::Running {
            return Vec::new();
        }
        let mut moves: Vec<Move> =
            machine.running().into_iter().map(|activation| Move::Return(activation.node)).collect();
        moves.extend(machine.timers_set().into_iter().map(Move::Timer));
        // an event that waits already would only make the queue longer
        let events = self.surroundings.events.iter().filter(|event| !machine.is_waiting(event));
        moves.extend(events.map(|event| Move::Event(event.clone())));
        moves.extend(self.surroundings.messages.then_some(Move::Messages));
        moves
    }

    /// Takes a step in every way in which it may go.
    fn step(&mut self, from: Option<usize>, machine: &Machine, cause: &Move) {
        let mut plans = vec![Plan::default()];
        let mut tried = 0;
        while let Some(plan) = plans.pop() {
            if tried == WAYS {
                self.found.is_finished = false;
                return;
            }
            tried += 1;
            self.step_as_planned(from, machine, cause, &plan, &mut plans);
        }
    }

    fn step_as_planned(
        &mut self,
        from: Option<usize>,
        machine: &Machine,
        cause: &Move,
        plan: &Plan,
        plans: &mut Vec<Plan>,
    ) {
        let mut next = machine.clone();
        let mut host = Chosen::new(&mut *self.surroundings.allows, &plan.decisions);
        let result = take(&mut next, cause, plan.choices.clone(), &mut host);
        let (decisions, notes) = host.finish();
        let choices = next.chooser().choices().to_vec();
        let values: Vec<bool> = decisions.iter().map(|decision| decision.value).collect();
        for index in plan.decisions.len()..decisions.len() {
            if decisions[index].is_free {
                let mut other = values[..index].to_vec();
                other.push(!values[index]);
                plans.push(Plan { decisions: other, choices: plan.choices.clone() });
            }
        }
        for index in plan.choices.len()..choices.len() {
            let before: Vec<u32> = choices[..index].iter().map(|&(chosen, _)| chosen).collect();
            plans.extend((1..choices[index].1).map(|other| {
                let choices = before.iter().copied().chain([other]).collect();
                Plan { decisions: plan.decisions.clone(), choices }
            }));
        }
        let step = Step {
            cause: cause.clone(),
            decisions: decisions.iter().map(|decision| (decision.script, decision.value)).collect(),
            choices: choices.iter().map(|&(chosen, _)| chosen).collect(),
        };
        self.arrive(from, next, step, &notes, result);
    }

    fn arrive(
        &mut self,
        from: Option<usize>,
        machine: Machine,
        step: Step,
        notes: &Notes,
        result: Result<(), MachineError>,
    ) {
        self.found.entered.extend(&notes.entered);
        self.found.left.extend(&notes.left);
        self.found.taken.extend(&notes.taken);
        self.found.held.extend(&notes.held);
        if let Err(error) = result {
            return self.fail(from, step, notes, &error);
        }
        let key = machine.key();
        let known = self.numbers.get(&key).copied();
        if known.is_none() && self.found.states.len() >= self.limit {
            self.found.is_finished = false;
            return;
        }
        let returned = match step.cause {
            Move::Return(node) => Some(node),
            _ => None,
        };
        let step = self.number_of(step);
        let to = known.unwrap_or_else(|| self.add((from, step), machine, key));
        match from {
            Some(from) => {
                let does_something = !notes.taken.is_empty();
                self.connect(Edge { from, to, does_something, returned, step });
            }
            None => {
                self.found.initial.insert(to);
            }
        }
    }

    /// Of steps that differ only in what was asked, one is kept, and none that does nothing.
    fn connect(&mut self, edge: Edge) {
        if edge.from == edge.to && !edge.does_something && edge.returned.is_none() {
            return;
        }
        let before = self.found.edges.iter_mut().rev().take_while(|other| other.from == edge.from);
        let same = before.into_iter().find(|other| other.to == edge.to && other.returned == edge.returned);
        match same {
            Some(same) => same.does_something |= edge.does_something,
            None => self.found.edges.push(edge),
        }
    }

    fn number_of(&mut self, step: Step) -> usize {
        let steps = &mut self.found.steps;
        *self.steps.entry(step).or_insert_with_key(|step| {
            steps.push(step.clone());
            steps.len() - 1
        })
    }

    fn add(&mut self, came: (Option<usize>, usize), machine: Machine, key: Key) -> usize {
        let number = self.found.states.len();
        self.numbers.insert(key, number);
        self.found.states.push(State {
            configuration: machine.configuration(),
            status: machine.status(),
            running: machine.running().into_iter().map(|activation| activation.node).collect(),
            came,
        });
        self.open.push_back((number, machine));
        number
    }

    /// A chart that writes may leave its circle: nothing is known of what it writes.
    fn fail(&mut self, from: Option<usize>, step: Step, notes: &Notes, error: &MachineError) {
        if notes.wrote {
            return;
        }
        let mut cycle = error.cycle().to_vec();
        cycle.sort_unstable();
        let is_known = |it: &Failure| it.kind == error.kind() && it.cycle == cycle;
        if !self.found.failures.iter().any(is_known) {
            self.found.failures.push(Failure { from, step, kind: error.kind(), cycle });
        }
    }
}

/// Takes a step for a cause. Timers wait after it until they are chosen to expire.
pub(super) fn take(
    machine: &mut Machine,
    cause: &Move,
    choices: Vec<u32>,
    host: &mut Chosen<'_, '_>,
) -> Result<(), MachineError> {
    go(machine, cause, choices, host)?;
    machine.put_timers_off();
    Ok(())
}

/// Takes a step for a cause. Timers that it set know when they are due.
pub(super) fn go(
    machine: &mut Machine,
    cause: &Move,
    choices: Vec<u32>,
    host: &mut Chosen<'_, '_>,
) -> Result<(), MachineError> {
    let now = machine.next_moment();
    machine.set_chooser(Chooser::scripted(choices));
    match cause {
        Move::Start => machine.start(now, host),
        Move::Event(name) => {
            machine.dispatch_name(name);
        }
        Move::Return(node) => {
            let running = machine.running().into_iter().find(|activation| activation.node == *node);
            if let Some(activation) = running {
                machine.activity_returned(activation, Outcome::Done);
            }
        }
        Move::Timer(timer) => {
            machine.make_due(*timer);
        }
        Move::Messages => {}
    }
    machine.run_to_completion(now, host)?;
    Ok(())
}
