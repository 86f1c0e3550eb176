//! Captures a machine as a snapshot.

use std::collections::BTreeSet;

use crate::bits::BitSet;
use crate::compile::{CompiledChart, NodeIndex};
use crate::expression::EventId;
use crate::ids::{Activation, CompoundTransitionId, ScopeId};
use crate::machine::Machine;
use crate::machine::activities::InvocationPhase;
use crate::machine::errors::StepError;
use crate::machine::livelock_limit::LivelockLimit;
use crate::machine::machine_state::MachineState;
use crate::machine::queues::{HeldEvent, PoppedEvent};
use crate::machine::snapshot::{
    ActivityPhase, ActivityRecord, EventName, FailedGuardRecord, HeldEventRecord, HistoryRecord,
    LivelockRecord, OccurrenceRecord, PathTable, PendingInterruptRecord, Snapshot, TimerRecord,
    TransitionPath, VERSION, event_name,
};

impl Machine {
    /// Captures everything that affects the later steps of the machine, by name. This is possible
    /// between any two calls, also within a step ([`micro_step`](Machine::micro_step)). The state
    /// of the host is not included: see [`snapshot`](crate::snapshot).
    pub fn snapshot(&self) -> Snapshot {
        let taken = Capture { chart: &self.chart, run: &self.run, paths: PathTable::new(&self.chart) };
        taken.snapshot(self.configuration().into_iter().map(|node| taken.paths.node(node).to_owned()))
    }

    /// The activities of active states, in document order: the host of a
    /// [restored](Machine::restore) machine must restore those that run or wait.
    pub fn activations(&self) -> impl Iterator<Item = (Activation, ActivityPhase)> {
        let activities = self.chart.activities.iter().enumerate();
        activities.filter_map(|(activity, &node)| {
            let slot = self.run.activities.slot(activity);
            Some((self.run.activation(&self.chart, node, slot), phase(slot.phase)?))
        })
    }
}

fn phase(phase: InvocationPhase) -> Option<ActivityPhase> {
    Some(match phase {
        InvocationPhase::Idle => return None,
        InvocationPhase::Queued => ActivityPhase::Queued,
        InvocationPhase::Running => ActivityPhase::Running,
        InvocationPhase::Ongoing => ActivityPhase::Ongoing,
        InvocationPhase::Failed => ActivityPhase::Failed,
        InvocationPhase::Done => ActivityPhase::Done,
    })
}

struct Capture<'a> {
    chart: &'a CompiledChart,
    run: &'a MachineState,
    paths: PathTable,
}

