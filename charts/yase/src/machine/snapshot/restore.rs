//! Restores a machine from a snapshot.

use std::collections::BTreeMap;
use std::sync::Arc;

use crate::compile::{CompiledChart, NodeIndex};
use crate::expression::EventId;
use crate::ids::{CompoundTransitionId, ScopeId};
use crate::machine::Machine;
use crate::machine::activities::{ActivityState, InvocationPhase};
use crate::machine::chooser::Chooser;
use crate::machine::errors::StepError;
use crate::machine::history::HistoryValue;
use crate::machine::livelock_limit::KEPT_TRANSITIONS;
use crate::machine::machine_state::{FailedGuard, MachineState, PendingInterrupt};
use crate::machine::queues::{HeldEvent, PoppedEvent};
use crate::machine::snapshot::{
    ActivityPhase, ActivityRecord, EventName, HeldEventRecord, OccurrenceRecord, PathTable, RestoreError,
    RestoreIssue, RestoreIssueKind, Snapshot, TimerName, TransitionPath, VERSION, compounds_by_segments,
    find_event, validate,
};
use crate::machine::timers::ArmedTimer;
use crate::semantics::Semantics;
use crate::statechart::{NodeKind, TransitionId};

impl Machine {
    /// Creates a machine that continues from the snapshot, with the numbering of this chart.
    ///
    /// # Errors
    /// If the snapshot has an unknown version, is of another chart, uses names that the chart does
    /// not have, or is inconsistent: the error lists all issues.
    pub fn restore(chart: Arc<CompiledChart>, snapshot: &Snapshot) -> Result<Machine, RestoreError> {
        let run = SnapshotRestorer::new(&chart).run(snapshot)?;
        Ok(Machine { chart, run })
    }
}

/// A machine state under construction, and the issues found so far.
pub(crate) struct SnapshotRestorer<'a> {
    pub(crate) chart: &'a CompiledChart,
    pub(crate) run: MachineState,
    pub(crate) issues: Vec<RestoreIssue>,
    paths: PathTable,
    compounds: BTreeMap<&'a [TransitionId], CompoundTransitionId>,
}

