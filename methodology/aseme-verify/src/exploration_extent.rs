//! The explored part of a state space.

use std::collections::BTreeSet;

use yase::NodeId;
use yase_explore::{Exploration, ExplorationStop, LabelledGraph};

/// The extent of an exploration.
#[derive(Clone, PartialEq, Eq, Debug)]
#[non_exhaustive]
pub struct ExplorationExtent {
    /// The number of machine states found.
    pub states: usize,
    /// The number of distinct configurations among them.
    pub configurations: usize,
    /// Whether the exploration is complete.
    pub is_finished: bool,
    /// Why it is not.
    pub stop: Option<ExplorationStop>,
    /// The events of which more may wait than are distinguished.
    pub overflowing: Vec<String>,
}

impl ExplorationExtent {
    pub(crate) fn of(found: &Exploration) -> ExplorationExtent {
        ExplorationExtent {
            states: found.states().len(),
            configurations: found.configurations(),
            is_finished: found.is_finished(),
            stop: found.stop(),
            overflowing: found.overflowing().into_iter().map(str::to_owned).collect(),
        }
    }

    pub(crate) fn of_labelled(found: &LabelledGraph) -> ExplorationExtent {
        let configurations: BTreeSet<&[NodeId]> =
            found.states().iter().map(|state| state.configuration.as_slice()).collect();
        ExplorationExtent {
            states: found.states().len(),
            configurations: configurations.len(),
            is_finished: found.is_finished(),
            stop: found.stop(),
            overflowing: found.overflowing().into_iter().map(str::to_owned).collect(),
        }
    }
}
