//! Where a person, or an editor, has put the parts of a chart.

use std::collections::BTreeMap;

use super::{NodeId, TransitionId};

/// A place or a size: pixels to the right and down.
pub type Point = (f64, f64);

/// Where the parts of a chart are drawn, as far as that is said. It means nothing to a machine.
///
/// Places count from where the content of a composite begins, below its title: of a node, the one it lies in; of bends, the innermost one that holds both ends.
#[derive(Clone, PartialEq, Debug, Default)]
pub struct Layout {
    /// What is said of nodes.
    pub frames: BTreeMap<NodeId, Frame>,
    /// The corners of transitions, from source to target.
    pub bends: BTreeMap<TransitionId, Vec<Point>>,
}

impl Layout {
    /// Whether nothing is said.
    pub fn is_empty(&self) -> bool {
        self.frames.is_empty() && self.bends.is_empty()
    }
}

/// Where a node is drawn, and how large.
#[derive(Clone, Copy, PartialEq, Debug, Default)]
pub struct Frame {
    /// Its upper left corner.
    pub at: Option<Point>,
    /// Its width and height, at least: a drawing makes room for what is written or drawn inside.
    pub size: Option<Point>,
}

impl Frame {
    /// Whether nothing is said.
    pub fn is_empty(&self) -> bool {
        *self == Frame::default()
    }
}
