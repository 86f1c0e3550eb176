//! Agents: what runs together under one name.

mod chart_settings;
mod profile;

use std::collections::BTreeMap;
use std::fmt;
use std::num::NonZeroUsize;
use std::time::Duration;

use aseme::properties::Property;
use yase::{Semantics, Statechart};

use crate::activity::Activity;
use crate::frequency::Frequency;
use crate::generated::GeneratedChart;
use crate::monitors::{OnViolation, Rules};
use crate::parameters::Parameters;

pub use chart_settings::ChartSettings;
pub(crate) use profile::{ActivityProfile, ChartProfile, Profile};

/// What happens when an activity fails or panics. Whatever it is, the failure is logged with the agent and the cycle, and no
/// other agent notices.
#[derive(Clone, Copy, PartialEq, Eq, Debug, Default)]
#[non_exhaustive]
pub enum Policy {
    /// The activity's `start` is called again before its next call. The first failure costs no call, each further one in a
    /// row twice as many as the one before, up to 64.
    #[default]
    Restart,
    /// Nothing: the activity is called again when it is its turn.
    Skip,
    /// The agent stops.
    StopAgent,
    /// The agent stops, and the body of its host sits down and rests from then on.
    SafeState,
}

impl Policy {
    /// Every policy with its name in configurations.
    pub const NAMES: [(&'static str, Policy); 4] = [
        ("restart", Policy::Restart),
        ("skip", Policy::Skip),
        ("stop-agent", Policy::StopAgent),
        ("safe-state", Policy::SafeState),
    ];
}

/// An agent: a list of activities that run one after the other once a period, statecharts that decide which activities run, or
/// both. The list and each chart share nothing but topics.
///
/// ```
/// use monas::{Agent, Blackboard, Hz};
///
/// fn hello(blackboard: &mut Blackboard) {
///     println!("hello at {}", blackboard.now());
/// }
/// let greeter = Agent::new("greeter", Hz(10)).activity(hello);
/// assert_eq!(greeter.name(), "greeter");
/// ```
pub struct Agent {
    pub(crate) name: String,
    pub(crate) frequency: Option<Frequency>,
    pub(crate) activities: Vec<Listed>,
    pub(crate) charts: Vec<Statechart>,
    /// What each chart has of its own, by its place.
    pub(crate) own: Vec<ChartSettings>,
    /// By their place among the charts: those that are code.
    pub(crate) generated: BTreeMap<usize, GeneratedChart>,
    pub(crate) policy: Policy,
    pub(crate) real_time: bool,
    pub(crate) priority: i32,
    pub(crate) statistics_every: Option<u64>,
    pub(crate) workers: Option<NonZeroUsize>,
    pub(crate) semantics: Semantics,
    pub(crate) elsewhere: Vec<String>,
    /// Where each chart comes from, by its place.
    pub(crate) models: Vec<String>,
    pub(crate) cores: Vec<usize>,
    pub(crate) stuck_after: Option<Duration>,
    pub(crate) rules: Vec<Rules>,
    /// In a replay: the places of the charts that run apart from the rest.
    pub(crate) absent: Vec<usize>,
}

/// An activity of a list.
pub(crate) struct Listed {
    pub(crate) name: String,
    /// Those it was configured with.
    pub(crate) parameters: Parameters,
    /// What happens when it fails, if that is not what happens when any of the agent's does.
    pub(crate) policy: Option<Policy>,
    pub(crate) activity: Box<dyn Activity>,
}

impl Agent {
    /// An agent whose list of activities runs so often.
    pub fn new(name: impl Into<String>, frequency: Frequency) -> Agent {
        Agent { frequency: Some(frequency), ..Agent::idle(name.into()) }
    }

    /// An agent that does what a statechart says. It steps when something happens: a message arrives that a guard reads, a
    /// timer expires, an activity returns.
    pub fn statechart(name: impl Into<String>, chart: Statechart) -> Agent {
        Agent::idle(name.into()).chart(chart)
    }

    pub(crate) fn idle(name: String) -> Agent {
        Agent {
            name,
            frequency: None,
            activities: Vec::new(),
            charts: Vec::new(),
            own: Vec::new(),
            generated: BTreeMap::new(),
            policy: Policy::default(),
            real_time: false,
            priority: 0,
            statistics_every: None,
            workers: None,
            semantics: Semantics::yase(),
            elsewhere: Vec::new(),
            models: Vec::new(),
            cores: Vec::new(),
            stuck_after: None,
            rules: Vec::new(),
            absent: Vec::new(),
        }
    }

    /// Adds an activity at the end of the list.
    pub fn activity(self, activity: impl Activity + 'static) -> Agent {
        let name = activity.name().to_owned();
        self.named_activity(name, Box::new(activity))
    }

    /// Adds an activity at the end of the list, under the name it is registered as.
    pub fn named_activity(self, name: impl Into<String>, activity: Box<dyn Activity>) -> Agent {
        self.listed(Listed { name: name.into(), parameters: Parameters::new(), policy: None, activity })
    }

    /// Adds an activity that was configured at the end of the list.
    pub(crate) fn listed(mut self, listed: Listed) -> Agent {
        self.activities.push(listed);
        self
    }

    /// Adds a statechart.
    pub fn chart(self, chart: Statechart) -> Agent {
        let name = chart.name.clone();
        self.chart_of(name, chart)
    }

    /// Adds a statechart that comes from a file, or has that name in the registry.
    pub(crate) fn chart_of(mut self, model: impl Into<String>, chart: Statechart) -> Agent {
        self.models.push(model.into());
        self.charts.push(chart);
        self.own.push(ChartSettings::new());
        self
    }

