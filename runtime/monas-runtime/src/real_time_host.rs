//! The agents of a host in real time: a thread for each list and each chart, and a pool for the
//! activities of each agent's charts.

use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::Sender;
use std::thread::{self, JoinHandle};
use std::time::Duration;

use narukom::{HostId, Hub, Timestamp, TopicSlot, Waker};

use super::admin::{AgentControl, HostAdmin};
use super::agent_entry;
use super::agent_factory::{AgentFactory, HostContext, PreparedAgent};
use super::agent_shared::{AgentShared, ThreadShared};
use super::agent_update::{AgentCommand, AgentStatus, AgentUpdate, ChangeRef, STOPPED_BY_REQUEST};
use super::body::SAFE_STATE;
use super::chart_thread::{ChartThread, PoolDriver};
use super::clock::RunClock;
use super::cycle_recorder::CycleRecorder;
use super::deadlines::Deadlines;
use super::host_status::HostStatus;
use super::list_thread::ListThread;
use super::observed_thread::LastingCall;
use super::pool::{self, ActivityPool};
use super::supervisor_request::{SupervisorRequest, request_notifier};
use super::sync::Mailbox;
use crate::list::ActivityList;
use monas_core::agent::AgentProfile;
use monas_core::chart_runner::{AgentDefaults, ChartAspect, ChartRunner, FinishedCall};
use monas_core::error::{Error, ErrorKind};
use monas_core::frequency::Frequency;
use monas_core::records::{AgentEntry, CHANGE, Change, Changed, ChartChoice};
use monas_core::scheduling::Scheduling;
use monas_core::statistics::{AgentStatistics, Timing};
use monas_log::LogHosts;

/// Timeout for the reply of a thread, unless its cycle takes longer.
const REPLY_TIMEOUT: Duration = Duration::from_secs(1);

/// A cycle of a list counts as stuck after this number of periods, and not before [`STUCK_LIST`].
const STUCK_PERIODS: u32 = 10;
const STUCK_LIST: Duration = Duration::from_secs(1);

/// A call of a chart's activity, which may legitimately take long, is reported after this time.
const STUCK_CALL: Duration = Duration::from_secs(10);

/// Time that the end of a run waits for calls of activities, unless an agent sets another limit.
const SHUTDOWN_TIMEOUT: Duration = Duration::from_secs(3);

/// Polling interval while threads end.
const END_POLL_INTERVAL: Duration = Duration::from_millis(2);

/// Sleeps for one polling interval.
#[expect(clippy::disallowed_methods, reason = "threads do not report their end")]
pub(crate) fn poll_pause() {
    thread::sleep(END_POLL_INTERVAL);
}

/// The agents of a host.
pub(crate) struct RealTimeHost {
    admin: HostAdmin,
    agents: AgentThreads,
}

/// The callback for published messages.
pub(crate) type WakeCallback = Arc<dyn Fn(TopicSlot, HostId) + Send + Sync>;

/// The threads of the agents.
struct AgentThreads {
    hub: Hub,
    host: usize,
    clock: RunClock,
    /// Set when the body must enter its safe state.
    safe_state: Arc<AtomicBool>,
    linked: Vec<WakeCallback>,
    supervisor: Sender<SupervisorRequest>,
    handles: Vec<AgentHandle>,
    /// The statistics of removed agents.
    removed: Vec<AgentStatistics>,
}

/// An agent and its threads.
struct AgentHandle {
    shared: Arc<AgentShared>,
    threads: Vec<JoinHandle<AgentStatistics>>,
    frequency: Option<Frequency>,
    statistics_every: Option<u64>,
    scheduling: Scheduling,
    stuck_after: Option<Duration>,
    recorder: CycleRecorder,
}

/// An agent that receives messages and whose threads have not been started.
pub(crate) struct ConnectedAgent {
    member: PreparedAgent,
    shared: Arc<AgentShared>,
    list: Option<Arc<ThreadShared>>,
    charts: Vec<Arc<ThreadShared>>,
}

