//! From a snapshot to a machine.

use std::collections::BTreeMap;
use std::sync::Arc;

use crate::chart::{Chart, CompoundId, Place, RegionId};
use crate::expression::EventId;
use crate::machine::Machine;
use crate::machine::activities::{Phase, Slot};
use crate::machine::bound::MEMORY;
use crate::machine::chooser::Chooser;
use crate::machine::errors::Fault;
use crate::machine::history::Record;
use crate::machine::queues::{Held, Occurrence};
use crate::machine::run::{ErredGuard, Pending, Run};
use crate::machine::snapshot::{
    ActivityPhase, ActivityRecord, EventName, HeldRecord, Misfit, MisfitKind, OccurrenceRecord, Paths,
    RestoreError, Snapshot, TimerName, VERSION, Way, consistency, find_event, ways,
};
use crate::machine::timers::Deadline;
use crate::semantics::Semantics;
use crate::statechart::{NodeKind, TransitionId};

impl Machine {
    /// A machine that goes on where the snapshot was taken, with the number that its states have in this chart.
    ///
    /// # Errors
    /// If the snapshot is of an unknown version or another chart, names what the chart does not have, or could not have been taken of any
    /// machine: the error lists all of it.
    pub fn restore(chart: Arc<Chart>, snapshot: &Snapshot) -> Result<Machine, RestoreError> {
        let run = Restoring::new(&chart).run(snapshot)?;
        Ok(Machine { chart, run })
    }
}

/// A run that is put together, and what was found wrong on the way.
pub(super) struct Restoring<'a> {
    pub(super) chart: &'a Chart,
    pub(super) run: Run,
    pub(super) misfits: Vec<Misfit>,
    paths: Paths,
    ways: BTreeMap<&'a [TransitionId], CompoundId>,
}

