//! A chart in simulated time: its activities are called at once, and return when their declared duration is over.

use narukom::{HostId, Moment, TopicSlot};

use super::orders::{Instances, ShownChart, Standing};
use super::teller::Teller;
use crate::agent::{ChartSettings, Policy};
use crate::chart::{Assignment, Returned, Runner, Swap};
use crate::coverage::ChartCoverage;
use crate::frequency::Frequency;
use crate::monitors;
use crate::origin::Origin;
use crate::statistics::ActivityStatistics;

/// A chart and the activities that are under way.
pub(super) struct SimulatedChart {
    runner: Runner,
    /// Activities whose declared duration is not over, in the order of the calls. What they did nobody knows yet.
    under_way: Vec<UnderWay>,
    /// Wakes it beside what happens, if it has no frequency of its own.
    frequency: Option<Frequency>,
    ticks: u64,
    /// How many calls there were at the moment of the last one.
    calls: u32,
    instant: Moment,
}

/// More calls than this at one moment are taken for calls without end.
const MOST_CALLS: u32 = 10_000;

struct UnderWay {
    until: Moment,
    assignment: Assignment,
    returned: Returned,
}

impl SimulatedChart {
    /// Starts a chart.
    pub(super) fn new(mut runner: Runner, frequency: Option<Frequency>, now: Moment) -> SimulatedChart {
        runner.start(now);
        let first = runner.frequency(frequency).map_or(0, |frequency| frequency.first_due(now));
        let under_way = Vec::new();
        SimulatedChart { runner, under_way, frequency, ticks: first, calls: 0, instant: now }
    }

    /// Wakes it as often as that from now on.
    pub(super) fn set_frequency(&mut self, frequency: Frequency, now: Moment) {
        self.frequency = Some(frequency);
        self.skip_ticks(now);
    }

    fn skip_ticks(&mut self, now: Moment) {
        let frequency = self.runner.frequency(self.frequency);
        self.ticks = frequency.map_or(0, |frequency| frequency.first_due(now));
    }

    /// Has other settings of its own.
    pub(super) fn settle(&mut self, own: ChartSettings, now: Moment) {
        let before = self.runner.frequency(self.frequency);
        self.runner.settle(own);
        if self.runner.frequency(self.frequency) != before {
            self.skip_ticks(now);
        }
    }

    /// Whether the body is to rest when the agent stops because of it.
    pub(super) fn rests_body(&mut self, of_agent: Policy) -> bool {
        self.runner.rests_body(of_agent)
    }

    /// What it is doing.
    pub(super) fn told(&self) -> Vec<String> {
        self.runner.told()
    }

    /// As its agent shows it.
    pub(super) fn shown(&self) -> ShownChart {
        let standing = if self.is_over() { Standing::Stopped } else { Standing::Runs };
        ShownChart { active: self.runner.active(), standing }
    }

    /// Goes on with another model.
    ///
    /// # Errors
    /// What stands against it.
    pub(super) fn swap(&mut self, swap: Swap, now: Moment) -> Result<Vec<String>, Vec<String>> {
        self.runner.swap(swap, now)
    }

    /// Goes on with other instances of activities.
    pub(super) fn renew(&mut self, instances: Instances, now: Moment) {
        self.runner.renew(instances, now);
    }

    /// The host it is on.
    pub(super) fn host(&self) -> &str {
        self.runner.host()
    }

    /// Does one step if there is one to be made, and calls the activities that it starts.
    ///
    /// # Errors
    /// Why the agent is to stop.
    pub(super) fn step_once(
        &mut self,
        now: Moment,
        agent: &str,
        policy: Policy,
        teller: &mut Teller,
    ) -> Result<(), String> {
        while let Some(over) = self.next_return(now) {
            self.returned(over, now, policy, teller.number())?;
        }
        while let Some(assignment) = self.runner.next_waiting(now) {
            self.call(assignment.in_cycle(teller.number()), now)?;
        }
        if !self.runner.is_over() && (self.runner.needs_step(now) || self.tick() <= now) {
            self.step(now, agent, policy, teller)?;
        } else {
            self.lapse(now, agent, policy, teller)?;
        }
        while let Some(assignment) = self.runner.next_started() {
            self.call(assignment.in_cycle(teller.number()), now)?;
        }
        Ok(())
    }

    pub(super) fn due(&self, now: Moment) -> Moment {
        if self.runner.is_over() {
            return Moment::MAX;
        }
        let returns = self.under_way.iter().map(|under_way| under_way.until);
        returns.chain([self.runner.due(now), self.tick()]).min().unwrap_or(Moment::MAX)
    }

    fn tick(&self) -> Moment {
        let frequency = self.runner.frequency(self.frequency);
        frequency.map_or(Moment::MAX, |frequency| frequency.due(self.ticks))
    }

