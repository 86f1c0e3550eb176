//! The present state of an agent as a message.

use super::agent_update::{AgentStatus, ChartStatus};
use monas_core::agent::{AgentProfile, ChartProfile, FailurePolicy};
use monas_core::parameters::Parameters;
use monas_core::records::{ActivityEntry, AgentEntry, ChartEntry, Setting, Times};
use monas_core::statistics::{ActivityStatistics, AgentStatistics, MovingAverage, Percentiles};

/// The profile of an agent with its status, its statistics and the status of its charts.
pub(crate) fn of(
    profile: &AgentProfile,
    standing: AgentStatus,
    statistics: &AgentStatistics,
    charts: Vec<ChartStatus>,
) -> AgentEntry {
    let policy = FailurePolicy::NAMES.into_iter().find(|(_, policy)| *policy == profile.policy);
    let shown = charts.into_iter().chain(std::iter::repeat_with(ChartStatus::default));
    AgentEntry {
        state: standing.word().into(),
        frequency: profile.frequency.map(|frequency| frequency.hertz()).unwrap_or_default(),
        priority: profile.priority,
        on_failure: policy.map(|(name, _)| name.to_owned()).unwrap_or_default(),
        charts: profile.charts.iter().zip(shown).map(|(chart, shown)| chart_entry(chart, shown)).collect(),
        activities: activities(profile, statistics),
        name: profile.name.clone(),
        ..counted(statistics)
    }
}

fn chart_entry(chart: &ChartProfile, shown: ChartStatus) -> ChartEntry {
    ChartEntry {
        model: chart.model.clone(),
        active: shown.active,
        state: shown.status.word().into(),
        name: chart.statechart.name.clone(),
    }
}

/// The counts and measurements of an agent.
pub(crate) fn counted(statistics: &AgentStatistics) -> AgentEntry {
    AgentEntry {
        host: statistics.host.clone(),
        name: statistics.agent.clone(),
        reason: statistics.stopped.clone().unwrap_or_default(),
        cycles: statistics.cycles,
        overruns: statistics.overruns,
        micro_steps: statistics.micro_steps,
        missed: statistics.missed,
        cycle_time: times(statistics.cycle_time, statistics.cycle_cpu, statistics.cycle_percentiles),
        activities: statistics.activities.iter().map(|activity| called(activity, None)).collect(),
        ..AgentEntry::default()
    }
}

/// The activities of the list with their parameters, in list order, then those of charts.
fn activities(profile: &AgentProfile, statistics: &AgentStatistics) -> Vec<ActivityEntry> {
    let (listed, charted): (Vec<_>, Vec<_>) =
        statistics.activities.iter().partition(|activity| activity.state.is_none());
    let parameters = profile.activities.iter().map(|activity| Some(&activity.parameters));
    let listed = listed.into_iter().zip(parameters.chain(std::iter::repeat(None)));
    let listed = listed.map(|(activity, parameters)| called(activity, parameters));
    listed.chain(charted.into_iter().map(|activity| called(activity, None))).collect()
}

fn called(activity: &ActivityStatistics, parameters: Option<&Parameters>) -> ActivityEntry {
    let settings = parameters.into_iter().flat_map(Parameters::iter);
    ActivityEntry {
        name: activity.name.clone(),
        state: activity.state.clone().unwrap_or_default(),
        parameters: settings.map(|(key, value)| Setting { key: key.into(), value: value.into() }).collect(),
        calls: activity.calls,
        failures: activity.failures,
        held: activity.held,
        grows: activity.grows,
        loops: activity.loops,
        call_time: times(activity.call_time, activity.call_cpu, activity.call_percentiles),
    }
}

fn times(
    wall: Option<MovingAverage>,
    cpu: Option<MovingAverage>,
    percentiles: Option<Percentiles>,
) -> Option<Times> {
    let wall = wall?;
    let of = percentiles.unwrap_or_default();
    Some(Times {
        count: wall.count(),
        mean: wall.mean().as_secs_f64(),
        deviation: wall.deviation().as_secs_f64(),
        longest: wall.longest().as_secs_f64(),
        cpu_mean: cpu.map(|cpu| cpu.mean().as_secs_f64()).unwrap_or_default(),
        cpu_deviation: cpu.map(|cpu| cpu.deviation().as_secs_f64()).unwrap_or_default(),
        p50: of.p50.as_secs_f64(),
        p90: of.p90.as_secs_f64(),
        p99: of.p99.as_secs_f64(),
        p999: of.p999.as_secs_f64(),
    })
}
