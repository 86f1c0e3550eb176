//! Translates a snapshot from an old chart to a new one.

use std::collections::{BTreeMap, BTreeSet};

use crate::compile::CompiledChart;
use crate::ids::CompoundTransitionId;
use crate::machine::snapshot::{
    ActivityPhase, ActivityRecord, EventName, FailedGuardRecord, HeldEventRecord, HistoryRecord,
    OccurrenceRecord, PendingInterruptRecord, Snapshot, TimerName, TimerRecord, TransitionPath, can_remember,
    compounds_by_segments, event_name, find_event,
};
use crate::migrate::matching::NodeMatch;
use crate::migrate::plan::NodeMapping;
use crate::migrate::report::{Conflict, Disposition, MigratedItem, MigrationFinding, MigrationReport};
use crate::statechart::{NodeId, NodeKind, TransitionId};

/// A snapshot during translation from one chart to another.
pub(crate) struct SnapshotTranslator<'a> {
    plan: &'a NodeMapping,
    /// The new chart.
    chart: &'a CompiledChart,
    compounds: BTreeMap<&'a [TransitionId], CompoundTransitionId>,
    pub(crate) report: MigrationReport,
    pub(crate) conflicts: Vec<Conflict>,
}

impl<'a> SnapshotTranslator<'a> {
    pub(crate) fn new(plan: &'a NodeMapping) -> SnapshotTranslator<'a> {
        SnapshotTranslator {
            plan,
            chart: &plan.new,
            compounds: compounds_by_segments(&plan.new),
            report: MigrationReport::default(),
            conflicts: Vec::new(),
        }
    }

    /// The snapshot with the names of the new chart. Losses without the caller's consent are
    /// recorded as conflicts.
    pub(crate) fn translate(&mut self, old: &Snapshot) -> Snapshot {
        let mut new = old.clone();
        new.chart = self.chart.statechart().name.clone();
        new.semantics = self.chart.semantics();
        new.due |= !self.plan.is_same();
        let active = self.active(old);
        self.unfinished(old, &mut new);
        self.enter(&active, &mut new);
        new.configuration = self.in_document_order(active);
        new.activities = old.activities.iter().filter_map(|record| self.activity(record)).collect();
        self.unmapped_activities(old, &new);
        new.history = old.history.iter().filter_map(|record| self.history(record)).collect();
        new.timers = old.timers.iter().filter_map(|record| self.timer(record)).collect();
        self.events(old, &mut new);
        new.pending = old.pending.iter().filter_map(|record| self.pending(record)).collect();
        self.notes(old, &mut new);
        self.reject_losses();
        new
    }

    /// The counterpart of the node that an old path names.
    fn node(&self, path: &str) -> Option<(NodeId, NodeId)> {
        let old = self.plan.old_paths.find_node(path)?;
        Some((old, self.plan.node(old)?))
    }

    fn path(&self, path: &str) -> Option<String> {
        self.node(path).map(|(_, node)| self.plan.new_paths.node(node).to_owned())
    }

    fn region(&self, path: &str) -> Option<String> {
        let (_, node) = self.node(path)?;
        self.chart.region_at(node)?;
        Some(self.plan.new_paths.node(node).to_owned())
    }

    /// The counterparts of all active nodes, with their ancestors.
    fn active(&mut self, old: &Snapshot) -> BTreeSet<NodeId> {
        let mut active = BTreeSet::new();
        for path in &old.configuration {
            let Some(node) = self.plan.old_paths.find_node(path) else { continue };
            let verdict = self.plan.verdict(node);
            match (self.plan.node(node), &verdict) {
                (Some(found), _) => {
                    active.insert(found);
                }
                (None, Disposition::Lost(why)) => {
                    self.conflicts.push(Conflict::StateGone { state: path.clone(), why });
                }
                _ => {}
            }
            self.report.add(MigratedItem::State, path, verdict);
        }
        self.add_ancestors(&mut active);
        active
    }

    fn add_ancestors(&mut self, active: &mut BTreeSet<NodeId>) {
        let statechart = self.chart.statechart();
        let around: BTreeSet<NodeId> = active.iter().flat_map(|&node| statechart.ancestors(node)).collect();
        for node in around {
            if active.insert(node) {
                self.report.add(MigratedItem::State, self.plan.new_paths.node(node), Disposition::Added);
            }
        }
    }

    /// New regions of active ANDs, and the blackboards of active regions that had none.
    fn enter(&mut self, active: &BTreeSet<NodeId>, new: &mut Snapshot) {
        (new.to_enter, new.to_inherit) = (Vec::new(), Vec::new());
        let chart = self.chart;
        let known: BTreeSet<_> =
            self.plan.old.regions().filter_map(|region| self.plan.region(region)).collect();
        for region in chart.regions() {
            let Some(node) = chart.region_node(region) else { continue };
            let Some(parent) = chart.statechart().node(node).parent else { continue };
            let path = self.plan.new_paths.node(node).to_owned();
            let is_vacated = new.vacated.iter().any(|path| path == self.plan.new_paths.node(parent));
            if is_vacated || !active.contains(&parent) {
                continue;
            } else if !active.contains(&node) {
                if chart.region_of(node) != Some(region) {
                    continue; // the blackboard of a composite that is not active
                }
                self.report.to_enter.push(path.clone());
                new.to_enter.push(path);
            } else if !known.contains(&region) {
                new.to_inherit.push(path);
            }
        }
    }

    fn in_document_order(&self, active: BTreeSet<NodeId>) -> Vec<String> {
        let layout = &self.chart.layout;
        let mut nodes: Vec<NodeId> = active.into_iter().collect();
        nodes.sort_by_key(|&node| layout.rank(layout.index_of(node)));
        nodes.into_iter().map(|node| self.plan.new_paths.node(node).to_owned()).collect()
    }

    fn activity(&mut self, record: &ActivityRecord) -> Option<ActivityRecord> {
        let name = format!("{}: {}", record.state, record.activity);
        let found = self.node(&record.state);
        let activity = found.and_then(|(_, node)| self.chart.activity(node)).map(|entry| entry.name);
        if activity == Some(record.activity.as_str()) {
            let state = self.path(&record.state)?;
            let verdict = self.renamed(&record.state, &state, &state);
            self.report.add(MigratedItem::Activation, name, verdict);
            return Some(ActivityRecord { state, ..record.clone() });
        }
        let is_done = record.phase == ActivityPhase::Done;
        match activity {
            _ if !is_done => self.conflicts.push(Conflict::ActivityGone {
                state: record.state.clone(),
                activity: record.activity.clone(),
            }),
            // `unmapped_activities` reports a state with another activity
            Some(_) => {}
            None => self.report.add(MigratedItem::Activation, name, Disposition::Kept),
        }
        None
    }

    /// Active states with an activity that has not been started.
    fn unmapped_activities(&mut self, old: &Snapshot, new: &Snapshot) {
        if new.status != crate::Status::Running {
            return;
        }
        let reported: BTreeSet<&str> = new.activities.iter().map(|record| record.state.as_str()).collect();
        let objected: BTreeSet<String> = old
            .activities
            .iter()
            .filter(|record| record.phase != ActivityPhase::Done)
            .filter_map(|record| self.path(&record.state))
            .collect();
        for entry in self.chart.activities() {
            let path = self.plan.new_paths.node(entry.node);
            if new.is_active(path) && !reported.contains(path) && !objected.contains(path) {
                let (state, new) = (path.to_owned(), entry.name.to_owned());
                self.conflicts.push(Conflict::ActivityChanged { state, new });
            }
        }
    }

    /// Whether the name is unchanged, apart from the name of the root.
    fn renamed(&self, old: &str, new: &str, to: &str) -> Disposition {
        match self.plan.old_paths.find_node(old).map(|node| self.plan.matches[node.0 as usize]) {
            Some(NodeMatch::Kept(node)) if self.plan.new_paths.node(node) == new => Disposition::Kept,
            _ => Disposition::Moved(to.to_owned()),
        }
    }

    fn unfinished(&mut self, old: &Snapshot, new: &mut Snapshot) {
        new.vacated = old.vacated.iter().filter_map(|path| self.path(path)).collect();
        new.joined = old.joined.iter().filter_map(|path| self.joined(path)).collect();
        new.completions = old.completions.iter().filter_map(|path| self.path(path)).collect();
        new.no_branch = old.no_branch.as_ref().and_then(|path| self.path(path));
    }

    fn joined(&mut self, path: &TransitionPath) -> Option<TransitionPath> {
        let found = self.transition_path(path).filter(|found| {
            let compound = self.plan.new_paths.find_compound(&self.compounds, found);
            compound.is_some_and(|compound| self.chart.compounds[compound.0 as usize].arrives().is_some())
        });
        let verdict = match &found {
            Some(found) if found == path => Disposition::Kept,
            Some(found) => Disposition::Moved(found.join(", ")),
            None => Disposition::Lost("it leads to nothing that joins regions now"),
        };
        self.report.add(MigratedItem::Arrival, path.join(", "), verdict);
        found
    }

    fn history(&mut self, record: &HistoryRecord) -> Option<HistoryRecord> {
        let Some(found) = self.history_nodes(record) else {
            let why = "it cannot remember that any more";
            self.report.add(MigratedItem::History, &record.history, Disposition::Lost(why));
            return None;
        };
        let is_kept = record.nodes.len() == found.nodes.len()
            && record
                .nodes
                .iter()
                .zip(&found.nodes)
                .all(|(old, new)| self.renamed(old, new, new) == Disposition::Kept);
        let verdict = match self.renamed(&record.history, &found.history, &found.history) {
            Disposition::Kept if !is_kept => Disposition::Moved(found.nodes.join(", ")),
            verdict => verdict,
        };
        self.report.add(MigratedItem::History, &record.history, verdict);
        Some(found)
    }

    /// The value of a HISTORY is kept if its nodes exist and, with the composites added around
    /// them, can have been active in its composite.
    fn history_nodes(&self, record: &HistoryRecord) -> Option<HistoryRecord> {
        let (chart, layout) = (self.chart, &self.chart.layout);
        let (_, node) = self.node(&record.history)?;
        let history = chart.histories.iter().find(|history| history.node == layout.index_of(node))?;
        let nodes: Option<Vec<NodeId>> =
            record.nodes.iter().map(|path| self.node(path).map(|(_, node)| node)).collect();
        let mut indices = BTreeSet::new();
        for node in nodes? {
            indices.insert(layout.index_of(node));
            if history.is_deep {
                let around = chart.statechart().ancestors(node).map(|node| layout.index_of(node));
                indices.extend(around.take_while(|&index| index != history.owner));
            }
        }
        let path = |node| self.plan.new_paths.node_path(chart, node);
        can_remember(chart, history, &indices).then(|| HistoryRecord {
            history: path(history.node),
            nodes: indices.into_iter().map(path).collect(),
        })
    }

    fn timer(&mut self, record: &TimerRecord) -> Option<TimerRecord> {
        let name = format!("{}: {}", record.timer.region, record.timer.name);
        let Some(timer) = self.timer_name(&record.timer) else {
            let why = "no action starts such a timer there";
            self.report.add(MigratedItem::Timer, name, Disposition::Lost(why));
            return None;
        };
        let owner = record.owner.as_ref().map(|path| self.path(path));
        if owner == Some(None) {
            self.report.add(
                MigratedItem::Timer,
                name,
                Disposition::Lost("the state that it belongs to is no more"),
            );
            return None;
        }
        let to = format!("{}: {}", timer.region, timer.name);
        let verdict = self.renamed(&record.timer.region, &timer.region, &to);
        self.report.add(MigratedItem::Timer, name, verdict);
        Some(TimerRecord { timer, owner: owner.flatten(), ..record.clone() })
    }

    fn timer_name(&self, timer: &TimerName) -> Option<TimerName> {
        let found = TimerName { region: self.region(&timer.region)?, name: timer.name.clone() };
        self.plan.new_paths.find_timer(self.chart, &found).map(|_| found)
    }

    fn events(&mut self, old: &Snapshot, new: &mut Snapshot) {
        new.raised = self.occurrences(MigratedItem::Event, &old.raised);
        new.arrived = self.occurrences(MigratedItem::Event, &old.arrived);
        new.deferred = self.occurrences(MigratedItem::DeferredEvent, &old.deferred);
        new.held = old.held.iter().filter_map(|held| self.held(held)).collect();
    }

    fn occurrences(&mut self, subject: MigratedItem, queue: &[OccurrenceRecord]) -> Vec<OccurrenceRecord> {
        queue.iter().filter_map(|record| self.occurrence(subject, record)).collect()
    }

    fn occurrence(&mut self, subject: MigratedItem, record: &OccurrenceRecord) -> Option<OccurrenceRecord> {
        let (EventName::Name(name) | EventName::Message(name)) = &record.event;
        let (found, verdict) = match self.event(record) {
            Ok(found) if found.event == record.event => (Some(found), Disposition::Kept),
            Ok(found) => (Some(found), Disposition::Moved("?".into())),
            Err(why) => (None, Disposition::Lost(why)),
        };
        self.report.add(subject, name, verdict);
        found
    }

    /// An event that the new chart does not name can still be taken by `*` and `not e`, if it has
    /// such triggers.
    fn event(&self, record: &OccurrenceRecord) -> Result<OccurrenceRecord, &'static str> {
        let chart = self.chart;
        let expiry = match &record.expiry {
            Some(timer) => Some(self.timer_name(timer).ok_or("no action starts that timer")?),
            None => None,
        };
        let Some(event) = find_event(chart, &record.event) else {
            let takes_any = chart.triggers.iter().any(|trigger| trigger.matches(chart.unnamed));
            let is_name = matches!(record.event, EventName::Name(_));
            return match is_name && takes_any && expiry.is_none() {
                true => Ok(OccurrenceRecord {
                    event: event_name(chart, chart.unnamed),
                    known: false,
                    ..record.clone()
                }),
                false => Err("nothing waits for it"),
            };
        };
        let timer = expiry.as_ref().and_then(|timer| self.plan.new_paths.find_timer(chart, timer));
        if timer.is_some_and(|timer| chart.timers[timer].event != Some(event)) {
            return Err("nothing waits for it");
        }
        Ok(OccurrenceRecord { expiry, ..record.clone() })
    }

