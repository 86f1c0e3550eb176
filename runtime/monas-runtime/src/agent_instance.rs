//! An agent in simulated time: its list, its charts, and their due times.
//!
//! An activity of a chart is called immediately and returns when its declared duration has elapsed.

use std::sync::{Arc, Mutex, PoisonError};

use narukom::{HostId, Timestamp, TopicSlot};

use super::END_REASON;
use super::agent_factory::PreparedAgent;
use super::agent_update::{AgentCommand, AgentStatus, AgentUpdate, ChartStatus, STOPPED_BY_REQUEST};
use super::clock::{CPU_EVERY, RunClock, cpu_time};
use super::cycle_recorder::CycleRecorder;
use super::simulated_chart::SimulatedChart;
use crate::list::ActivityList;
use crate::list::CycleOutcome;
use crate::list::CycleTimer;
use monas_core::agent::FailurePolicy;
use monas_core::chart_runner::{AgentDefaults, ChartAspect, ChartRunner};
use monas_core::coverage::ChartCoverage;
use monas_core::frequency::Frequency;
use monas_core::publishing_activity::{self, PublishingActivity};
use monas_core::records::Delivery;
use monas_core::statistics::{AgentStatistics, Timing};

/// An agent on its host.
pub(crate) struct AgentInstance {
    name: String,
    policy: FailurePolicy,
    frequency: Option<Frequency>,
    list: Option<ScheduledList>,
    charts: Vec<SimulatedChart>,
    recorder: CycleRecorder,
    /// The clock that measures its cycles and calls, if they are measured.
    clock: Option<RunClock>,
    pauses: bool,
    stopped: Option<String>,
}

/// A list and the time of its next cycle.
struct ScheduledList {
    list: ActivityList,
    frequency: Frequency,
    next: u64,
    clock: Option<RunClock>,
    timing: Timing,
}

impl AgentInstance {
    /// Takes over an agent and starts its charts.
    pub(crate) fn new(member: PreparedAgent, now: Timestamp) -> AgentInstance {
        let PreparedAgent { name, policy, frequency, list, charts, recorder, .. } = member;
        let list = list.zip(frequency).map(|(list, frequency)| ScheduledList::new(list, frequency, now));
        let defaults = AgentDefaults { frequency, policy, ..AgentDefaults::default() };
        let start = |runner| SimulatedChart::new(runner, defaults.clone(), now);
        let charts = charts.into_iter().map(start).collect();
        let (clock, pauses, stopped) = (None, false, None);
        AgentInstance { name, policy, frequency, list, charts, recorder, clock, pauses, stopped }
    }

    /// From now on measures cycles and calls by a clock.
    pub(crate) fn measure(&mut self, clock: RunClock) {
        self.clock = Some(clock);
        self.list.iter_mut().for_each(|scheduled| scheduled.clock = Some(clock));
        self.charts.iter_mut().for_each(|chart| chart.measure(clock));
    }

    pub(crate) fn has_list(&self) -> bool {
        self.list.is_some()
    }

    /// The time at which it next acts, if nothing happens before.
    pub(crate) fn due(&self, now: Timestamp) -> Timestamp {
        if self.stopped.is_some() || self.pauses {
            return Timestamp::MAX;
        }
        let list = self.list.iter().map(ScheduledList::due);
        list.chain(self.charts.iter().map(|chart| chart.due(now))).min().unwrap_or(Timestamp::MAX)
    }

    /// Notes that a message was published on a topic of its host.
    pub(crate) fn message_arrived(
        &mut self,
        topic: TopicSlot,
        host: HostId,
        origin: Option<PublishingActivity>,
        now: Timestamp,
    ) {
        self.charts.iter_mut().for_each(|chart| chart.runner.message_arrived(topic, host, origin, now));
    }

    /// Executes what is due: a cycle of its list, then the steps of each chart until it is stable.
    pub(crate) fn run(&mut self, now: Timestamp) -> CycleOutcome {
        let is_due = self.list.as_ref().is_some_and(|scheduled| scheduled.due() <= now);
        let outcome = if is_due { self.cycle(now) } else { CycleOutcome::Running };
        if outcome != CycleOutcome::Running {
            return outcome;
        }
        self.each_chart(now, SimulatedChart::run)
    }

