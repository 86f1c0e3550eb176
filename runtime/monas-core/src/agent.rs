//! Agents: named units of execution.

mod chart_settings;
mod profile;

use std::collections::BTreeMap;
use std::fmt;
use std::num::NonZeroUsize;
use std::time::Duration;

use aseme_verify::properties::Property;
use yase::{Semantics, Statechart};

use crate::activity::Activity;
use crate::binder::CompiledModel;
use crate::frequency::Frequency;
use crate::generated::GeneratedChart;
use crate::guarded_activity::GuardedActivity;
use crate::monitors::{PropertySet, ViolationResponse};
use crate::parameters::Parameters;

pub use chart_settings::ChartSettings;
pub use profile::{ActivityProfile, AgentProfile, ChartProfile};

/// The reaction to an activity that fails or panics. Every failure is logged with the agent and the
/// cycle and has no effect on other agents.
#[derive(Clone, Copy, PartialEq, Eq, Debug, Default)]
#[non_exhaustive]
pub enum FailurePolicy {
    /// Calls the activity's `start` again before its next call. The first failure skips no call,
    /// each further failure in a row twice as many as the previous one, up to 64.
    #[default]
    Restart,
    /// No reaction: the activity is called again in its next cycle.
    Skip,
    /// The agent stops.
    StopAgent,
    /// The agent stops, and the body of its host sits down and stays in its rest posture.
    SafeState,
}

impl FailurePolicy {
    /// Every policy with its name in configurations.
    pub const NAMES: [(&'static str, FailurePolicy); 4] = [
        ("restart", FailurePolicy::Restart),
        ("skip", FailurePolicy::Skip),
        ("stop-agent", FailurePolicy::StopAgent),
        ("safe-state", FailurePolicy::SafeState),
    ];

    /// Whether a failure ends the agent.
    pub const fn stops_agent(self) -> bool {
        matches!(self, FailurePolicy::StopAgent | FailurePolicy::SafeState)
    }
}

/// An agent: a list of activities called one after the other once per period, statecharts that
/// select the running activities, or both. The list and the charts share only topics.
///
/// ```
/// use monas_core::{Agent, Blackboard, Hz};
///
/// fn hello(blackboard: &mut Blackboard) {
///     println!("hello at {}", blackboard.now());
/// }
/// let greeter = Agent::new("greeter", Hz(10)).activity(hello);
/// assert_eq!(greeter.name(), "greeter");
/// ```
pub struct Agent {
    /// The name.
    pub name: String,
    /// The frequency of the list; `None` without a list.
    pub frequency: Option<Frequency>,
    /// The activities of the list, in the order of their calls.
    pub activities: Vec<ListedActivity>,
    /// The statecharts.
    pub charts: Vec<Statechart>,
    /// The compiled form of each chart, by index, if it was compiled on loading.
    pub compiled: Vec<Option<CompiledModel>>,
    /// The settings of each chart, by index.
    pub chart_settings: Vec<ChartSettings>,
    /// Generated charts, by index among the charts.
    pub generated: BTreeMap<usize, GeneratedChart>,
    /// The reaction to failing activities.
    pub policy: FailurePolicy,
    /// Whether its threads request real-time scheduling.
    pub real_time: bool,
    /// The priority of its threads, 1 to 99, higher values first.
    pub priority: i32,
    /// Number of cycles after which times are logged; `None` for never.
    pub statistics_every: Option<u64>,
    /// Number of threads for the activities of its charts in real time.
    pub workers: Option<NonZeroUsize>,
    /// The semantics of its charts.
    pub semantics: Semantics,
    /// Activities executed by another process.
    pub elsewhere: Vec<String>,
    /// The origin of each chart, by index.
    pub models: Vec<String>,
    /// Numbers of the permitted cores; empty for any core.
    pub cores: Vec<usize>,
    /// Duration after which a call counts as stuck.
    pub stuck_after: Option<Duration>,
    /// Properties monitored on its only chart.
    pub property_sets: Vec<PropertySet>,
    /// In a replay: indices of the charts that are executed separately.
    pub absent: Vec<usize>,
}

/// An activity of a list.
pub struct ListedActivity {
    /// The name.
    pub name: String,
    /// The parameters with which it was configured.
    pub parameters: Parameters,
    /// Its failure policy, if it differs from the agent's.
    pub policy: Option<FailurePolicy>,
    /// The activity.
    pub activity: Box<dyn Activity>,
}

impl Agent {
    /// An agent with a list of activities that runs at a frequency.
    pub fn new(name: impl Into<String>, frequency: Frequency) -> Agent {
        Agent { frequency: Some(frequency), ..Agent::idle(name.into()) }
    }

