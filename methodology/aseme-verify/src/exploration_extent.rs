//! How much of a state space was explored.

/// The extent of an exploration.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
#[non_exhaustive]
pub struct ExplorationExtent {
    /// The number of machine states found.
    pub states: usize,
    /// The number of distinct configurations among them.
    pub configurations: usize,
    /// Whether the exploration is complete.
    pub is_finished: bool,
}
