//! Metrics of a run between two samples.

use std::time::Duration;

use monas::records::{ActivityEntry, AgentEntry, Times};
use monas_link::control::messages::TopicEntry;

use super::RunSample;

/// From this load on, in cores, an activity is marked as using a core.
const BURNS: f64 = 0.8;
/// An activity blocks if its calls take at least this share of the time
const LONG: f64 = 0.5;
/// and use less than this share of their duration as processor time.
const IDLE: f64 = 0.2;

/// The metrics of a run; rates refer to the run's time.
pub(crate) struct Metrics {
    pub(crate) run: String,
    pub(crate) now: Duration,
    /// Highest load first.
    pub(crate) agents: Vec<AgentFigures>,
    /// Highest rate first.
    pub(crate) topics: Vec<TopicFigures>,
}

/// The metrics of an agent.
pub(crate) struct AgentFigures {
    pub(crate) entry: AgentEntry,
    /// Cycles per second.
    pub(crate) hz: f64,
    /// Load, in cores; none if not measured.
    pub(crate) load: Option<f64>,
    /// Overruns since the last sample.
    pub(crate) overruns: u64,
    pub(crate) activities: Vec<ActivityFigures>,
}

/// The metrics of an activity.
pub(crate) struct ActivityFigures {
    pub(crate) entry: ActivityEntry,
    /// Calls per second.
    pub(crate) hz: f64,
    /// Load, in cores; none if not measured.
    pub(crate) load: Option<f64>,
    pub(crate) remark: Option<ActivityRemark>,
}

/// A remarkable condition of an activity.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub(crate) enum ActivityRemark {
    /// Uses nearly a whole core.
    Burns,
    /// Its calls wait most of the time.
    Blocks,
    /// A call does not return.
    Stuck,
    /// Failed since the last sample.
    Fails,
    /// Holds more and more memory.
    Leaks,
}

impl ActivityRemark {
    pub(crate) const fn name(self) -> &'static str {
        match self {
            ActivityRemark::Burns => "burns a core",
            ActivityRemark::Blocks => "blocks",
            ActivityRemark::Stuck => "stuck",
            ActivityRemark::Fails => "fails",
            ActivityRemark::Leaks => "leaks",
        }
    }
}

/// The metrics of a topic.
pub(crate) struct TopicFigures {
    pub(crate) host: String,
    pub(crate) path: String,
    pub(crate) publisher: String,
    /// Messages per second of the last publisher.
    pub(crate) hz: f64,
}

impl Metrics {
    pub(crate) fn between(before: &RunSample, after: &RunSample) -> Metrics {
        let seconds = after.now.saturating_sub(before.now).as_secs_f64();
        let rate = |count: u64| if seconds > 0.0 { count as f64 / seconds } else { 0.0 };
        let agent = |entry: &AgentEntry| {
            let known =
                before.agents.iter().find(|known| (&known.host, &known.name) == (&entry.host, &entry.name));
            agent(entry, known, &rate)
        };
        let topic = |entry: &TopicEntry| {
            let known =
                before.topics.iter().find(|known| (&known.host, &known.path) == (&entry.host, &entry.path));
            topic(entry, known, &rate)
        };
        let mut agents: Vec<AgentFigures> = after.agents.iter().map(agent).collect();
        agents.sort_by(|one, other| other.load.unwrap_or(0.0).total_cmp(&one.load.unwrap_or(0.0)));
        let mut topics: Vec<TopicFigures> = after.topics.iter().filter_map(topic).collect();
        topics.sort_by(|one, other| other.hz.total_cmp(&one.hz));
        Metrics { run: after.run.clone(), now: after.now, agents, topics }
    }
}