    /// Adds a statechart that is code, as [`Registry::chart`](crate::Registry::chart) gives it.
    pub fn generated(self, chart: GeneratedChart) -> Agent {
        let name = chart.statechart().name.clone();
        self.generated_as(name, chart)
    }

    /// Adds a statechart that is code, under the name it is registered as.
    pub(crate) fn generated_as(mut self, name: impl Into<String>, chart: GeneratedChart) -> Agent {
        let statechart = chart.statechart().clone();
        self.generated.insert(self.charts.len(), chart);
        self.chart_of(name, statechart)
    }

    /// Says what the statechart that was added last has of its own; what it does not say is as the agent says.
    pub fn chart_settings(mut self, settings: ChartSettings) -> Agent {
        if let Some(own) = self.own.last_mut() {
            *own = settings;
        }
        self
    }

    /// Says what happens when an activity fails.
    pub fn on_failure(mut self, policy: Policy) -> Agent {
        self.policy = policy;
        self
    }

    /// Says what happens when the activity fails that was added last to the list.
    pub fn activity_on_failure(mut self, policy: Policy) -> Agent {
        if let Some(listed) = self.activities.last_mut() {
            listed.policy = Some(policy);
        }
        self
    }

    /// Says how often it runs: its list, and its charts besides what wakes them anyway.
    pub fn every(mut self, frequency: Frequency) -> Agent {
        self.frequency = Some(frequency);
        self
    }

    /// Says how urgent it is, from 1 to 99, the higher the sooner, and whether the system's real-time scheduling is wanted for its threads.
    /// Where that is not permitted the log says so, and they run on like others.
    pub fn urgency(mut self, priority: i32, real_time: bool) -> Agent {
        (self.priority, self.real_time) = (priority, real_time);
        self
    }

    /// Says on which of the computer's cores its threads may run, by their numbers; on any, if none is named.
    pub fn cores(mut self, cores: impl IntoIterator<Item = usize>) -> Agent {
        self.cores = cores.into_iter().collect();
        self
    }

    /// Says how long a cycle of its list may take in real time before it counts as stuck: nothing that it does is published then, and the
    /// agent stops when it comes back. If it is not said, ten times its period, and a second at least. A call of a chart's
    /// activity is reported after this time; after ten seconds, if it is not said.
    pub fn stuck_after(mut self, time: Duration) -> Agent {
        self.stuck_after = Some(time);
        self
    }

    /// Says after how many cycles its times are written to the log.
    pub fn statistics_every(mut self, cycles: u64) -> Agent {
        self.statistics_every = (cycles > 0).then_some(cycles);
        self
    }

    /// Says how its charts are read, where dialects of statecharts differ; as [`Semantics::yase`] does, if it is not said.
    pub fn semantics(mut self, semantics: Semantics) -> Agent {
        self.semantics = semantics;
        self
    }

    /// Says how many threads the activities of its charts have in real time; as many as can be active at once, at most twelve, if it is not
    /// said.
    pub fn workers(mut self, workers: NonZeroUsize) -> Agent {
        self.workers = Some(workers);
        self
    }

    /// Says that another process runs an activity of its charts: here its state does nothing, and what the activity publishes comes over a
    /// link.
    pub fn elsewhere(mut self, activity: impl Into<String>) -> Agent {
        self.elsewhere.push(activity.into());
        self
    }

    /// Has [properties](aseme::properties) of its statechart followed while it runs: of the one that it has. Of several each has its own,
    /// [`ChartSettings::monitor`].
    pub fn monitor(self, properties: Vec<Property>, on_violation: OnViolation) -> Agent {
        self.ruled(Rules { file: String::new(), properties, on_violation, source: None })
    }

    pub(crate) fn ruled(mut self, rules: Rules) -> Agent {
        self.rules.push(rules);
        self
    }

    /// For a replay: what each of its threads runs, as an agent of its own. A chart has its place, the list none; a list may begin later.
    pub(crate) fn apart(mut self, begins_list: bool) -> Vec<(Option<usize>, Agent)> {
        let activities = std::mem::take(&mut self.activities);
        let mut generated = std::mem::take(&mut self.generated);
        let all = 0..self.charts.len();
        let without = |place: Option<usize>| all.clone().filter(|other| Some(*other) != place).collect();
        let list = (begins_list || !activities.is_empty())
            .then(|| (None, Agent { activities, absent: without(None), ..self.without_instances() }));
        let charts = all.clone().map(|place| {
            let generated = generated.remove(&place).map(|chart| (place, chart)).into_iter().collect();
            let absent = without(Some(place));
            (Some(place), Agent { generated, absent, ..self.without_instances() })
        });
        charts.chain(list).collect()
    }

    /// A copy, without what can be there only once.
    fn without_instances(&self) -> Agent {
        Agent {
            name: self.name.clone(),
            frequency: self.frequency,
            activities: Vec::new(),
            charts: self.charts.clone(),
            own: self.own.clone(),
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
            rules: self.rules.clone(),
            absent: self.absent.clone(),
        }
    }

    /// Its name.
    pub fn name(&self) -> &str {
        &self.name
    }

    /// How often it runs, if it does not only when something happens.
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

    /// What happens when an activity fails.
    pub fn policy(&self) -> Policy {
        self.policy
    }

    /// How many threads the activities of its charts have, if that is said.
    pub fn worker_count(&self) -> Option<NonZeroUsize> {
        self.workers
    }

    /// How urgent it is, and whether real-time scheduling is wanted.
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