    fn cycle(&mut self, now: Timestamp) -> CycleOutcome {
        let Some(scheduled) = &mut self.list else { return CycleOutcome::Running };
        let outcome = scheduled.cycle(now, &mut self.recorder);
        if outcome != CycleOutcome::Running {
            let reason = scheduled.list.stopped().unwrap_or_default().to_owned();
            self.fail(&reason, now);
        }
        outcome
    }

    fn each_chart(
        &mut self,
        now: Timestamp,
        act: impl Fn(&mut SimulatedChart, Timestamp, &mut CycleRecorder) -> Result<(), String>,
    ) -> CycleOutcome {
        for index in 0..self.charts.len() {
            let chart = &mut self.charts[index];
            if let Err(reason) = act(chart, now, &mut self.recorder) {
                let enters_safe_state = chart.runner.requires_safe_state();
                self.fail(&reason, now);
                return if enters_safe_state { CycleOutcome::SafeState } else { CycleOutcome::Stopped };
            }
        }
        CycleOutcome::Running
    }

    /// Raises an event in its charts; returns false if none of them names it.
    pub(crate) fn raise(&mut self, event: &str) -> bool {
        // Every chart gets the event, even if an earlier one has taken it.
        self.charts.iter_mut().filter_map(|chart| chart.runner.raise(event).then_some(())).count() > 0
    }

    /// Stops because of a failure.
    fn fail(&mut self, reason: &str, now: Timestamp) {
        if self.stopped.is_none() {
            tracing::error!(robot = %self.host(), agent = %self.name, "stopped: {reason}");
            self.end(reason, now);
        }
    }

    /// Stops because this is intended.
    pub(crate) fn stop(&mut self, reason: &str, now: Timestamp) {
        if self.stopped.is_none() {
            tracing::info!(robot = %self.host(), agent = %self.name, "stopped: {reason}");
            self.end(reason, now);
        }
    }

    fn host(&self) -> &str {
        let listed = self.list.iter().map(|scheduled| scheduled.list.blackboard().hub().host());
        listed.chain(self.charts.iter().map(|chart| chart.runner.host())).next().unwrap_or_default()
    }

    /// Stops the list and all charts.
    fn end(&mut self, reason: &str, now: Timestamp) {
        self.stopped = Some(reason.into());
        if let Some(scheduled) = &mut self.list {
            scheduled.list.stop(reason);
        }
        self.charts.iter_mut().for_each(|chart| chart.runner.stop(now));
    }

    /// Applies an update between two turns. Returns the outcome for the agent, with notes.
    ///
    /// # Errors
    /// The reasons against it; nothing has changed then.
    pub(crate) fn apply(
        &mut self,
        mut orders: AgentUpdate,
        now: Timestamp,
    ) -> Result<(CycleOutcome, Vec<String>), Vec<String>> {
        let mut said = Vec::new();
        if let Some((index, swap)) = orders.swap
            && let Some(chart) = self.charts.get_mut(index)
        {
            said = chart.runner.swap(*swap, now)?;
        }
        for (index, instances) in orders.instances {
            if let Some(chart) = self.charts.get_mut(index) {
                chart.runner.replace_instances(instances, now);
            }
        }
        if let Some((list, frequency)) = orders.list.zip(self.frequency) {
            self.list =
                Some(ScheduledList { clock: self.clock, ..ScheduledList::new(*list, frequency, now) });
        }
        if let Some(scheduled) = &mut self.list {
            orders.edits.into_iter().for_each(|edit| scheduled.list.edit(edit));
        }
        if let Some((index, own)) = orders.chart_settings
            && let Some(chart) = self.charts.get_mut(index)
        {
            chart.runner.apply_settings(*own, now);
        }
        let is_meant = |index: usize| orders.only.is_none_or(|only| only == index);
        let meant = self.charts.iter_mut().enumerate().filter(|(index, _)| is_meant(*index));
        for (_, chart) in meant {
            orders.events.iter().for_each(|event| _ = chart.runner.raise(event));
        }
        if let Some(index) = orders.only {
            self.apply_to_chart(index, orders.charts.pop(), &orders.commands, now);
            return Ok((CycleOutcome::Running, said));
        }
        if !orders.charts.is_empty() {
            let defaults = self.defaults();
            let clock = self.clock;
            let start = |runner| SimulatedChart::new(runner, defaults.clone(), now).measured(clock);
            self.charts = orders.charts.into_iter().map(start).collect();
        }
        let mut outcome = CycleOutcome::Running;
        for directive in orders.commands {
            outcome = self.apply_command(directive, now);
        }
        Ok((outcome, said))
    }

