//! The search, breadth first.

use std::collections::VecDeque;
use std::sync::Arc;

use super::host::Chosen;
use super::numbers::Numbers;
use super::{Edge, Exploration, Failure, Happened, Move, State, Step, Surroundings};
use crate::bits::BitSet;
use crate::chart::Chart;
use crate::host::{Host, Outcome};
use crate::machine::explored::Sight;
use crate::machine::{Chooser, Machine, MachineError, Status};

/// So many ways are tried in which one step may go.
const WAYS: usize = 2_048;

/// Finds out what a chart can do in surroundings, looking at no more than `limit` states.
pub fn explore(chart: &Arc<Chart>, surroundings: &mut Surroundings<'_>, limit: usize) -> Exploration {
    explore_as_seen(chart, surroundings, limit, Sight::new(chart))
}

/// The same, with what is to be told apart.
pub(super) fn explore_as_seen(
    chart: &Arc<Chart>,
    surroundings: &mut Surroundings<'_>,
    limit: usize,
    sight: Sight,
) -> Exploration {
    let Surroundings { events, messages, allows } = surroundings;
    let machine = Machine::new(chart.clone());
    let mut search = Search {
        events,
        messages: *messages,
        limit,
        sight,
        found: nothing_yet(chart),
        host: Chosen::new(&mut **allows),
        next: machine.clone(),
        numbers: Numbers::default(),
        steps: Numbers::default(),
        row: Vec::new(),
        choices: Vec::new(),
        open: VecDeque::new(),
    };
    search.step(None, &machine, (0, &Move::Start));
    while let Some((number, machine)) = search.open.pop_front() {
        for (cause, one) in search.moves(&machine) {
            search.step(Some(number), &machine, (cause, &one));
        }
    }
    search.found
}

fn nothing_yet(chart: &Arc<Chart>) -> Exploration {
    let nodes = BitSet::new(chart.statechart().nodes().len());
    let transitions = BitSet::new(chart.statechart().transitions().len());
    Exploration {
        chart: chart.clone(),
        is_finished: true,
        states: Vec::new(),
        initial: Default::default(),
        edges: Vec::new(),
        steps: Vec::new(),
        failures: Vec::new(),
        seen: Happened { entered: nodes.clone(), left: nodes, taken: transitions.clone(), held: transitions },
    }
}

struct Search<'s, 'a> {
    events: &'s [String],
    messages: bool,
    limit: usize,
    sight: Sight,
    found: Exploration,
    host: Chosen<'s, 'a>,
    /// The machine that takes the steps.
    next: Machine,
    /// The states, by their keys.
    numbers: Numbers,
    /// The steps that lead anywhere, as words.
    steps: Numbers,
    /// A key or a step that is being written.
    row: Vec<u32>,
    /// Which options the last step took, and of how many.
    choices: Vec<(u32, u32)>,
    /// The states that were found and not yet looked at.
    open: VecDeque<(usize, Machine)>,
}

/// What is chosen in one step.
#[derive(Clone, Default)]
struct Plan {
    decisions: Vec<bool>,
    choices: Vec<u32>,
}

/// A cause, with the words that it is known by.
type Cause<'c> = (u32, &'c Move);

impl Search<'_, '_> {
    /// What may happen next, each with a word of its own.
    fn moves(&self, machine: &Machine) -> Vec<(u32, Move)> {
        if machine.status() != Status::Running {
            return Vec::new();
        }
        let returns = machine.running().into_iter().map(|activation| activation.node);
        let mut moves: Vec<(u32, Move)> = returns.map(|node| (node.0 << 2 | 1, Move::Return(node))).collect();
        moves.extend(
            machine.timers_set().into_iter().map(|timer| ((timer as u32) << 2 | 2, Move::Timer(timer))),
        );
        // an event that waits already would only make the queue longer
        let events = self.events.iter().enumerate().filter(|(_, event)| !machine.is_waiting(event));
        moves.extend(events.map(|(index, event)| ((index as u32) << 2 | 3, Move::Event(event.clone()))));
        moves.extend(self.messages.then_some((4, Move::Messages)));
        moves
    }

