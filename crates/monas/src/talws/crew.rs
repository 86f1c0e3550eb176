//! What agents are set up with, before a run and while it lasts.

use std::num::NonZeroUsize;
use std::time::Duration;

use narukom::{Moment, Narukom};
use yase::Semantics;

use super::links::Brought;
use super::replay::Company;
use super::scheduling::Scheduling;
use super::seeds::component_seed;
use super::setup::{Observers, collect_all};
use super::teller::Teller;
use crate::agent::{Agent, ChartSettings, Listed, Policy, Profile};
use crate::binder::{Binder, BoundChart};
use crate::chart::{Home, Runner};
use crate::error::{Error, ErrorKind};
use crate::frequency::Frequency;
use crate::link::Elsewhere;
use crate::list::List;
use crate::listener::Listeners;
use crate::monitors::{Monitors, needs_one_chart};
use crate::reach::{Reach, out_of_reach};
use crate::registry::Registry;

/// What every agent of a run is set up with.
pub(super) struct Crew {
    pub(super) registry: Registry,
    pub(super) listeners: Listeners,
    pub(super) observers: Observers,
    pub(super) seed: u64,
    pub(super) company: Vec<Company>,
}

/// Where the agents of a host stand: its hub, and who can be heard there.
pub(super) struct Ground {
    pub(super) hub: Narukom,
    pub(super) brought: Brought,
    /// Those who publish beside the agents.
    pub(super) others: Vec<String>,
}

/// An agent with its list and its charts, each with its blackboards.
pub(super) struct Member {
    pub(super) name: String,
    pub(super) policy: Policy,
    pub(super) frequency: Option<Frequency>,
    pub(super) statistics_every: Option<u64>,
    pub(super) workers: Option<NonZeroUsize>,
    pub(super) scheduling: Scheduling,
    /// A cycle that takes longer is stuck, if that is said.
    pub(super) stuck_after: Option<Duration>,
    pub(super) list: Option<List>,
    pub(super) charts: Vec<Runner>,
    pub(super) teller: Teller,
}

/// As which part of its agent a thread publishes: charts by their places, then the list. So an agent with one thread is one part, the
/// first.
pub(super) fn part(number: usize) -> u16 {
    u16::try_from(number).unwrap_or(u16::MAX)
}

/// Where a chart of an agent is to run.
pub(super) struct Place<'a> {
    pub(super) ground: &'a Ground,
    /// The names of all agents of the host.
    pub(super) names: &'a [String],
    pub(super) agent: &'a str,
    pub(super) elsewhere: &'a [String],
    pub(super) now: Moment,
}

impl Crew {
    /// An agent, ready to run from a moment on.
    pub(super) fn member(
        &self,
        binder: &Binder<'_>,
        agent: Agent,
        ground: &Ground,
        names: &[String],
        now: Moment,
    ) -> Result<Member, Error> {
        let Agent { name, policy, frequency, activities, charts, own, mut generated, semantics, .. } = agent;
        if frequency.is_none() && !activities.is_empty() {
            let message = format!("agent `{name}` has activities, but nothing says how often they run");
            return Err(Error::new(ErrorKind::NoFrequency, message).with_hint("say so with `every`"));
        }
        let place = Place { ground, names, agent: &name, elsewhere: &agent.elsewhere, now };
        let count = charts.len();
        let charts = charts.iter().zip(own).zip(0..);
        let here = charts.filter(|(_, number)| !agent.absent.contains(&(*number as usize)));
        let charts = here.map(|((chart, own), number)| {
            let bound = match generated.remove(&(number as usize)) {
                Some(generated) => binder.bind_generated(generated, semantics),
                None => binder.bind(chart, semantics, None),
            };
            let bound = bound.map_err(Error::invalid)?;
            let monitors = binder.monitors(Some((&agent.rules, &name, count)), &own.rules, &bound.chart);
            self.runner(bound, number, monitors.map_err(Error::invalid)?, own, &place)
        });
        let charts = collect_all(charts)?;
        if let Some(wrong) = needs_one_chart(&name, count).filter(|_| !agent.rules.is_empty()) {
            return Err(Error::invalid(vec![wrong]));
        }
        let part = part(count);
        let list =
            (!activities.is_empty()).then(|| self.list((&name, part), policy, activities, &ground.hub));
        let teller = Teller::new(&ground.hub, &name)?;
        Ok(Member {
            policy,
            frequency,
            statistics_every: agent.statistics_every,
            workers: agent.workers,
            scheduling: Scheduling {
                priority: agent.priority,
                real_time: agent.real_time,
                cores: agent.cores,
            },
            stuck_after: agent.stuck_after,
            list,
            charts,
            teller,
            name,
        })
    }