    /// An agent that executes a statechart. It steps on events: a message that a guard reads
    /// arrives, a timer expires, an activity returns.
    pub fn statechart(name: impl Into<String>, chart: Statechart) -> Agent {
        Agent::idle(name.into()).chart(chart)
    }

    /// An agent without activities and charts.
    pub fn idle(name: String) -> Agent {
        Agent {
            name,
            frequency: None,
            activities: Vec::new(),
            charts: Vec::new(),
            compiled: Vec::new(),
            chart_settings: Vec::new(),
            generated: BTreeMap::new(),
            policy: FailurePolicy::default(),
            real_time: false,
            priority: 0,
            statistics_every: None,
            workers: None,
            semantics: Semantics::yase(),
            elsewhere: Vec::new(),
            models: Vec::new(),
            cores: Vec::new(),
            stuck_after: None,
            property_sets: Vec::new(),
            absent: Vec::new(),
        }
    }

    /// Adds an activity at the end of the list.
    pub fn activity(self, activity: impl Activity + 'static) -> Agent {
        let activity = GuardedActivity::of(Box::new(activity));
        let name = activity.name().to_owned();
        self.listed(ListedActivity { name, parameters: Parameters::new(), policy: None, activity })
    }

    /// Adds an activity at the end of the list, under its registered name.
    pub fn named_activity(self, name: impl Into<String>, activity: Box<dyn Activity>) -> Agent {
        self.listed(ListedActivity {
            name: name.into(),
            parameters: Parameters::new(),
            policy: None,
            activity: GuardedActivity::of(activity),
        })
    }

    /// Adds a configured activity at the end of the list.
    pub fn listed(mut self, listed: ListedActivity) -> Agent {
        self.activities.push(listed);
        self
    }

    /// Adds a statechart.
    pub fn chart(self, chart: Statechart) -> Agent {
        let name = chart.name.clone();
        self.chart_of(name, chart)
    }

    /// Adds a statechart from a file, or with that name in the registry.
    pub fn chart_of(mut self, model: impl Into<String>, chart: Statechart) -> Agent {
        self.models.push(model.into());
        self.charts.push(chart);
        self.compiled.push(None);
        self.chart_settings.push(ChartSettings::new());
        self
    }

    /// Sets the compiled form of the statechart added last.
    pub fn compiled_to(mut self, model: Option<CompiledModel>) -> Agent {
        if let Some(compiled) = self.compiled.last_mut() {
            *compiled = model;
        }
        self
    }

    /// Adds a generated statechart, as returned by [`Registry::chart`](crate::Registry::chart).
    pub fn generated(self, chart: GeneratedChart) -> Agent {
        let name = chart.statechart().name.clone();
        self.generated_as(name, chart)
    }

    /// Adds a generated statechart under its registered name.
    pub fn generated_as(mut self, name: impl Into<String>, chart: GeneratedChart) -> Agent {
        let statechart = chart.statechart().clone();
        self.generated.insert(self.charts.len(), chart);
        self.chart_of(name, statechart)
    }

    /// Sets the settings of the statechart added last; settings not given default to the agent's.
    pub fn chart_settings(mut self, settings: ChartSettings) -> Agent {
        if let Some(own) = self.chart_settings.last_mut() {
            *own = settings;
        }
        self
    }

    /// Sets the failure policy.
    pub fn on_failure(mut self, policy: FailurePolicy) -> Agent {
        self.policy = policy;
        self
    }

    /// Sets the failure policy of the activity added last to the list.
    pub fn activity_on_failure(mut self, policy: FailurePolicy) -> Agent {
        if let Some(listed) = self.activities.last_mut() {
            listed.policy = Some(policy);
        }
        self
    }

    /// Sets the frequency of its list; its charts step at this frequency in addition to their
    /// events.
    pub fn every(mut self, frequency: Frequency) -> Agent {
        self.frequency = Some(frequency);
        self
    }

    /// Sets the priority of its threads, 1 (lowest) to 99, and whether they request real-time
    /// scheduling of the system. If that is not permitted, the log reports it and the threads run
    /// with ordinary scheduling.
    pub fn urgency(mut self, priority: i32, real_time: bool) -> Agent {
        (self.priority, self.real_time) = (priority, real_time);
        self
    }

    /// Sets the CPU cores its threads may use, by number; any core if empty.
    pub fn cores(mut self, cores: impl IntoIterator<Item = usize>) -> Agent {
        self.cores = cores.into_iter().collect();
        self
    }