/// The environment of a host's agents.
pub(crate) struct HostSite {
    pub(crate) hub: Hub,
    /// Index of the host.
    pub(crate) host: usize,
    pub(crate) clock: RunClock,
    pub(crate) safe_state: Arc<AtomicBool>,
    pub(crate) supervisor: Sender<SupervisorRequest>,
}

impl RealTimeHost {
    /// A host without agents.
    pub(crate) fn new(
        site: HostSite,
        factory: Arc<AgentFactory>,
        ground: HostContext,
        profiles: Vec<AgentProfile>,
        configuration: Option<Arc<yase::Source>>,
    ) -> Result<RealTimeHost, Error> {
        let HostSite { hub, host, clock, safe_state, supervisor } = site;
        let team = AgentThreads {
            hub,
            host,
            clock,
            safe_state,
            linked: Vec::new(),
            supervisor,
            handles: Vec::new(),
            removed: Vec::new(),
        };
        Ok(RealTimeHost { admin: HostAdmin::new(ground, factory, profiles, configuration)?, agents: team })
    }

    /// Subscribes agents: their charts are notified of messages from now on.
    pub(crate) fn connect(&mut self, members: Vec<PreparedAgent>) -> Result<Vec<ConnectedAgent>, Error> {
        self.agents.connect(members)
    }

    /// Adds the links of the host to those that are notified of messages.
    pub(crate) fn connect_links(&mut self, linked: impl IntoIterator<Item = WakeCallback>) {
        self.agents.linked.extend(linked);
        self.agents.set_waker();
    }

    /// Starts the threads of agents that are connected.
    pub(crate) fn start(&mut self, members: Vec<ConnectedAgent>) -> Result<(), Error> {
        self.agents.start(members)
    }

    pub(crate) fn name(&self) -> &str {
        self.agents.hub.host()
    }

    pub(crate) fn is_empty(&self) -> bool {
        self.agents.handles.is_empty()
    }

    /// Whether no agent will act again by itself.
    pub(crate) fn is_over(&self) -> bool {
        !self.is_empty() && self.agents.handles.iter().all(|worker| worker.shared.is_over())
    }

    pub(crate) fn request_safe_state(&self) {
        self.agents.safe_state.store(true, Ordering::SeqCst);
    }

    /// Applies an external change.
    pub(crate) fn change(&mut self, change: Change, now: Timestamp) -> Changed {
        self.admin.submit_change(change, &mut self.agents, now)
    }

    /// Applies the published changes.
    pub(crate) fn apply_requests(&mut self, now: Timestamp) {
        self.admin.apply_requests(&mut self.agents, now);
    }

    pub(crate) fn status(&mut self, chart: Option<&ChartChoice>) -> HostStatus {
        HostStatus {
            chart: chart.map(|chart| self.admin.chart(chart, &self.agents)),
            host: self.name().into(),
            agents: self.admin.entries(&self.agents),
            configuration: self.admin.configuration(),
            modules: self.admin.modules(),
        }
    }

    /// Checks whether all agents make progress. Returns true if one is newly found to be stuck.
    pub(crate) fn check_agents(&self, now: Timestamp) -> bool {
        let look = |worker: &AgentHandle| {
            let (list, chart) = worker.limits();
            worker.shared.check_watchdog(now, list, chart)
        };
        // Checks all agents, even if an earlier one is stuck.
        self.agents.handles.iter().filter(|worker| look(worker)).count() > 0
    }

    /// Whether all threads have ended, apart from stuck ones.
    pub(crate) fn is_finished(&self) -> bool {
        self.agents.handles.iter().all(AgentHandle::is_finished)
    }

    /// Requests that every thread end.
    pub(crate) fn end(&self) {
        self.agents.handles.iter().for_each(AgentHandle::end);
    }

