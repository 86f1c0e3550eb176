//! Updates of agents, applied between two cycles.

use std::sync::Arc;

use yase::NodeId;

use crate::list::ActivityList;
use crate::list::ListEdit;
use monas_core::activity::Activity;
use monas_core::agent::{ChartSettings, FailurePolicy};
use monas_core::chart_runner::{AgentDefaults, ChartAspect, ChartRunner, ModelSwap};
use monas_core::frequency::Frequency;

/// The effects of one change on an agent. Its list and its charts each apply their share between
/// two of their cycles.
#[derive(Default)]
pub(crate) struct AgentUpdate {
    /// Requests the state of a chart, see [`ChartRunner::inspect`]; changes nothing.
    pub(crate) inspection: Option<ChartAspect>,
    pub(crate) commands: Vec<AgentCommand>,
    pub(crate) edits: Vec<ListEdit>,
    /// A list for an agent without one.
    pub(crate) list: Option<Box<ActivityList>>,
    /// For an agent that starts: its charts in their initial state.
    pub(crate) charts: Vec<ChartRunner>,
    /// A new model for the chart at an index.
    pub(crate) swap: Option<(usize, Box<ModelSwap>)>,
    /// New instances of activities for the charts at these indices.
    pub(crate) instances: Vec<(usize, ActivityInstances)>,
    /// New settings for the chart at an index.
    pub(crate) chart_settings: Option<(usize, Box<ChartSettings>)>,
    /// Events to raise in its charts.
    pub(crate) events: Vec<String>,
    /// Restricts the commands and events to the chart at this index.
    pub(crate) only: Option<usize>,
    /// The change that requested the update, for real-time records.
    pub(crate) change: Option<ChangeRef>,
}

/// The share of an update for one thread.
pub(crate) struct ThreadUpdate {
    /// The chart's index; `None` for the list.
    pub(crate) chart: Option<usize>,
    pub(crate) update: AgentUpdate,
    /// Whether it changes the list or chart of the thread, beside commands for the whole agent.
    pub(crate) is_own: bool,
}

/// Activities for the states of a chart.
pub(crate) type ActivityInstances = Vec<(NodeId, Box<dyn Activity>)>;

/// A reference to the change that requested an update.
#[derive(Clone, Debug)]
pub(crate) struct ChangeRef {
    pub(crate) publisher: Arc<str>,
    pub(crate) sequence: u64,
    /// Number of publications that the hub had taken when the update was prepared.
    pub(crate) ready_at: u64,
}

/// A command for a whole agent.
#[derive(Clone, Copy, PartialEq, Debug)]
pub(crate) enum AgentCommand {
    /// Start again from the beginning.
    Start,
    Stop,
    Pause,
    Resume,
    /// Execute one cycle while paused.
    Step,
    Frequency(Frequency),
    Policy(FailurePolicy),
    StatisticsEvery(Option<u64>),
    /// The priority, and whether real-time scheduling is requested.
    Scheduling(i32, bool),
}

impl AgentCommand {
    /// Applies the command to the settings of an agent, if it concerns them.
    pub(crate) fn apply_to(self, defaults: &mut AgentDefaults) {
        match self {
            AgentCommand::Frequency(frequency) => defaults.frequency = Some(frequency),
            AgentCommand::Policy(policy) => defaults.policy = policy,
            AgentCommand::StatisticsEvery(cycles) => defaults.statistics_every = cycles,
            AgentCommand::Scheduling(priority, real_time) => {
                (defaults.scheduling.priority, defaults.scheduling.real_time) = (priority, real_time);
            }
            AgentCommand::Start
            | AgentCommand::Stop
            | AgentCommand::Pause
            | AgentCommand::Resume
            | AgentCommand::Step => {}
        }
    }
}

/// The status of an agent or chart.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub(crate) enum AgentStatus {
    Running,
    Paused,
    Stopped,
    /// A call does not return.
    Stuck,
}

impl AgentStatus {
    /// The status in messages for users.
    pub(crate) fn word(self) -> &'static str {
        match self {
            AgentStatus::Running => "runs",
            AgentStatus::Paused => "pauses",
            AgentStatus::Stopped => "stopped",
            AgentStatus::Stuck => "stuck",
        }
    }
}

/// The status of a chart.
#[derive(Clone, Debug)]
pub(crate) struct ChartStatus {
    /// The paths of the BASIC states that are active.
    pub(crate) active: Vec<String>,
    pub(crate) status: AgentStatus,
}

impl Default for ChartStatus {
    fn default() -> ChartStatus {
        ChartStatus { active: Vec::new(), status: AgentStatus::Stopped }
    }
}

/// Stop reason of an agent that was stopped by a command.
pub(crate) const STOPPED_BY_REQUEST: &str = "by request";

impl AgentUpdate {
    /// An update that consists of commands only.
    pub(crate) fn of(directives: impl IntoIterator<Item = AgentCommand>) -> AgentUpdate {
        AgentUpdate { commands: directives.into_iter().collect(), ..AgentUpdate::default() }
    }

    /// The shares of the threads of an agent with so many charts, without empty ones.
    pub(crate) fn shares(self, has_list: bool, charts: usize) -> Vec<ThreadUpdate> {
        let AgentUpdate {
            commands: directives,
            edits,
            charts: runners,
            swap,
            instances,
            chart_settings: own,
            events,
            only,
            change: asked,
            ..
        } = self;
        let chart_update = |index: Option<usize>| {
            let is_meant = only.is_none() || index == only;
            let directives = if is_meant { directives.clone() } else { Vec::new() };
            let is_chart = index.is_some() && is_meant;
            let events = if is_chart { events.clone() } else { Vec::new() };
            AgentUpdate { change: asked.clone(), only, events, ..AgentUpdate::of(directives) }
        };
        let mut shares = Vec::new();
        if has_list {
            let is_own = !edits.is_empty();
            shares.push(ThreadUpdate {
                chart: None,
                update: AgentUpdate { edits, ..chart_update(None) },
                is_own,
            });
        }
        let (mut runners, mut swap, mut own, mut instances) = (runners.into_iter(), swap, own, instances);
        for index in 0..charts {
            let swap = swap.take_if(|(chart, _)| *chart == index).map(|(_, swap)| (0, swap));
            let own = own.take_if(|(chart, _)| *chart == index);
            let fresh: Vec<_> = instances.extract_if(.., |(chart, _)| *chart == index).collect();
            let is_own = swap.is_some() || own.is_some() || !fresh.is_empty();
            let is_meant = only.is_none_or(|only| only == index);
            let charts = if is_meant { runners.next().into_iter().collect() } else { Vec::new() };
            let orders = AgentUpdate {
                charts,
                swap,
                chart_settings: own,
                instances: fresh,
                ..chart_update(Some(index))
            };
            shares.push(ThreadUpdate { chart: Some(index), update: orders, is_own });
        }
        shares.retain(|ThreadUpdate { update: orders, is_own, .. }| {
            *is_own || !orders.commands.is_empty() || !orders.events.is_empty()
        });
        shares
    }
}
