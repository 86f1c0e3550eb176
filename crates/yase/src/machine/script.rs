//! What scripts of the host's own language see of the machine.

use crate::bits::BitSet;
use crate::chart::{Chart, Place};
use crate::machine::run::Run;
use crate::moment::Moment;
use crate::statechart::NodeId;

/// The active states, as a condition in the host's own language sees them.
#[derive(Clone, Copy, Debug)]
pub struct States<'a> {
    pub(super) chart: &'a Chart,
    pub(super) active: &'a BitSet,
}

impl States<'_> {
    /// Whether a node is active.
    pub fn is_active(&self, node: NodeId) -> bool {
        is_active(self.chart, self.active, node)
    }
}

/// The machine, as an action in the host's own language sees it.
#[derive(Debug)]
pub struct Performance<'a> {
    pub(super) chart: &'a Chart,
    pub(super) run: &'a mut Run,
}

impl Performance<'_> {
    /// Whether a node is active.
    pub fn is_active(&self, node: NodeId) -> bool {
        is_active(self.chart, &self.run.active, node)
    }

    /// Whether a node is active and has completed.
    pub fn is_complete(&self, node: NodeId) -> bool {
        let place = self.chart.layout.place(node);
        place.is_some_and(|place| self.run.is_active(place) && self.run.is_complete(self.chart, place))
    }

    /// The moment of the step.
    pub fn now(&self) -> Moment {
        self.run.now
    }

    /// Raises an event, which is offered in the same step, with a number that [`Host::offered`](crate::Host::offered) is told then. Says
    /// whether any expression of the chart names it.
    pub fn raise(&mut self, name: &str, token: u64) -> bool {
        let (event, is_known) = self.chart.event(name);
        self.run.raise(self.chart, event, is_known, token);
        is_known
    }
}

fn is_active(chart: &Chart, active: &BitSet, node: NodeId) -> bool {
    chart.layout.place(node).is_some_and(|place: Place| active.contains(place.index()))
}
