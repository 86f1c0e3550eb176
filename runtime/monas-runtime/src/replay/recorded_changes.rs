//! Changes of an agent in real time, applied again where its thread applied them in the recording.

use std::collections::VecDeque;
use std::sync::Arc;

use narukom::Timestamp;

use super::super::admin::{AgentControl, HostAdmin};
use super::super::agent_factory::{AgentFactory, HostContext, PreparedAgent, part};
use super::super::agent_update::{AgentStatus, AgentUpdate, ChangeRef as ByWhom};
use super::replayed_agents::refuse_in_real_time;
use super::replayed_thread::ReplayedThread;
use monas_core::agent::AgentProfile;
use monas_core::chart_runner::ChartAspect;
use monas_core::error::{Error, ErrorKind};
use monas_core::records::{Action, AgentEntry, Asked, Change, Changed, Cycle};

/// The requested changes of an agent, and its present profile.
pub(crate) struct RecordedChanges {
    admin: HostAdmin,
    thread: ThreadPosition,
    /// Requests that have not been applied, in order.
    requests: VecDeque<RecordedRequest>,
    /// Whether the recording contains the positions at which changes were applied.
    was_applied: bool,
    /// The error for a change without a recorded position, and the number of turns that may begin
    /// before it is definite.
    pending_error: Option<(Error, u32)>,
}

/// Identifies the replayed thread of an agent.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(crate) struct ThreadPosition {
    /// The index of its chart; `None` for the list.
    pub(crate) chart: Option<usize>,
    /// Number of charts of the agent.
    pub(crate) charts: usize,
    /// Whether the agent has a list.
    pub(crate) has_list: bool,
    /// Whether it has one at any time of the recording.
    pub(crate) lists: bool,
}

impl ThreadPosition {
    /// The part of its agent under which it publishes.
    pub(crate) fn part(self) -> u16 {
        part(self.chart.unwrap_or(self.charts))
    }

    /// The list or chart of this thread out of an agent with the same number of charts; `None`
    /// otherwise.
    fn of(self, agent: PreparedAgent) -> Option<PreparedAgent> {
        let PreparedAgent { list, mut charts, .. } = agent;
        let is_same = charts.len() == self.charts;
        let (list, charts) = match self.chart.filter(|_| is_same) {
            Some(index) => (None, vec![charts.swap_remove(index)]),
            None => (list, Vec::new()),
        };
        is_same.then_some(PreparedAgent { list, charts, ..agent })
    }

    /// Whether the agent has other threads at any time, which share its count of cycles: a list
    /// counts from its start, before its record.
    pub(crate) fn counts_with_others(self) -> bool {
        self.charts + usize::from(self.lists) > 1
    }

    /// Whether the agent has other threads.
    fn has_siblings(self) -> bool {
        self.charts + usize::from(self.has_list) > 1
    }
}

/// A change and the message that requested it.
struct RecordedRequest {
    publisher: String,
    sequence: u32,
    change: Change,
}

impl RecordedChanges {
    pub(crate) fn new(
        ground: HostContext,
        factory: Arc<AgentFactory>,
        profile: AgentProfile,
        thread: ThreadPosition,
    ) -> Result<RecordedChanges, Error> {
        let admin = HostAdmin::new(ground, factory, vec![profile], None)?;
        Ok(RecordedChanges {
            admin,
            thread,
            requests: VecDeque::new(),
            was_applied: false,
            pending_error: None,
        })
    }

    /// Adds a requested change.
    pub(crate) fn add_request(&mut self, publisher: &str, sequence: u32, change: Change) {
        self.requests.push_back(RecordedRequest { publisher: publisher.to_owned(), sequence, change });
    }

    /// Drops the requests of an agent that was removed: they were refused.
    pub(crate) fn discard_requests(&mut self, agent: &str) {
        self.admin.remove_profile(agent);
        self.requests.retain(|request| request.change.action() == Action::AddAgents);
    }

    /// Whether all requests have been applied.
    pub(crate) fn is_idle(&self) -> bool {
        self.requests.is_empty()
    }

    /// The change of a reply, if the agent has not applied it.
    pub(crate) fn change_of(&self, changed: &Changed) -> Option<Change> {
        self.request_of(changed).map(|index| self.requests[index].change.clone())
    }

    /// Prepares the thread of a removed agent that a change adds again.
    ///
    /// # Errors
    /// The replayed agent cannot be added by this change, or the number of its charts differs.
    pub(crate) fn prepare_restart(
        &mut self,
        change: &Change,
        agent: &str,
        repeated: &mut ReplayedThread,
        now: Timestamp,
    ) -> Result<PreparedAgent, Error> {
        let mut replayer = ChangeReplayer::of(change, self.thread, repeated, now);
        let changed = self.admin.restart_removed(change, &[agent.to_owned()], &mut replayer, now);
        let begun = replayer
            .begun
            .ok_or_else(|| refused_change_error(&Changed { agent: agent.to_owned(), ..changed }, now))?;
        self.thread.has_list = begun.list.is_some();
        self.thread.of(begun).ok_or_else(|| came_back_otherwise(agent, now))
    }

