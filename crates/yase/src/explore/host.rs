//! The world of an exploring machine: it decides what nobody has decided, and takes note.

use std::cell::RefCell;

use crate::chart::{Chart, RegionId};
use crate::expression::{CallError, EventId, ScriptId};
use crate::host::{Activation, Host};
use crate::machine::{Performance, States};
use crate::statechart::{NodeId, TransitionId};
use crate::trace::{Occasion, TraceRecord};

use super::Allows;
use super::permits::Permits;

/// Stands for the blackboard of whoever asks beside the chart.
const BESIDE: RegionId = RegionId(u32::MAX);

/// The blackboard of the chart's root.
const ROOT: RegionId = RegionId(0);

/// A world in which conditions have the values that are chosen for them.
pub(super) struct Chosen<'s, 'a> {
    decisions: RefCell<Decisions<'s, 'a>>,
    pub(super) notes: Notes,
}

struct Decisions<'s, 'a> {
    permits: Permits<'s, 'a>,
    /// The values of the first conditions that are asked for.
    planned: Vec<bool>,
    /// Each that was decided on: its value, and whether it could have had the other.
    log: Vec<Decision>,
    /// What is known on each blackboard in this step.
    known: Vec<(RegionId, ScriptId, bool)>,
    /// What is known on one of them.
    on_board: Vec<(ScriptId, bool)>,
    /// The blackboards on which nothing that is asked holds, by their numbers.
    idle: &'s [bool],
    /// The blackboards that show the newest messages.
    delivered: Vec<RegionId>,
    /// Whether the chart has written on the blackboard of its root, which then differs from the others until the next step.
    is_root_written: bool,
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
    pub(super) events: Vec<EventId>,
    pub(super) dropped: Vec<EventId>,
    /// Whether an action wrote something.
    pub(super) wrote: bool,
    /// The trace, if it is wanted: a line for each micro-step.
    pub(super) lines: Option<Vec<String>>,
}

impl<'s, 'a> Chosen<'s, 'a> {
    pub(super) fn new(allows: &'s mut Allows<'a>) -> Chosen<'s, 'a> {
        let decisions = Decisions {
            permits: Permits::new(allows),
            planned: Vec::new(),
            log: Vec::new(),
            known: Vec::new(),
            on_board: Vec::new(),
            idle: &[],
            delivered: Vec::new(),
            is_root_written: false,
        };
        Chosen { decisions: RefCell::new(decisions), notes: Notes::default() }
    }

    /// A world in which nothing that is asked on some blackboards holds, by their numbers.
    pub(super) fn with_idle(mut self, idle: &'s [bool]) -> Chosen<'s, 'a> {
        self.decisions.get_mut().idle = idle;
        self
    }

    /// Begins a step in which the first conditions have such values.
    pub(super) fn begin(&mut self, planned: &[bool]) {
        let decisions = self.decisions.get_mut();
        decisions.planned.clear();
        decisions.planned.extend_from_slice(planned);
        decisions.log.clear();
        decisions.known.clear();
        decisions.delivered.clear();
        decisions.is_root_written = false;
        self.notes.clear();
    }

    /// What was decided on in the step.
    pub(super) fn decided(&mut self) -> &[Decision] {
        &self.decisions.get_mut().log
    }

    /// Decides on what is asked after a step, of what the blackboard of the root shows then: the newest messages, and what the chart has written there itself.
    pub(super) fn decide_beside(&mut self, script: ScriptId) -> bool {
        self.decisions.get_mut().decide_beside(script)
    }
}

impl Notes {
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
    fn decide(&mut self, region: RegionId, script: ScriptId) -> bool {
        let on_board = |it: &&(RegionId, ScriptId, bool)| it.0 == region;
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

    fn is_idle(&self, region: RegionId) -> bool {
        self.idle.get(region.index()) == Some(&true)
    }

    /// What holds nowhere is decided too: whoever plays the way again has to be told so.
    fn log_idle(&mut self, script: ScriptId) -> bool {
        self.log.push(Decision { script, value: false, is_free: false });
        false
    }

    fn decide_beside(&mut self, script: ScriptId) -> bool {
        let is_alike = |region: RegionId| region == ROOT || !self.is_root_written;
        let is_new =
            |region: RegionId| self.delivered.contains(&region) && !self.is_idle(region) && is_alike(region);
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

impl Host for Chosen<'_, '_> {
    fn condition(&self, script: ScriptId, region: RegionId, _: &States<'_>) -> Result<bool, CallError> {
        Ok(self.decisions.borrow_mut().decide(region, script))
    }

    fn deliver(&mut self, region: RegionId) {
        self.decisions.get_mut().delivered.push(region);
    }

    /// What is taken over from newest messages are newest messages.
    fn inherit(&mut self, region: RegionId, from: RegionId) {
        let decisions = self.decisions.get_mut();
        if decisions.delivered.contains(&from) {
            decisions.delivered.push(region);
        }
    }

    /// What is written on a blackboard may change what is read there.
    fn perform(&mut self, _: ScriptId, region: RegionId, _: &mut Performance<'_>) -> Result<(), CallError> {
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

    fn trace(&mut self, chart: &Chart, record: &TraceRecord<'_>) {
        if let Some(lines) = &mut self.notes.lines {
            lines.push(record.display(chart).to_string());
        }
        if let Occasion::Event(event) = record.occasion {
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
