//! The states.

use ::monas::generated::NodeId;

/// The nodes of the chart, in its order. Each is named by the shortest unique end of its path.
#[allow(non_camel_case_types, clippy::upper_case_acronyms)] // names as in the model
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Debug)]
pub enum State {
    /// OR: `player`
    player,
    /// START: `player/START`
    START,
    /// BASIC: `player/look`
    look,
    /// BASIC: `player/kick`
    kick,
    /// BASIC: `player/passBall`
    passBall,
    /// END: `player/END`
    END,
}

impl From<State> for NodeId {
    fn from(state: State) -> NodeId {
        NodeId(state as u32)
    }
}