    /// Processes the reply to a change.
    ///
    /// # Errors
    /// The change added a thread to the agent, and the recording lacks the inputs with which it
    /// began.
    pub(crate) fn answered(
        &mut self,
        changed: &Changed,
        repeated: &mut ReplayedThread,
        at: Timestamp,
    ) -> Result<(), Error> {
        let adds = matches!(changed.action(), Action::AddActivity | Action::LoadModule);
        let begins_list = changed.done && adds && !self.thread.has_list;
        if begins_list && self.thread.chart.is_none() {
            return Err(begun_late(&changed.agent, at));
        }
        let waits = matches!(repeated, ReplayedThread::Waiting(_));
        if begins_list || waits || self.thread.has_siblings() {
            self.note(changed, repeated, at);
            self.thread.has_list |= begins_list;
            let refused = self.request_of(changed).filter(|_| waits && !changed.done);
            refused.and_then(|index| self.requests.remove(index));
            return Ok(());
        }
        let is_list = matches!(repeated, ReplayedThread::List(_));
        // The reply waits up to a second for a busy thread: a chart may finish its present turn
        // first.
        let turns_left = if is_list { 0 } else { 1 };
        if !self.was_applied && self.pending_error.is_none() {
            self.pending_error =
                refuse_in_real_time(changed, is_list, at).err().map(|error| (error, turns_left));
        }
        Ok(())
    }

    /// Updates the profile after a change that concerned only other threads of the agent.
    fn note(&mut self, changed: &Changed, repeated: &mut ReplayedThread, at: Timestamp) {
        let index = self.request_of(changed).filter(|_| changed.done);
        // Removal and addition of agents are processed elsewhere.
        let comes_or_goes = matches!(changed.action(), Action::AddAgents | Action::RemoveAgent);
        let Some(index) = index.filter(|_| !comes_or_goes) else { return };
        let RecordedRequest { change, .. } = &self.requests[index];
        let mut replayer =
            ChangeReplayer { is_unaffected: true, ..ChangeReplayer::of(change, self.thread, repeated, at) };
        if self.admin.replay_change(change, &mut replayer, at).done {
            self.requests.remove(index);
        }
    }

    /// Index among the pending requests of the change that a reply answers.
    fn request_of(&self, changed: &Changed) -> Option<usize> {
        let is_it = |request: &RecordedRequest| {
            (request.change.number, request.change.action) == (changed.number, changed.action)
        };
        self.requests.iter().position(is_it)
    }

    /// Begins a turn.
    ///
    /// # Errors
    /// A change was applied before it, and the recording lacks its position.
    pub(crate) fn begin_turn(&mut self) -> Result<(), Error> {
        match self.pending_error.take() {
            Some((error, 0)) => Err(error),
            untold => {
                self.pending_error = untold.map(|(error, turns_left)| (error, turns_left - 1));
                Ok(())
            }
        }
    }

    /// The change that the agent applied at this position, or that added it.
    ///
    /// # Errors
    /// The recording lacks it.
    pub(crate) fn recorded_change(&mut self, record: &Cycle) -> Result<Change, Error> {
        (self.was_applied, self.pending_error) = (true, None);
        let asked = record.asked.clone().unwrap_or_default();
        self.take_request(&asked).ok_or_else(|| missing_request_error(&asked))
    }

    /// Applies a change to the replayed agent.
    ///
    /// # Errors
    /// The replayed agent cannot be changed like that.
    pub(crate) fn apply_change(
        &mut self,
        change: &Change,
        repeated: &mut ReplayedThread,
        now: Timestamp,
    ) -> Result<(), Error> {
        let mut replayer = ChangeReplayer::of(change, self.thread, repeated, now);
        let changed = self.admin.replay_change(change, &mut replayer, now);
        let was_applied = replayer.was_applied;
        self.thread.has_list |= matches!(repeated, ReplayedThread::List(_));
        if was_applied { Ok(()) } else { Err(refused_change_error(&changed, now)) }
    }

    /// Processes the reply to a module change. An agent with a record of the change has applied it
    /// by now; for any other the module changes the registered names.
    ///
    /// # Errors
    /// The module differs from the recorded one.
    pub(crate) fn update_modules(
        &mut self,
        changed: &Changed,
        repeated: &mut ReplayedThread,
        now: Timestamp,
    ) -> Result<(), Error> {
        let request = self.request_of(changed).and_then(|index| self.requests.remove(index));
        let Some(RecordedRequest { change, .. }) = request.filter(|_| changed.done) else { return Ok(()) };
        let mut replayer = ChangeReplayer::of(&change, self.thread, repeated, now);
        let again = self.admin.replay_change(&change, &mut replayer, now);
        if again.done { Ok(()) } else { Err(refused_change_error(&again, now)) }
    }

    /// The change that a message requested. Earlier requests were refused, since changes are
    /// applied in order.
    fn take_request(&mut self, asked: &Asked) -> Option<Change> {
        // A recording has the lower 32 bits of sequence numbers.
        let sequence = asked.sequence as u32;
        let is_it =
            |request: &RecordedRequest| request.publisher == asked.publisher && request.sequence == sequence;
        let index = self.requests.iter().position(is_it)?;
        self.requests.drain(..=index).next_back().map(|request| request.change)
    }
}

