//! Who runs on a host, and what is asked about them.

use std::sync::Arc;

use narukom::{Header, HostId, Moment, Narukom, Publisher, Subscriber};
use yase::Source;

use super::findings::{Refusal, finding, refusal, refusal_with, remark};
use super::modules::{self, Equipment};
use super::plan::{Plan, Step};
use super::save;
use super::settings;
use super::staff::Staff;
use crate::agent::Profile;
use crate::error::Error;
use crate::records::{
    AgentEntry, CHANGE, CHANGED, Change, Changed, ChartChoice, ChartState, Configuration, Finding,
    ModuleEntry,
};
use crate::registry::Registry;
use crate::talws::crew::{Crew, Ground};
use crate::talws::orders::{Asked, Orders};
use crate::talws::overview::OUTSIDE;

/// The host publishes under this name what is not an agent's.
pub(in crate::talws) const HOST_ITSELF: &str = "monas";

/// The agents of a host as data, with what it takes to change them.
pub(in crate::talws) struct Roster {
    pub(super) ground: Ground,
    pub(super) crew: Arc<Crew>,
    /// By name.
    pub(super) profiles: Vec<Profile>,
    /// What agents are made of here: what the run began with, and the modules that have been loaded since.
    pub(super) registry: Registry,
    /// The text they were read from.
    configuration: Option<Arc<Source>>,
    asked: Subscriber,
    from_outside: Publisher<Change>,
    answers: Publisher<Changed>,
}

impl Roster {
    pub(in crate::talws) fn new(
        ground: Ground,
        crew: Arc<Crew>,
        profiles: Vec<Profile>,
        configuration: Option<Arc<Source>>,
    ) -> Result<Roster, Error> {
        let hub = &ground.hub;
        Ok(Roster {
            asked: hub.subscriber_of(HostId::LOCAL, CHANGE.path()).map_err(Error::hub)?,
            from_outside: hub.publisher(CHANGE, OUTSIDE).map_err(Error::hub)?,
            answers: hub.publisher(CHANGED, HOST_ITSELF).map_err(Error::hub)?,
            registry: crew.registry.clone(),
            ground,
            crew,
            profiles,
            configuration,
        })
    }

    pub(in crate::talws) fn hub(&self) -> &Narukom {
        &self.ground.hub
    }

    /// Publishes a change from outside and makes it; also those that others have published.
    pub(in crate::talws) fn ask(&mut self, change: Change, staff: &mut dyn Staff, now: Moment) -> Changed {
        self.from_outside.publish(change.clone(), now);
        let mut own = None;
        self.make_all(staff, now, &mut |asked, changed| {
            if *asked == change {
                own = Some(changed.clone());
            }
        });
        own.unwrap_or_else(|| lost(&change))
    }

    /// Makes the changes that were published, one after the other.
    pub(in crate::talws) fn attend(&mut self, staff: &mut dyn Staff, now: Moment) {
        self.make_all(staff, now, &mut |_, _| {});
    }

    fn make_all(&mut self, staff: &mut dyn Staff, now: Moment, told: &mut dyn FnMut(&Change, &Changed)) {
        while let Some(sample) = self.asked.next_sample() {
            let Some(change) = sample.downcast::<Change>() else { continue };
            let changed = self.make(change.message, Some(&sample.header), staff, now);
            told(change.message, &changed);
            self.answers.publish(changed, now);
        }
    }

    /// The modules that are loaded here, with the agents that have activities of them.
    pub(in crate::talws) fn modules(&self) -> Vec<ModuleEntry> {
        self.registry.modules().map(|module| modules::entry(module, self)).collect()
    }

    /// In a replay: the changes that were published and not yet looked at.
    pub(in crate::talws) fn next_asked(&mut self) -> Option<Change> {
        while let Some(sample) = self.asked.next_sample() {
            if let Some(change) = sample.downcast::<Change>() {
                return Some(change.message.clone());
            }
        }
        None
    }