    /// Abandons the threads that have not ended by now; the end of the run was requested at
    /// `asked`.
    pub(crate) fn abandon(&self, asked: Timestamp, now: Timestamp) {
        let late = |worker: &&AgentHandle| {
            let limit = worker.stuck_after.unwrap_or(SHUTDOWN_TIMEOUT);
            !worker.is_finished() && now >= asked + limit
        };
        self.agents.handles.iter().filter(late).for_each(|worker| worker.shared.abandon(now));
    }

    /// Waits for every thread and returns the statistics of the agents.
    pub(crate) fn join(self) -> Vec<AgentStatistics> {
        let mut all = self.agents.removed;
        all.extend(self.agents.handles.into_iter().filter_map(AgentHandle::join));
        all
    }
}

impl AgentThreads {
    /// Subscribes agents before any of their threads runs: whatever one of them publishes reaches
    /// the others, however late their threads begin.
    fn connect(&mut self, members: Vec<PreparedAgent>) -> Result<Vec<ConnectedAgent>, Error> {
        let mut connected = Vec::new();
        for member in members {
            let part = || Arc::new(ThreadShared::new(self.hub.topics().len()));
            let list = member.list.as_ref().map(|_| part());
            let charts: Vec<Arc<ThreadShared>> = member.charts.iter().map(|_| part()).collect();
            for (runner, part) in member.charts.iter().zip(&charts) {
                runner.topics_of_guards().into_iter().for_each(|topic| _ = part.mailbox.follow(topic));
            }
            let (rests, line) = (self.safe_state.clone(), self.supervisor.clone());
            let shared = Arc::new(AgentShared::new(&member.name, list.clone(), charts.clone(), rests, line));
            let index = self.handles.partition_point(|known| known.shared.name < member.name);
            self.handles.insert(
                index,
                AgentHandle {
                    shared: shared.clone(),
                    threads: Vec::new(),
                    frequency: member.frequency,
                    statistics_every: member.statistics_every,
                    scheduling: member.scheduling.clone(),
                    stuck_after: member.stuck_after,
                    recorder: member.recorder.of_part(0)?,
                },
            );
            connected.push(ConnectedAgent { member, shared, list, charts });
        }
        // Their blackboards exist since the agents were prepared, and see what came since then.
        let charts = || connected.iter().flat_map(|agent| agent.member.charts.iter().zip(&agent.charts));
        let since = charts().map(|(runner, _)| runner.position()).min().unwrap_or(u64::MAX);
        for (number, topic, host) in self.hub.set_waker_since(since, self.waker()) {
            let readers = charts().filter(|(runner, _)| runner.position() < number);
            readers.for_each(|(_, part)| part.mailbox.message(topic, host));
        }
        Ok(connected)
    }

    fn start(&mut self, connected: Vec<ConnectedAgent>) -> Result<(), Error> {
        for ConnectedAgent { member, shared, list, charts } in connected {
            let threads = self.threads(member, &shared, list, charts)?;
            if let Some(worker) = self.handles.iter_mut().find(|worker| worker.shared.name == shared.name) {
                worker.threads = threads;
            }
        }
        Ok(())
    }

    fn set_waker(&self) {
        self.hub.set_waker(self.waker());
    }

    /// Connects every mailbox to the publications of the hub, and the supervisor to changes.
    fn waker(&self) -> Arc<dyn Waker> {
        let mut mailboxes: Vec<Arc<Mailbox<FinishedCall>>> = Vec::new();
        for worker in &self.handles {
            worker.shared.for_each_thread(|part| mailboxes.push(part.mailbox.clone()));
        }
        let (linked, change) = (self.linked.clone(), self.hub.topic(CHANGE.path()));
        let asked = request_notifier(&self.supervisor, self.host);
        Arc::new(move |topic, host| {
            mailboxes.iter().for_each(|mailbox| mailbox.message(topic, host));
            linked.iter().for_each(|wake| wake(topic, host));
            if Some(topic) == change {
                asked();
            }
        })
    }

