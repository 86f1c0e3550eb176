//! What agents are told between two cycles.

use std::sync::Arc;

use yase::NodeId;

use crate::activity::Activity;
use crate::agent::{ChartSettings, Policy};
use crate::chart::{Runner, Swap};
use crate::frequency::Frequency;
use crate::list::{List, ListEdit};

/// Everything that one change means for an agent. Its list and its charts each take their part at the edge of a cycle of their own.
#[derive(Default)]
pub(super) struct Orders {
    /// Nothing changes: the chart says what it is doing, see [`Runner::told`].
    pub(super) look: bool,
    pub(super) directives: Vec<Directive>,
    pub(super) edits: Vec<ListEdit>,
    /// A list for an agent that had none.
    pub(super) list: Option<Box<List>>,
    /// For an agent that starts: its charts from their beginning.
    pub(super) charts: Vec<Runner>,
    /// Another model for the chart at a place.
    pub(super) swap: Option<(usize, Box<Swap>)>,
    /// Other instances of activities for the charts at these places.
    pub(super) instances: Vec<(usize, Instances)>,
    /// What the chart at a place has of its own from now on.
    pub(super) own: Option<(usize, Box<ChartSettings>)>,
    /// Events that come to its charts.
    pub(super) events: Vec<String>,
    /// They are for the chart at this place alone.
    pub(super) only: Option<usize>,
    /// What they follow from, for the records of real time.
    pub(super) asked: Option<Asked>,
}

/// What one thread of an agent is told.
pub(super) struct Share {
    /// The chart's place; none for the list.
    pub(super) place: Option<usize>,
    pub(super) orders: Orders,
    /// Whether it changes what the thread works on, beside what concerns the agent as a whole.
    pub(super) is_own: bool,
}

/// Activities for the states of a chart.
pub(super) type Instances = Vec<(NodeId, Box<dyn Activity>)>;

/// The change that orders follow from.
#[derive(Clone, Debug)]
pub(super) struct Asked {
    pub(super) publisher: Arc<str>,
    pub(super) sequence: u64,
    /// How many publications the hub had taken when the orders were ready.
    pub(super) ready_at: u64,
}

/// What concerns an agent as a whole.
#[derive(Clone, Copy, PartialEq, Debug)]
pub(super) enum Directive {
    /// It begins anew.
    Start,
    Stop,
    Pause,
    Resume,
    /// One cycle while it pauses.
    Step,
    Frequency(Frequency),
    Policy(Policy),
    StatisticsEvery(Option<u64>),
    /// How urgent it is, and whether real-time scheduling is wanted.
    Scheduling(i32, bool),
}

/// Whether an agent does anything.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub(super) enum Standing {
    Runs,
    Pauses,
    Stopped,
    /// A call does not come to its end.
    Stuck,
}

impl Standing {
    /// As people read it.
    pub(super) fn word(self) -> &'static str {
        match self {
            Standing::Runs => "runs",
            Standing::Pauses => "pauses",
            Standing::Stopped => "stopped",
            Standing::Stuck => "stuck",
        }
    }
}

/// A chart as its agent shows it.
#[derive(Clone, Debug)]
pub(super) struct ShownChart {
    /// The paths of the BASIC states that are active.
    pub(super) active: Vec<String>,
    pub(super) standing: Standing,
}

impl Default for ShownChart {
    fn default() -> ShownChart {
        ShownChart { active: Vec::new(), standing: Standing::Stopped }
    }
}

/// Why an agent has stopped that was told to.
pub(super) const TOLD: &str = "it was told to";

impl Orders {
    /// Nothing but what concerns the whole agent.
    pub(super) fn of(directives: impl IntoIterator<Item = Directive>) -> Orders {
        Orders { directives: directives.into_iter().collect(), ..Orders::default() }
    }

    /// What each thread of an agent with so many charts is told, of those that are told something.
    pub(super) fn shares(self, has_list: bool, charts: usize) -> Vec<Share> {
        let Orders { directives, edits, charts: runners, swap, instances, own, events, only, asked, .. } =
            self;
        let told = |place: Option<usize>| {
            let is_meant = only.is_none() || place == only;
            let directives = if is_meant { directives.clone() } else { Vec::new() };
            let is_chart = place.is_some() && is_meant;
            let events = if is_chart { events.clone() } else { Vec::new() };
            Orders { asked: asked.clone(), only, events, ..Orders::of(directives) }
        };
        let mut shares = Vec::new();
        if has_list {
            let is_own = !edits.is_empty();
            shares.push(Share { place: None, orders: Orders { edits, ..told(None) }, is_own });
        }
        let (mut runners, mut swap, mut own, mut instances) = (runners.into_iter(), swap, own, instances);
        for place in 0..charts {
            let swap = swap.take_if(|(chart, _)| *chart == place).map(|(_, swap)| (0, swap));
            let own = own.take_if(|(chart, _)| *chart == place);
            let fresh: Vec<_> = instances.extract_if(.., |(chart, _)| *chart == place).collect();
            let is_own = swap.is_some() || own.is_some() || !fresh.is_empty();
            let is_meant = only.is_none_or(|only| only == place);
            let charts = if is_meant { runners.next().into_iter().collect() } else { Vec::new() };
            let orders = Orders { charts, swap, own, instances: fresh, ..told(Some(place)) };
            shares.push(Share { place: Some(place), orders, is_own });
        }
        shares.retain(|Share { orders, is_own, .. }| {
            *is_own || !orders.directives.is_empty() || !orders.events.is_empty()
        });
        shares
    }
}