    /// In a replay: makes a change again. What was answered is on the recording.
    pub(in crate::talws) fn repeat(
        &mut self,
        change: &Change,
        staff: &mut dyn Staff,
        now: Moment,
    ) -> Changed {
        self.make(change, None, staff, now)
    }

    /// In a replay: of the agents that a change adds, has those begin again that had left. The others are not replayed.
    pub(in crate::talws) fn bring_back(
        &mut self,
        change: &Change,
        gone: &[String],
        staff: &mut dyn Staff,
        now: Moment,
    ) -> Changed {
        let plan = Plan::of_return(change, gone, self, staff, now);
        self.follow(change, plan, None, staff)
    }

    /// In a replay: an agent has left.
    pub(in crate::talws) fn forget(&mut self, agent: &str) {
        self.profiles.retain(|profile| profile.name != agent);
    }

    /// Whether an agent of that name is here.
    pub(in crate::talws) fn knows(&self, agent: &str) -> bool {
        self.profiles.iter().any(|profile| profile.name == agent)
    }

    /// What agents are made of.
    pub(in crate::talws) fn registry(&self) -> &Registry {
        &self.registry
    }

    fn make(
        &mut self,
        change: &Change,
        header: Option<&Header>,
        staff: &mut dyn Staff,
        now: Moment,
    ) -> Changed {
        let plan = Plan::of(change, self, staff, now);
        self.follow(change, plan, header, staff)
    }

    /// Carries out what a change comes to, and answers it.
    fn follow(
        &mut self,
        change: &Change,
        plan: Result<Plan, Refusal>,
        header: Option<&Header>,
        staff: &mut dyn Staff,
    ) -> Changed {
        let asked = header.and_then(|header| self.asked(header));
        let made = plan.and_then(|plan| self.carry_out(plan, asked, staff));
        let (done, findings) = match made {
            Ok(said) => (true, said),
            Err(reasons) => (false, reasons.iter().map(finding).collect()),
        };
        let (host, agent) = (self.ground.hub.host(), &change.agent);
        match done {
            true => tracing::info!(%host, %agent, action = ?change.action(), "changed"),
            false => tracing::warn!(%host, %agent, action = ?change.action(), "a change was refused"),
        }
        Changed {
            number: change.number,
            action: change.action,
            agent: change.agent.clone(),
            done,
            cycle: staff.cycles(&change.agent),
            findings,
        }
    }

    /// The message by which somebody asked, when everything that it needs is ready.
    fn asked(&self, header: &Header) -> Option<Asked> {
        let hub = &self.ground.hub;
        let publisher = hub.publisher_name(header.publisher)?;
        Some(Asked { publisher, sequence: header.sequence, ready_at: hub.position() })
    }

    fn carry_out(
        &mut self,
        plan: Plan,
        asked: Option<Asked>,
        staff: &mut dyn Staff,
    ) -> Result<Vec<Finding>, Refusal> {
        let Plan { warnings, step } = plan;
        let mut said: Vec<Finding> = warnings.iter().map(finding).collect();
        match step {
            Step::Tell(profile, orders) => {
                let remarks = staff.obey(&profile.name, Orders { asked, ..*orders }).map_err(objected)?;
                said.extend(remarks.into_iter().map(remark));
                self.note(*profile);
            }
            Step::Launch(agents) => {
                for (profile, member) in agents {
                    staff.launch(member, asked.as_ref()).map_err(|reason| refusal("E0357", reason))?;
                    let place = self.profiles.partition_point(|known| known.name < profile.name);
                    self.profiles.insert(place, profile);
                }
            }
            Step::Equip(equipment) => {
                said.extend(self.equip(*equipment, asked.as_ref(), staff)?);
            }
            Step::Dismiss(name) => {
                staff.dismiss(&name).map_err(|reason| refusal("E0357", reason))?;
                self.forget(&name);
            }
        }
        Ok(said)
    }