    /// Held events are offered again under the new chart, to determine the activities they wait
    /// for.
    fn held(&mut self, held: &HeldEventRecord) -> Option<HeldEventRecord> {
        let occurrence = self.occurrence(MigratedItem::HeldEvent, &held.occurrence)?;
        let ways = held.ways.iter().filter_map(|way| self.transition_path(way)).collect();
        Some(HeldEventRecord { occurrence, ways, offer: held.offer || !self.plan.is_same() })
    }

    fn pending(&mut self, record: &PendingInterruptRecord) -> Option<PendingInterruptRecord> {
        let name = record.way.join(", ");
        let is_known = record.event.as_ref().is_none_or(|event| find_event(self.chart, event).is_some());
        let Some(way) = self.transition_path(&record.way).filter(|_| is_known) else {
            self.conflicts.push(Conflict::PendingGone(name));
            return None;
        };
        let verdict = if way == record.way { Disposition::Kept } else { Disposition::Moved(way.join(", ")) };
        self.report.add(MigratedItem::PendingTransition, name, verdict);
        Some(PendingInterruptRecord { way, event: record.event.clone() })
    }

    fn transition_path(&self, path: &TransitionPath) -> Option<TransitionPath> {
        let segments: Option<Vec<TransitionId>> = path.iter().map(|segment| self.segment(segment)).collect();
        let segments = segments?;
        self.compounds.get(segments.as_slice())?;
        Some(segments.iter().map(|&segment| self.plan.new_paths.segment(segment).to_owned()).collect())
    }

