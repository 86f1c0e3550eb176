//! The agents of a host, and queries about them.

use std::sync::Arc;

use narukom::{Header, HostId, Hub, Publisher, Subscriber, Timestamp};
use yase::Source;

use super::agent_control::AgentControl;
use super::change_plan::{ChangePlan, PlanStep};
use super::findings::{ChangeRefusal, finding, note, refusal, refusal_with};
use super::module_update::{self, ModuleUpdate};
use super::save;
use super::settings;
use crate::agent_factory::{AgentFactory, HostContext};
use crate::agent_update::{AgentUpdate, ChangeRef};
use crate::host_status::OUTSIDE;
use monas_core::agent::AgentProfile;
use monas_core::chart_runner::ChartAspect;
use monas_core::error::Error;
use monas_core::records::{
    AgentEntry, CHANGE, CHANGED, Change, Changed, ChartChoice, ChartState, Configuration, Finding,
    ModuleEntry,
};
use monas_core::registry::Registry;

/// The publisher name of the host itself.
pub(crate) const HOST_ITSELF: &str = "monas";

/// The profiles of a host's agents, with everything needed to change them.
pub(crate) struct HostAdmin {
    pub(crate) context: HostContext,
    pub(crate) factory: Arc<AgentFactory>,
    /// Sorted by name.
    pub(crate) profiles: Vec<AgentProfile>,
    /// The source of activities: the registry of the run, and the modules loaded since.
    pub(crate) registry: Registry,
    /// The text of the configuration.
    configuration: Option<Arc<Source>>,
    requests: Subscriber,
    external_changes: Publisher<Change>,
    replies: Publisher<Changed>,
}

impl HostAdmin {
    pub(crate) fn new(
        ground: HostContext,
        factory: Arc<AgentFactory>,
        profiles: Vec<AgentProfile>,
        configuration: Option<Arc<Source>>,
    ) -> Result<HostAdmin, Error> {
        let hub = &ground.hub;
        Ok(HostAdmin {
            requests: hub.subscriber_of(HostId::LOCAL, CHANGE.path()).map_err(Error::hub)?,
            external_changes: hub.publisher(CHANGE, OUTSIDE).map_err(Error::hub)?,
            replies: hub.publisher(CHANGED, HOST_ITSELF).map_err(Error::hub)?,
            registry: factory.registry.clone(),
            context: ground,
            factory,
            profiles,
            configuration,
        })
    }

    pub(crate) fn hub(&self) -> &Hub {
        &self.context.hub
    }

    /// Publishes an external change and applies it, after those that others have published. A dry
    /// run changes nothing, so that it is neither published nor recorded.
    pub(crate) fn submit_change(
        &mut self,
        change: Change,
        control: &mut dyn AgentControl,
        now: Timestamp,
    ) -> Changed {
        if change.dry_run {
            self.apply_requests(control, now);
            return self.apply_change(&change, None, control, now);
        }
        self.external_changes.publish(change.clone(), now);
        let mut own = None;
        self.apply_all(control, now, &mut |asked, changed| {
            if *asked == change {
                own = Some(changed.clone());
            }
        });
        own.unwrap_or_else(|| lost_change_reply(&change))
    }

    /// Applies the published changes in order.
    pub(crate) fn apply_requests(&mut self, control: &mut dyn AgentControl, now: Timestamp) {
        self.apply_all(control, now, &mut |_, _| {});
    }

    fn apply_all(
        &mut self,
        control: &mut dyn AgentControl,
        now: Timestamp,
        on_change: &mut dyn FnMut(&Change, &Changed),
    ) {
        while let Some(sample) = self.requests.next_sample() {
            let Some(change) = sample.downcast::<Change>() else { continue };
            let changed = self.apply_change(change.message, Some(&sample.header), control, now);
            on_change(change.message, &changed);
            self.replies.publish(changed, now);
        }
    }

    /// The modules loaded on this host, with the agents that use their activities.
    pub(crate) fn modules(&self) -> Vec<ModuleEntry> {
        self.registry.modules().map(|module| module_update::entry(module, self)).collect()
    }

    /// In a replay: the next published change that has not been processed.
    pub(crate) fn next_request(&mut self) -> Option<Change> {
        while let Some(sample) = self.requests.next_sample() {
            if let Some(change) = sample.downcast::<Change>() {
                return Some(change.message.clone());
            }
        }
        None
    }

