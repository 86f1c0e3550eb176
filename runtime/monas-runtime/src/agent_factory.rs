//! Preparation of agents, before a run and during it.

use std::num::NonZeroUsize;
use std::time::Duration;

use narukom::{Hub, Timestamp};
use yase::Semantics;

use super::cycle_recorder::CycleRecorder;
use super::links::LinkedTopics;
use super::observers::SharedObservers;
use super::recorded_publisher::RecordedPublisher;
use crate::list::ActivityList;
use crate::remote_activity::RemoteActivity;
use monas_core::agent::{Agent, AgentProfile, ChartSettings, FailurePolicy, ListedActivity};
use monas_core::binder::{Binder, BoundChart};
use monas_core::chart_runner::{ChartContext, ChartRunner};
use monas_core::error::collect_all;
use monas_core::error::{Error, ErrorKind};
use monas_core::frequency::Frequency;
use monas_core::listener::ListenerSet;
use monas_core::monitors::{Monitors, needs_one_chart};
use monas_core::registry::Registry;
use monas_core::scheduling::Scheduling;
use monas_core::seeds::component_seed;
use monas_core::unreachable_sources::{HostPublishers, out_of_reach};

/// The data that all agents of a run share.
pub(crate) struct AgentFactory {
    pub(crate) registry: Registry,
    pub(crate) listeners: ListenerSet,
    pub(crate) observers: SharedObservers,
    pub(crate) seed: u64,
    pub(crate) publishers: Vec<RecordedPublisher>,
}

/// The hub of a host and the names that publish there.
pub(crate) struct HostContext {
    pub(crate) hub: Hub,
    pub(crate) linked_topics: LinkedTopics,
    /// Publishers of the host beside its agents.
    pub(crate) others: Vec<String>,
}

/// An agent with its list and its charts, each with its blackboards.
pub(crate) struct PreparedAgent {
    pub(crate) name: String,
    pub(crate) policy: FailurePolicy,
    pub(crate) frequency: Option<Frequency>,
    pub(crate) statistics_every: Option<u64>,
    pub(crate) workers: Option<NonZeroUsize>,
    pub(crate) scheduling: Scheduling,
    /// The configured limit for a cycle; a longer one is reported as stuck.
    pub(crate) stuck_after: Option<Duration>,
    pub(crate) list: Option<ActivityList>,
    pub(crate) charts: Vec<ChartRunner>,
    pub(crate) recorder: CycleRecorder,
}

/// The part of its agent under which a thread publishes: charts by their indices, then the list. An
/// agent with one thread thus has only part 0.
pub(crate) fn part(number: usize) -> u16 {
    u16::try_from(number).unwrap_or(u16::MAX)
}

/// The agent of a chart and its environment.
pub(crate) struct ChartSite<'a> {
    pub(crate) context: &'a HostContext,
    /// The names of all agents of the host.
    pub(crate) names: &'a [String],
    pub(crate) agent: &'a str,
    pub(crate) elsewhere: &'a [String],
    pub(crate) now: Timestamp,
}

impl AgentFactory {
    /// Prepares an agent to run from `now` on.
    pub(crate) fn prepare_agent(
        &self,
        binder: &Binder<'_>,
        agent: Agent,
        ground: &HostContext,
        names: &[String],
        now: Timestamp,
    ) -> Result<PreparedAgent, Error> {
        let Agent { name, policy, frequency, activities, charts, compiled, chart_settings: own, .. } = agent;
        let (mut generated, semantics) = (agent.generated, agent.semantics);
        if frequency.is_none() && !activities.is_empty() {
            let message = format!("agent `{name}` has activities but no frequency");
            return Err(Error::new(ErrorKind::NoFrequency, message).with_hint("say so with `every`"));
        }
        let site = ChartSite { context: ground, names, agent: &name, elsewhere: &agent.elsewhere, now };
        let count = charts.len();
        let charts = charts.iter().zip(compiled).zip(own).zip(0..);
        let here = charts.filter(|(_, number)| !agent.absent.contains(&(*number as usize)));
        let charts = here.map(|(((chart, compiled), own), number)| {
            let bound = match generated.remove(&(number as usize)) {
                Some(generated) => binder.bind_generated(generated, semantics),
                None => binder.bind(chart, compiled.as_ref(), semantics, None),
            };
            let bound = bound.map_err(Error::invalid)?;
            let monitors =
                binder.monitors(Some((&agent.property_sets, &name, count)), &own.property_sets, &bound.chart);
            self.runner(bound, number, monitors.map_err(Error::invalid)?, own, &site)
        });
        let charts = collect_all(charts)?;
        if let Some(wrong) = needs_one_chart(&name, count).filter(|_| !agent.property_sets.is_empty()) {
            return Err(Error::invalid(vec![wrong]));
        }
        let part = part(count);
        let list =
            (!activities.is_empty()).then(|| self.list((&name, part), policy, activities, &ground.hub));
        let recorder = CycleRecorder::new(&ground.hub, &name)?;
        Ok(PreparedAgent {
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
            recorder,
            name,
        })
    }

