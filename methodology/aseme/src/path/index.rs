//! Lookup of many paths in one chart.

use std::collections::BTreeMap;

use yase::{NodeId, Statechart, TransitionId};

use super::Path;

/// The nodes of a chart by name, and the transitions at each: what a path names is found without a
/// look at the whole chart, unless the path ends with a connector or a wildcard.
#[derive(Debug)]
pub struct PathIndex<'a> {
    chart: &'a Statechart,
    by_name: BTreeMap<&'a str, Vec<NodeId>>,
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
        let (mut into, mut out) = (vec![Vec::new(); count], vec![Vec::new(); count]);
        for (id, transition) in chart.transitions() {
            for (ends, node) in [(&mut into, transition.target), (&mut out, transition.source)] {
                if let Some(ends) = ends.get_mut(node.0 as usize) {
                    ends.push(id);
                }
            }
        }
        PathIndex { chart, by_name, into, out }
    }

    /// The chart.
    pub fn chart(&self) -> &'a Statechart {
        self.chart
    }

    /// The nodes that a path names, in the order of the chart.
    pub fn nodes(&self, path: &Path) -> Vec<NodeId> {
        match path.last_name() {
            Some(name) => {
                let named = self.by_name.get(name).map(Vec::as_slice).unwrap_or_default();
                named.iter().copied().filter(|&id| path.matches(self.chart, id)).collect()
            }
            None => {
                let all = self.chart.nodes().map(|(id, _)| id);
                all.filter(|&id| path.matches(self.chart, id)).collect()
            }
        }
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