    /// In a replay: applies a change again. Its reply is in the recording.
    pub(crate) fn replay_change(
        &mut self,
        change: &Change,
        control: &mut dyn AgentControl,
        now: Timestamp,
    ) -> Changed {
        self.apply_change(change, None, control, now)
    }

    /// In a replay: restarts those agents of an adding change that had been removed. The others are
    /// not replayed.
    pub(crate) fn restart_removed(
        &mut self,
        change: &Change,
        gone: &[String],
        control: &mut dyn AgentControl,
        now: Timestamp,
    ) -> Changed {
        let plan = ChangePlan::of_return(change, gone, self, control, now);
        self.execute_plan(change, plan, None, control)
    }

    /// In a replay: removes the profile of an agent that has been removed.
    pub(crate) fn remove_profile(&mut self, agent: &str) {
        self.profiles.retain(|profile| profile.name != agent);
    }

    /// Whether the host has an agent of that name.
    pub(crate) fn has_agent(&self, agent: &str) -> bool {
        self.profiles.iter().any(|profile| profile.name == agent)
    }

    /// The source of activities.
    pub(crate) fn registry(&self) -> &Registry {
        &self.registry
    }

    fn apply_change(
        &mut self,
        change: &Change,
        header: Option<&Header>,
        control: &mut dyn AgentControl,
        now: Timestamp,
    ) -> Changed {
        let plan = match change.dry_run && header.is_some() {
            true => Err(refusal_with(
                "E0352",
                "a message cannot ask for a dry run",
                "ask on the control socket: `monas agent swap --dry-run`",
            )),
            false => ChangePlan::of(change, self, control, now),
        };
        self.execute_plan(change, plan, header, control)
    }

    /// Executes a plan and publishes the reply.
    fn execute_plan(
        &mut self,
        change: &Change,
        plan: Result<ChangePlan, ChangeRefusal>,
        header: Option<&Header>,
        control: &mut dyn AgentControl,
    ) -> Changed {
        let asked = header.and_then(|header| self.change_ref(header));
        let made = plan.and_then(|plan| self.carry_out(plan, change.dry_run, asked, control));
        let (done, findings) = match made {
            Ok(said) => (true, said),
            Err(reasons) => (false, reasons.iter().map(finding).collect()),
        };
        let (host, agent) = (self.context.hub.host(), &change.agent);
        match done {
            _ if change.dry_run => {
                tracing::info!(%host, %agent, action = ?change.action(), done, "a dry run")
            }
            true => tracing::info!(%host, %agent, action = ?change.action(), "changed"),
            false => tracing::warn!(%host, %agent, action = ?change.action(), "a change was refused"),
        }
        Changed {
            number: change.number,
            action: change.action,
            agent: change.agent.clone(),
            done,
            cycle: control.cycles(&change.agent),
            findings,
        }
    }

    /// The reference to the message that requested a change, taken when everything it needs is
    /// prepared.
    fn change_ref(&self, header: &Header) -> Option<ChangeRef> {
        let hub = &self.context.hub;
        let publisher = hub.publisher_name(header.publisher)?;
        Some(ChangeRef { publisher, sequence: header.sequence, ready_at: hub.position() })
    }

    fn carry_out(
        &mut self,
        plan: ChangePlan,
        is_dry_run: bool,
        asked: Option<ChangeRef>,
        control: &mut dyn AgentControl,
    ) -> Result<Vec<Finding>, ChangeRefusal> {
        let ChangePlan { warnings, step } = plan;
        let mut said: Vec<Finding> = warnings.iter().map(finding).collect();
        match step {
            PlanStep::Update(profile, update) => {
                let remarks = control
                    .apply(&profile.name, AgentUpdate { change: asked, ..*update })
                    .map_err(refusal_from_reasons)?;
                said.extend(remarks.into_iter().map(note));
                if !is_dry_run {
                    self.set_profile(*profile);
                }
            }
            PlanStep::Launch(agents) => {
                for (profile, member) in agents {
                    control.launch(member, asked.as_ref()).map_err(|reason| refusal("E0357", reason))?;
                    let index = self.profiles.partition_point(|known| known.name < profile.name);
                    self.profiles.insert(index, profile);
                }
            }
            PlanStep::UpdateModules(module_update) => {
                said.extend(self.update_modules(*module_update, asked.as_ref(), control)?);
            }
            PlanStep::Remove(name) => {
                control.remove(&name).map_err(|reason| refusal("E0357", reason))?;
                self.remove_profile(&name);
            }
        }
        Ok(said)
    }

