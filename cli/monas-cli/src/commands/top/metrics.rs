//! Metrics of a run between two samples.

use std::time::Duration;

use monas::records::{ActivityEntry, AgentEntry, OpenCallEntry, Times};
use monas_link::control::messages::TopicEntry;

use super::RunSample;

/// From this load on, in cores, an activity is marked as using a core.
const MIN_BUSY_LOAD: f64 = 0.8;
/// An activity blocks if its calls take at least this share of the time
const MIN_BLOCKING_SHARE: f64 = 0.5;
/// and use less than this share of their duration as processor time.
const MAX_BLOCKING_CPU_SHARE: f64 = 0.2;

/// The metrics of a run; rates refer to the run's time.
pub(crate) struct Metrics {
    pub(crate) run: String,
    pub(crate) now: Duration,
    /// Conditions that endanger the run's results.
    pub(crate) alarms: Vec<String>,
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
    /// The part of the load of a call that has not returned since the last sample.
    pub(crate) open_load: f64,
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
    /// Is part of a loop of its chart in which nothing waits.
    Loops,
}

impl ActivityRemark {
    pub(crate) const fn name(self) -> &'static str {
        match self {
            ActivityRemark::Burns => "burns a core",
            ActivityRemark::Blocks => "blocks",
            ActivityRemark::Stuck => "stuck",
            ActivityRemark::Fails => "fails",
            ActivityRemark::Leaks => "leaks",
            ActivityRemark::Loops => "loops",
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
        Metrics { run: after.run.clone(), now: after.now, alarms: after.alarms.clone(), agents, topics }
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
        .map(|(index, one)| {
            let known =
                before.and_then(|before| before.activities.get(index)).filter(|known| known.name == one.name);
            let (calls, failures) = (known.map(|known| known.calls), known.map(|known| known.failures));
            activity(one, rate(since(one.calls, calls)), since(one.failures, failures), stuck)
        })
        .collect();
    let mut open = open_load(entry, before);
    let with_open_call =
        |one: ActivityFigures| match open.iter().position(|(name, _)| *name == one.entry.name) {
            Some(position) => one.with_open_call(open.remove(position).1),
            None => one,
        };
    let activities: Vec<ActivityFigures> = activities.into_iter().map(with_open_call).collect();
    // Activities of states run beside the steps of their chart, those of a list within the agent's
    // cycles, unless their call has not returned.
    let beside = activities.iter().map(|one| match one.entry.state.is_empty() {
        true => one.open_load,
        false => one.load.unwrap_or_default(),
    });
    let beside: f64 = beside.sum();
    // Steps of charts are measured in processor time. If it is not measured, the load of a
    // list's cycles is unknown.
    let has_list = activities.iter().any(|one| one.entry.state.is_empty());
    let each = entry.cycle_time.as_ref().and_then(|times| match processor_time(times) {
        None if !has_list => Some(times.mean),
        measured => measured,
    });
    AgentFigures {
        hz,
        load: match each {
            Some(each) => Some(hz * each + beside),
            None => activities.iter().any(|one| one.open_load > 0.0).then_some(beside),
        },
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
        _ if entry.loops => Some(ActivityRemark::Loops),
        (Some(load), _) if load >= MIN_BUSY_LOAD => Some(ActivityRemark::Burns),
        (Some(load), Some(called))
            if called >= MIN_BLOCKING_SHARE && load < MAX_BLOCKING_CPU_SHARE * called =>
        {
            Some(ActivityRemark::Blocks)
        }
        _ => None,
    };
    ActivityFigures { entry: entry.clone(), hz, load, open_load: 0.0, remark }
}

/// The load of the calls that lasted from one sample to the next, by activity.
fn open_load<'a>(entry: &'a AgentEntry, before: Option<&AgentEntry>) -> Vec<(&'a str, f64)> {
    let earlier = |call: &OpenCallEntry| {
        let calls = before.into_iter().flat_map(|before| &before.open_calls);
        calls.into_iter().find(|known| (known.number, &known.activity) == (call.number, &call.activity))
    };
    let load = |call: &'a OpenCallEntry| {
        let known = earlier(call)?;
        let (seconds, cpu) = (call.seconds - known.seconds, call.cpu_seconds? - known.cpu_seconds?);
        (seconds > 0.0).then(|| (call.activity.as_str(), (cpu / seconds).min(1.0)))
    };
    entry.open_calls.iter().filter_map(load).collect()
}

impl ActivityFigures {
    /// The same with the load of a call that has not returned.
    fn with_open_call(self, open: f64) -> ActivityFigures {
        let remark = self.remark.or((open >= MIN_BUSY_LOAD).then_some(ActivityRemark::Burns));
        ActivityFigures { load: Some(self.load.unwrap_or_default() + open), open_load: open, remark, ..self }
    }
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
        RunSample {
            run: "r".into(),
            now: Duration::from_secs(seconds),
            alarms: Vec::new(),
            agents,
            topics: vec![topic],
        }
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
    fn a_call_that_spins_is_a_busy_core() {
        let agent = |seconds: f64, cpu_seconds: f64, number: u64| AgentEntry {
            state: "stuck".into(),
            reason: "activity `A` is stuck in cycle 3".into(),
            activities: vec![activity("A", "", 1, 0, None), activity("B", "", 1, 0, None)],
            open_calls: vec![OpenCallEntry {
                activity: "A".into(),
                number,
                seconds,
                cpu_seconds: Some(cpu_seconds),
                ..OpenCallEntry::default()
            }],
            ..AgentEntry::default()
        };
        // In simulated time the time of the run stands still meanwhile.
        let (before, same) = (sample(1, vec![agent(2.0, 7.0, 5)], 0), sample(1, vec![agent(4.0, 8.9, 5)], 0));
        let figures = Metrics::between(&before, &same);
        let is_busy = |load: Option<f64>| load.is_some_and(|load| (load - 0.95).abs() < 1e-9);
        assert!(is_busy(figures.agents[0].load), "{:?}", figures.agents[0].load);
        let [spins, other] = figures.agents[0].activities.as_slice() else { panic!("two activities") };
        assert!(is_busy(spins.load), "{:?}", spins.load);
        assert_eq!(spins.remark, Some(ActivityRemark::Stuck));
        assert_eq!(other.load, None);
        let another = sample(1, vec![agent(4.0, 8.9, 6)], 0);
        assert_eq!(Metrics::between(&before, &another).agents[0].load, None, "it is another call");
    }

    #[test]
    fn the_load_of_a_list_without_a_measured_processor_time_is_not_known() {
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
        let marked = |grows, loops| {
            let times = times(0.001, 0.001);
            let entry = ActivityEntry { grows, loops, call_time: times, ..ActivityEntry::default() };
            super::activity(&entry, 900.0, 0, "").remark
        };
        assert_eq!(marked(true, false), Some(ActivityRemark::Leaks));
        assert_eq!(marked(false, true), Some(ActivityRemark::Loops), "that is why it burns a core");
        assert_eq!(marked(false, false), Some(ActivityRemark::Burns));
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
