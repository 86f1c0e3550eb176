//! A host in a replay: replayed agents, and the recorded messages of the others.

use std::collections::BTreeSet;
use std::sync::{Arc, Mutex, PoisonError};

use narukom::{Hub, Observer, Publication, Timestamp, TopicSlot};

use super::super::END_REASON;
use super::super::admin::HostAdmin;
use super::super::agent_factory::AgentFactory;
use super::super::agent_instance::{AgentInstance, PublishedTopics};
use super::super::setup::PreparedHost;
use super::comparison::{ComparisonReport, MomentComparison};
use super::replayed_agents::{ReplayedAgents, added, concerning};
use super::{RecordedPublisher, ReplayDifference};
use monas_core::activity_context::SimulatedTimeGuard;
use monas_core::error::{Error, ErrorKind};
use monas_core::records::{Action, Change, Changed};

/// A message that was published in the replay.
pub(crate) struct AgentOutput {
    pub(crate) host: String,
    pub(crate) publisher: String,
    pub(crate) topic: TopicSlot,
    pub(crate) bytes: Vec<u8>,
}

/// Observes what agents publish.
#[derive(Clone, Default)]
pub(crate) struct OutputCapture(Arc<Mutex<CaptureState>>);

#[derive(Default)]
struct CaptureState {
    /// Whether present publications come from the recording and are ignored.
    ignores_publications: bool,
    produced: Vec<AgentOutput>,
}

impl OutputCapture {
    pub(crate) fn mute(&self, is_mute: bool) {
        self.0.lock().unwrap_or_else(PoisonError::into_inner).ignores_publications = is_mute;
    }

    pub(crate) fn take(&self) -> Vec<AgentOutput> {
        std::mem::take(&mut self.0.lock().unwrap_or_else(PoisonError::into_inner).produced)
    }

    /// The messages published during `act`.
    fn capture(&self, act: impl FnOnce()) -> Vec<AgentOutput> {
        self.mute(false);
        act();
        self.mute(true);
        self.take()
    }
}

impl Observer for OutputCapture {
    fn observe(&mut self, publication: Publication<'_>) {
        let mut seen = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        if !seen.ignores_publications {
            seen.produced.push(AgentOutput {
                host: publication.host.to_owned(),
                publisher: publication.publisher.to_owned(),
                topic: publication.sample.header.topic,
                bytes: publication.bytes().to_vec(),
            });
        }
    }
}

/// A host in a replay.
pub(crate) struct ReplayHost {
    pub(crate) hub: Hub,
    moved: PublishedTopics,
    admin: HostAdmin,
    /// Names of agents that were removed.
    removed: Vec<String>,
    /// The number of the change that most recently added a removed agent again.
    returned_by: Option<u64>,
    /// Why the replay cannot continue.
    refused: Option<Error>,
    agents: Vec<ReplayedAgent>,
    /// The names of all agents, replayed or not, in the order of their turns.
    turn_order: Vec<String>,
    /// Index in `turn_order` of the agent whose turn it is.
    turn: Option<usize>,
    pub(crate) now: Timestamp,
    /// Whether no agent has run yet: records of the agents before that belong to no turn.
    is_setting_up: bool,
    /// Whether the recorded run has ended.
    has_ended: bool,
}

/// A replayed agent.
pub(crate) struct ReplayedAgent {
    turn: usize,
    pub(crate) instance: AgentInstance,
    /// Its recorded and replayed publications at the present timestamp.
    comparison: MomentComparison,
}

impl ReplayHost {
    pub(crate) fn new(
        host: PreparedHost,
        factory: &Arc<AgentFactory>,
        publishers: &[RecordedPublisher],
    ) -> Result<ReplayHost, Error> {
        let PreparedHost { hub, agents: members, context: ground, profiles, configuration, .. } = host;
        let moved = PublishedTopics::default();
        hub.set_waker(Arc::new(moved.topic_callback()));
        let others = publishers.iter().filter(|one| one.is_agent && one.host == hub.host());
        let names: BTreeSet<String> = others
            .map(|one| one.publisher.clone())
            .chain(members.iter().map(|member| member.name.clone()))
            .collect();
        let turn_order: Vec<String> = names.into_iter().collect();
        let replayed = |member: super::super::agent_factory::PreparedAgent| {
            let index = turn_order.binary_search(&member.name).unwrap_or_default();
            let window = MomentComparison::new(hub.host(), &member.name);
            ReplayedAgent {
                turn: index,
                instance: AgentInstance::new(member, Timestamp::ZERO),
                comparison: window,
            }
        };
        let agents = members.into_iter().map(replayed).collect();
        Ok(ReplayHost {
            admin: HostAdmin::new(ground, factory.clone(), profiles, configuration)?,
            hub,
            moved,
            removed: Vec::new(),
            returned_by: None,
            refused: None,
            agents,
            turn_order,
            turn: None,
            now: Timestamp::ZERO,
            is_setting_up: true,
            has_ended: false,
        })
    }