    /// The list of an agent, which is one of its parts, with its blackboard.
    pub(super) fn list(
        &self,
        (agent, part): (&str, u16),
        policy: Policy,
        activities: Vec<Listed>,
        hub: &Narukom,
    ) -> List {
        let mut blackboard = hub.blackboard(agent).of_part(part);
        blackboard.set_random(component_seed(self.seed, &format!("{}/{agent}", hub.host())));
        List::new(agent, policy, activities, blackboard)
    }

    /// The charts of an agent once more, from their beginning, with activities of this registry.
    pub(super) fn charts_anew(
        &self,
        profile: &Profile,
        place: &Place<'_>,
        registry: &Registry,
    ) -> Result<Vec<Runner>, Error> {
        let binder = Binder::new(registry)?;
        collect_all((0..profile.charts.len()).map(|number| self.chart_anew(&binder, profile, number, place)))
    }

    /// One of them, by its place.
    pub(super) fn chart_anew(
        &self,
        binder: &Binder<'_>,
        profile: &Profile,
        number: usize,
        place: &Place<'_>,
    ) -> Result<Runner, Error> {
        let chart = &profile.charts[number];
        let bound = match chart.is_generated {
            true => self.generated(binder, &chart.model, profile.semantics)?,
            false => binder.bind(&chart.statechart, profile.semantics, None).map_err(Error::invalid)?,
        };
        let of_agent = Some((&profile.rules[..], profile.name.as_str(), profile.charts.len()));
        let monitors = binder.monitors(of_agent, &chart.own.rules, &bound.chart).map_err(Error::invalid)?;
        self.runner(bound, u32::try_from(number).unwrap_or(u32::MAX), monitors, chart.own.clone(), place)
    }

    /// A generated chart by its name.
    pub(super) fn generated(
        &self,
        binder: &Binder<'_>,
        name: &str,
        semantics: Semantics,
    ) -> Result<BoundChart, Error> {
        let chart = self.registry.chart(name).unwrap_or_else(|| {
            let message = format!("no generated statechart `{name}` is registered");
            Err(Error::new(ErrorKind::UnknownChart, message).with_nearest(name, self.registry.chart_names()))
        });
        binder.bind_generated(chart?, semantics).map_err(Error::invalid)
    }

    fn runner(
        &self,
        bound: BoundChart,
        number: u32,
        monitors: Option<Monitors>,
        own: ChartSettings,
        place: &Place<'_>,
    ) -> Result<Runner, Error> {
        let bound = self.fitting(bound, &own, place)?;
        let Place { ground, agent, now, .. } = *place;
        let listeners = &self.listeners;
        let home = Home { hub: &ground.hub, agent, number, seed: self.seed, listeners, now };
        let mut runner = Runner::new(bound, own, home)?;
        if let Some(monitors) = monitors {
            runner.follow(monitors);
        }
        Ok(runner)
    }

    /// A chart with what is said of its activities, and with those that run elsewhere taken out, if all that it reads can arrive.
    pub(super) fn fitting(
        &self,
        bound: BoundChart,
        own: &ChartSettings,
        place: &Place<'_>,
    ) -> Result<BoundChart, Error> {
        let Place { ground, names, elsewhere, .. } = *place;
        let mut bound = bound.configured(own);
        put_elsewhere(&mut bound, elsewhere);
        put_elsewhere(&mut bound, &own.elsewhere);
        let publishers: Vec<String> = names.iter().chain(&ground.others).cloned().collect();
        let reach = Reach {
            hub: &ground.hub,
            publishers: &publishers,
            from_others: &ground.brought.others,
            from_own: &ground.brought.own,
        };
        match out_of_reach(&bound.chart, &reach) {
            wrong if wrong.is_empty() => Ok(bound),
            wrong => Err(Error::invalid(wrong)),
        }
    }
}

/// Takes the activities out of a chart that another process runs.
fn put_elsewhere(bound: &mut BoundChart, names: &[String]) {
    for (entry, activity) in bound.chart.activities().zip(&mut bound.activities) {
        if names.iter().any(|name| name == entry.name) {
            *activity = Box::new(Elsewhere::new(entry.name));
        }
    }
}
