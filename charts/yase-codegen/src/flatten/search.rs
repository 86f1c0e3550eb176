//! Steps from each state for each event, with all values of conditions.

use std::sync::Arc;

use super::recording_host::{RecordedCall, RecordingHost};
use super::symbols::{Symbol, SymbolTable};
use super::{FlatEvent, FlatMachine, FlatOp, FlatPath, FlatState};
use yase::CompiledChart;
use yase::diagnostic::{Diagnostic, Span};
use yase::state_key::RelevantState;
use yase::statechart::NodeId;
use yase::{Machine, MachineError, Status};
use yase_explore::{RowInterner, StepCause, advance_and_step};

/// Maximum number of steps per possible state.
const MAX_STEPS_PER_STATE: usize = 256;

/// Maximum number of conditions that hold on a path: each is one level of nested code, and of
/// recursion.
const MAX_DEPTH: usize = 256;

/// A name that no expression contains: it represents all other events.
const OTHER_EVENT: &str = "?";

pub(crate) fn search(
    chart: &Arc<CompiledChart>,
    words: SymbolTable,
    limit: usize,
) -> Result<FlatMachine, Diagnostic> {
    let scripts: Vec<Option<Symbol>> = chart.scripts().map(|script| Symbol::of(script.text)).collect();
    let mut search = FlatSearch {
        scripts: &scripts,
        relevance: RelevantState::new(chart),
        limit,
        numbers: RowInterner::default(),
        key: Vec::new(),
        machines: Vec::new(),
        states: Vec::new(),
        steps: 0,
    };
    let start = search.path(&Machine::new(chart.clone()), &StepCause::Start, &[])?;
    let moves = words.events.iter().map(|event| match event {
        FlatEvent::Named(name) => StepCause::Event(name.clone()),
        FlatEvent::Other => StepCause::Event(OTHER_EVENT.to_owned()),
        FlatEvent::Nothing => StepCause::Messages,
    });
    let moves: Vec<StepCause> = moves.collect();
    let mut paths = Vec::new();
    while let Some(machine) = search.machines.get(paths.len()).cloned() {
        let state = paths.len();
        let mut row = Vec::with_capacity(moves.len());
        for event in &moves {
            row.push(match search.states[state].is_over {
                true => FlatPath { pieces: Vec::new(), to: state },
                false => search.path(&machine, event, &[])?,
            });
        }
        paths.push(row);
    }
    let SymbolTable { events, conditions, actions, .. } = words;
    let name = chart.statechart().name.clone();
    Ok(FlatMachine { name, states: search.states, events, conditions, actions, start, paths }
        .merged()
        .without_unused())
}

struct FlatSearch<'s> {
    scripts: &'s [Option<Symbol>],
    relevance: RelevantState,
    limit: usize,
    /// The states, by the part that affects later behaviour.
    numbers: RowInterner,
    key: Vec<u32>,
    machines: Vec<Machine>,
    states: Vec<FlatState>,
    steps: usize,
}

