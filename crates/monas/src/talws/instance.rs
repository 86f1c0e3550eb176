//! An agent on its host, ready to run in simulated time: its list, its charts, and what it tells of both.

use narukom::{Moment, Narukom, Publisher, TopicSlot};

use super::seeds::component_seed;
use super::simulated_chart::SimulatedChart;
use crate::agent::{Agent, Policy};
use crate::binder::Binder;
use crate::chart::Home;
use crate::coverage::ChartCoverage;
use crate::error::Error;
use crate::frequency::Frequency;
use crate::list::{List, Outcome};
use crate::listener::Listeners;
use crate::records::{self, CYCLE, Delivery};
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

/// Counts the cycles of an agent and publishes a record of each.
pub(super) struct Teller {
    number: u64,
    cycles: Publisher<records::Cycle>,
}

impl Teller {
    /// A cycle has begun, and brought this.
    pub(super) fn tell(&mut self, now: Moment, delivered: Vec<Delivery>) {
        self.number += 1;
        self.cycles.publish(records::Cycle { number: self.number, time: now.as_nanos(), delivered }, now);
    }

    pub(super) fn number(&self) -> u64 {
        self.number
    }
}

impl Instance {
    /// Puts an agent on a hub and starts its charts.
    pub(super) fn new(
        agent: Agent,
        hub: &Narukom,
        seed: u64,
        binder: &Binder<'_>,
        listeners: &Listeners,
    ) -> Result<Instance, Error> {
        let Agent { name, policy, frequency, activities, charts, .. } = agent;
        let cycles = hub.publisher(CYCLE, &name).map_err(Error::hub)?;
        let charts = charts.iter().zip(0..).map(|(chart, number)| {
            let home = Home { hub, agent: &name, number, seed, listeners };
            let bound = binder.bind(chart, None).map_err(Error::invalid)?;
            SimulatedChart::new(bound, home, frequency)
        });
        let charts = charts.collect::<Result<_, Error>>()?;
        let list = frequency.filter(|_| !activities.is_empty()).map(|frequency| {
            let mut blackboard = hub.blackboard(&name);
            blackboard.set_random(component_seed(seed, &format!("{}/{name}", hub.host())));
            Scheduled { list: List::new(&name, policy, activities, blackboard), frequency, next: 0 }
        });
        Ok(Instance { name, policy, list, charts, teller: Teller { number: 0, cycles }, stopped: None })
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
    pub(super) fn message_arrived(&mut self, topic: TopicSlot, now: Moment) {
        self.charts.iter_mut().for_each(|chart| chart.message_arrived(topic, now));
    }

    /// Does what is due: a cycle of its list, then the steps of each chart until it rests.
    pub(super) fn run(&mut self, now: Moment) -> Outcome {
        if let Some(scheduled) = self.list.as_mut().filter(|scheduled| scheduled.due() <= now) {
            scheduled.next += 1;
            scheduled.list.begin(now);
            self.teller.tell(now, Delivery::all(scheduled.list.blackboard(), 0).collect());
            let outcome = scheduled.list.cycle(now);
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
            cycles: self.teller.number,
            micro_steps: self.charts.iter().map(SimulatedChart::micro_steps).sum(),
            activities: listed.chain(charted).collect(),
            stopped: self.stopped.clone(),
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
}
