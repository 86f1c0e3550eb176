//! Changes of agents in a replay.
//!
//! In simulated time a change is a message like any other: it is applied again at its time, and the
//! consequences are compared. In real time each agent repeats its own recorded turns; a record
//! states between which of them it applied a change, see
//! [`recorded_changes`](super::recorded_changes). Recordings of earlier versions lack this record:
//! stops of an agent and pauses of its list are part of its turns, and any other change is refused.

use std::path::Path;

use yase::Source;

use super::super::END_REASON;
use super::super::admin::AgentControl;
use super::super::agent_entry;
use super::super::agent_factory::PreparedAgent;
use super::super::agent_instance::AgentInstance;
use super::super::agent_update::{AgentStatus, AgentUpdate, ChangeRef};
use super::replay_host::ReplayedAgent;
use monas_core::agent::AgentProfile;
use monas_core::chart_runner::ChartAspect;
use monas_core::error::{Error, ErrorKind};
use monas_core::records::{Action, AgentEntry, Change, Changed};
use monas_core::registry::Registry;
use narukom::Timestamp;

/// Implements `AgentControl` for the replayed agents of a host.
pub(crate) struct ReplayedAgents<'a> {
    pub(crate) host: &'a str,
    pub(crate) agents: &'a mut [ReplayedAgent],
    pub(crate) now: Timestamp,
}

impl ReplayedAgents<'_> {
    fn instance(&self, agent: &str) -> Option<&AgentInstance> {
        self.agents.iter().map(|replayed| &replayed.instance).find(|instance| instance.name() == agent)
    }

    fn instance_mut(&mut self, agent: &str) -> Option<&mut AgentInstance> {
        self.agents
            .iter_mut()
            .map(|replayed| &mut replayed.instance)
            .find(|instance| instance.name() == agent)
    }
}

impl AgentControl for ReplayedAgents<'_> {
    fn status(&self, agent: &str) -> AgentStatus {
        self.instance(agent).map_or(AgentStatus::Stopped, AgentInstance::status)
    }

    fn chart_status(&self, agent: &str, index: usize) -> AgentStatus {
        let shown = self.instance(agent).map(AgentInstance::chart_statuses).unwrap_or_default();
        shown.get(index).map_or(AgentStatus::Stopped, |chart| chart.status)
    }

    fn inspect_chart(&self, agent: &str, index: usize, aspect: ChartAspect) -> Result<Vec<String>, String> {
        let on_difference = self.instance(agent).and_then(|instance| instance.inspect_chart(index, aspect));
        on_difference.ok_or_else(|| format!("`{agent}` has no such statechart"))
    }

    fn has_list(&self, agent: &str) -> bool {
        self.instance(agent).is_some_and(AgentInstance::has_list)
    }

    fn cycles(&self, agent: &str) -> u64 {
        self.instance(agent).map_or(0, AgentInstance::cycles)
    }

    fn apply(&mut self, agent: &str, orders: AgentUpdate) -> Result<Vec<String>, Vec<String>> {
        let now = self.now;
        let instance = self.instance_mut(agent).ok_or_else(|| vec![format!("`{agent}` is not there")])?;
        // A replayed host has no body that could enter its safe state.
        instance.apply(orders, now).map(|(_, said)| said)
    }

    /// Starts a removed agent again.
    fn launch(&mut self, member: PreparedAgent, _: Option<&ChangeRef>) -> Result<(), String> {
        let now = self.now;
        let Some(instance) = self.instance_mut(&member.name) else {
            return Err(format!("`{}` is not replayed: it was added while the others ran", member.name));
        };
        *instance = AgentInstance::new(member, now);
        Ok(())
    }

    fn remove(&mut self, agent: &str) -> Result<(), String> {
        let now = self.now;
        if let Some(instance) = self.instance_mut(agent) {
            instance.stop(END_REASON, now);
        }
        Ok(())
    }

    fn entry(&self, profile: &AgentProfile) -> AgentEntry {
        let Some(instance) = self.instance(&profile.name) else { return AgentEntry::default() };
        agent_entry::of(
            profile,
            instance.status(),
            &instance.statistics(self.host),
            instance.chart_statuses(),
        )
    }
}

/// Whether a change concerns a module and thus all agents of its host.
pub(crate) fn is_of_module(action: Action) -> bool {
    matches!(action, Action::LoadModule | Action::UnloadModule | Action::ReloadModule)
}

/// The part of a change that concerns replayed agents: changes of one of them, or of a module,
/// which changes the registered names.
pub(crate) fn concerning(change: &Change, knows: impl Fn(&str) -> bool) -> Option<Change> {
    match (knows(&change.agent), is_of_module(change.action())) {
        (true, _) => Some(change.clone()),
        (false, true) => Some(Change { agent: String::new(), ..change.clone() }),
        (false, false) => None,
    }
}

/// The names of the agents that a change adds.
pub(crate) fn added(change: &Change, registry: &Registry) -> Vec<String> {
    if change.action() != Action::AddAgents {
        return Vec::new();
    }
    let source = Source::new(&change.file, change.text.clone());
    let (setup, _) = monas_config::read(&source, Path::new(&change.file), registry);
    setup.agents.into_iter().map(|agent| agent.name).collect()
}

pub(crate) fn unread(error: prost::DecodeError) -> Error {
    Error::new(ErrorKind::Invalid, format!("a recorded change of agents cannot be read: {error}"))
}

/// Processes a change of an agent in real time whose recording lacks records of changes.
///
/// # Errors
/// The agent was changed: the recording does not state after which of its turns.
pub(crate) fn refuse_in_real_time(changed: &Changed, is_list: bool, at: Timestamp) -> Result<(), Error> {
    let what = match changed.action() {
        // Its turns, pauses and refused changes are covered by the records of its cycles.
        _ if !changed.done => return Ok(()),
        Action::NoAction | Action::StopAgent | Action::RemoveAgent => return Ok(()),
        Action::PauseAgent | Action::ResumeAgent if is_list => return Ok(()),
        // A paused chart postpones what is due.
        Action::PauseAgent => "paused",
        Action::ResumeAgent => "resumed",
        // Added agents are not replayed.
        Action::AddAgents => return Ok(()),
        Action::StepAgent => "stepped",
        Action::StartAgent => "started again",
        Action::AddActivity => "given another activity",
        Action::RemoveActivity => "changed by the removal of an activity",
        Action::MoveActivity => "changed by another order of activities",
        Action::ReplaceActivity => "changed by the replacement of an activity",
        Action::Set => "set otherwise",
        Action::SwapModel => "given another model",
        Action::RaiseEvent => "given an event",
        Action::LoadModule => "changed by activities of a module",
        Action::UnloadModule | Action::ReloadModule => "changed by other activities of a module",
    };
    let message = format!(
        "agent `{}` was {what} {:.3} s after the start of the run: the recording, of an earlier version, lacks the turn",
        changed.agent,
        at.as_secs_f64()
    );
    Err(Error::new(ErrorKind::Invalid, message).with_hint("replay other agents, or the time before"))
}