    /// Applies an update to one chart; the others are not affected.
    fn apply_to_chart(
        &mut self,
        index: usize,
        anew: Option<ChartRunner>,
        directives: &[AgentCommand],
        now: Timestamp,
    ) {
        let defaults = self.defaults();
        let Some(chart) = self.charts.get_mut(index) else { return };
        if directives.contains(&AgentCommand::Stop) {
            chart.runner.stop(now);
        }
        if let Some(runner) = anew {
            *chart = SimulatedChart::new(runner, defaults, now).measured(self.clock);
        }
    }

    /// The settings of the agent, for its charts.
    fn defaults(&self) -> AgentDefaults {
        AgentDefaults { frequency: self.frequency, policy: self.policy, ..AgentDefaults::default() }
    }

    fn apply_command(&mut self, directive: AgentCommand, now: Timestamp) -> CycleOutcome {
        match directive {
            AgentCommand::Start => self.start(now),
            AgentCommand::Stop => self.stop(STOPPED_BY_REQUEST, now),
            AgentCommand::Pause => self.pauses = true,
            AgentCommand::Resume => {
                self.pauses = false;
                self.list.iter_mut().for_each(|scheduled| scheduled.skip_to(now));
            }
            AgentCommand::Step => return self.step(now),
            AgentCommand::Frequency(frequency) => self.set_frequency(frequency, now),
            AgentCommand::Policy(policy) => {
                self.policy = policy;
                self.list.iter_mut().for_each(|scheduled| scheduled.list.set_policy(policy));
                for chart in &mut self.charts {
                    chart.runner.update_defaults(|defaults| defaults.policy = policy, now);
                }
            }
            // Simulated time has no measurements, and threads have no priorities.
            AgentCommand::StatisticsEvery(_) | AgentCommand::Scheduling(..) => {}
        }
        CycleOutcome::Running
    }

    fn start(&mut self, now: Timestamp) {
        (self.stopped, self.pauses) = (None, false);
        if let Some(scheduled) = &mut self.list {
            scheduled.list.restart();
            scheduled.skip_to(now);
        }
    }

    fn step(&mut self, now: Timestamp) -> CycleOutcome {
        match self.cycle(now) {
            CycleOutcome::Running => self.each_chart(now, SimulatedChart::step_once),
            other => other,
        }
    }

    fn set_frequency(&mut self, frequency: Frequency, now: Timestamp) {
        self.frequency = Some(frequency);
        if let Some(scheduled) = &mut self.list {
            scheduled.frequency = frequency;
            scheduled.skip_to(now);
        }
        self.charts.iter_mut().for_each(|chart| chart.set_frequency(frequency, now));
    }

    pub(crate) fn status(&self) -> AgentStatus {
        match (&self.stopped, self.pauses) {
            (Some(_), _) => AgentStatus::Stopped,
            (None, true) => AgentStatus::Paused,
            (None, false) => AgentStatus::Running,
        }
    }

    /// Whether it will not act again by itself.
    pub(crate) fn is_over(&self) -> bool {
        self.stopped.is_some()
            || self.list.is_none() && self.charts.iter().all(|chart| chart.runner.is_over())
    }

    pub(crate) fn name(&self) -> &str {
        &self.name
    }

    pub(crate) fn cycles(&self) -> u64 {
        self.recorder.number()
    }

    /// The state of one of its charts, see [`ChartRunner::inspect`].
    pub(crate) fn inspect_chart(&self, index: usize, aspect: ChartAspect) -> Option<Vec<String>> {
        self.charts.get(index).map(|chart| chart.runner.inspect(aspect))
    }

    /// The status of its charts.
    pub(crate) fn chart_statuses(&self) -> Vec<ChartStatus> {
        let is_held = |chart: ChartStatus| match self.pauses && chart.status == AgentStatus::Running {
            true => ChartStatus { status: AgentStatus::Paused, ..chart },
            false => chart,
        };
        self.charts.iter().map(|chart| is_held(chart.status())).collect()
    }