impl<'a> SnapshotRestorer<'a> {
    fn new(chart: &'a CompiledChart) -> SnapshotRestorer<'a> {
        let (run, paths, compounds) =
            (MachineState::new(chart), PathTable::new(chart), compounds_by_segments(chart));
        SnapshotRestorer { chart, run, issues: Vec::new(), paths, compounds }
    }

    fn run(mut self, snapshot: &Snapshot) -> Result<MachineState, RestoreError> {
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
        validate::check(&mut self, snapshot);
        RestoreError::new(self.issues).map_or(Ok(self.run), Err)
    }

    pub(crate) fn report_issue(
        &mut self,
        kind: RestoreIssueKind,
        field: impl Into<String>,
        text: impl Into<String>,
    ) {
        self.issues.push(RestoreIssue::new(kind, field, text));
    }

    fn origin(&mut self, snapshot: &Snapshot) {
        if snapshot.version != VERSION {
            let text = format!("the format is {}; {VERSION} is understood", snapshot.version);
            self.report_issue(RestoreIssueKind::Version, "version", text);
        }
        let name = &self.chart.statechart().name;
        if snapshot.chart != *name {
            let text = format!("it is of the chart `{}`, this is `{name}`", snapshot.chart);
            self.report_issue(RestoreIssueKind::Chart, "chart", text);
        }
        // the limit is configuration, not state
        let limit = self.chart.semantics().limit;
        if (Semantics { limit, ..snapshot.semantics }) != self.chart.semantics() {
            self.report_issue(RestoreIssueKind::Semantics, "semantics", "the chart has other semantics");
        }
    }

    fn clock(&mut self, snapshot: &Snapshot) {
        let run = &mut self.run;
        (run.status, run.now, run.needs_step) = (snapshot.status, snapshot.now, snapshot.due);
        run.step_in_progress = snapshot.step;
        run.chooser = Chooser::restored(&snapshot.chooser);
    }

    fn states(&mut self, snapshot: &Snapshot) {
        for (index, path) in snapshot.configuration.iter().enumerate() {
            let field = format!("configuration[{index}]");
            let Some(node) = self.node_index(&field, path) else { continue };
            self.check_unique(self.run.active.contains(node.index()), &field, path);
            self.run.activate(self.chart, node);
        }
        for (index, path) in snapshot.waiting_starts.iter().enumerate() {
            let field = format!("waiting_starts[{index}]");
            let Some(start) = self.node_index(&field, path) else { continue };
            self.check_unique(self.run.waiting_starts.contains(start.index()), &field, path);
            self.run.waiting_starts.insert(start.index());
        }
        for (index, path) in snapshot.written.iter().enumerate() {
            let field = format!("written[{index}]");
            let Some(region) = self.region(&field, path) else { continue };
            self.check_unique(self.run.written.contains(region.index()), &field, path);
            self.run.written.insert(region.index());
        }
    }

    /// Restores the effects of transitions that end without entering a state.
    fn unfinished(&mut self, snapshot: &Snapshot) {
        for (index, path) in snapshot.vacated.iter().enumerate() {
            let field = format!("vacated[{index}]");
            let Some(node) = self.node_index(&field, path) else { continue };
            self.check_unique(self.run.vacated.contains(node.index()), &field, path);
            self.run.vacated.insert(node.index());
            self.run.active_leaves.insert(node.index());
        }
        for (index, path) in snapshot.joined.iter().enumerate() {
            let field = format!("joined[{index}]");
            let Some(compound) = self.compound(&field, path) else { continue };
            let Some(slot) = self.chart.compounds[compound.0 as usize].arrives() else {
                self.report_issue(
                    RestoreIssueKind::Unknown,
                    field,
                    format!("`{}` leads to nothing that joins regions", path.join(", ")),
                );
                continue;
            };
            self.check_unique(self.run.arrived.contains(slot), &field, &path.join(", "));
            self.run.arrived.insert(slot);
        }
        for (index, path) in snapshot.completions.iter().enumerate() {
            if let Some(node) = self.node_index(&format!("completions[{index}]"), path) {
                self.run.completions.push_back(node);
            }
        }
        self.run.root_is_final = snapshot.ending;
        if let Some(path) = &snapshot.no_branch
            && let Some(node) = self.node_index("no_branch", path)
        {
            self.run.failure = Some(StepError::NoBranch(self.chart.layout.node(node)));
        }
    }

    fn history(&mut self, snapshot: &Snapshot) {
        for (index, record) in snapshot.history.iter().enumerate() {
            let field = format!("history[{index}]");
            let Some(owner) = self.node_index(&format!("{field}.history"), &record.history) else { continue };
            let histories = &self.chart.histories;
            let Some(number) = histories.iter().position(|history| history.node == owner) else {
                let text = format!("`{}` is not a HISTORY", record.history);
                self.report_issue(RestoreIssueKind::Unknown, format!("{field}.history"), text);
                continue;
            };
            self.check_unique(self.run.records[number].is_known, &field, &record.history);
            let nodes = record.nodes.iter().enumerate();
            let mut indices: Vec<NodeIndex> = nodes
                .filter_map(|(node, path)| self.node_index(&format!("{field}.nodes[{node}]"), path))
                .collect();
            indices.sort_unstable();
            self.run.records[number] = HistoryValue { is_known: true, nodes: indices };
        }
    }

    fn newcomers(&mut self, snapshot: &Snapshot) {
        for (index, path) in snapshot.to_enter.iter().enumerate() {
            let field = format!("to_enter[{index}]");
            let Some(node) = self.node_index(&field, path) else { continue };
            self.check_unique(self.run.is_to_enter(node), &field, path);
            self.run.regions_to_enter.regions.push(node);
        }
        for (index, path) in snapshot.to_inherit.iter().enumerate() {
            let field = format!("to_inherit[{index}]");
            let Some(region) = self.region(&field, path) else { continue };
            self.check_unique(self.run.regions_to_enter.blackboards.contains(&region), &field, path);
            self.run.regions_to_enter.blackboards.push(region);
        }
    }

    fn activities(&mut self, snapshot: &Snapshot) {
        self.run.activities.count = snapshot.activations;
        for (index, record) in snapshot.activities.iter().enumerate() {
            self.activity(&format!("activities[{index}]"), record);
        }
    }

    fn activity(&mut self, field: &str, record: &ActivityRecord) {
        let Some(index) = self.node_index(&format!("{field}.state"), &record.state) else { return };
        let node = self.chart.statechart().node(self.chart.layout.node(index));
        let Some(activity) = self.chart.states[index.index()].activity else {
            let text = format!("`{}` has no activity", record.state);
            return self.report_issue(RestoreIssueKind::Unknown, format!("{field}.state"), text);
        };
        if node.activity.as_ref() != Some(&record.activity) {
            let name = node.activity.as_deref().unwrap_or_default();
            let text = format!("the activity of `{}` is `{name}`, not `{}`", record.state, record.activity);
            self.report_issue(RestoreIssueKind::Unknown, format!("{field}.activity"), text);
        }
        self.check_unique(
            self.run.activities.slot(activity).phase != InvocationPhase::Idle,
            field,
            &record.state,
        );
        let phase = phase(record.phase);
        let state = ActivityState { phase, number: record.number, cancelled: record.cancelled };
        self.run.activities.set(activity, state);
        self.run.activities.queued |= phase == InvocationPhase::Queued;
        if matches!(phase, InvocationPhase::Queued | InvocationPhase::Running) {
            self.run.lock(self.chart, index);
        }
    }

    fn timers(&mut self, snapshot: &Snapshot) {
        for (index, record) in snapshot.timers.iter().enumerate() {
            let field = format!("timers[{index}].timer");
            let Some(timer) = self.timer(&field, &record.timer) else { continue };
            let name = format!("{}` of `{}", record.timer.name, record.timer.region);
            self.check_unique(self.run.timers.slot(timer).is_some(), &field, &name);
            let owner = match &record.owner {
                Some(path) => self.node_index(&format!("timers[{index}].owner"), path),
                None => None,
            };
            let armed = ArmedTimer { moment: record.deadline, expired: record.expired, owner };
            self.run.timers.set_slot(timer, Some(armed));
        }
        self.run.timers.recompute_next();
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

    fn occurrences(&mut self, field: &str, records: &[OccurrenceRecord]) -> Vec<PoppedEvent> {
        let one = |(index, record)| self.occurrence(&format!("{field}[{index}]"), record);
        records.iter().enumerate().filter_map(one).collect()
    }

    fn occurrence(&mut self, field: &str, record: &OccurrenceRecord) -> Option<PoppedEvent> {
        let event = self.event(&format!("{field}.event"), &record.event);
        let expiry = match &record.expiry {
            Some(timer) => Some(self.timer(&format!("{field}.expiry"), timer)? as u32),
            None => None,
        };
        Some(PoppedEvent {
            event: event?,
            number: record.number,
            raised: record.raised,
            expiry,
            token: record.token,
            is_known: record.known,
        })
    }

    fn held(&mut self, field: &str, record: &HeldEventRecord) {
        let occurrence = self.occurrence(&format!("{field}.occurrence"), &record.occurrence);
        let paths = record.ways.iter().enumerate();
        let compounds = paths
            .filter_map(|(index, path)| self.compound(&format!("{field}.ways[{index}]"), path))
            .collect();
        if let Some(occurrence) = occurrence {
            self.run.queues.held.push(HeldEvent { occurrence, compounds, offer: record.offer });
        }
    }

    fn pending(&mut self, snapshot: &Snapshot) {
        for (index, record) in snapshot.pending.iter().enumerate() {
            let compound = self.compound(&format!("pending[{index}].way"), &record.way);
            let event =
                record.event.as_ref().map(|event| self.event(&format!("pending[{index}].event"), event));
            let event = match event {
                Some(None) => continue,
                event => event.flatten(),
            };
            if let Some(compound) = compound {
                self.run.pending.push(PendingInterrupt { compound, event });
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
                |guard: &crate::compile::ScopedGuard| guard.transition == segment && guard.region == region;
            let Some(guard) = self.chart.guards.iter().position(is_it) else {
                let text = format!("`{}` has no guard on `{}`", record.segment, record.region);
                self.report_issue(RestoreIssueKind::Unknown, field, text);
                continue;
            };
            self.check_unique(
                self.run.failed_guards.iter().any(|erred| erred.guard == guard),
                &field,
                &record.segment,
            );
            self.run.failed_guards.push(FailedGuard { guard, stale: record.stale });
        }
    }

    fn bound(&mut self, snapshot: &Snapshot) {
        let record = &snapshot.bound;
        let bound = &mut self.run.livelock_limit;
        (bound.micro_steps, bound.instant, bound.steps) = (record.micro_steps, record.instant, record.steps);
        if record.recent.len() > KEPT_TRANSITIONS {
            let text = format!("at most {KEPT_TRANSITIONS} transitions are remembered");
            self.report_issue(RestoreIssueKind::Contradiction, "bound.recent", text);
        }
        for (index, path) in record.recent.iter().enumerate() {
            if let Some(compound) = self.compound(&format!("bound.recent[{index}]"), path) {
                self.run.livelock_limit.record_transition(compound);
            }
        }
    }

    fn check_unique(&mut self, is_there: bool, field: &str, name: &str) {
        if is_there {
            self.report_issue(RestoreIssueKind::Twice, field, format!("`{name}` is there twice"));
        }
    }

    fn known<T>(&mut self, found: Option<T>, field: &str, what: &str, name: &str) -> Option<T> {
        if found.is_none() {
            self.report_issue(RestoreIssueKind::Unknown, field, format!("the chart has no {what} `{name}`"));
        }
        found
    }

    fn node_index(&mut self, field: &str, path: &str) -> Option<NodeIndex> {
        let found = self.paths.find_index(self.chart, path);
        self.known(found, field, "node", path)
    }

    fn region(&mut self, field: &str, path: &str) -> Option<ScopeId> {
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

    fn compound(&mut self, field: &str, path: &TransitionPath) -> Option<CompoundTransitionId> {
        let found = self.paths.find_compound(&self.compounds, path);
        self.known(found, field, "compound transition", &path.join(", "))
    }

    pub(crate) fn path(&self, node: NodeIndex) -> String {
        self.paths.node_path(self.chart, node)
    }

    pub(crate) fn kind(&self, node: NodeIndex) -> NodeKind {
        self.chart.states[node.index()].kind
    }
}

fn phase(phase: ActivityPhase) -> InvocationPhase {
    match phase {
        ActivityPhase::Queued => InvocationPhase::Queued,
        ActivityPhase::Running => InvocationPhase::Running,
        ActivityPhase::Ongoing => InvocationPhase::Ongoing,
        ActivityPhase::Failed => InvocationPhase::Failed,
        ActivityPhase::Done => InvocationPhase::Done,
    }
}