    fn threads(
        &self,
        member: PreparedAgent,
        unit: &Arc<AgentShared>,
        list_part: Option<Arc<ThreadShared>>,
        chart_parts: Vec<Arc<ThreadShared>>,
    ) -> Result<Vec<JoinHandle<AgentStatistics>>, Error> {
        let PreparedAgent { name, policy, frequency, workers, list, charts, recorder, .. } = member;
        let (statistics_every, scheduling) = (member.statistics_every, member.scheduling);
        let sharing = charts.iter().filter(|runner| runner.own().workers.is_none());
        let useful = sharing.map(ChartRunner::max_activities).sum();
        let pool = Arc::new(ActivityPool::new(
            &name,
            pool::workers(workers, useful),
            self.clock,
            unit.observed().clone(),
            &self.hub,
        ));
        let mut threads = Vec::new();
        let of_agent = AgentDefaults { frequency, policy, scheduling: scheduling.clone(), statistics_every };
        for (runner, part) in charts.into_iter().zip(chart_parts) {
            let own_pool = |workers| {
                let name = format!("{name} {}", runner.chart_index() + 1);
                Arc::new(ActivityPool::new(&name, workers, self.clock, unit.observed().clone(), &self.hub))
            };
            let own_pool = runner.own().workers.map(|workers| own_pool(workers.get()));
            let (unit, pool) = (unit.clone(), own_pool.unwrap_or_else(|| pool.clone()));
            let recorder = recorder.of_part(runner.part())?;
            threads.push(self.spawn_chart(unit, part, runner, of_agent.clone(), pool, recorder)?);
        }
        if let (Some(list), Some(frequency), Some(part)) = (list, frequency, list_part) {
            let list = ListSpawn { list, frequency, statistics_every, scheduling };
            threads.push(self.spawn_list(unit.clone(), part, list, &recorder)?);
        }
        Ok(threads)
    }

    fn spawn_list(
        &self,
        unit: Arc<AgentShared>,
        part: Arc<ThreadShared>,
        list: ListSpawn,
        recorder: &CycleRecorder,
    ) -> Result<JoinHandle<AgentStatistics>, Error> {
        let ListSpawn { list, frequency, statistics_every, scheduling } = list;
        let recorder = recorder.of_part(list.blackboard().part())?;
        let name = unit.name.clone();
        let thread = ListThread {
            host: self.hub.host().into(),
            agent: unit,
            thread: part,
            list,
            deadlines: Deadlines::new(frequency, self.clock.now().max(self.clock.begin())),
            statistics_every,
            scheduling,
            recorder,
            clock: self.clock,
            cycles: 0,
            timing: Timing::default(),
            last_warning: None,
            suppressed_warnings: 0,
            was_late: false,
            has_ended: false,
        };
        let clock = self.clock;
        let hosting = LogHosts::real([&self.hub], move || clock.now());
        spawn(&name, move || hosting.during(|| thread.run()))
    }

    fn spawn_chart(
        &self,
        unit: Arc<AgentShared>,
        part: Arc<ThreadShared>,
        mut runner: ChartRunner,
        of_agent: AgentDefaults,
        pool: Arc<ActivityPool>,
        recorder: CycleRecorder,
    ) -> Result<JoinHandle<AgentStatistics>, Error> {
        let name = unit.name.clone();
        runner.set_defaults(of_agent);
        let driver = PoolDriver::new(unit, part, pool, recorder, self.clock);
        let thread = ChartThread::new(runner, driver);
        let clock = self.clock;
        let hosting = LogHosts::real([&self.hub], move || clock.now());
        spawn(&name, move || hosting.during(|| thread.run()))
    }

    fn agent_handle(&self, agent: &str) -> Option<&AgentHandle> {
        self.handles.iter().find(|worker| worker.shared.name == agent)
    }

