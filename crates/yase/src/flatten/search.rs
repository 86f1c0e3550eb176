//! Steps from each state for each event, in each way in which conditions may turn out.

use std::sync::Arc;

use super::record::{Record, Recorder};
use super::words::{Word, Words};
use super::{Flat, FlatEvent, FlatState, Piece, Way};
use crate::chart::Chart;
use crate::diagnostic::{Diagnostic, Span};
use crate::explore::{Move, Numbers, go};
use crate::machine::explored::Sight;
use crate::machine::{Machine, MachineError, Status};
use crate::statechart::NodeId;

/// So many steps are tried for each state that there may be.
const STEPS: usize = 256;

/// A name that no expression has: events with it are others.
const OTHER: &str = "?";

pub(super) fn search(chart: &Arc<Chart>, words: Words, limit: usize) -> Result<Flat, Diagnostic> {
    let scripts: Vec<Option<Word>> = chart.scripts().map(|script| Word::of(script.text)).collect();
    let mut search = Search {
        scripts: &scripts,
        sight: Sight::new(chart),
        limit,
        numbers: Numbers::default(),
        key: Vec::new(),
        machines: Vec::new(),
        states: Vec::new(),
        steps: 0,
    };
    let start = search.way(&Machine::new(chart.clone()), &Move::Start, &[])?;
    let moves = words.events.iter().map(|event| match event {
        FlatEvent::Named(name) => Move::Event(name.clone()),
        FlatEvent::Other => Move::Event(OTHER.to_owned()),
        FlatEvent::Nothing => Move::Messages,
    });
    let moves: Vec<Move> = moves.collect();
    let mut ways = Vec::new();
    while let Some(machine) = search.machines.get(ways.len()).cloned() {
        let state = ways.len();
        let mut row = Vec::with_capacity(moves.len());
        for event in &moves {
            row.push(match search.states[state].is_over {
                true => Way { pieces: Vec::new(), to: state },
                false => search.way(&machine, event, &[])?,
            });
        }
        ways.push(row);
    }
    let Words { events, conditions, actions, .. } = words;
    let name = chart.statechart().name.clone();
    Ok(Flat { name, states: search.states, events, conditions, actions, start, ways }
        .merged()
        .without_unused())
}

struct Search<'s> {
    scripts: &'s [Option<Word>],
    sight: Sight,
    limit: usize,
    /// The states, by what can matter to what comes.
    numbers: Numbers,
    key: Vec<u32>,
    machines: Vec<Machine>,
    states: Vec<FlatState>,
    steps: usize,
}

impl Search<'_> {
    /// What happens behind the point where the conditions that are planned have been asked.
    fn way(&mut self, from: &Machine, cause: &Move, planned: &[bool]) -> Result<Way, Diagnostic> {
        self.steps += 1;
        let most = self.limit.saturating_mul(STEPS);
        if self.steps > most {
            return Err(too_many(format!("it has more than {most} ways")));
        }
        let mut machine = from.clone();
        let mut recorder = Recorder::new(self.scripts, planned);
        go(&mut machine, cause, Vec::new(), &mut recorder).map_err(|error| endless(from, &error))?;
        if !machine.chooser().choices().is_empty() {
            let message = "which of its transitions wins is left to chance".to_owned();
            return Err(Diagnostic::error("E0160", Span::default(), message));
        }
        let to = self.number(machine)?;
        let mut pieces = Vec::new();
        let mut asked = planned.to_vec();
        for record in behind(&recorder.records(), planned.len()) {
            pieces.push(match *record {
                Record::Did(action) => Piece::Do(action),
                Record::Asked(condition) => {
                    asked.push(true);
                    let way = self.way(from, cause, &asked)?;
                    asked.pop();
                    asked.push(false);
                    Piece::If(condition, way)
                }
            });
        }
        Ok(without_idle_questions(Way { pieces, to }))
    }

    fn number(&mut self, machine: Machine) -> Result<usize, Diagnostic> {
        machine.write_key(&self.sight, &mut self.key);
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

/// What comes when so many conditions have been asked.
fn behind(records: &[Record], asked: usize) -> &[Record] {
    let questions = records.iter().enumerate().filter(|(_, record)| matches!(record, Record::Asked(_)));
    let last = asked.checked_sub(1).and_then(|last| questions.map(|(index, _)| index).nth(last));
    &records[last.map_or(0, |last| last + 1)..]
}

/// A condition that changes nothing is not asked.
pub(super) fn without_idle_questions(mut way: Way) -> Way {
    for index in (0..way.pieces.len()).rev() {
        let is_idle = match &way.pieces[index] {
            Piece::If(_, other) => other.to == way.to && other.pieces == way.pieces[index + 1..],
            Piece::Do(_) => false,
        };
        if is_idle {
            way.pieces.remove(index);
        }
    }
    way
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
        .with_hint("a chart whose regions have many states runs on a machine, which keeps them apart")
}

fn endless(from: &Machine, error: &MachineError) -> Diagnostic {
    let active =
        from.configuration().iter().map(|&node| from.chart().short_path(node)).collect::<Vec<_>>().join(", ");
    let place = if active.is_empty() {
        String::from("when it is started")
    } else {
        format!("where active are {active}")
    };
    Diagnostic::error("E0162", Span::default(), format!("a step has no end, {place}: {error}"))
}
