//! The host of a replay: which delivery or assignment each condition reads.
//!
//! A message that a blackboard shows has the number of the delivery that brought it: names with
//! different numbers are different unknowns. A field that was assigned is what was assigned to it.

use std::cell::RefCell;
use std::collections::{BTreeMap, BTreeSet};

use yase::expression::{CallError, Expression, ExpressionKind, Name, Path, ScriptId};
use yase::{Activation, ActiveStates, Host, ScopeId, ScriptContext};

use crate::abstraction::{Abstraction, Assignment, may_be_one_message, same_message};

/// Stands between the number and the name of what is read.
const NUMBER_SEPARATOR: char = '\'';

/// The origins of a run's messages.
pub(crate) struct MessageSources<'a> {
    /// Whether nothing but the chart itself publishes the message of a field.
    pub(crate) is_own: &'a dyn Fn(&Path) -> bool,
    /// The messages that arrive with steps that name them, and else stay as they are.
    pub(crate) announced: Vec<Path>,
}

/// The contents of a blackboard.
#[derive(Clone, Debug, Default)]
struct ReplayBoard {
    /// The number of its last delivery.
    delivery: u32,
    /// The assignments on it since.
    written: Vec<usize>,
}

/// An assignment that was executed.
struct Write {
    assignment: Assignment,
    /// Its value, as a term over what was read then.
    value: ExpressionKind,
    /// The last delivery before it.
    delivery: u32,
}

/// Executes the steps of a run and collects what its conditions say.
pub(super) struct ReplayHost<'a> {
    abstraction: &'a Abstraction,
    idle: Vec<bool>,
    sources: MessageSources<'a>,
    /// The number of the step that is being executed, from 0.
    steps: usize,
    is_begun: bool,
    delivery: u32,
    boards: Vec<ReplayBoard>,
    writes: Vec<Write>,
    /// Arrivals of announced messages, with the deliveries that bring them.
    arrivals: Vec<(Path, u32)>,
    decisions: Vec<(ScriptId, bool)>,
    log: RefCell<ReplayLog>,
}

/// A fact of a run.
#[derive(Clone)]
pub(super) struct RunClaim {
    /// As it is written in the model.
    pub(super) written: Expression,
    /// Of what is read there.
    pub(super) condition: Expression,
    pub(super) holds: bool,
    /// The number of the step in which it is read.
    pub(super) step: usize,
}

/// Decisions and claims of a replay, in order.
#[derive(Default)]
struct ReplayLog {
    /// The place of the next decision of this step.
    next: usize,
    /// Known values of this step.
    known: Vec<(ScopeId, ScriptId, bool)>,
    claims: Vec<RunClaim>,
    /// The deliveries in which each message is read.
    read: BTreeMap<String, (Path, BTreeSet<u32>)>,
    error: Option<String>,
}

impl RunClaim {
    /// Something that follows from how messages come.
    fn of(condition: Expression, step: usize) -> RunClaim {
        let written = condition.replaced(&mut |part| {
            let kind = match &part.kind {
                ExpressionKind::Absent(path) => ExpressionKind::Absent(unnumbered(path)),
                ExpressionKind::Present(path) => ExpressionKind::Present(unnumbered(path)),
                _ => return None,
            };
            Some(Expression { kind, position: part.position })
        });
        RunClaim { written, condition, holds: true, step }
    }
}