fn agent(entry: &AgentEntry, before: Option<&AgentEntry>, rate: &impl Fn(u64) -> f64) -> AgentFigures {
    let since = |count: u64, known: Option<u64>| count.saturating_sub(known.unwrap_or(count));
    let hz = rate(since(entry.cycles, before.map(|before| before.cycles)));
    let stuck = if entry.state == "stuck" { entry.reason.as_str() } else { "" };
    let activities: Vec<ActivityFigures> = entry
        .activities
        .iter()
        .enumerate()
        .map(|(place, one)| {
            let known =
                before.and_then(|before| before.activities.get(place)).filter(|known| known.name == one.name);
            let (calls, failures) = (known.map(|known| known.calls), known.map(|known| known.failures));
            activity(one, rate(since(one.calls, calls)), since(one.failures, failures), stuck)
        })
        .collect();
    // Activities of states run beside the steps of their chart, those of a list within the agent's
    // cycles.
    let beside = activities.iter().filter(|one| !one.entry.state.is_empty()).filter_map(|one| one.load);
    // Steps of charts are measured in processor time. Where it is not measured, the load of a
    // list's cycles is unknown.
    let has_list = activities.iter().any(|one| one.entry.state.is_empty());
    let each = entry.cycle_time.as_ref().and_then(|times| match processor_time(times) {
        None if !has_list => Some(times.mean),
        measured => measured,
    });
    AgentFigures {
        hz,
        load: each.map(|each| hz * each + beside.sum::<f64>()),
        overruns: since(entry.overruns, before.map(|before| before.overruns)),
        activities,
        entry: entry.clone(),
    }
}

fn activity(entry: &ActivityEntry, hz: f64, failures: u64, stuck: &str) -> ActivityFigures {
    let times = entry.call_time.as_ref();
    let load = times.and_then(processor_time).map(|each| hz * each);
    let called = times.map(|times| hz * times.mean);
    let remark = match (load, called) {
        _ if stuck.contains(&format!("`{}`", entry.name)) => Some(ActivityRemark::Stuck),
        _ if failures > 0 => Some(ActivityRemark::Fails),
        _ if entry.grows => Some(ActivityRemark::Leaks),
        (Some(load), _) if load >= BURNS => Some(ActivityRemark::Burns),
        (Some(load), Some(called)) if called >= LONG && load < IDLE * called => Some(ActivityRemark::Blocks),
        _ => None,
    };
    ActivityFigures { entry: entry.clone(), hz, load, remark }
}

/// The mean processor time of a call, if measured, s.
fn processor_time(times: &Times) -> Option<f64> {
    (times.cpu_mean > 0.0).then_some(times.cpu_mean)
}

fn topic(
    entry: &TopicEntry,
    before: Option<&TopicEntry>,
    rate: &impl Fn(u64) -> f64,
) -> Option<TopicFigures> {
    let last = entry.last.as_ref()?;
    let known =
        before.and_then(|before| before.last.as_ref()).filter(|known| known.publisher == last.publisher);
    let count = last.sequence.saturating_sub(known.map_or(last.sequence, |known| known.sequence));
    Some(TopicFigures {
        host: entry.host.clone(),
        path: entry.path.clone(),
        publisher: last.publisher.clone(),
        hz: rate(count),
    })
}

#[cfg(test)]
mod tests {
    use monas_link::control::messages::Last;

    use super::*;

    fn times(mean: f64, cpu_mean: f64) -> Option<Times> {
        Some(Times { count: 1, mean, cpu_mean, ..Times::default() })
    }

    fn activity(
        name: &str,
        state: &str,
        calls: u64,
        failures: u64,
        call_time: Option<Times>,
    ) -> ActivityEntry {
        ActivityEntry {
            name: name.into(),
            state: state.into(),
            calls,
            failures,
            call_time,
            ..ActivityEntry::default()
        }
    }

    fn sample(seconds: u64, agents: Vec<AgentEntry>, sequence: u64) -> RunSample {
        let last = Some(Last { publisher: "vision".into(), sequence, published: 0 });
        let topic = TopicEntry { path: "ball".into(), last, ..TopicEntry::default() };
        RunSample { run: "r".into(), now: Duration::from_secs(seconds), agents, topics: vec![topic] }
    }