impl Capture<'_> {
    fn snapshot(&self, configuration: impl Iterator<Item = String>) -> Snapshot {
        let (chart, run) = (self.chart, self.run);
        let queues = &run.queues;
        Snapshot {
            version: VERSION,
            chart: chart.statechart().name.clone(),
            semantics: chart.semantics(),
            status: run.status,
            now: run.now,
            due: run.needs_step,
            step: run.step_in_progress,
            configuration: configuration.collect(),
            to_enter: run
                .regions_to_enter
                .regions
                .iter()
                .map(|&index| self.paths.node_path(chart, index))
                .collect(),
            to_inherit: run
                .regions_to_enter
                .blackboards
                .iter()
                .map(|&region| self.paths.region(chart, region))
                .collect(),
            waiting_starts: self.nodes(&run.waiting_starts),
            vacated: self.nodes(&run.vacated),
            joined: self.joined(),
            completions: run.completions.iter().map(|&node| self.paths.node_path(chart, node)).collect(),
            ending: run.root_is_final,
            no_branch: run.failure.and_then(|fault| match fault {
                StepError::NoBranch(node) => Some(self.paths.node(node).to_owned()),
                _ => None,
            }),
            history: self.history(),
            timers: self.timers(),
            activations: run.activities.count,
            activities: self.activities(),
            occurrences: queues.count,
            raised: self.occurrences(&*queues.raised),
            arrived: self.occurrences(&*queues.arrived),
            deferred: self.occurrences(&*queues.deferred),
            held: queues.held.iter().map(|held| self.held(held)).collect(),
            pending: self.pending(),
            erred_guards: self.erred_guards(),
            written: self.regions(&run.written),
            bound: self.bound(&run.livelock_limit),
            chooser: run.chooser.record(),
        }
    }

    fn nodes(&self, set: &BitSet) -> Vec<String> {
        let last = self.chart.layout.len();
        members(set, last).map(|index| self.paths.node_path(self.chart, NodeIndex(index as u32))).collect()
    }

    fn regions(&self, set: &BitSet) -> Vec<String> {
        let last = self.chart.regions.len();
        members(set, last).map(|index| self.paths.region(self.chart, ScopeId(index as u32))).collect()
    }

    fn joined(&self) -> Vec<TransitionPath> {
        let ids = (0..self.chart.compounds.len() as u32).map(CompoundTransitionId);
        let arriving = ids.filter_map(|id| Some((self.chart.compounds[id.0 as usize].arrives()?, id)));
        // of several ways from one region, the first stands for all
        let mut seen = BTreeSet::new();
        let arrived = arriving.filter(|&(slot, _)| self.run.arrived.contains(slot) && seen.insert(slot));
        arrived.map(|(_, id)| self.transition_path(id)).collect()
    }

    fn history(&self) -> Vec<HistoryRecord> {
        let records = self.chart.histories.iter().zip(&self.run.records);
        records
            .filter(|(_, record)| record.is_known)
            .map(|(history, record)| HistoryRecord {
                history: self.paths.node_path(self.chart, history.node),
                nodes: record.nodes.iter().map(|&node| self.paths.node_path(self.chart, node)).collect(),
            })
            .collect()
    }

    fn timers(&self) -> Vec<TimerRecord> {
        let set = self.run.timers.armed();
        set.map(|(timer, deadline)| {
            let timer = self.paths.timer(self.chart, timer);
            let owner = deadline.owner.map(|node| self.paths.node_path(self.chart, node));
            TimerRecord { timer, deadline: deadline.moment, expired: deadline.expired, owner }
        })
        .collect()
    }

    fn activities(&self) -> Vec<ActivityRecord> {
        let activities = self.chart.activities.iter().enumerate();
        activities
            .filter_map(|(activity, &index)| {
                let slot = self.run.activities.slot(activity);
                let node = self.chart.statechart().node(self.chart.layout.node(index));
                Some(ActivityRecord {
                    state: self.paths.node_path(self.chart, index),
                    activity: node.activity.clone().unwrap_or_default(),
                    phase: phase(slot.phase)?,
                    number: slot.number,
                    cancelled: slot.cancelled,
                })
            })
            .collect()
    }

    fn occurrences<'o>(&self, queue: impl IntoIterator<Item = &'o PoppedEvent>) -> Vec<OccurrenceRecord> {
        queue.into_iter().map(|occurrence| self.occurrence(occurrence)).collect()
    }

    fn occurrence(&self, occurrence: &PoppedEvent) -> OccurrenceRecord {
        OccurrenceRecord {
            event: self.event(occurrence.event),
            number: occurrence.number,
            raised: occurrence.raised,
            expiry: occurrence.expiry.map(|timer| self.paths.timer(self.chart, timer as usize)),
            token: occurrence.token,
            known: occurrence.is_known,
        }
    }

    fn event(&self, event: EventId) -> EventName {
        event_name(self.chart, event)
    }

    fn transition_path(&self, compound: CompoundTransitionId) -> TransitionPath {
        self.paths.transition_path(self.chart, compound)
    }

    fn held(&self, held: &HeldEvent) -> HeldEventRecord {
        HeldEventRecord {
            occurrence: self.occurrence(&held.occurrence),
            ways: held.compounds.iter().map(|&compound| self.transition_path(compound)).collect(),
            offer: held.offer,
        }
    }

    fn pending(&self) -> Vec<PendingInterruptRecord> {
        let pending = self.run.pending.iter();
        pending
            .map(|pending| PendingInterruptRecord {
                way: self.transition_path(pending.compound),
                event: pending.event.map(|event| self.event(event)),
            })
            .collect()
    }

    fn erred_guards(&self) -> Vec<FailedGuardRecord> {
        let erred = self.run.failed_guards.iter();
        erred
            .filter_map(|erred| {
                let guard = self.chart.guards.get(erred.guard)?;
                Some(FailedGuardRecord {
                    segment: self.paths.segment(guard.transition).to_owned(),
                    region: self.paths.region(self.chart, guard.region),
                    stale: erred.stale,
                })
            })
            .collect()
    }

    fn bound(&self, bound: &LivelockLimit) -> LivelockRecord {
        LivelockRecord {
            micro_steps: bound.micro_steps,
            instant: bound.instant,
            steps: bound.steps,
            recent: bound.last().into_iter().map(|compound| self.transition_path(compound)).collect(),
        }
    }
}

fn members(set: &BitSet, last: usize) -> impl Iterator<Item = usize> + '_ {
    std::iter::successors(set.next(0, last), move |&index| set.next(index + 1, last))
}
