//! A host in simulated time, with all that runs on it.

use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

use narukom::{Moment, Narukom};

use crate::agent::Profile;
use crate::error::{Error, ErrorKind};
use crate::list::Outcome;
use crate::records::{AgentEntry, CHANGE, Change, Changed, ChartChoice};
use crate::statistics::AgentStatistics;
use crate::talws::ENDED;
use crate::talws::body::Body;
use crate::talws::crew::{Crew, Member};
use crate::talws::entry;
use crate::talws::instance::Instance;
use crate::talws::links::RunningLink;
use crate::talws::management::{Roster, Staff};
use crate::talws::moved::Moved;
use crate::talws::orders::{Asked, Orders, Standing};
use crate::talws::overview::{ShownMoment, View};
use crate::talws::setup::{Station, tick};

/// A host.
pub(super) struct Host {
    moved: Moved,
    /// Whether somebody has asked for a change.
    asked: Arc<AtomicBool>,
    roster: Roster,
    team: Team,
}

/// The body of a host and its agents, in the order of their names.
struct Team {
    host: String,
    body: Option<(Body, u64)>,
    instances: Vec<Instance>,
    /// What agents have done that were removed.
    gone: Vec<AgentStatistics>,
}

impl Host {
    pub(super) fn new(
        station: Station,
        crew: &Arc<Crew>,
        shown: &Arc<ShownMoment>,
        running: &mut Vec<RunningLink>,
    ) -> Result<Host, Error> {
        let Station { hub, body, members, links, ground, profiles, configuration } = station;
        let moved = Moved::default();
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
        let (note, asked) = (moved.noting(), Arc::new(AtomicBool::new(false)));
        let (change, ring) = (hub.topic(CHANGE.path()), asked.clone());
        hub.set_waker(Arc::new(move |topic, host| {
            note(topic, host);
            if Some(topic) == change {
                ring.store(true, Ordering::Relaxed);
            }
            linked.iter().for_each(|wake| wake(topic, host));
        }));
        let instances = members.into_iter().map(|member| Instance::new(member, Moment::ZERO)).collect();
        let team =
            Team { host: hub.host().into(), body: body.map(|body| (body, 0)), instances, gone: Vec::new() };
        let roster = Roster::new(ground, crew.clone(), profiles, configuration)?;
        Ok(Host { moved, asked, roster, team })
    }

    pub(super) fn name(&self) -> &str {
        &self.team.host
    }

    pub(super) fn hub(&self) -> &Narukom {
        self.roster.hub()
    }

    pub(super) fn instances(&self) -> &[Instance] {
        &self.team.instances
    }

    /// What its agents have done, those that were removed first.
    pub(super) fn statistics(&self) -> impl Iterator<Item = AgentStatistics> {
        let present = self.team.instances.iter().map(|agent| agent.statistics(&self.team.host));
        self.team.gone.iter().cloned().chain(present)
    }

    pub(super) fn due(&self, now: Moment) -> Moment {
        let body = self.team.body.iter().map(|(body, ticks)| tick(body.period(), *ticks));
        let instances = self.team.instances.iter().map(|instance| instance.due(now));
        body.chain(instances).min().unwrap_or(Moment::MAX)
    }

    pub(super) fn sense(&mut self, now: Moment) -> Result<(), Error> {
        if let Some((body, ticks)) = &mut self.team.body
            && tick(body.period(), *ticks) <= now
        {
            *ticks += 1;
            body.sense(now)?;
            self.wake(now);
        }
        Ok(())
    }

    /// Gives each agent its turn; false if none had anything to do.
    pub(super) fn run_agents(&mut self, now: Moment) -> Result<bool, Error> {
        let mut any = false;
        for index in 0..self.team.instances.len() {
            if self.team.instances[index].due(now) > now {
                continue;
            }
            any = true;
            let outcome = self.team.instances[index].run(now);
            self.team.heed(outcome, now)?;
            self.wake(now);
        }
        Ok(any)
    }

    /// Tells every agent which topics have moved.
    pub(super) fn wake(&mut self, now: Moment) {
        self.moved.tell(self.team.instances.iter_mut(), now);
    }

    /// Hands the newest commands to the body, which may move no topic.
    pub(super) fn act(&mut self, now: Moment) -> Result<(), Error> {
        self.team.body.as_mut().map_or(Ok(()), |(body, _)| body.act(now))
    }

