//! Host of an exploring machine: it chooses the values of conditions and records them.

use std::cell::RefCell;

use yase::expression::{CallError, EventId, ScriptId};
use yase::statechart::{NodeId, TransitionId};
use yase::{Activation, Host};
use yase::{ActiveStates, ScriptContext};
use yase::{CompiledChart, ScopeId};
use yase::{MicroStepCause, TraceRecord};

use super::constraint_cache::ConstraintCache;
use super::{ConditionConstraint, WriteEffects};

/// The blackboard of conditions that only the caller evaluates.
const CALLER_SCOPE: ScopeId = ScopeId(u32::MAX);

/// The blackboard of the chart's root.
const ROOT_SCOPE: ScopeId = ScopeId(0);

/// A host that chooses the values of conditions.
pub(crate) struct ChoosingHost<'s, 'a> {
    decisions: RefCell<Decisions<'s, 'a>>,
    pub(crate) notes: StepNotes,
}

struct Decisions<'s, 'a> {
    permits: ConstraintCache<'s, 'a>,
    effects: &'s WriteEffects<'a>,
    /// The planned values of the first conditions.
    planned: Vec<bool>,
    /// The decisions: their values, and whether the other value was possible.
    log: Vec<Decision>,
    /// The known values of conditions on each blackboard in this step.
    known: Vec<(ScopeId, ScriptId, bool)>,
    /// The facts on each blackboard: values of conditions, and executed actions, which are true.
    /// Unlike a known value, a fact is not lost when an action writes something else.
    facts: Vec<(ScopeId, ScriptId, bool)>,
    /// The actions of this step that have written to a blackboard.
    written: Vec<(ScopeId, ScriptId)>,
    /// The facts on one blackboard.
    on_board: Vec<(ScriptId, bool)>,
    /// The blackboards on which no condition holds, by index.
    idle: &'s [bool],
    /// The blackboards to which the newest messages were delivered.
    delivered: Vec<ScopeId>,
}

/// The decided value of a condition.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Decision {
    pub(crate) script: ScriptId,
    pub(crate) value: bool,
    pub(crate) is_free: bool,
}

/// The record of a step.
#[derive(Default)]
pub(crate) struct StepNotes {
    pub(crate) entered: Vec<NodeId>,
    pub(crate) left: Vec<NodeId>,
    pub(crate) taken: Vec<TransitionId>,
    pub(crate) held: Vec<TransitionId>,
    pub(crate) events: Vec<EventId>,
    pub(crate) dropped: Vec<EventId>,
    /// Whether an action wrote data.
    pub(crate) wrote: bool,
    /// The trace, if requested: one line per micro-step.
    pub(crate) lines: Option<Vec<String>>,
}

impl<'s, 'a> ChoosingHost<'s, 'a> {
    pub(crate) fn new(
        allows: &'s mut ConditionConstraint<'a>,
        effects: &'s WriteEffects<'a>,
    ) -> ChoosingHost<'s, 'a> {
        let decisions = Decisions {
            permits: ConstraintCache::new(allows),
            effects,
            planned: Vec::new(),
            log: Vec::new(),
            known: Vec::new(),
            facts: Vec::new(),
            written: Vec::new(),
            on_board: Vec::new(),
            idle: &[],
            delivered: Vec::new(),
        };
        ChoosingHost { decisions: RefCell::new(decisions), notes: StepNotes::default() }
    }

    /// Sets the idle blackboards, by index.
    pub(crate) fn with_idle(mut self, idle: &'s [bool]) -> ChoosingHost<'s, 'a> {
        self.decisions.get_mut().idle = idle;
        self
    }

    /// Starts a step with planned values of the first conditions.
    pub(crate) fn begin(&mut self, planned: &[bool]) {
        let decisions = self.decisions.get_mut();
        decisions.planned.clear();
        decisions.planned.extend_from_slice(planned);
        decisions.log.clear();
        decisions.known.clear();
        decisions.facts.clear();
        decisions.written.clear();
        decisions.delivered.clear();
        self.notes.clear();
    }

    /// The decisions of the step.
    pub(crate) fn step_decisions(&mut self) -> &[Decision] {
        &self.decisions.get_mut().log
    }

    /// Decides a condition after a step, as the blackboard of the root shows it then: with the
    /// newest messages, and the data that the chart has written.
    pub(crate) fn decide_after_step(&mut self, script: ScriptId) -> bool {
        self.decisions.get_mut().decide_after_step(script)
    }
}

impl StepNotes {
    fn clear(&mut self) {
        for nodes in [&mut self.entered, &mut self.left] {
            nodes.clear();
        }
        for segments in [&mut self.taken, &mut self.held] {
            segments.clear();
        }
        self.events.clear();
        self.dropped.clear();
        self.wrote = false;
        self.lines.iter_mut().for_each(Vec::clear);
    }
}

impl Decisions<'_, '_> {
    fn decide(&mut self, region: ScopeId, script: ScriptId) -> bool {
        let on_board = |it: &&(ScopeId, ScriptId, bool)| it.0 == region;
        if let Some((_, _, value)) = self.known.iter().filter(on_board).find(|(_, it, _)| *it == script) {
            return *value;
        }
        let value = match self.is_idle(region) {
            true => self.log_idle(script),
            false => {
                let value = self.choose_among(region, script);
                self.facts.push((region, script, value));
                value
            }
        };
        self.known.push((region, script, value));
        value
    }

