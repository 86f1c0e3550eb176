//! The world of an exploring machine: it decides what nobody has decided, and takes note.

use std::cell::RefCell;

use crate::chart::{Chart, RegionId};
use crate::expression::{CallError, ScriptId};
use crate::host::{Activation, Host};
use crate::machine::{Performance, States};
use crate::statechart::{NodeId, TransitionId};
use crate::trace::TraceRecord;

use super::Allows;

/// A world in which conditions have the values that are chosen for them.
pub(super) struct Chosen<'h, 'a> {
    decisions: RefCell<Decisions<'h, 'a>>,
    pub(super) notes: Notes,
}

struct Decisions<'h, 'a> {
    allows: &'h mut Allows<'a>,
    /// The values of the first conditions that are asked for.
    planned: &'h [bool],
    /// Each that was decided on: its value, and whether it could have had the other.
    log: Vec<Decision>,
    /// What is known on each blackboard in this step.
    known: Vec<(RegionId, ScriptId, bool)>,
}

/// A condition that was decided on.
#[derive(Clone, Copy, Debug)]
pub(super) struct Decision {
    pub(super) script: ScriptId,
    pub(super) value: bool,
    pub(super) is_free: bool,
}

/// What happened in a step.
#[derive(Default)]
pub(super) struct Notes {
    pub(super) entered: Vec<NodeId>,
    pub(super) left: Vec<NodeId>,
    pub(super) taken: Vec<TransitionId>,
    pub(super) held: Vec<TransitionId>,
    /// Whether an action wrote something.
    pub(super) wrote: bool,
    /// The trace, if it is wanted: a line for each micro-step.
    pub(super) lines: Option<Vec<String>>,
}

impl<'h, 'a> Chosen<'h, 'a> {
    pub(super) fn new(allows: &'h mut Allows<'a>, planned: &'h [bool]) -> Chosen<'h, 'a> {
        let decisions = Decisions { allows, planned, log: Vec::new(), known: Vec::new() };
        Chosen { decisions: RefCell::new(decisions), notes: Notes::default() }
    }

    pub(super) fn finish(self) -> (Vec<Decision>, Notes) {
        (self.decisions.into_inner().log, self.notes)
    }
}

impl Decisions<'_, '_> {
    fn decide(&mut self, region: RegionId, script: ScriptId) -> bool {
        let on_board = |it: &&(RegionId, ScriptId, bool)| it.0 == region;
        if let Some((_, _, value)) = self.known.iter().filter(on_board).find(|(_, it, _)| *it == script) {
            return *value;
        }
        let known: Vec<(ScriptId, bool)> =
            self.known.iter().filter(on_board).map(|&(_, script, value)| (script, value)).collect();
        let (may_be_false, may_be_true) =
            ((self.allows)(script, false, &known), (self.allows)(script, true, &known));
        let is_free = may_be_false == may_be_true;
        let value = match self.planned.get(self.log.len()) {
            Some(&value) if is_free => value,
            _ => !may_be_false && may_be_true,
        };
        self.log.push(Decision { script, value, is_free });
        self.known.push((region, script, value));
        value
    }
}

impl Host for Chosen<'_, '_> {
    fn condition(&self, script: ScriptId, region: RegionId, _: &States<'_>) -> Result<bool, CallError> {
        Ok(self.decisions.borrow_mut().decide(region, script))
    }

    /// What is written on a blackboard may change what is read there.
    fn perform(&mut self, _: ScriptId, region: RegionId, _: &mut Performance<'_>) -> Result<(), CallError> {
        self.decisions.get_mut().known.retain(|(board, ..)| *board != region);
        self.notes.wrote = true;
        Ok(())
    }

    fn start(&mut self, _: Activation) {}

    fn cancel(&mut self, _: Activation) {}

    fn stop(&mut self, _: Activation) {}

    fn wants_trace(&self) -> bool {
        true
    }

    fn trace(&mut self, chart: &Chart, record: &TraceRecord<'_>) {
        if let Some(lines) = &mut self.notes.lines {
            lines.push(record.display(chart).to_string());
        }
        self.notes.entered.extend(record.entries);
        self.notes.left.extend(record.exits);
        let segments = record.selected.iter().flat_map(|&compound| chart.segments(compound));
        self.notes.taken.extend(segments.chain(record.taken));
        self.notes.held.extend(record.held.iter().flat_map(|&compound| chart.segments(compound)));
    }
}