    fn segment(&self, segment: &str) -> Option<TransitionId> {
        let old = self.plan.old_paths.find_segment(segment)?;
        self.plan.segments[old.0 as usize]
    }

    /// Records that only suppress a repeated report or identify a cycle are kept if they have a
    /// counterpart.
    fn notes(&self, old: &Snapshot, new: &mut Snapshot) {
        let chart = self.chart;
        let is_start = |path: &String| {
            let node = self.plan.new_paths.find_node(path);
            node.is_some_and(|node| chart.statechart().node(node).kind == NodeKind::Start)
        };
        let starts = old.waiting_starts.iter().filter_map(|path| self.path(path)).filter(is_start);
        new.waiting_starts = starts.filter(|path| new.is_active(path)).collect();
        new.written = old.written.iter().filter_map(|path| self.region(path)).collect();
        new.bound.recent = old.bound.recent.iter().filter_map(|path| self.transition_path(path)).collect();
        new.erred_guards = old.erred_guards.iter().filter_map(|record| self.erred_guard(record)).collect();
        let inherit = old.to_inherit.iter().filter_map(|path| self.region(path));
        new.to_inherit.extend(inherit);
        new.to_inherit.sort_by_key(|path| self.plan.new_paths.find_region(chart, path));
    }

    fn erred_guard(&self, record: &FailedGuardRecord) -> Option<FailedGuardRecord> {
        let (segment, region) = (self.segment(&record.segment)?, self.region(&record.region)?);
        let region_id = self.plan.new_paths.find_region(self.chart, &region)?;
        let is_it =
            |guard: &crate::compile::ScopedGuard| guard.transition == segment && guard.region == region_id;
        self.chart.guards.iter().any(is_it).then(|| FailedGuardRecord {
            segment: self.plan.new_paths.segment(segment).to_owned(),
            region,
            stale: record.stale,
        })
    }

    fn reject_losses(&mut self) {
        if self.plan.accepts_losses {
            return;
        }
        let is_state = |finding: &&MigrationFinding| finding.subject != MigratedItem::State;
        let losses: Vec<Conflict> =
            self.report.losses().filter(is_state).cloned().map(Conflict::Loss).collect();
        self.conflicts.extend(losses);
    }
}
