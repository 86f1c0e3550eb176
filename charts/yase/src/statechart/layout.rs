//! The positions of the parts of a chart in drawings.

use std::collections::BTreeMap;

use super::{NodeId, TransitionId};

/// A position or a size: pixels to the right and down.
pub type Point = (f64, f64);

/// The positions of the parts of a chart, as far as they are specified. Without effect on
/// execution.
///
/// The origin is where the content of a composite begins, below its title: for a node, the
/// composite that contains it; for bends, the innermost one that contains both ends.
#[derive(Clone, PartialEq, Debug, Default)]
pub struct Layout {
    /// The frames of nodes.
    pub frames: BTreeMap<NodeId, Frame>,
    /// The corners of transitions, from source to target.
    pub bends: BTreeMap<TransitionId, Vec<Point>>,
}

impl Layout {
    /// Whether nothing is specified.
    pub fn is_empty(&self) -> bool {
        self.frames.is_empty() && self.bends.is_empty()
    }
}

/// The position and size of a node.
#[derive(Clone, Copy, PartialEq, Debug, Default)]
pub struct Frame {
    /// Its upper left corner.
    pub at: Option<Point>,
    /// Its minimum width and height: a drawing makes room for text and content inside.
    pub size: Option<Point>,
}

impl Frame {
    /// Whether nothing is specified.
    pub fn is_empty(&self) -> bool {
        *self == Frame::default()
    }
}