    /// Sets the time after which a cycle of its list counts as stuck in real time: its outputs are
    /// then discarded, and the agent stops when the cycle returns. Default: ten periods, at least 1
    /// s. A call of a chart's activity is reported after this time; default 10 s.
    pub fn stuck_after(mut self, time: Duration) -> Agent {
        self.stuck_after = Some(time);
        self
    }

    /// Sets the number of cycles after which its timing is written to the log.
    pub fn statistics_every(mut self, cycles: u64) -> Agent {
        self.statistics_every = (cycles > 0).then_some(cycles);
        self
    }

    /// Sets the statechart semantics of its charts; default [`Semantics::yase`].
    pub fn semantics(mut self, semantics: Semantics) -> Agent {
        self.semantics = semantics;
        self
    }

    /// Sets the number of threads that call the activities of its charts in real time. Default: the
    /// number of activities that can be active at once, at most twelve.
    pub fn workers(mut self, workers: NonZeroUsize) -> Agent {
        self.workers = Some(workers);
        self
    }

    /// Marks an activity of its charts as executed by another process: its state does nothing here,
    /// and a link delivers its publications.
    pub fn elsewhere(mut self, activity: impl Into<String>) -> Agent {
        self.elsewhere.push(activity.into());
        self
    }

    /// Monitors [properties](aseme_verify::properties) of its only statechart while it runs. An
    /// agent with several charts monitors each with [`ChartSettings::monitor`].
    pub fn monitor(self, properties: Vec<Property>, on_violation: ViolationResponse) -> Agent {
        self.with_property_set(PropertySet { file: String::new(), properties, on_violation, source: None })
    }

    /// Adds a set of properties to monitor on its only chart.
    pub fn with_property_set(mut self, rules: PropertySet) -> Agent {
        self.property_sets.push(rules);
        self
    }

    /// For a replay: splits the agent into one agent per thread, each with the index of its chart
    /// (none for the list). A list may start later.
    pub fn split_by_thread(mut self, begins_list: bool) -> Vec<(Option<usize>, Agent)> {
        let activities = std::mem::take(&mut self.activities);
        let mut generated = std::mem::take(&mut self.generated);
        let all = 0..self.charts.len();
        let without = |index: Option<usize>| all.clone().filter(|other| Some(*other) != index).collect();
        let list = (begins_list || !activities.is_empty())
            .then(|| (None, Agent { activities, absent: without(None), ..self.without_instances() }));
        let charts = all.clone().map(|position| {
            let generated = generated.remove(&position).map(|chart| (position, chart)).into_iter().collect();
            let absent = without(Some(position));
            (Some(position), Agent { generated, absent, ..self.without_instances() })
        });
        charts.chain(list).collect()
    }

    /// A copy without the parts that exist only once.
    fn without_instances(&self) -> Agent {
        Agent {
            name: self.name.clone(),
            frequency: self.frequency,
            activities: Vec::new(),
            charts: self.charts.clone(),
            compiled: self.compiled.clone(),
            chart_settings: self.chart_settings.clone(),
            generated: BTreeMap::new(),
            policy: self.policy,
            real_time: self.real_time,
            priority: self.priority,
            statistics_every: self.statistics_every,
            workers: self.workers,
            semantics: self.semantics,
            elsewhere: self.elsewhere.clone(),
            models: self.models.clone(),
            cores: self.cores.clone(),
            stuck_after: self.stuck_after,
            property_sets: self.property_sets.clone(),
            absent: self.absent.clone(),
        }
    }

    /// Its name.
    pub fn name(&self) -> &str {
        &self.name
    }

    /// Its frequency; none if it runs only on events.
    pub fn frequency(&self) -> Option<Frequency> {
        self.frequency
    }

    /// The names of the activities in its list, in order.
    pub fn activity_names(&self) -> impl Iterator<Item = &str> {
        self.activities.iter().map(|listed| listed.name.as_str())
    }

    /// Its statecharts.
    pub fn charts(&self) -> &[Statechart] {
        &self.charts
    }

    /// Its failure policy.
    pub fn policy(&self) -> FailurePolicy {
        self.policy
    }

    /// The number of threads for the activities of its charts, if set.
    pub fn worker_count(&self) -> Option<NonZeroUsize> {
        self.workers
    }

    /// Its priority, and whether it requests real-time scheduling.
    pub fn scheduling(&self) -> (i32, bool) {
        (self.priority, self.real_time)
    }
}

impl fmt::Debug for Agent {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Agent")
            .field("name", &self.name)
            .field("frequency", &self.frequency)
            .field("activities", &self.activity_names().collect::<Vec<_>>())
            .field("charts", &self.charts.iter().map(|chart| &chart.name).collect::<Vec<_>>())
            .field("policy", &self.policy)
            .finish()
    }
}