    /// Records the requester of a starting agent, for each of its threads.
    fn record_change_request(&self, member: &PreparedAgent, asked: &ChangeRef) -> Result<(), Error> {
        for runner in &member.charts {
            let mut recorder = member.recorder.of_part(runner.part())?;
            recorder.record_change_request(self.clock.now(), asked, asked.ready_at, runner.chart_index());
        }
        member.list.iter().try_for_each(|list| self.record_list_change_request(&member.recorder, list, asked))
    }

    /// Records the requester of a starting list, and the position from which on signals reach it.
    fn record_list_change_request(
        &self,
        recorder: &CycleRecorder,
        list: &ActivityList,
        asked: &ChangeRef,
    ) -> Result<(), Error> {
        let blackboard = list.blackboard();
        let mut recorder = recorder.of_part(blackboard.part())?;
        recorder.record_change_request(self.clock.now(), asked, blackboard.position(), 0);
        Ok(())
    }

    /// Adds a list to an agent without one.
    fn add_list(&mut self, agent: &str, list: ActivityList, asked: Option<&ChangeRef>) -> Result<(), String> {
        let part = Arc::new(ThreadShared::new(0));
        let Some(worker) = self.agent_handle(agent) else { return Err(format!("`{agent}` is not there")) };
        let Some(frequency) = worker.frequency else {
            return Err(format!("`{agent}` has no frequency"));
        };
        if let Some(asked) = asked {
            self.record_list_change_request(&worker.recorder, &list, asked)
                .map_err(|error| error.to_string())?;
        }
        let (unit, statistics_every) = (worker.shared.clone(), worker.statistics_every);
        let list = ListSpawn { list, frequency, statistics_every, scheduling: worker.scheduling.clone() };
        let thread = self.spawn_list(unit.clone(), part.clone(), list, &worker.recorder);
        let thread = thread.map_err(|error| error.to_string())?;
        unit.set_list(part);
        self.set_waker();
        if let Some(worker) = self.handles.iter_mut().find(|worker| worker.shared.name == agent) {
            worker.threads.push(thread);
        }
        Ok(())
    }
}

/// A list with the data for its thread.
struct ListSpawn {
    list: ActivityList,
    frequency: Frequency,
    statistics_every: Option<u64>,
    scheduling: Scheduling,
}

impl AgentHandle {
    fn end(&self) {
        self.shared.for_each_thread(|part| part.mailbox.stop());
    }

    /// The limits for a cycle of its list and for a call of its charts.
    fn limits(&self) -> (Duration, Duration) {
        let periods = self.frequency.map(|frequency| frequency.period().saturating_mul(STUCK_PERIODS));
        let usual = periods.unwrap_or_default().max(STUCK_LIST);
        (self.stuck_after.unwrap_or(usual), self.stuck_after.unwrap_or(STUCK_CALL))
    }

    /// Whether all its threads have ended, apart from stuck ones.
    fn is_finished(&self) -> bool {
        let is_given_up = self.shared.is_stuck() || self.shared.is_abandoned();
        is_given_up || self.threads.iter().all(JoinHandle::is_finished)
    }

    /// Joins its threads and returns their statistics. A stuck thread is detached.
    fn join(self) -> Option<AgentStatistics> {
        if self.shared.is_stuck() || self.shared.is_abandoned() {
            return Some(self.shared.statuses().0);
        }
        let mut all: Option<AgentStatistics> = None;
        for thread in self.threads {
            match (thread.join(), &mut all) {
                (Ok(part), Some(all)) => all.add(part),
                (Ok(part), None) => all = Some(part),
                (Err(_), _) => {
                    tracing::error!(agent = %self.shared.name, "a thread of the agent has panicked")
                }
            }
        }
        all
    }
}

impl AgentControl for AgentThreads {
    fn status(&self, agent: &str) -> AgentStatus {
        self.agent_handle(agent).map_or(AgentStatus::Stopped, |worker| worker.shared.status())
    }

