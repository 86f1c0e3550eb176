//! Host of an exploring machine: it chooses the values of conditions and records them.

use std::cell::RefCell;

use yase::expression::{CallError, EventId, ScriptId};
use yase::statechart::{NodeId, TransitionId};
use yase::{Activation, Host};
use yase::{ActiveStates, ScriptContext};
use yase::{CompiledChart, ScopeId};
use yase::{MicroStepCause, TraceRecord};

use super::ConditionConstraint;
use super::constraint_cache::ConstraintCache;

/// The blackboard of conditions that only the caller evaluates.
const BESIDE: ScopeId = ScopeId(u32::MAX);

/// The blackboard of the chart's root.
const ROOT: ScopeId = ScopeId(0);

/// A host that chooses the values of conditions.
pub(crate) struct ChoosingHost<'s, 'a> {
    decisions: RefCell<Decisions<'s, 'a>>,
    pub(crate) notes: StepNotes,
}

struct Decisions<'s, 'a> {
    permits: ConstraintCache<'s, 'a>,
    /// The planned values of the first conditions.
    planned: Vec<bool>,
    /// The decisions: their values, and whether the other value was possible.
    log: Vec<Decision>,
    /// The known values of conditions on each blackboard in this step.
    known: Vec<(ScopeId, ScriptId, bool)>,
    /// The known values on one of them.
    on_board: Vec<(ScriptId, bool)>,
    /// The blackboards on which no condition holds, by index.
    idle: &'s [bool],
    /// The blackboards to which the newest messages were delivered.
    delivered: Vec<ScopeId>,
    /// Whether the chart has written to the blackboard of its root, which then differs from the
    /// others until the next step.
    is_root_written: bool,
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
    pub(crate) fn new(allows: &'s mut ConditionConstraint<'a>) -> ChoosingHost<'s, 'a> {
        let decisions = Decisions {
            permits: ConstraintCache::new(allows),
            planned: Vec::new(),
            log: Vec::new(),
            known: Vec::new(),
            on_board: Vec::new(),
            idle: &[],
            delivered: Vec::new(),
            is_root_written: false,
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
        decisions.delivered.clear();
        decisions.is_root_written = false;
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
                let mut known = std::mem::take(&mut self.on_board);
                known.clear();
                known.extend(self.known.iter().filter(on_board).map(|&(_, script, value)| (script, value)));
                let value = self.choose(script, &known);
                self.on_board = known;
                value
            }
        };
        self.known.push((region, script, value));
        value
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
        let is_alike = |region: ScopeId| region == ROOT || !self.is_root_written;
        let is_new =
            |region: ScopeId| self.delivered.contains(&region) && !self.is_idle(region) && is_alike(region);
        let mut known: Vec<(ScriptId, bool)> = Vec::new();
        let of_boards = self.known.iter().filter(|(region, ..)| is_new(*region) || *region == BESIDE);
        known.extend(of_boards.map(|&(_, script, value)| (script, value)));
        known.sort_unstable();
        known.dedup();
        let value = self.choose(script, &known);
        self.known.push((BESIDE, script, value));
        value
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

    /// A region that inherits from another has the newest messages if that one has.
    fn inherit(&mut self, region: ScopeId, from: ScopeId) {
        let decisions = self.decisions.get_mut();
        if decisions.delivered.contains(&from) {
            decisions.delivered.push(region);
        }
    }

    /// Data written to a blackboard may change the conditions read there.
    fn perform(&mut self, _: ScriptId, region: ScopeId, _: &mut ScriptContext<'_>) -> Result<(), CallError> {
        let decisions = self.decisions.get_mut();
        decisions.known.retain(|(board, ..)| *board != region);
        decisions.is_root_written |= region == ROOT;
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
        if let MicroStepCause::Event(event) = record.occasion {
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