    pub(super) fn message_arrived(
        &mut self,
        topic: TopicSlot,
        host: HostId,
        origin: Option<Origin>,
        now: Moment,
    ) {
        self.runner.message_arrived(topic, host, origin, now);
    }

    pub(super) fn raise(&mut self, event: &str) -> bool {
        self.runner.raise(event)
    }

    /// Steps and calls activities until nothing is left to do at this moment. Activities that a step starts are called before the
    /// next one, in the order in which the machine started them; each return begins a step of its own; those that wait for another
    /// call get it when the chart rests.
    ///
    /// # Errors
    /// Why the agent is to stop.
    pub(super) fn run(
        &mut self,
        now: Moment,
        agent: &str,
        policy: Policy,
        teller: &mut Teller,
    ) -> Result<(), String> {
        while !self.runner.is_over() {
            if let Some(assignment) = self.runner.next_started() {
                self.call(assignment.in_cycle(teller.number()), now)?;
            } else if self.runner.needs_step(now) || self.tick() <= now {
                self.step(now, agent, policy, teller)?;
            } else if let Some(over) = self.next_return(now) {
                self.returned(over, now, policy, teller.number())?;
            } else if let Some(assignment) = self.runner.next_waiting(now) {
                self.call(assignment.in_cycle(teller.number()), now)?;
            } else {
                return self.lapse(now, agent, policy, teller);
            }
        }
        Ok(())
    }

    /// Looks whether something that had to come in time has not.
    fn lapse(&mut self, now: Moment, agent: &str, policy: Policy, teller: &mut Teller) -> Result<(), String> {
        match self.runner.lapse(now) {
            true => {
                let broken = self.runner.broken();
                teller.tell_step(now, [], &broken);
                let policy = self.runner.policy(policy);
                monitors::answer(&broken, (self.runner.host(), agent), policy, teller.number(), now)
            }
            false => Ok(()),
        }
    }

    /// Calls an activity.
    ///
    /// # Errors
    /// The chart's activities wake each other for ever, and time would never go on.
    fn call(&mut self, mut assignment: Assignment, now: Moment) -> Result<(), String> {
        if self.instant != now {
            (self.instant, self.calls) = (now, 0);
        }
        self.calls += 1;
        if self.calls > MOST_CALLS {
            let activity = self.runner.activity_name(assignment.activation);
            self.runner.put_back(assignment);
            return Err(format!(
                "activity `{activity}` is called at one moment after {MOST_CALLS} other calls"
            ));
        }
        let until = now + assignment.duration;
        let returned = assignment.call();
        self.under_way.push(UnderWay { until, assignment, returned });
        Ok(())
    }

    fn step(&mut self, now: Moment, agent: &str, policy: Policy, teller: &mut Teller) -> Result<(), String> {
        while self.tick() <= now {
            self.ticks += 1;
        }
        let stepped = self.runner.step(now);
        let broken = self.runner.broken();
        teller.tell_step(now, self.runner.delivered().iter().cloned(), &broken);
        let policy = self.runner.policy(policy);
        let answered = monitors::answer(&broken, (self.runner.host(), agent), policy, teller.number(), now);
        while let Some(cancelled) = self.runner.next_cancelled() {
            let under_way =
                self.under_way.iter_mut().filter(|one| one.assignment.activation.number == cancelled.number);
            under_way.for_each(|one| one.until = now);
        }
        stepped.map_err(|error| format!("chart `{}`: {error}", self.runner.name())).and(answered)
    }

    /// The first call whose time is over; of several that end at one moment the one that was made first.
    fn next_return(&mut self, now: Moment) -> Option<UnderWay> {
        let first = self.under_way.iter().enumerate().min_by_key(|(place, one)| (one.until, *place));
        let place = first.filter(|(_, one)| one.until <= now).map(|(place, _)| place)?;
        Some(self.under_way.remove(place))
    }

    fn returned(&mut self, over: UnderWay, now: Moment, of_agent: Policy, cycle: u64) -> Result<(), String> {
        let UnderWay { assignment, returned, .. } = over;
        let activation = self.runner.known_as(&assignment);
        let restart = self.runner.policy_of(activation, of_agent) == Policy::Restart;
        let result = self.runner.returned(assignment, returned, None, restart, now);
        let Err(failure) = result else { return Ok(()) };
        self.runner.has_failed(activation, &failure, of_agent, cycle)
    }

    pub(super) fn is_over(&self) -> bool {
        self.runner.is_over()
    }

    pub(super) fn stop(&mut self, now: Moment) {
        self.runner.stop(now);
        self.under_way.clear();
    }

    pub(super) fn micro_steps(&self) -> u64 {
        self.runner.micro_steps()
    }

    pub(super) fn activity_statistics(&self) -> impl Iterator<Item = ActivityStatistics> {
        self.runner.activity_statistics()
    }

    pub(super) fn coverage(&self) -> ChartCoverage {
        self.runner.coverage()
    }
}