    fn has_list(&self, agent: &str) -> bool {
        self.agent_handle(agent).is_some_and(|worker| worker.shared.has_list())
    }

    fn chart_status(&self, agent: &str, index: usize) -> AgentStatus {
        let shown = self.agent_handle(agent).map(|worker| worker.shared.statuses().1);
        shown.and_then(|charts| charts.get(index).map(|chart| chart.status)).unwrap_or(AgentStatus::Stopped)
    }

    fn inspect_chart(&self, agent: &str, index: usize, aspect: ChartAspect) -> Result<Vec<String>, String> {
        let worker = self.agent_handle(agent).ok_or_else(|| format!("`{agent}` is not there"))?;
        worker.shared.inspect_chart(index, aspect, REPLY_TIMEOUT)
    }

    fn cycles(&self, agent: &str) -> u64 {
        self.agent_handle(agent).map_or(0, |worker| worker.recorder.number())
    }

    fn apply(&mut self, agent: &str, mut orders: AgentUpdate) -> Result<Vec<String>, Vec<String>> {
        if let Some(list) = orders.list.take() {
            self.add_list(agent, *list, orders.change.as_ref()).map_err(|reason| vec![reason])?;
        }
        let Some(worker) = self.handles.iter_mut().find(|worker| worker.shared.name == agent) else {
            return Err(vec![format!("`{agent}` is not there")]);
        };
        let of_agent = orders.only.is_none();
        for directive in orders.commands.iter().filter(|_| of_agent) {
            match directive {
                AgentCommand::Start => worker.shared.start(),
                AgentCommand::Stop => drop(worker.shared.stop(STOPPED_BY_REQUEST)),
                AgentCommand::Pause => worker.shared.set_paused(true),
                AgentCommand::Resume => worker.shared.set_paused(false),
                AgentCommand::Frequency(frequency) => worker.frequency = Some(*frequency),
                AgentCommand::StatisticsEvery(cycles) => worker.statistics_every = *cycles,
                AgentCommand::Scheduling(priority, real_time) => {
                    (worker.scheduling.priority, worker.scheduling.real_time) = (*priority, *real_time);
                }
                AgentCommand::Step | AgentCommand::Policy(_) => {}
            }
        }
        let starts = of_agent && orders.commands.iter().any(|command| matches!(command, AgentCommand::Start));
        let mut said = worker.shared.apply(orders, REPLY_TIMEOUT)?;
        if starts && self.safe_state.load(Ordering::SeqCst) {
            said.push(SAFE_STATE.to_owned());
        }
        Ok(said)
    }

    fn launch(&mut self, member: PreparedAgent, asked: Option<&ChangeRef>) -> Result<(), String> {
        let name = member.name.clone();
        if let Some(asked) = asked {
            self.record_change_request(&member, asked).map_err(|error| error.to_string())?;
        }
        self.connect(vec![member]).and_then(|connected| self.start(connected)).map_err(|error| {
            // The existing threads end, so that no agent remains with only some of its threads.
            if let Some(index) = self.handles.iter().position(|worker| worker.shared.name == name) {
                self.handles.remove(index).end();
                self.set_waker();
            }
            error.to_string()
        })
    }

    fn remove(&mut self, agent: &str) -> Result<(), String> {
        let Some(index) = self.handles.iter().position(|worker| worker.shared.name == agent) else {
            return Ok(());
        };
        let worker = self.handles.remove(index);
        worker.shared.stop(STOPPED_BY_REQUEST);
        worker.end();
        let began = self.clock.now();
        while !worker.is_finished() && self.clock.now() < began + REPLY_TIMEOUT {
            poll_pause();
        }
        if !worker.is_finished() {
            // It stops permanently when its cycle ends; until then it remains listed.
            self.handles.insert(index, worker);
            return Err(format!("`{agent}` is in a cycle that does not end: it stops when that ends"));
        }
        self.set_waker();
        self.removed.extend(worker.join());
        Ok(())
    }