    /// Applies module updates to agents. Everything has been prepared, so an update can only fail
    /// because an agent is busy: if it is the first agent, nothing has changed; otherwise that
    /// agent continues unchanged.
    fn update_modules(
        &mut self,
        module_update: ModuleUpdate,
        asked: Option<&ChangeRef>,
        control: &mut dyn AgentControl,
    ) -> Result<Vec<Finding>, ChangeRefusal> {
        let ModuleUpdate { registry, updates } = module_update;
        let mut said = Vec::new();
        let mut is_begun = false;
        for (profile, update) in updates {
            let name = profile.name.clone();
            match control.apply(&name, AgentUpdate { change: asked.cloned(), ..update }) {
                Ok(remarks) => {
                    is_begun = true;
                    said.extend(remarks.into_iter().map(note));
                    self.set_profile(profile);
                }
                Err(reasons) if !is_begun => return Err(refusal_from_reasons(reasons)),
                Err(reasons) => {
                    let reason = format!("`{name}` is unchanged: {}", reasons.join("; "));
                    said.extend(refusal("E0356", reason).iter().map(finding));
                }
            }
        }
        self.registry = registry;
        Ok(said)
    }

    /// Replaces the profile of an agent.
    fn set_profile(&mut self, profile: AgentProfile) {
        if let Some(known) = self.profiles.iter_mut().find(|known| known.name == profile.name) {
            *known = profile;
        }
    }

    /// The present entries of all agents.
    pub(crate) fn entries(&self, control: &dyn AgentControl) -> Vec<AgentEntry> {
        self.profiles.iter().map(|profile| control.entry(profile)).collect()
    }

    /// The state of a chart.
    ///
    /// # Errors
    /// There is no such agent or chart, or it does not reply.
    pub(crate) fn chart(
        &self,
        choice: &ChartChoice,
        control: &dyn AgentControl,
    ) -> Result<ChartState, String> {
        let ChartChoice { agent, chart, values } = choice;
        let profile = self.profiles.iter().find(|profile| profile.name == *agent);
        let profile = profile.ok_or_else(|| format!("no agent is named `{agent}`"))?;
        let said = |refusal: ChangeRefusal| {
            let reasons = refusal.into_iter().map(|reason| match reason.hint {
                Some(hint) => format!("{} ({hint})", reason.message),
                None => reason.message,
            });
            reasons.collect::<Vec<_>>().join("; ")
        };
        let index = settings::chart(profile, chart).map_err(said)?;
        let aspect = if *values { ChartAspect::Values } else { ChartAspect::State };
        let mut documents = control.inspect_chart(agent, index, aspect)?.into_iter();
        let mut document = || documents.next().unwrap_or_default();
        let mut state = ChartState {
            host: self.hub().host().into(),
            agent: agent.clone(),
            model: profile.charts[index].model.clone(),
            state: control.chart_status(agent, index).word().into(),
            ..ChartState::default()
        };
        match aspect {
            ChartAspect::Values => state.values = document(),
            ChartAspect::State => {
                (state.snapshot, state.drawing, state.picture) = (document(), document(), document());
            }
        }
        Ok(state)
    }

    /// The present configuration, as it is saved.
    pub(crate) fn configuration(&self) -> Configuration {
        let file = self.configuration.as_ref().map(|source| source.name.clone()).unwrap_or_default();
        Configuration { file, text: save::text(self.configuration.as_ref(), &self.profiles, &self.registry) }
    }
}

/// The refusal of an update.
fn refusal_from_reasons(reasons: Vec<String>) -> ChangeRefusal {
    reasons.into_iter().flat_map(|reason| refusal("E0356", reason)).collect()
}

/// The reply to a change that was lost: its topic has a bounded history, and others have published
/// more.
fn lost_change_reply(change: &Change) -> Changed {
    let reason = refusal_with("E0359", "too many simultaneous changes: this one was lost", "ask again");
    Changed {
        number: change.number,
        action: change.action,
        agent: change.agent.clone(),
        findings: reason.iter().map(finding).collect(),
        ..Changed::default()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_change_that_was_lost_is_refused_by_its_number() {
        let changed = lost_change_reply(&Change { number: 7, agent: "a".into(), ..Change::default() });
        assert_eq!((changed.number, changed.agent.as_str(), changed.done), (7, "a", false));
        assert_eq!(changed.findings.len(), 1);
        assert_eq!(changed.findings[0].code, "E0359");
    }
}
