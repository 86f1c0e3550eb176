//! Finds nodes by their paths, in charts of any size.

use std::collections::BTreeMap;

use crate::statechart::{NodeId, Statechart};

/// The nodes of a chart by the last segment of their path, computed on first use.
#[derive(Default)]
pub(crate) struct PathIndex {
    by_segment: std::cell::OnceCell<BTreeMap<String, Vec<NodeId>>>,
}

impl PathIndex {
    /// Like [`Statechart::find`].
    pub(crate) fn find(&self, chart: &Statechart, path: &str) -> Option<NodeId> {
        let last = path.rsplit('/').next()?;
        let by_segment = self.by_segment.get_or_init(|| {
            let mut by_segment: BTreeMap<String, Vec<NodeId>> = BTreeMap::new();
            for (segment, (id, _)) in chart.segments().into_iter().zip(chart.nodes()) {
                by_segment.entry(segment).or_default().push(id);
            }
            by_segment
        });
        let mut fitting = by_segment.get(last)?.iter().filter(|&&id| chart.is_at(id, path));
        let found = fitting.next()?;
        fitting.next().is_none().then_some(*found)
    }
}