    #[test]
    fn rates_are_by_the_time_of_the_run_and_loads_are_shares_of_a_core() {
        let agent = |cycles: u64, overruns: u64| AgentEntry {
            name: "a".into(),
            cycles,
            overruns,
            cycle_time: times(0.004, 0.003),
            activities: vec![activity("A", "", cycles, 0, times(0.003, 0.002))],
            ..AgentEntry::default()
        };
        let chart = |calls: u64| AgentEntry {
            name: "c".into(),
            cycles: 2 * calls,
            cycle_time: times(0.001, 0.0),
            activities: vec![activity("B", "s", calls, 0, times(0.02, 0.01))],
            ..AgentEntry::default()
        };
        let figures = Metrics::between(
            &sample(10, vec![agent(100, 1), chart(20)], 7),
            &sample(12, vec![agent(300, 4), chart(120)], 27),
        );
        let [c, a] = figures.agents.as_slice() else { panic!("two agents") };
        assert_eq!((a.hz, a.overruns), (100.0, 3));
        assert!(
            (a.load.unwrap_or_default() - 0.3).abs() < 1e-9,
            "activities of a list are within its cycles"
        );
        assert!(
            (c.load.unwrap_or_default() - (100.0 * 0.001 + 50.0 * 0.01)).abs() < 1e-9,
            "those of states beside it"
        );
        assert_eq!((figures.topics[0].hz, c.activities[0].hz), (10.0, 50.0));
    }

    #[test]
    fn the_load_of_a_list_without_processor_time_is_unknown() {
        let agent = |state: &str| AgentEntry {
            cycle_time: times(0.004, 0.0),
            activities: vec![activity("A", state, 1, 0, None)],
            ..AgentEntry::default()
        };
        let load = |state| {
            let (before, after) = (sample(0, vec![agent(state)], 0), sample(1, vec![agent(state)], 0));
            Metrics::between(&before, &after).agents[0].load
        };
        assert_eq!((load(""), load("s")), (None, Some(0.0)));
    }

    #[test]
    fn busy_blocked_failing_and_stuck_agents_are_named() {
        let remark = |calls: u64, failures: u64, call_time: Option<Times>, state: &str| {
            let agent = |calls, failures| AgentEntry {
                name: "a".into(),
                state: state.into(),
                reason: "activity `A` is stuck in cycle 3".into(),
                activities: vec![activity("A", "", calls, failures, call_time)],
                ..AgentEntry::default()
            };
            let figures = Metrics::between(
                &sample(0, vec![agent(0, 0)], 0),
                &sample(1, vec![agent(calls, failures)], 0),
            );
            figures.agents[0].activities[0].remark
        };
        assert_eq!(remark(90, 0, times(0.01, 0.0095), "runs"), Some(ActivityRemark::Burns));
        assert_eq!(remark(90, 0, times(0.01, 0.001), "runs"), Some(ActivityRemark::Blocks));
        assert_eq!(remark(90, 0, times(0.01, 0.005), "runs"), None);
        assert_eq!(remark(40, 0, times(0.01, 0.001), "runs"), None);
        assert_eq!(remark(10, 1, times(0.01, 0.001), "runs"), Some(ActivityRemark::Fails));
        let grows =
            |grows| super::activity(&ActivityEntry { grows, ..ActivityEntry::default() }, 1.0, 0, "").remark;
        assert_eq!((grows(true), grows(false)), (Some(ActivityRemark::Leaks), None));
        assert_eq!(remark(0, 0, None, "stuck"), Some(ActivityRemark::Stuck));
        assert_eq!(remark(0, 0, None, "runs"), None);
    }

    #[test]
    fn a_run_with_stopped_time_has_no_rates() {
        let agent = |cycles| AgentEntry { cycles, ..AgentEntry::default() };
        let figures = Metrics::between(&sample(3, vec![agent(5)], 1), &sample(3, vec![agent(6)], 2));
        assert_eq!((figures.agents[0].hz, figures.topics[0].hz), (0.0, 0.0));
    }
}