    /// Index of a replayed agent.
    pub(crate) fn agent_index(&self, name: &str) -> Option<usize> {
        self.agents.iter().position(|agent| agent.instance.name() == name)
    }

    /// Index of an agent in the order of turns, replayed or not.
    pub(crate) fn turn_index(&self, name: &str) -> Option<usize> {
        self.turn_order.binary_search_by(|other| other.as_str().cmp(name)).ok()
    }

    /// Processes a publication of an agent before any agent has run.
    pub(crate) fn was_set_up(&mut self, produced: &AgentOutput) {
        if let Some(agent) = self.agent_index(&produced.publisher) {
            self.agents[agent].comparison.produced(produced.topic, produced.bytes.clone());
        }
    }

    /// Executes everything that is due before a time, and begins that time.
    pub(crate) fn advance_to(
        &mut self,
        moment: Timestamp,
        output: &OutputCapture,
        report: &mut ComparisonReport,
        on_difference: &mut dyn FnMut(ReplayDifference),
    ) {
        while self.now < moment {
            SimulatedTimeGuard::pass(self.now);
            self.run_and_compare(output, report, on_difference);
            // Requests that exist only in the replay may give agents something to do at this time.
            self.apply_requests(output);
            self.now = if self.has_ended { moment } else { self.due().clamp(self.now, moment) };
            self.turn = None;
        }
        SimulatedTimeGuard::pass(self.now);
    }

    /// Applies the requested changes since the last call that concern replayed agents.
    pub(crate) fn apply_requests(&mut self, output: &OutputCapture) {
        while let Some(change) = self.admin.next_request().filter(|_| !self.has_ended) {
            if !self.removed.is_empty() {
                self.restart_removed(&change, output);
            }
            if let Some(change) = concerning(&change, |agent| self.admin.has_agent(agent)) {
                self.replay_change(&change, output);
            }
        }
    }

    fn replay_change(&mut self, change: &Change, output: &OutputCapture) {
        let is_done = self.make(output, |admin, agents, now| admin.replay_change(change, agents, now));
        if is_done && change.action() == Action::RemoveAgent {
            self.removed.push(change.agent.clone());
        }
    }

    /// Restarts removed agents that the change adds.
    fn restart_removed(&mut self, change: &Change, output: &OutputCapture) {
        let names = added(change, self.admin.registry());
        let back: Vec<String> = self.removed.iter().filter(|gone| names.contains(gone)).cloned().collect();
        if back.is_empty() {
            return;
        }
        if self.make(output, |admin, agents, now| admin.restart_removed(change, &back, agents, now)) {
            self.removed.retain(|gone| !back.contains(gone));
            self.returned_by = Some(change.number);
        }
    }