impl FlatSearch<'_> {
    /// The operations after the planned conditions have been read.
    fn path(&mut self, from: &Machine, cause: &StepCause, planned: &[bool]) -> Result<FlatPath, Diagnostic> {
        self.steps += 1;
        let max = self.limit.saturating_mul(MAX_STEPS_PER_STATE);
        if self.steps > max {
            return Err(too_many(format!("it has more than {max} paths")));
        }
        if planned.iter().filter(|holds| **holds).count() > MAX_DEPTH {
            return Err(self.too_deep(from, cause, planned));
        }
        let (records, to) = self.run(from, cause, planned)?;
        let mut pieces = Vec::new();
        let mut asked = planned.to_vec();
        for record in records_after(&records, planned.len()) {
            pieces.push(match *record {
                RecordedCall::ActionExecuted(action) => FlatOp::Do(action),
                RecordedCall::ConditionRead(condition) => {
                    asked.push(true);
                    let path = self.path(from, cause, &asked)?;
                    asked.pop();
                    asked.push(false);
                    FlatOp::If(condition, path)
                }
            });
        }
        Ok(without_idle_questions(FlatPath { pieces, to }))
    }

    /// The calls of a step and its target. The recursion keeps no machine.
    fn run(
        &mut self,
        from: &Machine,
        cause: &StepCause,
        planned: &[bool],
    ) -> Result<(Vec<RecordedCall>, usize), Diagnostic> {
        let mut machine = from.clone();
        let mut recorder = RecordingHost::new(self.scripts, planned);
        advance_and_step(&mut machine, cause, Vec::new(), &mut recorder)
            .map_err(|error| endless(from, &error))?;
        if !machine.chooser().choices().is_empty() {
            let message = "a conflict of its transitions is resolved at random".to_owned();
            return Err(Diagnostic::error("E0160", Span::default(), message));
        }
        Ok((recorder.records(), self.number(machine)?))
    }

    /// The error of a path on which too many conditions hold: a livelock if it does not end when
    /// all later ones hold too.
    fn too_deep(&mut self, from: &Machine, cause: &StepCause, planned: &[bool]) -> Diagnostic {
        let later = vec![true; MAX_DEPTH.saturating_mul(MAX_DEPTH)];
        match self.run(from, cause, &[planned, &later].concat()) {
            Err(found) => found,
            Ok(_) => too_many(format!("more than {MAX_DEPTH} of its conditions hold on one path")),
        }
    }

    fn number(&mut self, machine: Machine) -> Result<usize, Diagnostic> {
        machine.write_key(&self.relevance, &mut self.key);
        if machine.status() != Status::Running {
            self.key.clear(); // whatever it remembers
        }
        let number = self.numbers.number(&self.key);
        if number == self.machines.len() {
            if number == self.limit {
                return Err(too_many(format!("it has more than {} configurations", self.limit)));
            }
            self.states.push(state(&machine));
            self.machines.push(machine);
        }
        Ok(number)
    }
}

/// The records after this many conditions have been read.
fn records_after(records: &[RecordedCall], asked: usize) -> &[RecordedCall] {
    let questions =
        records.iter().enumerate().filter(|(_, record)| matches!(record, RecordedCall::ConditionRead(_)));
    let last = asked.checked_sub(1).and_then(|last| questions.map(|(index, _)| index).nth(last));
    &records[last.map_or(0, |last| last + 1)..]
}

/// Removes conditions without effect.
pub(crate) fn without_idle_questions(mut path: FlatPath) -> FlatPath {
    for index in (0..path.pieces.len()).rev() {
        let is_idle = match &path.pieces[index] {
            FlatOp::If(_, other) => other.to == path.to && other.pieces == path.pieces[index + 1..],
            FlatOp::Do(_) => false,
        };
        if is_idle {
            path.pieces.remove(index);
        }
    }
    path
}

fn state(machine: &Machine) -> FlatState {
    let is_over = machine.status() != Status::Running;
    let configuration = if is_over { Vec::new() } else { machine.configuration() };
    let chart = machine.chart().statechart();
    let has_none_inside =
        |node: &&NodeId| !configuration.iter().any(|&it| chart.node(it).parent == Some(**node));
    let leaves = configuration.iter().filter(has_none_inside).map(|&node| machine.chart().short_path(node));
    FlatState { leaves: leaves.collect(), configuration, is_over }
}

fn too_many(message: String) -> Diagnostic {
    Diagnostic::error("E0161", Span::default(), message)
        .with_hint("execute a chart with many states in its regions on a machine")
}

fn endless(from: &Machine, error: &MachineError) -> Diagnostic {
    let active =
        from.configuration().iter().map(|&node| from.chart().short_path(node)).collect::<Vec<_>>().join(", ");
    let place =
        if active.is_empty() { String::from("when it is started") } else { format!("with {active} active") };
    Diagnostic::error("E0162", Span::default(), format!("a livelock, {place}: {error}"))
}