    pub(super) fn raise(&mut self, agent: &str, event: &str) -> bool {
        let agent = self.team.instances.iter_mut().find(|known| known.name() == agent);
        agent.is_some_and(|agent| agent.raise(event))
    }

    pub(super) fn stop(&mut self, now: Moment) {
        self.team.instances.iter_mut().for_each(|instance| instance.stop(ENDED, now));
    }

    /// Makes a change from outside.
    pub(super) fn change(&mut self, change: Change, now: Moment) -> Changed {
        let changed = self.roster.ask(change, &mut Working { team: &mut self.team, now }, now);
        self.asked.store(false, Ordering::Relaxed);
        self.wake(now);
        changed
    }

    /// Makes the changes that were published.
    pub(super) fn attend(&mut self, now: Moment) {
        if self.asked.swap(false, Ordering::Relaxed) {
            self.roster.attend(&mut Working { team: &mut self.team, now }, now);
            // The answers that this publishes are nothing to attend to.
            self.wake(now);
        }
    }

    pub(super) fn view(&mut self, chart: Option<&ChartChoice>) -> View {
        let working = Working { team: &mut self.team, now: Moment::ZERO };
        View {
            chart: chart.map(|chart| self.roster.chart(chart, &working)),
            host: working.team.host.clone(),
            agents: self.roster.entries(&working),
            configuration: self.roster.configuration(),
            modules: self.roster.modules(),
        }
    }
}

impl Team {
    fn instance(&self, agent: &str) -> Option<&Instance> {
        self.instances.iter().find(|known| known.name() == agent)
    }

    /// What becomes of the body when an agent has ended like this.
    fn heed(&mut self, outcome: Outcome, now: Moment) -> Result<(), Error> {
        match &mut self.body {
            Some((body, _)) if outcome == Outcome::SafeState => body.rest(now),
            Some((body, _))
                if outcome == Outcome::Stopped && self.instances.iter().all(Instance::is_over) =>
            {
                body.rest(now)
            }
            _ => Ok(()),
        }
    }
}

/// The agents of a host at a moment.
struct Working<'a> {
    team: &'a mut Team,
    now: Moment,
}

impl Staff for Working<'_> {
    fn standing(&self, agent: &str) -> Standing {
        self.team.instance(agent).map_or(Standing::Stopped, Instance::standing)
    }

    fn standing_of_chart(&self, agent: &str, place: usize) -> Standing {
        let shown = self.team.instance(agent).map(Instance::shown).unwrap_or_default();
        shown.get(place).map_or(Standing::Stopped, |chart| chart.standing)
    }

    fn told(&self, agent: &str, place: usize) -> Result<Vec<String>, String> {
        let told = self.team.instance(agent).and_then(|instance| instance.told(place));
        told.ok_or_else(|| format!("`{agent}` has no such statechart"))
    }

    fn has_list(&self, agent: &str) -> bool {
        self.team.instance(agent).is_some_and(Instance::has_list)
    }

    fn cycles(&self, agent: &str) -> u64 {
        self.team.instance(agent).map_or(0, Instance::cycles)
    }

    fn obey(&mut self, agent: &str, orders: Orders) -> Result<Vec<String>, Vec<String>> {
        let Some(instance) = self.team.instances.iter_mut().find(|known| known.name() == agent) else {
            return Err(vec![format!("`{agent}` is not there")]);
        };
        let (outcome, said) = instance.obey(orders, self.now)?;
        self.team.heed(outcome, self.now).map_err(|error| vec![error.to_string()])?;
        Ok(said)
    }

    fn launch(&mut self, member: Member, _: Option<&Asked>) -> Result<(), String> {
        let instance = Instance::new(member, self.now);
        let place = self.team.instances.partition_point(|known| known.name() < instance.name());
        self.team.instances.insert(place, instance);
        Ok(())
    }

    fn dismiss(&mut self, agent: &str) -> Result<(), String> {
        if let Some(place) = self.team.instances.iter().position(|known| known.name() == agent) {
            let mut instance = self.team.instances.remove(place);
            instance.stop(ENDED, self.now);
            self.team.gone.push(instance.statistics(&self.team.host));
        }
        Ok(())
    }

    fn entry(&self, profile: &Profile) -> AgentEntry {
        let Some(instance) = self.team.instance(&profile.name) else { return AgentEntry::default() };
        let statistics = instance.statistics(&self.team.host);
        entry::of(profile, instance.standing(), &statistics, instance.shown())
    }
}