/// Applies a change to the replayed agent.
struct ChangeReplayer<'a> {
    action: Action,
    repeated: &'a mut ReplayedThread,
    now: Timestamp,
    /// Whether it concerns one chart only.
    is_of_chart: bool,
    thread: ThreadPosition,
    /// Whether the thread ignores the parts of the change for itself.
    is_unaffected: bool,
    was_applied: bool,
    /// The prepared agent, if it was removed and starts again.
    begun: Option<PreparedAgent>,
}

impl<'a> ChangeReplayer<'a> {
    fn of(
        change: &Change,
        thread: ThreadPosition,
        repeated: &'a mut ReplayedThread,
        now: Timestamp,
    ) -> ChangeReplayer<'a> {
        let (action, is_of_chart) = (change.action(), !change.chart.is_empty());
        ChangeReplayer {
            action,
            repeated,
            now,
            is_of_chart,
            thread,
            is_unaffected: false,
            was_applied: false,
            begun: None,
        }
    }
}

impl AgentControl for ChangeReplayer<'_> {
    /// The change was applied, so the agent had a status that permits it.
    fn status(&self, _: &str) -> AgentStatus {
        match self.action {
            Action::StartAgent if !self.is_of_chart => AgentStatus::Stopped,
            Action::ResumeAgent | Action::StepAgent => AgentStatus::Paused,
            _ => AgentStatus::Running,
        }
    }

    fn chart_status(&self, _: &str, _: usize) -> AgentStatus {
        if self.action == Action::StartAgent { AgentStatus::Stopped } else { AgentStatus::Running }
    }

    fn inspect_chart(&self, agent: &str, _: usize, _: ChartAspect) -> Result<Vec<String>, String> {
        Err(format!("`{agent}` is replayed"))
    }

    fn has_list(&self, _: &str) -> bool {
        self.thread.has_list
    }

    fn cycles(&self, _: &str) -> u64 {
        0
    }

    fn apply(&mut self, _: &str, mut orders: AgentUpdate) -> Result<Vec<String>, Vec<String>> {
        let ThreadPosition { chart: index, charts, has_list, .. } = self.thread;
        if let (ReplayedThread::Waiting(_), Some(list)) = (&self.repeated, orders.list.take()) {
            if self.is_unaffected {
                return Err(vec!["the thread follows later".into()]);
            }
            self.was_applied = true;
            return self.repeated.begin(*list).map(|()| Vec::new()).map_err(|error| vec![error.to_string()]);
        }
        let own = orders.shares(has_list, charts).into_iter().find(|share| share.chart == index);
        match own {
            Some(_) if self.is_unaffected => Err(vec!["the thread follows later".into()]),
            Some(share) => {
                self.was_applied = true;
                self.repeated.apply(share.update, self.now)
            }
            None => Ok(Vec::new()),
        }
    }

    fn launch(&mut self, member: PreparedAgent, _: Option<&ByWhom>) -> Result<(), String> {
        self.begun = Some(member);
        Ok(())
    }

    fn remove(&mut self, agent: &str) -> Result<(), String> {
        Err(format!("`{agent}` has no turn in which it leaves"))
    }

    fn entry(&self, _: &AgentProfile) -> AgentEntry {
        AgentEntry::default()
    }
}

fn missing_request_error(asked: &Asked) -> Error {
    let Asked { publisher, sequence } = asked;
    let message = format!("the recording lacks change {sequence} of `{publisher}`, which an agent applied");
    let hint = "agents repeat recorded changes: only a recording of all topics can be replayed";
    Error::new(ErrorKind::Invalid, message).with_hint(hint)
}

fn came_back_otherwise(agent: &str, at: Timestamp) -> Error {
    let message = format!(
        "agent `{agent}` returned {:.3} s after the start of the run with another number of charts: the inputs of new threads are not replayed",
        at.as_secs_f64()
    );
    Error::new(ErrorKind::Invalid, message).with_hint("replay other agents, or the time before")
}

fn begun_late(agent: &str, at: Timestamp) -> Error {
    let message = format!(
        "agent `{agent}` got its first activity {:.3} s after the start of the run: the recording, of an earlier version, lacks the start of the list",
        at.as_secs_f64()
    );
    Error::new(ErrorKind::Invalid, message).with_hint("replay other agents, or the time before")
}

fn refused_change_error(changed: &Changed, at: Timestamp) -> Error {
    let finding = changed.findings.first();
    let reason = finding.map_or("no agent can apply it", |finding| finding.message.as_str());
    let message = format!(
        "the change of agent `{}` {:.3} s after the start of the run cannot be repeated: {reason}",
        changed.agent,
        at.as_secs_f64()
    );
    let error = Error::new(ErrorKind::Invalid, message);
    match finding.filter(|finding| !finding.hint.is_empty()) {
        Some(finding) => error.with_hint(&finding.hint),
        None => error,
    }
}
