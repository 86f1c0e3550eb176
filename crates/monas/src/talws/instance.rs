//! An agent in simulated time: its list, its charts, and when each has something to do.

use narukom::{HostId, Moment, TopicSlot};

use super::ENDED;
use super::setup::Member;
use super::simulated_chart::SimulatedChart;
use super::teller::Teller;
use crate::agent::Policy;
use crate::coverage::ChartCoverage;
use crate::frequency::Frequency;
use crate::list::{List, Outcome};
use crate::origin::Origin;
use crate::records::Delivery;
use crate::statistics::AgentStatistics;

/// An agent on its host.
pub(super) struct Instance {
    name: String,
    policy: Policy,
    list: Option<Scheduled>,
    charts: Vec<SimulatedChart>,
    teller: Teller,
    stopped: Option<String>,
}

/// A list and when its next cycle is due.
struct Scheduled {
    list: List,
    frequency: Frequency,
    next: u64,
}

impl Instance {
    /// Takes over an agent, and starts its charts.
    pub(super) fn new(member: Member) -> Instance {
        let Member { name, policy, frequency, list, charts, teller, .. } = member;
        let list = list.zip(frequency).map(|(list, frequency)| Scheduled { list, frequency, next: 0 });
        let charts = charts.into_iter().map(|runner| SimulatedChart::new(runner, frequency)).collect();
        Instance { name, policy, list, charts, teller, stopped: None }
    }

    /// When it has something to do, if nothing happens before.
    pub(super) fn due(&self, now: Moment) -> Moment {
        if self.stopped.is_some() {
            return Moment::MAX;
        }
        let list = self.list.iter().map(Scheduled::due);
        list.chain(self.charts.iter().map(|chart| chart.due(now))).min().unwrap_or(Moment::MAX)
    }

    /// Takes note that a message was published on a topic of its host.
    pub(super) fn message_arrived(
        &mut self,
        topic: TopicSlot,
        host: HostId,
        origin: Option<Origin>,
        now: Moment,
    ) {
        self.charts.iter_mut().for_each(|chart| chart.message_arrived(topic, host, origin, now));
    }

    /// Does what is due: a cycle of its list, then the steps of each chart until it rests.
    pub(super) fn run(&mut self, now: Moment) -> Outcome {
        if let Some(scheduled) = self.list.as_mut().filter(|scheduled| scheduled.due() <= now) {
            let outcome = scheduled.cycle(now, &mut self.teller);
            if outcome != Outcome::Continues {
                let reason = scheduled.list.stopped().unwrap_or_default().to_owned();
                self.stop(&reason, now);
                return outcome;
            }
        }
        for index in 0..self.charts.len() {
            if let Err(reason) = self.charts[index].run(now, &self.name, self.policy, &mut self.teller) {
                self.stop(&reason, now);
                return if self.policy == Policy::SafeState { Outcome::SafeState } else { Outcome::Stopped };
            }
        }
        Outcome::Continues
    }

    /// Notes an event for its charts; false if none of them names it.
    pub(super) fn raise(&mut self, event: &str) -> bool {
        // Every chart takes note, also when an earlier one has.
        self.charts.iter_mut().filter_map(|chart| chart.raise(event).then_some(())).count() > 0
    }

    /// Ends everything.
    pub(super) fn stop(&mut self, reason: &str, now: Moment) {
        if self.stopped.is_some() {
            return;
        }
        self.stopped = Some(reason.into());
        tracing::info!(agent = %self.name, "stopped: {reason}");
        if let Some(scheduled) = &mut self.list {
            scheduled.list.stop(reason);
        }
        self.charts.iter_mut().for_each(|chart| chart.stop(now));
    }

    pub(super) fn name(&self) -> &str {
        &self.name
    }

    pub(super) fn statistics(&self, host: &str) -> AgentStatistics {
        let listed = self.list.iter().flat_map(|scheduled| scheduled.list.activity_statistics());
        let charted = self.charts.iter().flat_map(SimulatedChart::activity_statistics);
        AgentStatistics {
            host: host.into(),
            agent: self.name.clone(),
            cycles: self.teller.number(),
            micro_steps: self.charts.iter().map(SimulatedChart::micro_steps).sum(),
            activities: listed.chain(charted).collect(),
            stopped: self.stopped.clone().filter(|reason| reason != ENDED),
            ..AgentStatistics::default()
        }
    }

    pub(super) fn coverage(&self) -> impl Iterator<Item = ChartCoverage> {
        self.charts.iter().map(SimulatedChart::coverage)
    }
}

impl Scheduled {
    fn due(&self) -> Moment {
        self.frequency.due(self.next)
    }

    fn cycle(&mut self, now: Moment, teller: &mut Teller) -> Outcome {
        self.next += 1;
        self.list.begin(now);
        teller.tell(now, Delivery::all(self.list.blackboard(), 0).collect());
        self.list.cycle(now, None)
    }
}
