//! Changes of agents that were made while they were recorded.
//!
//! In simulated time a change is a message like any other: it is made again when it comes, and what it leads to is compared. In real time
//! each agent repeats its own recorded turns; a record tells between which of them it was told to follow a change, see
//! [`ordered`](super::ordered). Recordings of earlier versions lack it: that an agent was stopped, or its list paused, is in its turns all the
//! same, and any other change is refused.

use std::path::Path;

use yase::Source;

use super::super::ENDED;
use super::super::crew::Member;
use super::super::entry;
use super::super::instance::Instance;
use super::super::management::Staff;
use super::super::orders::{Asked, Orders, Standing};
use super::scene::Actor;
use crate::agent::Profile;
use crate::config;
use crate::error::{Error, ErrorKind};
use crate::records::{Action, AgentEntry, Change, Changed};
use crate::registry::Registry;
use narukom::Moment;

/// The agents of a host that are replayed, as those who are told of changes.
pub(super) struct Replayed<'a> {
    pub(super) host: &'a str,
    pub(super) actors: &'a mut [Actor],
    pub(super) now: Moment,
}

impl Replayed<'_> {
    fn instance(&self, agent: &str) -> Option<&Instance> {
        self.actors.iter().map(|actor| &actor.instance).find(|instance| instance.name() == agent)
    }

    fn instance_mut(&mut self, agent: &str) -> Option<&mut Instance> {
        self.actors.iter_mut().map(|actor| &mut actor.instance).find(|instance| instance.name() == agent)
    }
}

impl Staff for Replayed<'_> {
    fn standing(&self, agent: &str) -> Standing {
        self.instance(agent).map_or(Standing::Stopped, Instance::standing)
    }

    fn standing_of_chart(&self, agent: &str, place: usize) -> Standing {
        let shown = self.instance(agent).map(Instance::shown).unwrap_or_default();
        shown.get(place).map_or(Standing::Stopped, |chart| chart.standing)
    }

    fn told(&self, agent: &str, place: usize) -> Result<Vec<String>, String> {
        let told = self.instance(agent).and_then(|instance| instance.told(place));
        told.ok_or_else(|| format!("`{agent}` has no such statechart"))
    }

    fn has_list(&self, agent: &str) -> bool {
        self.instance(agent).is_some_and(Instance::has_list)
    }

    fn cycles(&self, agent: &str) -> u64 {
        self.instance(agent).map_or(0, Instance::cycles)
    }

    fn obey(&mut self, agent: &str, orders: Orders) -> Result<Vec<String>, Vec<String>> {
        let now = self.now;
        let instance = self.instance_mut(agent).ok_or_else(|| vec![format!("`{agent}` is not there")])?;
        // A body that is to rest from now on is not here.
        instance.obey(orders, now).map(|(_, said)| said)
    }

    /// One that had left comes back.
    fn launch(&mut self, member: Member, _: Option<&Asked>) -> Result<(), String> {
        let now = self.now;
        let Some(instance) = self.instance_mut(&member.name) else {
            return Err(format!("`{}` is not replayed: it was added while the others ran", member.name));
        };
        *instance = Instance::new(member, now);
        Ok(())
    }

    fn dismiss(&mut self, agent: &str) -> Result<(), String> {
        let now = self.now;
        if let Some(instance) = self.instance_mut(agent) {
            instance.stop(ENDED, now);
        }
        Ok(())
    }

    fn entry(&self, profile: &Profile) -> AgentEntry {
        let Some(instance) = self.instance(&profile.name) else { return AgentEntry::default() };
        entry::of(profile, instance.standing(), &instance.statistics(self.host), instance.shown())
    }
}

/// Whether a change is about a module: then it is about all agents of its host.
pub(super) fn is_of_module(action: Action) -> bool {
    matches!(action, Action::LoadModule | Action::UnloadModule | Action::ReloadModule)
}

/// A change as it concerns agents that are replayed: it is about one of them, or about a module, which gives others names to be called by.
pub(super) fn concerning(change: &Change, knows: impl Fn(&str) -> bool) -> Option<Change> {
    match (knows(&change.agent), is_of_module(change.action())) {
        (true, _) => Some(change.clone()),
        (false, true) => Some(Change { agent: String::new(), ..change.clone() }),
        (false, false) => None,
    }
}

/// The names of the agents that a change adds.
pub(super) fn added(change: &Change, registry: &Registry) -> Vec<String> {
    if change.action() != Action::AddAgents {
        return Vec::new();
    }
    let source = Source::new(&change.file, change.text.clone());
    let (setup, _) = config::read(&source, Path::new(&change.file), registry);
    setup.agents.into_iter().map(|agent| agent.name).collect()
}

pub(super) fn unread(error: prost::DecodeError) -> Error {
    Error::new(ErrorKind::Invalid, format!("a recorded change of agents cannot be read: {error}"))
}

/// What became of an agent in real time, by a recording without records of it.
///
/// # Errors
/// It was made of something else: nothing tells after which of its turns.
pub(super) fn refuse_in_real_time(changed: &Changed, is_list: bool, at: Moment) -> Result<(), Error> {
    let what = match changed.action() {
        // When it ran, and that it did not, is in the records of its cycles; how a change was refused too.
        _ if !changed.done => return Ok(()),
        Action::NoAction | Action::StopAgent | Action::RemoveAgent => return Ok(()),
        Action::PauseAgent | Action::ResumeAgent if is_list => return Ok(()),
        // What is due in a chart that pauses waits.
        Action::PauseAgent => "paused",
        Action::ResumeAgent => "resumed",
        // Those that are added are not replayed.
        Action::AddAgents => return Ok(()),
        Action::StepAgent => "stepped",
        Action::StartAgent => "started again",
        Action::AddActivity => "given another activity",
        Action::RemoveActivity => "deprived of an activity",
        Action::MoveActivity => "given another order of its activities",
        Action::ReplaceActivity => "given an activity in the place of another",
        Action::Set => "set otherwise",
        Action::SwapModel => "given another model",
        Action::RaiseEvent => "given an event",
        Action::LoadModule => "given activities of a module",
        Action::UnloadModule | Action::ReloadModule => "given other activities of a module",
    };
    let message = format!(
        "agent `{}` was {what} {:.3} s after the run began: the recording, of an earlier version, does not tell after which turn",
        changed.agent,
        at.as_secs_f64()
    );
    Err(Error::new(ErrorKind::Invalid, message).with_hint("replay other agents, or the time before"))
}