    pub(crate) fn statistics(&self, host: &str) -> AgentStatistics {
        let listed = self.list.iter().flat_map(|scheduled| scheduled.list.activity_statistics());
        let charted = self.charts.iter().flat_map(|chart| chart.runner.activity_statistics());
        let mut statistics = AgentStatistics {
            host: host.into(),
            agent: self.name.clone(),
            cycles: self.recorder.number(),
            micro_steps: self.charts.iter().map(|chart| chart.runner.micro_steps()).sum(),
            activities: listed.chain(charted).collect(),
            stopped: self
                .stopped
                .clone()
                .filter(|reason| reason != END_REASON && reason != STOPPED_BY_REQUEST),
            ..AgentStatistics::default()
        };
        let listed = self.list.iter().map(|scheduled| &scheduled.timing);
        listed.chain(self.charts.iter().map(SimulatedChart::timing)).for_each(|timing| {
            statistics.add(AgentStatistics {
                cycle_time: timing.wall(),
                cycle_cpu: timing.cpu(),
                cycle_percentiles: timing.percentiles(),
                ..AgentStatistics::default()
            });
        });
        statistics
    }

    pub(crate) fn coverage(&self) -> impl Iterator<Item = ChartCoverage> {
        self.charts.iter().map(|chart| chart.runner.coverage())
    }
}

impl ScheduledList {
    fn new(list: ActivityList, frequency: Frequency, now: Timestamp) -> ScheduledList {
        let (clock, timing) = (None, Timing::default());
        ScheduledList { list, frequency, next: frequency.first_due(now), clock, timing }
    }

    fn due(&self) -> Timestamp {
        self.frequency.due(self.next)
    }

    /// Skips what was due before now, and what is due now if the last cycle was at this time.
    fn skip_to(&mut self, now: Timestamp) {
        self.next = self.frequency.first_due(now);
        if self.list.last_cycle() == Some(now) && self.due() == now {
            self.next += 1;
        }
    }

    fn cycle(&mut self, now: Timestamp, recorder: &mut CycleRecorder) -> CycleOutcome {
        self.next += 1;
        let since = self.clock.map(|clock| clock.now());
        self.list.begin(now);
        recorder.record(now, Delivery::all(self.list.blackboard(), 0));
        let Some((clock, since)) = self.clock.as_ref().zip(since) else { return self.list.cycle(now, None) };
        let cpu = if self.list.number() % CPU_EVERY == 1 { cpu_time() } else { None };
        let timer = CycleTimer { clock, since, cpu, watchdog: None };
        self.list.timed_cycle(now, timer, &mut self.timing).0
    }
}

/// Publications noted by the waker of a hub that have not been delivered to the agents.
#[derive(Clone, Default)]
pub(crate) struct PublishedTopics {
    notices: Arc<Mutex<Vec<PublicationNotice>>>,
    /// Holds the publications during their delivery; kept for its memory.
    delivered: Vec<PublicationNotice>,
}

/// A published message: its topic, its host, and the activity of a chart that published it, if any.
type PublicationNotice = (TopicSlot, HostId, Option<PublishingActivity>);

impl PublishedTopics {
    /// The callback for the waker of a hub, which notes each publication.
    pub(crate) fn topic_callback(&self) -> impl Fn(TopicSlot, HostId) + Send + Sync + 'static {
        let news = self.notices.clone();
        move |topic, host| {
            news.lock().unwrap_or_else(PoisonError::into_inner).push((
                topic,
                host,
                publishing_activity::publishing(),
            ));
        }
    }

    /// Notifies every agent of the noted publications.
    pub(crate) fn deliver<'a>(
        &mut self,
        instances: impl Iterator<Item = &'a mut AgentInstance>,
        now: Timestamp,
    ) {
        self.delivered.clear();
        std::mem::swap(
            &mut *self.notices.lock().unwrap_or_else(PoisonError::into_inner),
            &mut self.delivered,
        );
        if self.delivered.is_empty() {
            return;
        }
        for instance in instances {
            for (topic, host, origin) in &self.delivered {
                instance.message_arrived(*topic, *host, *origin, now);
            }
        }
    }
}
