//! A host in simulated time, with its agents and its body.

use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

use narukom::{Hub, Timestamp};

use crate::END_REASON;
use crate::admin::{AgentControl, HostAdmin};
use crate::agent_entry;
use crate::agent_factory::{AgentFactory, PreparedAgent};
use crate::agent_instance::{AgentInstance, PublishedTopics};
use crate::agent_update::{AgentCommand, AgentStatus, AgentUpdate, ChangeRef};
use crate::body::{BodyBridge, SAFE_STATE};
use crate::clock::{RunClock, SimulatedClock};
use crate::host_status::HostStatus;
use crate::links::RunningLink;
use crate::list::CycleOutcome;
use crate::setup::{PreparedHost, tick};
use monas_core::agent::AgentProfile;
use monas_core::chart_runner::ChartAspect;
use monas_core::error::{Error, ErrorKind};
use monas_core::records::{AgentEntry, CHANGE, Change, Changed, ChartChoice};
use monas_core::statistics::AgentStatistics;

/// A host.
pub(crate) struct SimulatedHost {
    moved: PublishedTopics,
    /// Whether changes have been requested.
    has_requests: Arc<AtomicBool>,
    admin: HostAdmin,
    team: BodyAndAgents,
}

/// The body of a host and its agents, in the order of their names.
struct BodyAndAgents {
    host: String,
    body: Option<(BodyBridge, u64)>,
    instances: Vec<AgentInstance>,
    /// Measures the agents, if they are measured.
    clock: Option<RunClock>,
    /// The statistics of removed agents.
    removed: Vec<AgentStatistics>,
}

impl SimulatedHost {
    pub(crate) fn new(
        prepared: PreparedHost,
        factory: &Arc<AgentFactory>,
        shown: &Arc<SimulatedClock>,
        running: &mut Vec<RunningLink>,
    ) -> Result<SimulatedHost, Error> {
        let PreparedHost { hub, body, agents: members, links, context: ground, profiles, configuration } =
            prepared;
        let moved = PublishedTopics::default();
        let (note, asked) = (moved.topic_callback(), Arc::new(AtomicBool::new(false)));
        let (change, ring) = (hub.topic(CHANGE.path()), asked.clone());
        let noted = Arc::new(move |topic, host| {
            note(topic, host);
            if Some(topic) == change {
                ring.store(true, Ordering::Relaxed);
            }
        });
        let admin = HostAdmin::new(ground, factory.clone(), profiles, configuration)?;
        // Links bring messages at once: what they bring before all of them stand is noted too.
        hub.set_waker(noted.clone());
        let mut linked = Vec::new();
        for link in links {
            if let Some(other) = &link.clock {
                let message =
                    format!("the time of `{}` is simulated, and cannot be that of `{other}`", hub.host());
                return Err(Error::new(ErrorKind::Link, message));
            }
            let shown = shown.clone();
            let link = RunningLink::start(&hub, link, move || shown.get())?;
            linked.push(link.waker());
            running.push(link);
        }
        if !linked.is_empty() {
            hub.set_waker(Arc::new(move |topic, host| {
                noted(topic, host);
                linked.iter().for_each(|wake| wake(topic, host));
            }));
        }
        let instances =
            members.into_iter().map(|member| AgentInstance::new(member, Timestamp::ZERO)).collect();
        let team = BodyAndAgents {
            host: hub.host().into(),
            body: body.map(|body| (body, 0)),
            instances,
            clock: None,
            removed: Vec::new(),
        };
        Ok(SimulatedHost { moved, has_requests: asked, admin, team })
    }

    pub(crate) fn name(&self) -> &str {
        &self.team.host
    }

    /// From now on measures the agents.
    pub(crate) fn measure(&mut self, clock: RunClock) {
        self.team.clock = Some(clock);
        self.team.instances.iter_mut().for_each(|instance| instance.measure(clock));
    }

    pub(crate) fn hub(&self) -> &Hub {
        self.admin.hub()
    }

    pub(crate) fn instances(&self) -> &[AgentInstance] {
        &self.team.instances
    }

    /// The statistics of its agents, removed ones first.
    pub(crate) fn statistics(&self) -> impl Iterator<Item = AgentStatistics> {
        let present = self.team.instances.iter().map(|agent| agent.statistics(&self.team.host));
        self.team.removed.iter().cloned().chain(present)
    }

    pub(crate) fn due(&self, now: Timestamp) -> Timestamp {
        let body = self.team.body.iter().map(|(body, ticks)| tick(body.period(), *ticks));
        let instances = self.team.instances.iter().map(|instance| instance.due(now));
        body.chain(instances).min().unwrap_or(Timestamp::MAX)
    }

    pub(crate) fn sense(&mut self, now: Timestamp) -> Result<(), Error> {
        if let Some((body, ticks)) = &mut self.team.body
            && tick(body.period(), *ticks) <= now
        {
            *ticks += 1;
            body.sense(now)?;
            self.deliver_publications(now);
        }
        Ok(())
    }

    /// Gives each agent its turn; returns false if none had anything to do.
    pub(crate) fn run_agents(&mut self, now: Timestamp) -> Result<bool, Error> {
        let mut any = false;
        for index in 0..self.team.instances.len() {
            if self.team.instances[index].due(now) > now {
                continue;
            }
            any = true;
            let outcome = self.team.instances[index].run(now);
            self.team.handle_outcome(outcome, now)?;
            self.deliver_publications(now);
        }
        Ok(any)
    }

    /// Notifies every agent of the topics with new messages.
    pub(crate) fn deliver_publications(&mut self, now: Timestamp) {
        self.moved.deliver(self.team.instances.iter_mut(), now);
    }