    /// Chooses a value that is possible with all that is known of a blackboard.
    fn choose_among(&mut self, region: ScopeId, script: ScriptId) -> bool {
        let mut known = std::mem::take(&mut self.on_board);
        known.clear();
        let of_board = self.facts.iter().filter(|(board, fact, _)| self.is_shared(*board, *fact, region));
        known.extend(of_board.map(|&(_, script, value)| (script, value)));
        known.sort_unstable();
        known.dedup();
        let value = self.choose(script, &known);
        self.on_board = known;
        value
    }

    /// Whether a fact of one blackboard is one of another: both have the newest messages, and
    /// neither was written since as far as the fact is concerned.
    fn is_shared(&self, board: ScopeId, fact: ScriptId, region: ScopeId) -> bool {
        match (board, region) {
            _ if board == region => true,
            (ROOT_SCOPE, CALLER_SCOPE) => self.delivered.contains(&ROOT_SCOPE),
            (_, CALLER_SCOPE) => self.is_newest(board, fact) && self.is_unwritten(ROOT_SCOPE, fact),
            _ => self.is_newest(board, fact) && self.is_newest(region, fact),
        }
    }

    fn is_newest(&self, board: ScopeId, fact: ScriptId) -> bool {
        self.delivered.contains(&board) && !self.is_idle(board) && self.is_unwritten(board, fact)
    }

    fn is_unwritten(&self, board: ScopeId, fact: ScriptId) -> bool {
        let mut of_board = self.written.iter().filter(|(written, _)| *written == board);
        of_board.all(|&(_, action)| action != fact && !(self.effects.changes)(action, fact))
    }

    fn is_idle(&self, region: ScopeId) -> bool {
        self.idle.get(region.index()) == Some(&true)
    }

    /// Values on idle blackboards are recorded too, since a replay needs them.
    fn log_idle(&mut self, script: ScriptId) -> bool {
        self.log.push(Decision { script, value: false, is_free: false });
        false
    }

    fn decide_after_step(&mut self, script: ScriptId) -> bool {
        let value = self.choose_among(CALLER_SCOPE, script);
        self.facts.push((CALLER_SCOPE, script, value));
        value
    }

    /// A region inherits the facts of another blackboard, and the writes there that it can see. If
    /// that blackboard has the newest messages, so has the region.
    fn inherit(&mut self, region: ScopeId, from: ScopeId) {
        self.known.retain(|(board, ..)| *board != region);
        self.facts.retain(|(board, ..)| *board != region);
        self.written.retain(|(board, _)| *board != region);
        self.delivered.retain(|board| *board != region);
        if self.delivered.contains(&from) {
            self.delivered.push(region);
        }
        let is_inherited = |action: ScriptId| (self.effects.is_inherited)(action);
        let seen = self.written.iter().filter(|(board, action)| *board == from && is_inherited(*action));
        let seen: Vec<(ScopeId, ScriptId)> = seen.map(|&(_, action)| (region, action)).collect();
        let remains = |fact: ScriptId| {
            let mut hidden =
                self.written.iter().filter(|(board, action)| *board == from && !is_inherited(*action));
            hidden.all(|&(_, action)| action != fact && !(self.effects.changes)(action, fact))
        };
        let facts = self.facts.iter().filter(|(board, fact, _)| *board == from && remains(*fact));
        let facts: Vec<_> = facts.map(|&(_, fact, value)| (region, fact, value)).collect();
        self.written.extend(seen);
        self.facts.extend(facts);
    }

    fn choose(&mut self, script: ScriptId, known: &[(ScriptId, bool)]) -> bool {
        let (may_be_false, may_be_true) = self.permits.of(script, known);
        let is_free = may_be_false == may_be_true;
        let value = match self.planned.get(self.log.len()) {
            Some(&value) if is_free => value,
            _ => !may_be_false && may_be_true,
        };
        self.log.push(Decision { script, value, is_free });
        value
    }
}

impl Host for ChoosingHost<'_, '_> {
    fn condition(&self, script: ScriptId, region: ScopeId, _: &ActiveStates<'_>) -> Result<bool, CallError> {
        Ok(self.decisions.borrow_mut().decide(region, script))
    }

    fn deliver(&mut self, region: ScopeId) {
        self.decisions.get_mut().delivered.push(region);
    }

    fn inherit(&mut self, region: ScopeId, from: ScopeId) {
        self.decisions.get_mut().inherit(region, from);
    }

    /// Data written to a blackboard may change the conditions read there.
    fn perform(
        &mut self,
        action: ScriptId,
        region: ScopeId,
        _: &mut ScriptContext<'_>,
    ) -> Result<(), CallError> {
        let decisions = self.decisions.get_mut();
        decisions.known.retain(|(board, ..)| *board != region);
        let changes = &decisions.effects.changes;
        decisions.facts.retain(|&(board, fact, _)| board != region || !changes(action, fact));
        decisions.facts.push((region, action, true));
        decisions.written.push((region, action));
        self.notes.wrote = true;
        Ok(())
    }

    fn start(&mut self, _: Activation) {}

    fn cancel(&mut self, _: Activation) {}

    fn stop(&mut self, _: Activation) {}

    fn wants_trace(&self) -> bool {
        true
    }

    fn trace(&mut self, chart: &CompiledChart, record: &TraceRecord<'_>) {
        if let Some(lines) = &mut self.notes.lines {
            lines.push(record.display(chart).to_string());
        }
        if let MicroStepCause::Event(event) = record.cause {
            self.notes.events.push(event);
            self.notes.dropped.extend(record.is_dropped().then_some(event));
        }
        self.notes.entered.extend(record.entries);
        self.notes.left.extend(record.exits);
        let segments = record.selected.iter().flat_map(|&compound| chart.segments(compound));
        self.notes.taken.extend(segments.chain(record.taken));
        self.notes.held.extend(record.held.iter().flat_map(|&compound| chart.segments(compound)));
    }
}
