//! An agent in simulated time: its list, its charts, and when each has something to do.

use narukom::{HostId, Moment, TopicSlot};

use super::ENDED;
use super::crew::Member;
use super::orders::{Directive, Orders, ShownChart, Standing, TOLD};
use super::simulated_chart::SimulatedChart;
use super::teller::Teller;
use crate::agent::Policy;
use crate::chart::Runner;
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
    frequency: Option<Frequency>,
    list: Option<Scheduled>,
    charts: Vec<SimulatedChart>,
    teller: Teller,
    pauses: bool,
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
    pub(super) fn new(member: Member, now: Moment) -> Instance {
        let Member { name, policy, frequency, list, charts, teller, .. } = member;
        let list = list.zip(frequency).map(|(list, frequency)| Scheduled::new(list, frequency, now));
        let charts = charts.into_iter().map(|runner| SimulatedChart::new(runner, frequency, now)).collect();
        Instance { name, policy, frequency, list, charts, teller, pauses: false, stopped: None }
    }

    pub(super) fn has_list(&self) -> bool {
        self.list.is_some()
    }

    /// When it has something to do, if nothing happens before.
    pub(super) fn due(&self, now: Moment) -> Moment {
        if self.stopped.is_some() || self.pauses {
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
        let is_due = self.list.as_ref().is_some_and(|scheduled| scheduled.due() <= now);
        let outcome = if is_due { self.cycle(now) } else { Outcome::Continues };
        if outcome != Outcome::Continues {
            return outcome;
        }
        self.each_chart(now, SimulatedChart::run)
    }

    fn cycle(&mut self, now: Moment) -> Outcome {
        let Some(scheduled) = &mut self.list else { return Outcome::Continues };
        let outcome = scheduled.cycle(now, &mut self.teller);
        if outcome != Outcome::Continues {
            let reason = scheduled.list.stopped().unwrap_or_default().to_owned();
            self.stop(&reason, now);
        }
        outcome
    }

    fn each_chart(
        &mut self,
        now: Moment,
        act: impl Fn(&mut SimulatedChart, Moment, &str, Policy, &mut Teller) -> Result<(), String>,
    ) -> Outcome {
        for index in 0..self.charts.len() {
            let chart = &mut self.charts[index];
            if let Err(reason) = act(chart, now, &self.name, self.policy, &mut self.teller) {
                let rests_body = chart.rests_body(self.policy);
                self.stop(&reason, now);
                return if rests_body { Outcome::SafeState } else { Outcome::Stopped };
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
        let listed = self.list.iter().map(|scheduled| scheduled.list.blackboard().hub().host());
        let robot = listed.chain(self.charts.iter().map(SimulatedChart::host)).next().unwrap_or_default();
        tracing::info!(%robot, agent = %self.name, "stopped: {reason}");
        if let Some(scheduled) = &mut self.list {
            scheduled.list.stop(reason);
        }
        self.charts.iter_mut().for_each(|chart| chart.stop(now));
    }

    /// Does what it is told. Says what became of it, and what there is to say of that.
    ///
    /// # Errors
    /// What stands against it; nothing has changed then.
    pub(super) fn obey(
        &mut self,
        mut orders: Orders,
        now: Moment,
    ) -> Result<(Outcome, Vec<String>), Vec<String>> {
        let mut said = Vec::new();
        if let Some((place, swap)) = orders.swap
            && let Some(chart) = self.charts.get_mut(place)
        {
            said = chart.swap(*swap, now)?;
        }
        for (place, instances) in orders.instances {
            if let Some(chart) = self.charts.get_mut(place) {
                chart.renew(instances, now);
            }
        }
        if let Some((list, frequency)) = orders.list.zip(self.frequency) {
            self.list = Some(Scheduled::new(*list, frequency, now));
        }
        if let Some(scheduled) = &mut self.list {
            orders.edits.into_iter().for_each(|edit| scheduled.list.edit(edit));
        }
        if let Some((place, own)) = orders.own
            && let Some(chart) = self.charts.get_mut(place)
        {
            chart.settle(*own, now);
        }
        let is_meant = |place: usize| orders.only.is_none_or(|only| only == place);
        let meant = self.charts.iter_mut().enumerate().filter(|(place, _)| is_meant(*place));
        for (_, chart) in meant {
            orders.events.iter().for_each(|event| _ = chart.raise(event));
        }
        if let Some(place) = orders.only {
            self.follow_alone(place, orders.charts.pop(), &orders.directives, now);
            return Ok((Outcome::Continues, said));
        }
        if !orders.charts.is_empty() {
            let frequency = self.frequency;
            let anew = orders.charts.into_iter();
            self.charts = anew.map(|runner| SimulatedChart::new(runner, frequency, now)).collect();
        }
        let mut outcome = Outcome::Continues;
        for directive in orders.directives {
            outcome = self.follow(directive, now);
        }
        Ok((outcome, said))
    }

    /// One of its charts is told something, and the others notice nothing.
    fn follow_alone(&mut self, place: usize, anew: Option<Runner>, directives: &[Directive], now: Moment) {
        let Some(chart) = self.charts.get_mut(place) else { return };
        if directives.contains(&Directive::Stop) {
            chart.stop(now);
        }
        if let Some(runner) = anew {
            *chart = SimulatedChart::new(runner, self.frequency, now);
        }
    }

    fn follow(&mut self, directive: Directive, now: Moment) -> Outcome {
        match directive {
            Directive::Start => self.start(now),
            Directive::Stop => self.stop(TOLD, now),
            Directive::Pause => self.pauses = true,
            Directive::Resume => {
                self.pauses = false;
                self.list.iter_mut().for_each(|scheduled| scheduled.skip_to(now));
            }
            Directive::Step => return self.step(now),
            Directive::Frequency(frequency) => self.set_frequency(frequency, now),
            Directive::Policy(policy) => {
                self.policy = policy;
                self.list.iter_mut().for_each(|scheduled| scheduled.list.set_policy(policy));
            }
            // In simulated time nothing is measured, and nobody waits for anybody.
            Directive::StatisticsEvery(_) | Directive::Scheduling(..) => {}
        }
        Outcome::Continues
    }

    fn start(&mut self, now: Moment) {
        (self.stopped, self.pauses) = (None, false);
        if let Some(scheduled) = &mut self.list {
            scheduled.list.restart();
            scheduled.skip_to(now);
        }
    }

    fn step(&mut self, now: Moment) -> Outcome {
        match self.cycle(now) {
            Outcome::Continues => self.each_chart(now, SimulatedChart::step_once),
            other => other,
        }
    }

    fn set_frequency(&mut self, frequency: Frequency, now: Moment) {
        self.frequency = Some(frequency);
        if let Some(scheduled) = &mut self.list {
            scheduled.frequency = frequency;
            scheduled.skip_to(now);
        }
        self.charts.iter_mut().for_each(|chart| chart.set_frequency(frequency, now));
    }

    pub(super) fn standing(&self) -> Standing {
        match (&self.stopped, self.pauses) {
            (Some(_), _) => Standing::Stopped,
            (None, true) => Standing::Pauses,
            (None, false) => Standing::Runs,
        }
    }

    /// Whether it will never do anything again by itself.
    pub(super) fn is_over(&self) -> bool {
        self.stopped.is_some() || self.list.is_none() && self.charts.iter().all(SimulatedChart::is_over)
    }

    pub(super) fn name(&self) -> &str {
        &self.name
    }

    pub(super) fn cycles(&self) -> u64 {
        self.teller.number()
    }

    /// What one of its charts is doing, see [`Runner::told`].
    pub(super) fn told(&self, place: usize) -> Option<Vec<String>> {
        self.charts.get(place).map(SimulatedChart::told)
    }

    /// Its charts as they stand.
    pub(super) fn shown(&self) -> Vec<ShownChart> {
        let is_held = |chart: ShownChart| match self.pauses && chart.standing == Standing::Runs {
            true => ShownChart { standing: Standing::Pauses, ..chart },
            false => chart,
        };
        self.charts.iter().map(|chart| is_held(chart.shown())).collect()
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
            stopped: self.stopped.clone().filter(|reason| reason != ENDED && reason != TOLD),
            ..AgentStatistics::default()
        }
    }

    pub(super) fn coverage(&self) -> impl Iterator<Item = ChartCoverage> {
        self.charts.iter().map(SimulatedChart::coverage)
    }
}

impl Scheduled {
    fn new(list: List, frequency: Frequency, now: Moment) -> Scheduled {
        Scheduled { list, frequency, next: frequency.first_due(now) }
    }

    fn due(&self) -> Moment {
        self.frequency.due(self.next)
    }

    /// What is due before now is left out; and so is what is due now, if the last cycle was at this moment.
    fn skip_to(&mut self, now: Moment) {
        self.next = self.frequency.first_due(now);
        if self.list.last_cycle() == Some(now) && self.due() == now {
            self.next += 1;
        }
    }

    fn cycle(&mut self, now: Moment, teller: &mut Teller) -> Outcome {
        self.next += 1;
        self.list.begin(now);
        teller.tell(now, Delivery::all(self.list.blackboard(), 0));
        self.list.cycle(now, None)
    }
}