    /// Forwards the newest commands to the body, which must not publish here.
    pub(crate) fn act(&mut self, now: Timestamp) -> Result<(), Error> {
        self.team.body.as_mut().map_or(Ok(()), |(body, _)| body.act(now).map(drop))
    }

    pub(crate) fn raise(&mut self, agent: &str, event: &str) -> bool {
        let agent = self.team.instances.iter_mut().find(|known| known.name() == agent);
        agent.is_some_and(|agent| agent.raise(event))
    }

    pub(crate) fn stop(&mut self, now: Timestamp) {
        self.team.instances.iter_mut().for_each(|instance| instance.stop(END_REASON, now));
    }

    /// Applies an external change.
    pub(crate) fn change(&mut self, change: Change, now: Timestamp) -> Changed {
        self.deliver_publications(now);
        let changed =
            self.admin.submit_change(change, &mut SimulatedAgents { team: &mut self.team, now }, now);
        self.has_requests.store(false, Ordering::Relaxed);
        self.deliver_publications(now);
        changed
    }

    /// Applies the published changes.
    pub(crate) fn apply_requests(&mut self, now: Timestamp) {
        if self.has_requests.swap(false, Ordering::Relaxed) {
            self.deliver_publications(now);
            self.admin.apply_requests(&mut SimulatedAgents { team: &mut self.team, now }, now);
            // The replies that this publishes need no processing.
            self.deliver_publications(now);
        }
    }

    pub(crate) fn status(&mut self, chart: Option<&ChartChoice>) -> HostStatus {
        let working = SimulatedAgents { team: &mut self.team, now: Timestamp::ZERO };
        HostStatus {
            chart: chart.map(|chart| self.admin.chart(chart, &working)),
            host: working.team.host.clone(),
            agents: self.admin.entries(&working),
            configuration: self.admin.configuration(),
            modules: self.admin.modules(),
        }
    }
}

impl BodyAndAgents {
    fn instance(&self, agent: &str) -> Option<&AgentInstance> {
        self.instances.iter().find(|known| known.name() == agent)
    }

    /// Applies the outcome of an agent's turn to the body.
    fn handle_outcome(&mut self, outcome: CycleOutcome, now: Timestamp) -> Result<(), Error> {
        match &mut self.body {
            Some((body, _)) if outcome == CycleOutcome::SafeState => body.enter_safe_state(now),
            Some((body, _))
                if outcome == CycleOutcome::Stopped && self.instances.iter().all(AgentInstance::is_over) =>
            {
                body.enter_safe_state(now)
            }
            _ => Ok(()),
        }
    }
}

/// The agents of a host at one time.
struct SimulatedAgents<'a> {
    team: &'a mut BodyAndAgents,
    now: Timestamp,
}

impl AgentControl for SimulatedAgents<'_> {
    fn status(&self, agent: &str) -> AgentStatus {
        self.team.instance(agent).map_or(AgentStatus::Stopped, AgentInstance::status)
    }

    fn chart_status(&self, agent: &str, index: usize) -> AgentStatus {
        let shown = self.team.instance(agent).map(AgentInstance::chart_statuses).unwrap_or_default();
        shown.get(index).map_or(AgentStatus::Stopped, |chart| chart.status)
    }

    fn inspect_chart(&self, agent: &str, index: usize, aspect: ChartAspect) -> Result<Vec<String>, String> {
        let inspection = self.team.instance(agent).and_then(|instance| instance.inspect_chart(index, aspect));
        inspection.ok_or_else(|| format!("`{agent}` has no such statechart"))
    }

    fn has_list(&self, agent: &str) -> bool {
        self.team.instance(agent).is_some_and(AgentInstance::has_list)
    }

    fn cycles(&self, agent: &str) -> u64 {
        self.team.instance(agent).map_or(0, AgentInstance::cycles)
    }

    fn apply(&mut self, agent: &str, orders: AgentUpdate) -> Result<Vec<String>, Vec<String>> {
        let Some(instance) = self.team.instances.iter_mut().find(|known| known.name() == agent) else {
            return Err(vec![format!("`{agent}` is not there")]);
        };
        let starts = orders.only.is_none()
            && orders.commands.iter().any(|command| matches!(command, AgentCommand::Start));
        let (outcome, mut said) = instance.apply(orders, self.now)?;
        if starts && self.team.body.as_ref().is_some_and(|(body, _)| body.is_safe_state()) {
            said.push(SAFE_STATE.to_owned());
        }
        self.team.handle_outcome(outcome, self.now).map_err(|error| vec![error.to_string()])?;
        Ok(said)
    }

    fn launch(&mut self, member: PreparedAgent, _: Option<&ChangeRef>) -> Result<(), String> {
        let mut instance = AgentInstance::new(member, self.now);
        self.team.clock.into_iter().for_each(|clock| instance.measure(clock));
        let index = self.team.instances.partition_point(|known| known.name() < instance.name());
        self.team.instances.insert(index, instance);
        Ok(())
    }

    fn remove(&mut self, agent: &str) -> Result<(), String> {
        if let Some(index) = self.team.instances.iter().position(|known| known.name() == agent) {
            let mut instance = self.team.instances.remove(index);
            instance.stop(END_REASON, self.now);
            self.team.removed.push(instance.statistics(&self.team.host));
        }
        Ok(())
    }

    fn entry(&self, profile: &AgentProfile) -> AgentEntry {
        let Some(instance) = self.team.instance(&profile.name) else { return AgentEntry::default() };
        let statistics = instance.statistics(&self.team.host);
        agent_entry::of(profile, instance.status(), &statistics, instance.chart_statuses())
    }
}
