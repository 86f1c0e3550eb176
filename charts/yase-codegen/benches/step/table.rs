//! A table interpreter: a lower bound for charts that are only known at run time.
//!
//! For each innermost state and each event, the table lists the exited and entered states and the
//! next innermost state. It supports nested states, regions, entry and exit actions; it has no
//! guards, queue, history, connectors or activities, and no transition leaves its region.

use std::collections::BTreeMap;

use yase::Statechart;
use yase::statechart::{NodeId, NodeKind};

use crate::counts::{Counts, EVENTS, Event, Toggle};
use crate::ours;

pub(crate) struct Machine {
    /// By innermost state and event.
    rows: Vec<Option<Row>>,
    /// The counter of each state's entry and exit actions.
    actions: Vec<Option<usize>>,
    /// The innermost state of each region.
    leaves: Vec<usize>,
    counts: Counts,
}

/// A transition from one innermost state.
struct Row {
    exits: Box<[usize]>,
    entries: Box<[usize]>,
    leaf: usize,
}

impl Toggle for Machine {
    #[inline(never)]
    fn handle(&mut self, event: Event) {
        for leaf in &mut self.leaves {
            let Some(row) = &self.rows[*leaf * EVENTS + event as usize] else { continue };
            for &state in &row.exits {
                if let Some(counter) = self.actions[state] {
                    self.counts.leave(counter);
                }
            }
            for &state in &row.entries {
                if let Some(counter) = self.actions[state] {
                    self.counts.enter(counter);
                }
            }
            *leaf = row.leaf;
        }
    }

    fn counts(&self) -> Counts {
        self.counts.clone()
    }
}

impl Machine {
    /// Builds the table of a chart without guards in which every event is `toggle` and every target
    /// has no children.
    pub(crate) fn new(chart: &Statechart) -> Machine {
        let tables = Tables {
            chart,
            targets: chart
                .transitions()
                .map(|(_, transition)| (transition.source, transition.target))
                .collect(),
        };
        let rows = |id| [tables.row(id), None];
        let mut leaves = Vec::new();
        tables.begin(Statechart::ROOT, &mut leaves);
        Machine {
            rows: chart.nodes().flat_map(|(id, _)| rows(id)).collect(),
            actions: chart.nodes().map(|(_, node)| ours::counter(&node.name)).collect(),
            leaves,
            counts: Counts::default(),
        }
    }
}

struct Tables<'a> {
    chart: &'a Statechart,
    targets: BTreeMap<NodeId, NodeId>,
}

impl Tables<'_> {
    /// The initial innermost states.
    fn begin(&self, node: NodeId, leaves: &mut Vec<usize>) {
        let children = self.chart.children(node);
        let start = children.iter().find(|&&child| self.chart.node(child).kind == NodeKind::Start);
        match start {
            Some(start) => self.begin(self.targets[start], leaves),
            None if children.is_empty() => leaves.push(node.0 as usize),
            None => children.iter().for_each(|&region| self.begin(region, leaves)),
        }
    }

    /// The transition of an innermost state: its own, or that of its nearest ancestor with one.
    fn row(&self, leaf: NodeId) -> Option<Row> {
        let (source, target) = self.outward(leaf).find_map(|node| Some((node, *self.targets.get(&node)?)))?;
        let scope = self
            .chart
            .ancestors(source)
            .find(|&node| self.chart.ancestors(target).any(|other| other == node))?;
        let inside =
            |node: NodeId| self.outward(node).take_while(|&node| node != scope).map(|node| node.0 as usize);
        let mut entries: Vec<usize> = inside(target).collect();
        entries.reverse();
        Some(Row { exits: inside(leaf).collect(), entries: entries.into(), leaf: target.0 as usize })
    }

    fn outward(&self, node: NodeId) -> impl Iterator<Item = NodeId> {
        std::iter::once(node).chain(self.chart.ancestors(node))
    }
}
