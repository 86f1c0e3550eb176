//! Consistency between the parts of a snapshot.

use std::collections::BTreeSet;

use crate::compile::NodeIndex;
use crate::ids::CompoundTransitionId;
use crate::machine::Status;
use crate::machine::queues::PoppedEvent;
use crate::machine::snapshot::restore::SnapshotRestorer;
use crate::machine::snapshot::{RestoreIssueKind, Snapshot, can_remember};
use crate::statechart::NodeKind;

/// Reports combinations that no machine of the chart can have. All names have been resolved, or
/// reported as unknown.
pub(crate) fn check(restoring: &mut SnapshotRestorer<'_>, snapshot: &Snapshot) {
    restoring.configuration_is_closed();
    restoring.unfinished_is_of_active_nodes();
    restoring.joined_regions_are_vacated();
    restoring.records_are_configurations();
    restoring.regions_to_enter_are_valid();
    restoring.starts_wait_where_they_are();
    restoring.activities_are_those_of_active_states(snapshot);
    restoring.occurrences_are_in_order(snapshot);
    restoring.expiries_are_of_expired_timers();
    restoring.held_events_wait_for_something();
    restoring.pending_transitions_interrupt();
    restoring.nothing_pending_unless_running(snapshot);
}

impl SnapshotRestorer<'_> {
    fn report_contradiction(&mut self, field: impl Into<String>, text: impl Into<String>) {
        self.report_issue(RestoreIssueKind::Contradiction, field, text);
    }

    fn is_active(&self, node: NodeIndex) -> bool {
        self.run.is_active(node)
    }

    fn active(&self) -> Vec<NodeIndex> {
        let nodes = self.chart.layout.indices();
        nodes.filter(|&node| self.is_active(node)).collect()
    }

    fn configuration_is_closed(&mut self) {
        let active = self.active();
        let may_be_empty = matches!(self.run.status, Status::Idle | Status::Finished);
        if active.is_empty() && (may_be_empty || self.run.failure.is_some()) {
            return;
        }
        if self.run.status == Status::Idle {
            self.unclosed("a machine that has not been started has no active nodes".into());
        }
        if !self.is_active(self.chart.layout.root()) {
            self.unclosed("the root is not active".into());
        }
        for node in active {
            self.parent_is_active(node);
            self.children_fit(node);
        }
    }

    fn unclosed(&mut self, text: String) {
        self.report_issue(RestoreIssueKind::Configuration, "configuration", text);
    }

    fn parent_is_active(&mut self, node: NodeIndex) {
        let Some(parent) = self.chart.statechart().node(self.chart.layout.node(node)).parent else { return };
        let parent = self.chart.layout.index_of(parent);
        if !self.is_active(parent) {
            let (path, around) = (self.path(node), self.path(parent));
            self.unclosed(format!("`{path}` is active, but `{around}` around it is not"));
        }
    }

    /// TERMINATE stops a chart within a micro-step: the targets have not been entered.
    fn children_fit(&mut self, node: NodeIndex) {
        let is_and = self.kind(node) == NodeKind::And;
        let is_there = |child: NodeIndex| self.is_active(child) || is_and && self.run.is_to_enter(child);
        let may_be_empty = self.run.vacated.contains(node.index());
        let is_cut_short = self.run.status == Status::Stopped
            && match self.kind(node) {
                NodeKind::And => true,
                NodeKind::Or => !self.children(node).any(is_there),
                _ => false,
            };
        if is_cut_short {
            return;
        }
        for text in self.holes(node, is_there, may_be_empty) {
            self.unclosed(text);
        }
    }

    /// The problems with the children of a node in a configuration.
    fn holes(
        &self,
        node: NodeIndex,
        is_there: impl Fn(NodeIndex) -> bool,
        may_be_empty: bool,
    ) -> Vec<String> {
        let path = self.path(node);
        let children: Vec<NodeIndex> = self.children(node).collect();
        let there = || children.iter().filter(|&&child| is_there(child));
        match self.kind(node) {
            NodeKind::Or | NodeKind::And if may_be_empty => match there().next() {
                Some(&child) => vec![format!("`{path}` was vacated, but `{}` is active", self.path(child))],
                None => Vec::new(),
            },
            NodeKind::Or => match there().count() {
                0 => vec![format!("`{path}` is active, but nothing in it")],
                1 => Vec::new(),
                _ => {
                    let list: Vec<String> = there().map(|&child| format!("`{}`", self.path(child))).collect();
                    vec![format!("in `{path}` one child is active, not {}", list.join(", "))]
                }
            },
            NodeKind::And => {
                let regions = self.chart.states[node.index()].parts.iter();
                let missing = regions.filter(|&&region| !is_there(region)).map(|&region| self.path(region));
                missing
                    .map(|region| format!("`{path}` is active, but its region `{region}` is not"))
                    .collect()
            }
            NodeKind::Basic | NodeKind::Start | NodeKind::End => Vec::new(),
            _ => vec![format!("`{path}` is a connector and never active")],
        }
    }

    fn children(&self, node: NodeIndex) -> impl Iterator<Item = NodeIndex> + use<'_> {
        let layout = &self.chart.layout;
        let children = self.chart.statechart().children(layout.node(node));
        children.iter().map(|&child| layout.index_of(child))
    }

    fn unfinished_is_of_active_nodes(&mut self) {
        let nodes = self.chart.layout.indices();
        let vacated = nodes.filter(|node| self.run.vacated.contains(node.index()));
        let completed = self.run.completions.iter().copied();
        let rows = vacated.map(|index| ("vacated", index)).chain(completed.map(|node| ("completions", node)));
        let wrong: Vec<_> = rows.filter(|&(_, node)| !self.is_active(node)).collect();
        for (field, node) in wrong {
            let text = format!("`{}` is not active", self.path(node));
            self.report_contradiction(field, text);
        }
    }

    fn joined_regions_are_vacated(&mut self) {
        let chart = self.chart;
        for join in &chart.joins {
            for (slot, &region) in join.slots().zip(&join.regions) {
                // a BASIC region has nothing inside that was left
                let is_basic = chart.states[region.index()].kind == NodeKind::Basic;
                let has_left = self.run.vacated.contains(region.index()) || is_basic;
                if self.run.arrived.contains(slot) && !has_left {
                    let text = format!(
                        "`{}` has arrived where regions are joined, but was not vacated",
                        self.path(region)
                    );
                    self.report_contradiction("joined", text);
                }
            }
        }
    }

    fn records_are_configurations(&mut self) {
        let chart = self.chart;
        for (history, record) in chart.histories.iter().zip(self.run.records.clone()) {
            let nodes = record.nodes.into_iter().collect();
            if record.is_known && !can_remember(chart, history, &nodes) {
                let path = self.path(history.node);
                self.report_contradiction(
                    "history",
                    format!("what `{path}` remembers was never active together"),
                );
            }
        }
    }

    fn regions_to_enter_are_valid(&mut self) {
        for index in 0..self.run.regions_to_enter.regions.len() {
            let node = self.run.regions_to_enter.regions[index];
            let path = self.path(node);
            if !self.chart.regions.iter().any(|region| region.root == node) {
                self.report_contradiction("to_enter", format!("`{path}` is not a region"));
            } else if self.is_active(node) {
                self.report_contradiction("to_enter", format!("`{path}` is active already"));
            } else if !self.is_around_active(node) {
                self.report_contradiction("to_enter", format!("the AND around `{path}` is not active"));
            }
        }
        for index in 0..self.run.regions_to_enter.blackboards.len() {
            let region = self.run.regions_to_enter.blackboards[index];
            let root = self.chart.regions[region.index()].root;
            if !self.is_active(root) {
                let text = format!("`{}` is not active", self.path(root));
                self.report_contradiction("to_inherit", text);
            }
        }
    }

    fn is_around_active(&self, index: NodeIndex) -> bool {
        let node = self.chart.statechart().node(self.chart.layout.node(index));
        node.parent.is_some_and(|parent| self.is_active(self.chart.layout.index_of(parent)))
    }

    fn starts_wait_where_they_are(&mut self) {
        for node in self.chart.layout.indices() {
            let waits = self.run.waiting_starts.contains(node.index());
            if waits && !(self.is_active(node) && self.kind(node) == NodeKind::Start) {
                let text = format!("`{}` is not an active START", self.path(node));
                self.report_contradiction("waiting_starts", text);
            }
        }
    }

    fn activities_are_those_of_active_states(&mut self, snapshot: &Snapshot) {
        let mut numbers = BTreeSet::new();
        for (index, record) in snapshot.activities.iter().enumerate() {
            let field = format!("activities[{index}].number");
            if record.number == 0 || record.number > snapshot.activations {
                let text = format!("{} is not from 1 to {}", record.number, snapshot.activations);
                self.report_contradiction(&field, text);
            }
            if !numbers.insert(record.number) {
                self.report_contradiction(field, format!("{} is that of another activity", record.number));
            }
            if !snapshot.is_active(&record.state) {
                let text = format!("`{}` is not active", record.state);
                self.report_contradiction(format!("activities[{index}].state"), text);
            }
        }
        if snapshot.status == Status::Running {
            self.active_states_have_their_activities(snapshot);
        }
    }

    fn active_states_have_their_activities(&mut self, snapshot: &Snapshot) {
        for &node in &self.chart.activities {
            let path = self.path(node);
            if self.is_active(node) && snapshot.activity(&path).is_none() {
                self.report_contradiction(
                    "activities",
                    format!("`{path}` is active, and nothing is said of its activity"),
                );
            }
        }
    }

    fn occurrences_are_in_order(&mut self, snapshot: &Snapshot) {
        let held: Vec<u64> = snapshot.held.iter().map(|held| held.occurrence.number).collect();
        let numbers = |records: &[crate::snapshot::OccurrenceRecord]| -> Vec<u64> {
            records.iter().map(|record| record.number).collect()
        };
        let queues = [
            ("raised", numbers(&snapshot.raised)),
            ("arrived", numbers(&snapshot.arrived)),
            ("deferred", numbers(&snapshot.deferred)),
            ("held", held),
        ];
        let mut all = BTreeSet::new();
        for (field, numbers) in queues {
            if !numbers.is_sorted() {
                self.report_contradiction(field, "older events, of lesser number, come first");
            }
            for number in numbers {
                self.number_is_new(field, number, snapshot.occurrences, &mut all);
            }
        }
        for (field, records, raised) in
            [("raised", &snapshot.raised, true), ("arrived", &snapshot.arrived, false)]
        {
            if records.iter().any(|record| record.raised != raised) {
                self.report_contradiction(field, format!("`raised` is {raised} for all of these events"));
            }
        }
    }

    fn number_is_new(&mut self, field: &str, number: u64, count: u64, all: &mut BTreeSet<u64>) {
        if number == 0 || number > count {
            self.report_contradiction(field, format!("the number {number} is not from 1 to {count}"));
        }
        if !all.insert(number) {
            self.report_contradiction(field, format!("the number {number} is that of another event"));
        }
    }

    fn expiries_are_of_expired_timers(&mut self) {
        let wrong: Vec<u32> = self
            .run
            .queues
            .all()
            .filter_map(|occurrence| Some((occurrence, occurrence.expiry?)))
            .filter(|(occurrence, timer)| !self.has_expired(occurrence, *timer))
            .map(|(_, timer)| timer)
            .collect();
        for timer in wrong {
            let name = &self.chart.timers[timer as usize].name;
            let text = format!(
                "an expiry of `{name}` waits, but that timer is not set, has not expired or is no such event"
            );
            self.report_contradiction("timers", text);
        }
    }

    fn has_expired(&self, occurrence: &PoppedEvent, timer: u32) -> bool {
        let deadline = self.run.timers.slot(timer as usize);
        deadline.is_some_and(|deadline| deadline.expired)
            && self.chart.timers[timer as usize].event == Some(occurrence.event)
    }

    /// A held event that waits for nothing would be lost.
    fn held_events_wait_for_something(&mut self) {
        for index in 0..self.run.queues.held.len() {
            let held = &self.run.queues.held[index];
            let waits = held.offer || held.compounds.iter().any(|&compound| self.is_blocked(compound));
            if !waits {
                self.report_contradiction(
                    format!("held[{index}]"),
                    "nothing that it waits for runs, and it is not offered",
                );
            }
        }
    }

    fn is_blocked(&self, compound: CompoundTransitionId) -> bool {
        let compound = &self.chart.compounds[compound.0 as usize];
        let is_locked = |source: NodeIndex| {
            let region = self.chart.states[source.index()].region;
            self.run.running_regions.contains(region.index()) || self.run.has_pending_exit(self.chart, source)
        };
        compound.sources().any(is_locked)
            || compound
                .exits
                .is_some_and(|(first, last)| self.run.running.any_in(first.index(), last.index()))
    }

    fn pending_transitions_interrupt(&mut self) {
        for index in 0..self.run.pending.len() {
            let pending = &self.run.pending[index];
            let compound = &self.chart.compounds[pending.compound.0 as usize];
            if !compound.interrupts {
                self.report_contradiction(format!("pending[{index}]"), "the transition does not interrupt");
            } else if let Some(source) = compound.sources().find(|&source| !self.is_active(source)) {
                let text = format!("its source `{}` is not active", self.path(source));
                self.report_contradiction(format!("pending[{index}]"), text);
            }
        }
    }

    fn nothing_pending_unless_running(&mut self, snapshot: &Snapshot) {
        if snapshot.status == Status::Running {
            return;
        }
        let rows = [
            ("raised", snapshot.raised.is_empty()),
            ("arrived", snapshot.arrived.is_empty()),
            ("deferred", snapshot.deferred.is_empty()),
            ("held", snapshot.held.is_empty()),
            ("pending", snapshot.pending.is_empty()),
            ("activities", snapshot.activities.is_empty()),
            ("completions", snapshot.completions.is_empty()),
        ];
        for (field, _) in rows.into_iter().filter(|(_, is_empty)| !is_empty) {
            self.report_contradiction(field, "the machine does not run, so there is nothing");
        }
    }
}