    /// Applies a change; returns false if it cannot be applied.
    fn make(
        &mut self,
        output: &OutputCapture,
        make: impl FnOnce(&mut HostAdmin, &mut ReplayedAgents<'_>, Timestamp) -> Changed,
    ) -> bool {
        self.is_setting_up = false;
        // As in the recorded run: a step of a paused agent sees what has arrived by then.
        self.deliver_publications();
        let now = self.now;
        let mut agents = ReplayedAgents { host: self.hub.host(), agents: &mut self.agents, now };
        let mut is_done = false;
        let produced = output.capture(|| is_done = make(&mut self.admin, &mut agents, now).done);
        for one in produced {
            if let Some(agent) = self.agent_index(&one.publisher) {
                self.agents[agent].comparison.produced(one.topic, one.bytes);
            }
        }
        self.deliver_publications();
        is_done
    }

    /// Processes the reply to the addition of agents: it may have been refused because of an agent
    /// that is not replayed.
    pub(crate) fn answered(&mut self, changed: &Changed) {
        let is_it = changed.action() == Action::AddAgents && self.returned_by == Some(changed.number);
        if is_it && !changed.done {
            let message = "removed agents were rejected when they were added again, because of agents that are not replayed";
            let error = Error::new(ErrorKind::Invalid, message).with_hint("replay all agents of the host");
            self.refused.get_or_insert(error);
        }
        if is_it {
            self.returned_by = None;
        }
    }

    /// # Errors
    /// Something was recorded that cannot be replayed.
    pub(crate) fn check(&mut self) -> Result<(), Error> {
        self.refused.take().map_or(Ok(()), Err)
    }

    fn due(&self) -> Timestamp {
        self.agents.iter().map(|agent| agent.instance.due(self.now)).min().unwrap_or(Timestamp::MAX)
    }

    /// Executes what is still due at this time, and compares.
    fn run_and_compare(
        &mut self,
        output: &OutputCapture,
        report: &mut ComparisonReport,
        on_difference: &mut dyn FnMut(ReplayDifference),
    ) {
        if !self.has_ended {
            self.run_due(self.turn, None, output);
            while self.due() <= self.now {
                self.run_due(None, None, output);
            }
        }
        for agent in &mut self.agents {
            agent.comparison.compare(&self.hub, self.now, report, on_difference);
        }
    }

    /// Begins the turn of an agent that is not replayed, or of no agent.
    pub(crate) fn turn_of_another(&mut self, index: Option<usize>, sets_up: bool, output: &OutputCapture) {
        self.is_setting_up &= sets_up;
        if let Some(index) = index.filter(|_| !self.is_setting_up) {
            self.run_before(index, output);
        }
    }

    /// Processes a recorded publication of an agent. Gives the agent its turn if it has not
    /// published this yet.
    pub(crate) fn expect(
        &mut self,
        agent: usize,
        topic: Option<TopicSlot>,
        line: usize,
        bytes: &[u8],
        output: &OutputCapture,
    ) {
        let window = &mut self.agents[agent].comparison;
        window.recorded(topic, line, bytes.to_vec());
        if !window.is_behind() || self.has_ended {
            return;
        }
        self.is_setting_up = false;
        let index = self.agents[agent].turn;
        if self.turn == Some(index) {
            // It has had its turn, and gets another one after all others.
            self.run_due(Some(index), None, output);
            self.turn = None;
        }
        self.run_before(index, output);
        self.deliver_publications();
        if self.agents[agent].instance.due(self.now) <= self.now {
            self.run(agent, output);
        }
    }

    /// Executes the turns of the agents before a place.
    fn run_before(&mut self, index: usize, output: &OutputCapture) {
        if self.turn == Some(index) {
            return;
        }
        if self.turn.is_some_and(|turn| turn > index) {
            self.run_due(self.turn, None, output);
            self.turn = None;
        }
        self.run_due(self.turn, Some(index), output);
        self.turn = Some(index);
    }

    /// Executes the turns of the agents between two positions that have something to do.
    fn run_due(&mut self, after: Option<usize>, before: Option<usize>, output: &OutputCapture) {
        self.deliver_publications();
        for agent in 0..self.agents.len() {
            let ReplayedAgent { turn: index, instance, .. } = &self.agents[agent];
            let is_between =
                after.is_none_or(|after| *index > after) && before.is_none_or(|before| *index < before);
            if is_between && instance.due(self.now) <= self.now {
                self.run(agent, output);
            }
        }
    }

    fn run(&mut self, agent: usize, output: &OutputCapture) {
        let ReplayedAgent { instance, comparison: window, .. } = &mut self.agents[agent];
        let now = self.now;
        // A replayed host has no body that could enter its safe state.
        let produced = output.capture(|| _ = instance.run(now));
        produced.into_iter().for_each(|one| window.produced(one.topic, one.bytes));
        self.deliver_publications();
    }

    fn deliver_publications(&mut self) {
        self.moved.deliver(self.agents.iter_mut().map(|agent| &mut agent.instance), self.now);
    }

    /// Stops the agents, as the recorded run was stopped now.
    pub(crate) fn stop(&mut self, output: &OutputCapture) {
        self.has_ended = true;
        let now = self.now;
        for ReplayedAgent { instance, comparison: window, .. } in &mut self.agents {
            let produced = output.capture(|| instance.stop(END_REASON, now));
            produced.into_iter().for_each(|one| window.produced(one.topic, one.bytes));
        }
    }

    /// Processes the end of the recording.
    pub(crate) fn close(
        &mut self,
        is_whole: bool,
        output: &OutputCapture,
        report: &mut ComparisonReport,
        on_difference: &mut dyn FnMut(ReplayDifference),
    ) {
        if is_whole {
            return self.run_and_compare(output, report, on_difference);
        }
        for agent in &mut self.agents {
            agent.comparison.discard_pending();
            agent.comparison.compare(&self.hub, self.now, report, on_difference);
        }
    }
}
