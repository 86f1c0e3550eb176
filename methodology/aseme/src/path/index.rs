//! Lookup of many paths in one chart.

use std::collections::BTreeMap;

use yase::{NodeId, Statechart, TransitionId};

use super::{Path, is_region, may_be_left_out};

/// The nodes of a chart by name, and the transitions at each: what a path names is found without a
/// look at the whole chart, unless it has a wildcard, or is that of a connector alone.
#[derive(Debug)]
pub struct PathIndex<'a> {
    chart: &'a Statechart,
    by_name: BTreeMap<&'a str, Vec<NodeId>>,
    /// The regions by their numbers.
    by_number: BTreeMap<usize, Vec<NodeId>>,
    /// By node: the transitions into it and out of it.
    into: Vec<Vec<TransitionId>>,
    out: Vec<Vec<TransitionId>>,
}

impl<'a> PathIndex<'a> {
    /// The index of a chart.
    pub fn new(chart: &'a Statechart) -> PathIndex<'a> {
        let count = chart.nodes().len();
        let mut by_name: BTreeMap<&str, Vec<NodeId>> = BTreeMap::new();
        for (id, node) in chart.nodes() {
            by_name.entry(node.name.as_str()).or_default().push(id);
        }
        let mut by_number: BTreeMap<usize, Vec<NodeId>> = BTreeMap::new();
        for (id, _) in chart.nodes() {
            for (&child, number) in chart.children(id).iter().zip(1..) {
                if is_region(chart, child) {
                    by_number.entry(number).or_default().push(child);
                }
            }
        }
        let (mut into, mut out) = (vec![Vec::new(); count], vec![Vec::new(); count]);
        for (id, transition) in chart.transitions() {
            for (ends, node) in [(&mut into, transition.target), (&mut out, transition.source)] {
                if let Some(ends) = ends.get_mut(node.0 as usize) {
                    ends.push(id);
                }
            }
        }
        PathIndex { chart, by_name, by_number, into, out }
    }

    /// The chart.
    pub fn chart(&self) -> &'a Statechart {
        self.chart
    }

    /// The nodes that a path names, in the order of the chart.
    pub fn nodes(&self, path: &Path) -> Vec<NodeId> {
        let named = |name: &str| self.by_name.get(name).map(Vec::as_slice).unwrap_or_default();
        let mut candidates = match (path.last_name(), path.name_around(), path.region_around()) {
            (Some(name), ..) => named(name).to_vec(),
            (None, Some(name), _) => self.inside(named(name)),
            (None, None, Some(number)) => {
                // a state may be named by a number too
                let regions = self.by_number.get(&number).into_iter().flatten().copied();
                let around: Vec<NodeId> = regions.chain(named(&number.to_string()).iter().copied()).collect();
                self.inside(&around)
            }
            (None, None, None) => self.chart.nodes().map(|(id, _)| id).collect(),
        };
        candidates.retain(|&id| path.matches(self.chart, id));
        candidates.sort_unstable();
        candidates.dedup();
        candidates
    }

    /// The nodes that a path may name as a child of some nodes: their children, and those of the
    /// ANDs and regions among these, which it may leave out.
    fn inside(&self, nodes: &[NodeId]) -> Vec<NodeId> {
        let mut open: Vec<NodeId> = nodes.to_vec();
        let mut found = Vec::new();
        while let Some(node) = open.pop() {
            for &child in self.chart.children(node) {
                found.push(child);
                if may_be_left_out(self.chart, child) {
                    open.push(child);
                }
            }
        }
        found
    }

    /// The transitions whose source and target two paths name, in the order of the chart.
    pub fn transitions(&self, source: &Path, target: &Path) -> Vec<TransitionId> {
        let at = |path: &Path, ends: &[Vec<TransitionId>]| -> Vec<TransitionId> {
            self.nodes(path).into_iter().flat_map(|id| ends[id.0 as usize].iter().copied()).collect()
        };
        let is_named_by_source = target.last_name().is_none() && source.last_name().is_some();
        let mut found = match is_named_by_source {
            true => at(source, &self.out),
            false => at(target, &self.into),
        };
        found.retain(|&id| {
            let transition = self.chart.transition(id);
            match is_named_by_source {
                true => target.matches(self.chart, transition.target),
                false => source.matches(self.chart, transition.source),
            }
        });
        found.sort_unstable();
        found
    }
}