impl<'a> Restoring<'a> {
    fn new(chart: &'a Chart) -> Restoring<'a> {
        let (run, paths, ways) = (Run::new(chart), Paths::new(chart), ways(chart));
        Restoring { chart, run, misfits: Vec::new(), paths, ways }
    }

    fn run(mut self, snapshot: &Snapshot) -> Result<Run, RestoreError> {
        self.origin(snapshot);
        self.clock(snapshot);
        self.states(snapshot);
        self.unfinished(snapshot);
        self.history(snapshot);
        self.newcomers(snapshot);
        self.activities(snapshot);
        self.timers(snapshot);
        self.queues(snapshot);
        self.pending(snapshot);
        self.erred_guards(snapshot);
        self.bound(snapshot);
        consistency::check(&mut self, snapshot);
        RestoreError::new(self.misfits).map_or(Ok(self.run), Err)
    }

    pub(super) fn misfit(&mut self, kind: MisfitKind, field: impl Into<String>, text: impl Into<String>) {
        self.misfits.push(Misfit::new(kind, field, text));
    }

    fn origin(&mut self, snapshot: &Snapshot) {
        if snapshot.version != VERSION {
            let text = format!("the format is {}; {VERSION} is understood", snapshot.version);
            self.misfit(MisfitKind::Version, "version", text);
        }
        let name = &self.chart.statechart().name;
        if snapshot.chart != *name {
            let text = format!("it is of the chart `{}`, this is `{name}`", snapshot.chart);
            self.misfit(MisfitKind::Chart, "chart", text);
        }
        // how long a machine may go on without rest is no part of what it is doing
        let limit = self.chart.semantics().limit;
        if (Semantics { limit, ..snapshot.semantics }) != self.chart.semantics() {
            self.misfit(MisfitKind::Semantics, "semantics", "the chart is read in another way");
        }
    }

    fn clock(&mut self, snapshot: &Snapshot) {
        let run = &mut self.run;
        (run.status, run.now, run.due) = (snapshot.status, snapshot.now, snapshot.due);
        run.under_way = snapshot.step;
        run.chooser = Chooser::restored(&snapshot.chooser);
    }

    fn states(&mut self, snapshot: &Snapshot) {
        for (index, path) in snapshot.configuration.iter().enumerate() {
            let field = format!("configuration[{index}]");
            let Some(place) = self.place(&field, path) else { continue };
            self.once(self.run.active.contains(place.index()), &field, path);
            self.run.activate(self.chart, place);
        }
        for (index, path) in snapshot.waiting_starts.iter().enumerate() {
            let field = format!("waiting_starts[{index}]");
            let Some(place) = self.place(&field, path) else { continue };
            self.once(self.run.waiting_starts.contains(place.index()), &field, path);
            self.run.waiting_starts.insert(place.index());
        }
        for (index, path) in snapshot.written.iter().enumerate() {
            let field = format!("written[{index}]");
            let Some(region) = self.region(&field, path) else { continue };
            self.once(self.run.written.contains(region.index()), &field, path);
            self.run.written.insert(region.index());
        }
    }

    /// What is left of transitions that end without entering.
    fn unfinished(&mut self, snapshot: &Snapshot) {
        for (index, path) in snapshot.vacated.iter().enumerate() {
            let field = format!("vacated[{index}]");
            let Some(place) = self.place(&field, path) else { continue };
            self.once(self.run.vacated.contains(place.index()), &field, path);
            self.run.vacated.insert(place.index());
            self.run.tips.insert(place.index());
        }
        for (index, way) in snapshot.joined.iter().enumerate() {
            let field = format!("joined[{index}]");
            let Some(compound) = self.way(&field, way) else { continue };
            let Some(slot) = self.chart.compounds[compound.0 as usize].arrives else {
                self.misfit(MisfitKind::Unknown, field, format!("`{}` leads to no JOIN", way.join(", ")));
                continue;
            };
            self.once(self.run.arrived.contains(slot), &field, &way.join(", "));
            self.run.arrived.insert(slot);
        }
        for (index, path) in snapshot.completions.iter().enumerate() {
            if let Some(place) = self.place(&format!("completions[{index}]"), path) {
                self.run.completions.push_back(place);
            }
        }
        self.run.ending = snapshot.ending;
        if let Some(path) = &snapshot.no_branch
            && let Some(place) = self.place("no_branch", path)
        {
            self.run.failure = Some(Fault::NoBranch(self.chart.layout.node(place)));
        }
    }

    fn history(&mut self, snapshot: &Snapshot) {
        for (index, record) in snapshot.history.iter().enumerate() {
            let field = format!("history[{index}]");
            let Some(place) = self.place(&format!("{field}.history"), &record.history) else { continue };
            let histories = &self.chart.histories;
            let Some(number) = histories.iter().position(|history| history.place == place) else {
                let text = format!("`{}` is no HISTORY", record.history);
                self.misfit(MisfitKind::Unknown, format!("{field}.history"), text);
                continue;
            };
            self.once(self.run.records[number].is_known, &field, &record.history);
            let nodes = record.nodes.iter().enumerate();
            let mut places: Vec<Place> = nodes
                .filter_map(|(node, path)| self.place(&format!("{field}.nodes[{node}]"), path))
                .collect();
            places.sort_unstable();
            self.run.records[number] = Record { is_known: true, places };
        }
    }

    fn newcomers(&mut self, snapshot: &Snapshot) {
        for (index, path) in snapshot.to_enter.iter().enumerate() {
            let field = format!("to_enter[{index}]");
            let Some(place) = self.place(&field, path) else { continue };
            self.once(self.run.is_to_enter(place), &field, path);
            self.run.newcomers.regions.push(place);
        }
        for (index, path) in snapshot.to_inherit.iter().enumerate() {
            let field = format!("to_inherit[{index}]");
            let Some(region) = self.region(&field, path) else { continue };
            self.once(self.run.newcomers.blackboards.contains(&region), &field, path);
            self.run.newcomers.blackboards.push(region);
        }
    }

    fn activities(&mut self, snapshot: &Snapshot) {
        self.run.activities.count = snapshot.activations;
        for (index, record) in snapshot.activities.iter().enumerate() {
            self.activity(&format!("activities[{index}]"), record);
        }
    }

    fn activity(&mut self, field: &str, record: &ActivityRecord) {
        let Some(place) = self.place(&format!("{field}.state"), &record.state) else { return };
        let node = self.chart.statechart().node(self.chart.layout.node(place));
        let Some(activity) = self.chart.states[place.index()].activity else {
            let text = format!("`{}` has no activity", record.state);
            return self.misfit(MisfitKind::Unknown, format!("{field}.state"), text);
        };
        if node.activity.as_ref() != Some(&record.activity) {
            let name = node.activity.as_deref().unwrap_or_default();
            let text = format!("the activity of `{}` is `{name}`, not `{}`", record.state, record.activity);
            self.misfit(MisfitKind::Unknown, format!("{field}.activity"), text);
        }
        self.once(self.run.activities.slot(activity).phase != Phase::Idle, field, &record.state);
        let phase = phase(record.phase);
        *self.run.activities.slot_mut(activity) =
            Slot { phase, number: record.number, cancelled: record.cancelled };
        self.run.activities.queued |= phase == Phase::Queued;
        if matches!(phase, Phase::Queued | Phase::Running) {
            self.run.lock(self.chart, place);
        }
    }

    fn timers(&mut self, snapshot: &Snapshot) {
        for (index, record) in snapshot.timers.iter().enumerate() {
            let field = format!("timers[{index}].timer");
            let Some(timer) = self.timer(&field, &record.timer) else { continue };
            let name = format!("{}` of `{}", record.timer.name, record.timer.region);
            self.once(self.run.timers.slots[timer].is_some(), &field, &name);
            let owner = match &record.owner {
                Some(path) => self.place(&format!("timers[{index}].owner"), path),
                None => None,
            };
            self.run.timers.slots[timer] =
                Some(Deadline { moment: record.deadline, expired: record.expired, owner });
        }
        self.run.timers.look_again();
    }

    fn queues(&mut self, snapshot: &Snapshot) {
        self.run.queues.count = snapshot.occurrences;
        self.run.queues.raised = self.occurrences("raised", &snapshot.raised).into();
        self.run.queues.arrived = self.occurrences("arrived", &snapshot.arrived).into();
        self.run.queues.deferred = self.occurrences("deferred", &snapshot.deferred).into();
        for (index, record) in snapshot.held.iter().enumerate() {
            self.held(&format!("held[{index}]"), record);
        }
    }

    fn occurrences(&mut self, field: &str, records: &[OccurrenceRecord]) -> Vec<Occurrence> {
        let one = |(index, record)| self.occurrence(&format!("{field}[{index}]"), record);
        records.iter().enumerate().filter_map(one).collect()
    }

    fn occurrence(&mut self, field: &str, record: &OccurrenceRecord) -> Option<Occurrence> {
        let event = self.event(&format!("{field}.event"), &record.event);
        let expiry = match &record.expiry {
            Some(timer) => Some(self.timer(&format!("{field}.expiry"), timer)? as u32),
            None => None,
        };
        Some(Occurrence {
            event: event?,
            number: record.number,
            raised: record.raised,
            expiry,
            token: record.token,
            is_known: record.known,
        })
    }

    fn held(&mut self, field: &str, record: &HeldRecord) {
        let occurrence = self.occurrence(&format!("{field}.occurrence"), &record.occurrence);
        let ways = record.ways.iter().enumerate();
        let compounds =
            ways.filter_map(|(index, way)| self.way(&format!("{field}.ways[{index}]"), way)).collect();
        if let Some(occurrence) = occurrence {
            self.run.queues.held.push(Held { occurrence, compounds, offer: record.offer });
        }
    }

    fn pending(&mut self, snapshot: &Snapshot) {
        for (index, record) in snapshot.pending.iter().enumerate() {
            let compound = self.way(&format!("pending[{index}].way"), &record.way);
            let event =
                record.event.as_ref().map(|event| self.event(&format!("pending[{index}].event"), event));
            let event = match event {
                Some(None) => continue,
                event => event.flatten(),
            };
            if let Some(compound) = compound {
                self.run.pending.push(Pending { compound, event });
            }
        }
    }

    fn erred_guards(&mut self, snapshot: &Snapshot) {
        for (index, record) in snapshot.erred_guards.iter().enumerate() {
            let field = format!("erred_guards[{index}]");
            let segment = self.segment(&format!("{field}.segment"), &record.segment);
            let region = self.region(&format!("{field}.region"), &record.region);
            let (Some(segment), Some(region)) = (segment, region) else { continue };
            let is_it =
                |guard: &crate::chart::ScopedGuard| guard.transition == segment && guard.region == region;
            let Some(guard) = self.chart.guards.iter().position(is_it) else {
                let text = format!("`{}` has no guard on `{}`", record.segment, record.region);
                self.misfit(MisfitKind::Unknown, field, text);
                continue;
            };
            self.once(self.run.erred.iter().any(|erred| erred.guard == guard), &field, &record.segment);
            self.run.erred.push(ErredGuard { guard, stale: record.stale });
        }
    }

    fn bound(&mut self, snapshot: &Snapshot) {
        let record = &snapshot.bound;
        let bound = &mut self.run.bound;
        (bound.micro_steps, bound.instant, bound.steps) = (record.micro_steps, record.instant, record.steps);
        if record.recent.len() > MEMORY {
            let text = format!("at most {MEMORY} transitions are remembered");
            self.misfit(MisfitKind::Contradiction, "bound.recent", text);
        }
        for (index, way) in record.recent.iter().enumerate() {
            if let Some(compound) = self.way(&format!("bound.recent[{index}]"), way) {
                self.run.bound.remember(compound);
            }
        }
    }

    fn once(&mut self, is_there: bool, field: &str, name: &str) {
        if is_there {
            self.misfit(MisfitKind::Twice, field, format!("`{name}` is there twice"));
        }
    }

    fn known<T>(&mut self, found: Option<T>, field: &str, what: &str, name: &str) -> Option<T> {
        if found.is_none() {
            self.misfit(MisfitKind::Unknown, field, format!("the chart has no {what} `{name}`"));
        }
        found
    }

    fn place(&mut self, field: &str, path: &str) -> Option<Place> {
        let found = self.paths.find_place(self.chart, path);
        self.known(found, field, "node", path)
    }

    fn region(&mut self, field: &str, path: &str) -> Option<RegionId> {
        let found = self.paths.find_region(self.chart, path);
        self.known(found, field, "region", path)
    }

    fn segment(&mut self, field: &str, name: &str) -> Option<TransitionId> {
        let found = self.paths.find_segment(name);
        self.known(found, field, "transition", name)
    }

    fn timer(&mut self, field: &str, timer: &TimerName) -> Option<usize> {
        let found = self.paths.find_timer(self.chart, timer);
        self.known(found, field, "timer", &format!("{}` of `{}", timer.name, timer.region))
    }

    fn event(&mut self, field: &str, event: &EventName) -> Option<EventId> {
        let (what, name) = match event {
            EventName::Name(name) => ("event", name),
            EventName::Message(name) => ("message event", name),
        };
        self.known(find_event(self.chart, event), field, what, name)
    }

    fn way(&mut self, field: &str, way: &Way) -> Option<CompoundId> {
        let found = self.paths.find_way(&self.ways, way);
        self.known(found, field, "compound transition", &way.join(", "))
    }

    pub(super) fn path(&self, place: Place) -> String {
        self.paths.place(self.chart, place)
    }

    pub(super) fn kind(&self, place: Place) -> NodeKind {
        self.chart.states[place.index()].kind
    }
}

fn phase(phase: ActivityPhase) -> Phase {
    match phase {
        ActivityPhase::Queued => Phase::Queued,
        ActivityPhase::Running => Phase::Running,
        ActivityPhase::Ongoing => Phase::Ongoing,
        ActivityPhase::Failed => Phase::Failed,
        ActivityPhase::Done => Phase::Done,
    }
}
