//! A table interpreter: the least that a chart that is only known at run time takes.
//!
//! For each innermost state and each event the table says which states are left, which are entered and which is innermost then. It knows nested
//! states and regions, and entry and exit actions; it knows no guards, no queue, no history, no connectors and no activities, and no
//! transition leaves its region.

use std::collections::BTreeMap;

use yase::Statechart;
use yase::statechart::{NodeId, NodeKind};

use crate::counts::{Counts, EVENTS, Event, Toggle};
use crate::ours;

pub(crate) struct Machine {
    /// By innermost state and event.
    rows: Vec<Option<Row>>,
    /// The action of each state at entry and exit: what it counts as.
    actions: Vec<Option<usize>>,
    /// The innermost state of each region.
    leaves: Vec<usize>,
    counts: Counts,
}

/// A transition: from a certain innermost state.
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
    /// Fills the table from a chart without guards in which every event is `toggle`, and every target a state without children.
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
    /// The innermost states at first.
    fn begin(&self, node: NodeId, leaves: &mut Vec<usize>) {
        let children = self.chart.children(node);
        let start = children.iter().find(|&&child| self.chart.node(child).kind == NodeKind::Start);
        match start {
            Some(start) => self.begin(self.targets[start], leaves),
            None if children.is_empty() => leaves.push(node.0 as usize),
            None => children.iter().for_each(|&region| self.begin(region, leaves)),
        }
    }

    /// The transition of an innermost state: its own, or that of the next state around it that has one.
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
