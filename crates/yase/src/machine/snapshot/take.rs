//! From a machine to a snapshot.

use crate::bits::BitSet;
use crate::chart::{Chart, CompoundId, Place, RegionId};
use crate::expression::EventId;
use crate::host::Activation;
use crate::machine::Machine;
use crate::machine::activities::Phase;
use crate::machine::bound::Bound;
use crate::machine::errors::Fault;
use crate::machine::queues::{Held, Occurrence};
use crate::machine::run::Run;
use crate::machine::snapshot::{
    ActivityPhase, ActivityRecord, BoundRecord, ErredGuardRecord, EventName, HeldRecord, HistoryRecord,
    OccurrenceRecord, Paths, PendingRecord, Snapshot, TimerRecord, VERSION, Way, event_name,
};

impl Machine {
    /// Everything about the machine that its coming steps depend on, by name. It can be taken at any time between two calls, in the middle of
    /// a step too ([`micro_step`](Machine::micro_step)). What the host keeps is not in it: see [`snapshot`](crate::snapshot).
    pub fn snapshot(&self) -> Snapshot {
        let taken = Taking { chart: &self.chart, run: &self.run, paths: Paths::new(&self.chart) };
        taken.snapshot(self.configuration().into_iter().map(|node| taken.paths.node(node).to_owned()))
    }

    /// The activities of active states, in the order of the document: those that run or wait must be brought back by the host of a machine
    /// that is [restored](Machine::restore).
    pub fn activations(&self) -> impl Iterator<Item = (Activation, ActivityPhase)> {
        let activities = self.chart.activities.iter().enumerate();
        activities.filter_map(|(activity, &place)| {
            let slot = self.run.activities.slot(activity);
            Some((self.run.activation(&self.chart, place, slot), phase(slot.phase)?))
        })
    }
}

fn phase(phase: Phase) -> Option<ActivityPhase> {
    Some(match phase {
        Phase::Idle => return None,
        Phase::Queued => ActivityPhase::Queued,
        Phase::Running => ActivityPhase::Running,
        Phase::Ongoing => ActivityPhase::Ongoing,
        Phase::Failed => ActivityPhase::Failed,
        Phase::Done => ActivityPhase::Done,
    })
}

struct Taking<'a> {
    chart: &'a Chart,
    run: &'a Run,
    paths: Paths,
}

impl Taking<'_> {
    fn snapshot(&self, configuration: impl Iterator<Item = String>) -> Snapshot {
        let (chart, run) = (self.chart, self.run);
        let queues = &run.queues;
        Snapshot {
            version: VERSION,
            chart: chart.statechart().name.clone(),
            semantics: chart.semantics(),
            status: run.status,
            now: run.now,
            due: run.due,
            step: run.under_way,
            configuration: configuration.collect(),
            to_enter: run.newcomers.regions.iter().map(|&place| self.paths.place(chart, place)).collect(),
            to_inherit: run
                .newcomers
                .blackboards
                .iter()
                .map(|&region| self.paths.region(chart, region))
                .collect(),
            waiting_starts: self.nodes(&run.waiting_starts),
            vacated: self.nodes(&run.vacated),
            joined: self.joined(),
            completions: run.completions.iter().map(|&place| self.paths.place(chart, place)).collect(),
            ending: run.ending,
            no_branch: run.failure.and_then(|fault| match fault {
                Fault::NoBranch(node) => Some(self.paths.node(node).to_owned()),
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
            bound: self.bound(&run.bound),
            chooser: run.chooser.record(),
        }
    }

    fn nodes(&self, set: &BitSet) -> Vec<String> {
        let last = self.chart.layout.len();
        members(set, last).map(|index| self.paths.place(self.chart, Place(index as u32))).collect()
    }

    fn regions(&self, set: &BitSet) -> Vec<String> {
        let last = self.chart.regions.len();
        members(set, last).map(|index| self.paths.region(self.chart, RegionId(index as u32))).collect()
    }

    fn joined(&self) -> Vec<Way> {
        let ids = (0..self.chart.compounds.len() as u32).map(CompoundId);
        let has_arrived = |id: &CompoundId| {
            let slot = self.chart.compounds[id.0 as usize].arrives;
            slot.is_some_and(|slot| self.run.arrived.contains(slot))
        };
        ids.filter(has_arrived).map(|id| self.way(id)).collect()
    }

    fn history(&self) -> Vec<HistoryRecord> {
        let records = self.chart.histories.iter().zip(&self.run.records);
        records
            .filter(|(_, record)| record.is_known)
            .map(|(history, record)| HistoryRecord {
                history: self.paths.place(self.chart, history.place),
                nodes: record.places.iter().map(|&place| self.paths.place(self.chart, place)).collect(),
            })
            .collect()
    }

    fn timers(&self) -> Vec<TimerRecord> {
        let set = self.run.timers.slots.iter().enumerate();
        set.filter_map(|(timer, slot)| {
            let deadline = slot.as_ref()?;
            let timer = self.paths.timer(self.chart, timer);
            let owner = deadline.owner.map(|place| self.paths.place(self.chart, place));
            Some(TimerRecord { timer, deadline: deadline.moment, expired: deadline.expired, owner })
        })
        .collect()
    }

    fn activities(&self) -> Vec<ActivityRecord> {
        let activities = self.chart.activities.iter().enumerate();
        activities
            .filter_map(|(activity, &place)| {
                let slot = self.run.activities.slot(activity);
                let node = self.chart.statechart().node(self.chart.layout.node(place));
                Some(ActivityRecord {
                    state: self.paths.place(self.chart, place),
                    activity: node.activity.clone().unwrap_or_default(),
                    phase: phase(slot.phase)?,
                    number: slot.number,
                    cancelled: slot.cancelled,
                })
            })
            .collect()
    }

    fn occurrences<'o>(&self, queue: impl IntoIterator<Item = &'o Occurrence>) -> Vec<OccurrenceRecord> {
        queue.into_iter().map(|occurrence| self.occurrence(occurrence)).collect()
    }

    fn occurrence(&self, occurrence: &Occurrence) -> OccurrenceRecord {
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

    fn way(&self, compound: CompoundId) -> Way {
        self.paths.way(self.chart, compound)
    }

    fn held(&self, held: &Held) -> HeldRecord {
        HeldRecord {
            occurrence: self.occurrence(&held.occurrence),
            ways: held.compounds.iter().map(|&compound| self.way(compound)).collect(),
            offer: held.offer,
        }
    }

    fn pending(&self) -> Vec<PendingRecord> {
        let pending = self.run.pending.iter();
        pending
            .map(|pending| PendingRecord {
                way: self.way(pending.compound),
                event: pending.event.map(|event| self.event(event)),
            })
            .collect()
    }

    fn erred_guards(&self) -> Vec<ErredGuardRecord> {
        let erred = self.run.erred.iter();
        erred
            .filter_map(|erred| {
                let guard = self.chart.guards.get(erred.guard)?;
                Some(ErredGuardRecord {
                    segment: self.paths.segment(guard.transition).to_owned(),
                    region: self.paths.region(self.chart, guard.region),
                    stale: erred.stale,
                })
            })
            .collect()
    }

    fn bound(&self, bound: &Bound) -> BoundRecord {
        BoundRecord {
            micro_steps: bound.micro_steps,
            instant: bound.instant,
            steps: bound.steps,
            recent: bound.last().into_iter().map(|compound| self.way(compound)).collect(),
        }
    }
}

fn members(set: &BitSet, last: usize) -> impl Iterator<Item = usize> + '_ {
    std::iter::successors(set.next(0, last), move |&index| set.next(index + 1, last))
}