impl<'a> ReplayHost<'a> {
    pub(super) fn new(
        abstraction: &'a Abstraction,
        idle: Vec<bool>,
        sources: MessageSources<'a>,
    ) -> ReplayHost<'a> {
        ReplayHost {
            abstraction,
            idle,
            sources,
            steps: 0,
            is_begun: false,
            delivery: 0,
            boards: vec![ReplayBoard::default(); abstraction.chart.regions().len()],
            writes: Vec::new(),
            arrivals: Vec::new(),
            decisions: Vec::new(),
            log: RefCell::default(),
        }
    }

    /// Begins a step that makes such decisions.
    pub(super) fn begin(&mut self, event: Option<&str>, decisions: &[(ScriptId, bool)]) {
        self.steps += usize::from(self.is_begun);
        self.is_begun = true;
        self.delivery += 1;
        self.decisions = decisions.to_vec();
        let named = self.sources.announced.iter().filter(|path| event == Some(path.text().as_str()));
        self.arrivals.extend(named.map(|path| (path.clone(), self.delivery)));
        let log = self.log.get_mut();
        log.next = 0;
        log.known.clear();
    }

    /// Ends a step: the machine must have asked what the run has decided.
    pub(super) fn end(&mut self) -> Result<(), String> {
        let log = self.log.get_mut();
        match log.error.take() {
            Some(trouble) => Err(trouble),
            None if log.next != self.decisions.len() => Err("other conditions are read there".into()),
            None => Ok(()),
        }
    }

    pub(super) fn step_number(&self) -> usize {
        self.steps
    }

    /// An announced message arrives with the next delivery.
    pub(super) fn receive(&mut self, message: &Path, known: &[Expression]) {
        self.arrivals.push((message.clone(), self.delivery + 1));
        self.claim_of_delivery(self.delivery + 1, known);
    }

    /// Records facts about the messages before the first step.
    pub(super) fn assume(&mut self, known: &[Expression]) {
        self.claim_of_delivery(0, known);
    }

    fn claim_of_delivery(&mut self, delivery: u32, known: &[Expression]) {
        let board = ReplayBoard { delivery, written: Vec::new() };
        for condition in known {
            let claim = RunClaim {
                written: condition.clone(),
                condition: self.versioned(condition, &board),
                holds: true,
                step: self.steps,
            };
            self.log.get_mut().claims.push(claim);
        }
    }

    /// Records a fact after a step on the blackboard of the root, with the newest messages.
    pub(super) fn claim_of_root(&mut self, condition: &Expression, holds: bool) {
        let root = &self.boards[ScopeId::ROOT.index()];
        let newest = match root.delivery == self.delivery {
            true => root.clone(),
            false => ReplayBoard { delivery: self.delivery, written: Vec::new() },
        };
        let step = self.steps;
        let claim = RunClaim {
            written: condition.clone(),
            condition: self.versioned(condition, &newest),
            holds,
            step,
        };
        self.log.get_mut().claims.push(claim);
    }

    /// All facts, and that messages persist once they have arrived.
    pub(super) fn claims(&self) -> Result<Vec<RunClaim>, String> {
        let log = self.log.borrow();
        if let Some(trouble) = &log.error {
            return Err(trouble.clone());
        }
        let mut claims = Vec::new();
        for (message, deliveries) in log.read.values() {
            if message.segments.iter().any(|name| name.text == "Signal") {
                continue;
            }
            let is = |delivery: u32, present: bool| {
                let path = numbered(message, &delivery.to_string());
                let kind = if present { ExpressionKind::Present(path) } else { ExpressionKind::Absent(path) };
                Expression { kind, position: message.position }
            };
            let deliveries: Vec<u32> = deliveries.iter().copied().collect();
            for pair in deliveries.windows(2) {
                let kind = ExpressionKind::Or(vec![is(pair[1], true), is(pair[0], false)]);
                claims.push(RunClaim::of(Expression { kind, position: message.position }, 0));
            }
            let written = self.writes.iter().filter(|write| message_of(&write.assignment.target) == *message);
            for write in written {
                let after = deliveries.iter().find(|&&delivery| delivery > write.delivery);
                claims.extend(after.map(|&delivery| RunClaim::of(is(delivery, true), 0)));
            }
        }
        claims.extend(log.claims.iter().cloned());
        Ok(claims)
    }

    /// A condition about what a blackboard shows.
    fn versioned(&self, condition: &Expression, board: &ReplayBoard) -> Expression {
        condition.replaced(&mut |part| {
            let kind = match &part.kind {
                ExpressionKind::Variable(path) if path.segments.len() > 1 => self.field(path, board),
                ExpressionKind::Absent(path) => self.presence(path, board, false),
                ExpressionKind::Present(path) => self.presence(path, board, true),
                _ => return None,
            };
            Some(Expression { kind, position: part.position })
        })
    }

    fn field(&self, path: &Path, board: &ReplayBoard) -> ExpressionKind {
        for write in board.written.iter().rev().chain(self.published(path, board).iter().rev()) {
            let target = &self.writes[*write].assignment.target;
            if same_message(target, path) && target.segments.last() == path.segments.last() {
                return self.writes[*write].value.clone();
            }
            if !same_message(target, path) && may_be_one_message(target, path) {
                self.trouble(format!(
                    "it is not known whether `{}` is part of `{}`",
                    path.text(),
                    target.text()
                ));
            }
        }
        ExpressionKind::Variable(numbered(path, &self.delivered(&message_of(path), board)))
    }

    fn presence(&self, message: &Path, board: &ReplayBoard, present: bool) -> ExpressionKind {
        for write in board.written.iter().rev().chain(self.published(message, board).iter().rev()) {
            let target = &self.writes[*write].assignment.target;
            if message_of(target) == *message {
                return ExpressionKind::Bool(present);
            }
            if may_be_one_message(target, message) {
                self.trouble(format!("it is not known whether `{}` has come then", message.text()));
            }
        }
        let path = numbered(message, &self.delivered(message, board));
        if present { ExpressionKind::Present(path) } else { ExpressionKind::Absent(path) }
    }

    /// The assignments that a delivery has brought back, of a message that is the chart's own.
    fn published(&self, path: &Path, board: &ReplayBoard) -> Vec<usize> {
        if !(self.sources.is_own)(path) {
            return Vec::new();
        }
        let before = |write: &usize| self.writes[*write].delivery < board.delivery;
        (0..self.writes.len()).filter(before).collect()
    }

    /// The delivery that has brought the message that a blackboard shows.
    fn delivered(&self, message: &Path, board: &ReplayBoard) -> String {
        if (self.sources.is_own)(message) {
            // nothing of it was published before
            let missing = numbered(message, "0");
            let kind = ExpressionKind::Absent(missing);
            let claim = RunClaim::of(Expression { kind, position: message.position }, 0);
            let is_written = self.writes.iter().any(|write| message_of(&write.assignment.target) == *message);
            if !is_written && let Ok(mut log) = self.log.try_borrow_mut() {
                log.claims.push(claim);
            }
            return "0".into();
        }
        let is_announced = self.sources.announced.iter().any(|it| may_be_one_message(it, message));
        let delivery = match is_announced {
            true => {
                let arrived = self.arrivals.iter().filter(|(path, _)| may_be_one_message(path, message));
                arrived.map(|&(_, delivery)| delivery).filter(|it| *it <= board.delivery).max().unwrap_or(0)
            }
            false => board.delivery,
        };
        if let Ok(mut log) = self.log.try_borrow_mut() {
            let read = log.read.entry(message.text()).or_insert_with(|| (message.clone(), BTreeSet::new()));
            read.1.insert(delivery);
        }
        delivery.to_string()
    }

    fn trouble(&self, text: String) {
        if let Ok(mut log) = self.log.try_borrow_mut() {
            log.error.get_or_insert(text);
        }
    }

    fn is_idle(&self, region: ScopeId) -> bool {
        self.idle.get(region.index()) == Some(&true)
    }

    /// The value that the run has given to a condition, in the order in which it is asked.
    fn decide(&self, script: ScriptId, region: ScopeId) -> (bool, bool) {
        let mut log = self.log.borrow_mut();
        let known = log.known.iter().find(|(board, it, _)| *board == region && *it == script);
        if let Some(&(.., value)) = known {
            return (value, false);
        }
        let value = match self.decisions.get(log.next) {
            Some(&(planned, value)) if planned == script => value,
            _ => {
                log.error.get_or_insert_with(|| "other conditions are read there".into());
                false
            }
        };
        log.next += 1;
        log.known.push((region, script, value));
        (value, !self.is_idle(region))
    }
}