    fn entry(&self, profile: &AgentProfile) -> AgentEntry {
        let Some(worker) = self.agent_handle(&profile.name) else { return AgentEntry::default() };
        let (mut statistics, charts) = worker.shared.statuses();
        statistics.cycles = worker.recorder.number();
        let open_calls =
            worker.shared.observed().open_calls(self.clock.now()).iter().map(LastingCall::entry).collect();
        AgentEntry { open_calls, ..agent_entry::of(profile, worker.shared.status(), &statistics, charts) }
    }
}

/// Starts a thread.
///
/// # Errors
/// The system cannot create it.
pub(crate) fn spawn<T: Send + 'static>(
    name: &str,
    work: impl FnOnce() -> T + Send + 'static,
) -> Result<JoinHandle<T>, Error> {
    thread::Builder::new().name(name.into()).spawn(work).map_err(|error| {
        Error::new(ErrorKind::Thread, format!("no thread for `{name}`: {error}")).caused_by(error)
    })
}

#[cfg(test)]
mod tests {
    use std::sync::mpsc::channel;

    use narukom::example::Ball;
    use narukom::{Signal, topic};

    use super::*;
    use crate::run_config::{HostConfig, RunConfig};
    use crate::setup::{PreparedHost, PreparedRun};
    use monas_core::agent::Agent;
    use monas_core::registry::Registry;

    topic! {
        /// A request that is made once.
        REQUEST: Signal<Ball> = "test/real_time_host/request";
    }

    /// When the only request is published.
    #[derive(Clone, Copy, Debug)]
    enum Published {
        BeforeConnection,
        BeforeThreads,
    }

    /// Whether a chart that waits for a request gets one that precedes its thread.
    fn is_answered(published: Published) -> bool {
        let (sender, answers) = channel();
        let registry = Registry::linked().with("Wait", || |_: &mut narukom::Blackboard| {}).with("Answer", {
            move || {
                let sender = sender.clone();
                move |_: &mut narukom::Blackboard| _ = sender.send(())
            }
        });
        let text = "Liveness:\nm = Wait . Answer\nTransitions:\nWait -> Answer : request";
        let (chart, diagnostics) = aseme_models::statechart_of(&yase::Source::new("m.srm", text));
        assert_eq!(diagnostics, []);
        let agents = vec![Agent::statechart("m", chart)];
        let host = HostConfig { name: "local".into(), agents, ..HostConfig::default() };
        let config = RunConfig { registry: Some(registry), hosts: vec![host], ..RunConfig::default() };
        let PreparedRun { hosts: mut prepared_hosts, factory, .. } = PreparedRun::new(config, 0).unwrap();
        let PreparedHost { hub, agents, context, profiles, configuration, .. } = prepared_hosts.remove(0);
        let (supervisor, _events) = channel();
        let safe_state = Arc::new(AtomicBool::new(false));
        let site = HostSite { hub: hub.clone(), host: 0, clock: RunClock::start(), safe_state, supervisor };
        let mut host = RealTimeHost::new(site, factory, context, profiles, configuration).unwrap();
        let publish = || hub.publisher(REQUEST, "test").unwrap().publish(Ball::default(), Timestamp::ZERO);
        if matches!(published, Published::BeforeConnection) {
            publish();
        }
        let connected = host.connect(agents).unwrap();
        if matches!(published, Published::BeforeThreads) {
            publish();
        }
        host.start(connected).unwrap();
        let is_answered = answers.recv_timeout(Duration::from_secs(20)).is_ok();
        host.end();
        host.join();
        is_answered
    }

    #[test]
    fn a_chart_gets_what_is_published_before_its_thread_begins() {
        for published in [Published::BeforeConnection, Published::BeforeThreads] {
            assert!(is_answered(published), "{published:?}");
        }
    }
}
