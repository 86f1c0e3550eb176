//! Names of nodes in diagnostics of a chart.

use std::cell::OnceCell;

use super::{NodeId, StateNames, Statechart};

/// The most characters of a path in a diagnostic: a composite of a formula is named by a whole
/// term.
const MAX_PATH_LENGTH: usize = 60;

/// The names of a chart's nodes in diagnostics: their paths, or [short names](StateNames) of those
/// whose paths are long.
#[derive(Debug)]
pub struct BriefNames<'a> {
    chart: &'a Statechart,
    /// Computed for the first node that needs one.
    names: OnceCell<StateNames>,
}

impl<'a> BriefNames<'a> {
    /// The names of the nodes of a chart.
    pub fn new(chart: &'a Statechart) -> BriefNames<'a> {
        BriefNames { chart, names: OnceCell::new() }
    }

    /// The name of a node.
    pub fn name(&self, node: NodeId) -> String {
        let path = self.chart.path(node);
        match path.chars().nth(MAX_PATH_LENGTH) {
            None => path,
            Some(_) => self.names.get_or_init(|| StateNames::of(self.chart)).name(node).to_owned(),
        }
    }
}