impl Host for ReplayHost<'_> {
    fn condition(&self, script: ScriptId, region: ScopeId, _: &ActiveStates<'_>) -> Result<bool, CallError> {
        let (value, is_claim) = self.decide(script, region);
        let condition = self.abstraction.conditions.get(script.0 as usize).and_then(Option::as_ref);
        if let (true, Some(condition)) = (is_claim, condition) {
            let versioned = self.versioned(condition, &self.boards[region.index()]);
            let claim =
                RunClaim { written: condition.clone(), condition: versioned, holds: value, step: self.steps };
            self.log.borrow_mut().claims.push(claim);
        }
        Ok(value)
    }

    fn perform(
        &mut self,
        action: ScriptId,
        region: ScopeId,
        _: &mut ScriptContext<'_>,
    ) -> Result<(), CallError> {
        self.log.get_mut().known.retain(|(board, ..)| *board != region);
        let index = region.index();
        match self.abstraction.assignment(action) {
            Some(assignment) => {
                let assignment = assignment.clone();
                let value = self.versioned(&assignment.value, &self.boards[index]);
                // else the action would have failed
                let read = crate::logic::messages(&value);
                let present = read.iter().map(|message| RunClaim::of(present(message, &value), self.steps));
                self.log.get_mut().claims.extend(present);
                self.boards[index].written.push(self.writes.len());
                let delivery = self.boards[index].delivery;
                self.writes.push(Write { assignment, value: value.kind, delivery });
            }
            None if self.abstraction.chart.script(action) == "process_messages" => {
                self.delivery += 1;
                self.boards[index] = ReplayBoard { delivery: self.delivery, written: Vec::new() };
            }
            None => {
                self.trouble(format!("what `{}` does is not known", self.abstraction.chart.script(action)))
            }
        }
        Ok(())
    }

    fn deliver(&mut self, region: ScopeId) {
        let delivery = self.delivery;
        self.boards[region.index()] = ReplayBoard { delivery, written: Vec::new() };
    }

    fn inherit(&mut self, region: ScopeId, from: ScopeId) {
        self.log.get_mut().known.retain(|(board, ..)| *board != region);
        let mut board = self.boards[from.index()].clone();
        board.written.retain(|&write| !self.writes[write].assignment.is_of_signal());
        self.boards[region.index()] = board;
    }

    fn start(&mut self, _: Activation) {}

    fn cancel(&mut self, _: Activation) {}

    fn stop(&mut self, _: Activation) {}
}

/// That a message of a part of an expression has arrived.
fn present(message: &str, part: &Expression) -> Expression {
    let position = part.position;
    let segments = message.split('.').map(|text| Name { text: text.to_owned(), position }).collect();
    Expression { kind: ExpressionKind::Present(Path { segments, position }), position }
}

fn message_of(field: &Path) -> Path {
    let count = field.segments.len().saturating_sub(1).max(1);
    Path { segments: field.segments.iter().take(count).cloned().collect(), position: field.position }
}

fn numbered(path: &Path, number: &str) -> Path {
    let mut path = path.clone();
    if let Some(first) = path.segments.first_mut() {
        first.text = format!("{number}{NUMBER_SEPARATOR}{}", first.text);
    }
    path
}

/// A path as it is written in the model.
fn unnumbered(path: &Path) -> Path {
    let mut path = path.clone();
    if let Some(first) = path.segments.first_mut()
        && let Some((_, name)) = first.text.split_once(NUMBER_SEPARATOR)
    {
        first.text = name.to_owned();
    }
    path
}