    /// The list of an agent, which is one of its parts, with its blackboard.
    pub(crate) fn list(
        &self,
        (agent, part): (&str, u16),
        policy: FailurePolicy,
        activities: Vec<ListedActivity>,
        hub: &Hub,
    ) -> ActivityList {
        let mut blackboard = hub.blackboard(agent).of_part(part);
        blackboard.set_random(component_seed(self.seed, &format!("{}/{agent}", hub.host())));
        ActivityList::new(agent, policy, activities, blackboard)
    }

    /// Builds the charts of an agent anew, in their initial state, with activities of this
    /// registry.
    pub(crate) fn rebuild_charts(
        &self,
        profile: &AgentProfile,
        index: &ChartSite<'_>,
        registry: &Registry,
    ) -> Result<Vec<ChartRunner>, Error> {
        let binder = Binder::new(registry)?;
        collect_all(
            (0..profile.charts.len()).map(|number| self.rebuild_chart(&binder, profile, number, index)),
        )
    }

    /// Builds one of the charts anew, by its index.
    pub(crate) fn rebuild_chart(
        &self,
        binder: &Binder<'_>,
        profile: &AgentProfile,
        number: usize,
        index: &ChartSite<'_>,
    ) -> Result<ChartRunner, Error> {
        let chart = &profile.charts[number];
        let bound = match chart.is_generated {
            true => self.generated(binder, &chart.model, profile.semantics)?,
            false => {
                let bound = binder.bind(&chart.statechart, chart.compiled.as_ref(), profile.semantics, None);
                bound.map_err(Error::invalid)?
            }
        };
        let of_agent = Some((&profile.property_sets[..], profile.name.as_str(), profile.charts.len()));
        let monitors =
            binder.monitors(of_agent, &chart.settings.property_sets, &bound.chart).map_err(Error::invalid)?;
        self.runner(bound, u32::try_from(number).unwrap_or(u32::MAX), monitors, chart.settings.clone(), index)
    }

    /// A generated chart by its name.
    pub(crate) fn generated(
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
        index: &ChartSite<'_>,
    ) -> Result<ChartRunner, Error> {
        let bound = self.fitting(bound, &own, index)?;
        let ChartSite { context: ground, agent, now, .. } = *index;
        let listeners = &self.listeners;
        let home = ChartContext { hub: &ground.hub, agent, number, seed: self.seed, listeners, now };
        let mut runner = ChartRunner::new(bound, own, home)?;
        if let Some(monitors) = monitors {
            runner.set_monitors(monitors);
        }
        Ok(runner)
    }

    /// A chart with the settings of its activities and without those that run elsewhere, if
    /// everything that it reads can arrive.
    pub(crate) fn fitting(
        &self,
        bound: BoundChart,
        own: &ChartSettings,
        index: &ChartSite<'_>,
    ) -> Result<BoundChart, Error> {
        let ChartSite { context: ground, names, elsewhere, .. } = *index;
        let mut bound = bound.configured(own);
        apply_remote_activities(&mut bound, elsewhere);
        apply_remote_activities(&mut bound, &own.elsewhere);
        let publishers: Vec<String> = names.iter().chain(&ground.others).cloned().collect();
        let reach = HostPublishers {
            hub: &ground.hub,
            publishers: &publishers,
            from_others: &ground.linked_topics.others,
            from_own: &ground.linked_topics.own,
        };
        match out_of_reach(&bound.chart, &reach) {
            wrong if wrong.is_empty() => Ok(bound),
            wrong => Err(Error::invalid(wrong)),
        }
    }
}

/// Removes those activities from a chart that another process executes.
fn apply_remote_activities(bound: &mut BoundChart, names: &[String]) {
    for (entry, activity) in bound.chart.activities().zip(&mut bound.activities) {
        if names.iter().any(|name| name == entry.name) {
            *activity = Box::new(RemoteActivity::new(entry.name));
        }
    }
}