    /// Takes a step in every way in which it may go.
    fn step(&mut self, from: Option<usize>, machine: &Machine, cause: Cause<'_>) {
        let mut plans = vec![Plan::default()];
        let mut tried = 0;
        while let Some(plan) = plans.pop() {
            if tried == WAYS {
                self.found.is_finished = false;
                return;
            }
            tried += 1;
            self.next.copy_from(machine);
            self.host.begin(&plan.decisions);
            let result = take(&mut self.next, cause.1, plan.choices.clone(), &mut self.host);
            self.choices.clear();
            self.choices.extend_from_slice(self.next.chooser().choices());
            self.plan_others(&plan, &mut plans);
            self.arrive(from, cause, result);
        }
    }

    /// What else could have been chosen behind what was planned.
    fn plan_others(&mut self, plan: &Plan, plans: &mut Vec<Plan>) {
        let decisions = self.host.decided();
        for index in plan.decisions.len()..decisions.len() {
            if decisions[index].is_free {
                let before = decisions[..index].iter().map(|decision| decision.value);
                let other = before.chain([!decisions[index].value]).collect();
                plans.push(Plan { decisions: other, choices: plan.choices.clone() });
            }
        }
        for index in plan.choices.len()..self.choices.len() {
            let before = self.choices[..index].iter().map(|&(chosen, _)| chosen);
            plans.extend((1..self.choices[index].1).map(|other| {
                let choices = before.clone().chain([other]).collect();
                Plan { decisions: plan.decisions.clone(), choices }
            }));
        }
    }

    fn arrive(&mut self, from: Option<usize>, cause: Cause<'_>, result: Result<(), MachineError>) {
        self.take_note();
        if let Err(error) = result {
            return self.fail(from, cause.1, &error);
        }
        self.next.write_key(&self.sight, &mut self.row);
        let known = self.numbers.find(&self.row);
        if known.is_none() && self.found.states.len() >= self.limit {
            self.found.is_finished = false;
            return;
        }
        let to = self.numbers.number(&self.row);
        let step = self.number_of_step(cause);
        if known.is_none() {
            self.add((from, step));
        }
        let returned = match cause.1 {
            Move::Return(node) => Some(*node),
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

    fn take_note(&mut self) {
        let (seen, notes) = (&mut self.found.seen, &self.host.notes);
        notes.entered.iter().for_each(|node| seen.entered.insert(node.0 as usize));
        notes.left.iter().for_each(|node| seen.left.insert(node.0 as usize));
        notes.taken.iter().for_each(|segment| seen.taken.insert(segment.0 as usize));
        notes.held.iter().for_each(|segment| seen.held.insert(segment.0 as usize));
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

    fn number_of_step(&mut self, cause: Cause<'_>) -> usize {
        self.row.clear();
        self.row.push(cause.0);
        self.row.extend(self.choices.iter().map(|&(chosen, _)| chosen));
        self.row.push(u32::MAX);
        let decisions = self.host.decided();
        self.row.extend(decisions.iter().map(|it| it.script.0 << 1 | u32::from(it.value)));
        let number = self.steps.number(&self.row);
        if number == self.found.steps.len() {
            let step = self.last_step(cause.1);
            self.found.steps.push(step);
        }
        number
    }

    fn last_step(&mut self, cause: &Move) -> Step {
        Step {
            cause: cause.clone(),
            decisions: self.host.decided().iter().map(|it| (it.script, it.value)).collect(),
            choices: self.choices.iter().map(|&(chosen, _)| chosen).collect(),
        }
    }

    fn add(&mut self, came: (Option<usize>, usize)) {
        let machine = self.next.clone();
        self.found.states.push(State {
            configuration: machine.configuration(),
            status: machine.status(),
            running: machine.running().into_iter().map(|activation| activation.node).collect(),
            came,
        });
        self.open.push_back((self.found.states.len() - 1, machine));
    }

    /// A chart that writes may leave its circle: nothing is known of what it writes.
    fn fail(&mut self, from: Option<usize>, cause: &Move, error: &MachineError) {
        if self.host.notes.wrote {
            return;
        }
        let step = self.last_step(cause);
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
pub(crate) fn go<H: Host>(
    machine: &mut Machine,
    cause: &Move,
    choices: Vec<u32>,
    host: &mut H,
) -> Result<(), MachineError> {
    let now = machine.next_moment();
    machine.set_chooser(Chooser::scripted(choices));
    match cause {
        Move::Start => machine.start(now, host),
        Move::Event(name) => {
            machine.dispatch_name(name);
        }
        Move::Return(node) => {
            if let Some(activation) = machine.running_at(*node) {
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