    /// Agents get what modules bring, or lose it. Everything has been made ready, so an agent can only be too busy to take it: if that is the
    /// first, nothing has changed; if it is another, it goes on as it was.
    fn equip(
        &mut self,
        equipment: Equipment,
        asked: Option<&Asked>,
        staff: &mut dyn Staff,
    ) -> Result<Vec<Finding>, Refusal> {
        let Equipment { registry, told } = equipment;
        let mut said = Vec::new();
        let mut is_begun = false;
        for (profile, orders) in told {
            let name = profile.name.clone();
            match staff.obey(&name, Orders { asked: asked.cloned(), ..orders }) {
                Ok(remarks) => {
                    is_begun = true;
                    said.extend(remarks.into_iter().map(remark));
                    self.note(profile);
                }
                Err(reasons) if !is_begun => return Err(objected(reasons)),
                Err(reasons) => {
                    let reason = format!("`{name}` goes on as it was: {}", reasons.join("; "));
                    said.extend(refusal("E0356", reason).iter().map(finding));
                }
            }
        }
        self.registry = registry;
        Ok(said)
    }

    /// An agent is made of this now.
    fn note(&mut self, profile: Profile) {
        if let Some(known) = self.profiles.iter_mut().find(|known| known.name == profile.name) {
            *known = profile;
        }
    }

    /// All agents as they are now.
    pub(in crate::talws) fn entries(&self, staff: &dyn Staff) -> Vec<AgentEntry> {
        self.profiles.iter().map(|profile| staff.entry(profile)).collect()
    }

    /// What one of their charts is doing.
    ///
    /// # Errors
    /// There is no such agent or chart, or it does not answer.
    pub(in crate::talws) fn chart(
        &self,
        choice: &ChartChoice,
        staff: &dyn Staff,
    ) -> Result<ChartState, String> {
        let ChartChoice { agent, chart } = choice;
        let profile = self.profiles.iter().find(|profile| profile.name == *agent);
        let profile = profile.ok_or_else(|| format!("no agent is named `{agent}`"))?;
        let said = |refusal: Refusal| {
            let reasons = refusal.into_iter().map(|reason| match reason.hint {
                Some(hint) => format!("{} ({hint})", reason.message),
                None => reason.message,
            });
            reasons.collect::<Vec<_>>().join("; ")
        };
        let place = settings::chart(profile, chart).map_err(said)?;
        let mut told = staff.told(agent, place)?.into_iter();
        Ok(ChartState {
            host: self.hub().host().into(),
            agent: agent.clone(),
            model: profile.charts[place].model.clone(),
            state: staff.standing_of_chart(agent, place).word().into(),
            snapshot: told.next().unwrap_or_default(),
            drawing: told.next().unwrap_or_default(),
        })
    }

    /// The present set-up, as it is saved.
    pub(in crate::talws) fn configuration(&self) -> Configuration {
        let file = self.configuration.as_ref().map(|source| source.name.clone()).unwrap_or_default();
        Configuration { file, text: save::text(self.configuration.as_ref(), &self.profiles, &self.registry) }
    }
}

/// What stands against orders.
fn objected(reasons: Vec<String>) -> Refusal {
    reasons.into_iter().flat_map(|reason| refusal("E0356", reason)).collect()
}

/// The answer to a change that never came here: its topic keeps so many, and others have published more.
fn lost(change: &Change) -> Changed {
    let reason =
        refusal_with("E0359", "so many changes were asked for at once that this one was lost", "ask again");
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
        let changed = lost(&Change { number: 7, agent: "a".into(), ..Change::default() });
        assert_eq!((changed.number, changed.agent.as_str(), changed.done), (7, "a", false));
        assert_eq!(changed.findings.len(), 1);
        assert_eq!(changed.findings[0].code, "E0359");
    }
}
