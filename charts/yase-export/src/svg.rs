//! A chart as an SVG drawing.
//!
//! Formulas give series-parallel charts, which are drawn as nested boxes: sequences from top to
//! bottom, alternatives side by side, regions with dashed borders. The same layout by ranks also
//! draws other charts, less compactly: back edges go around the boxes of their composite,
//! transitions across borders are routed individually. States have the names of their formula.
//!
//! Positions in the chart's [`Layout`](yase::statechart::Layout) are kept; elements without one are
//! placed automatically.

mod draw;
mod drawing_layout;
mod flow;
mod grid;
mod layout;
pub(crate) mod lettering;
mod placed;
mod ranks;
mod rectangle;
mod route;

pub(crate) use layout::layout;

use super::highlights::Highlights;
use yase::statechart::Statechart;

/// The chart as an SVG document.
///
/// OR states are titled yellow boxes, AND states blue boxes of dashed regions, BASIC states green
/// boxes with round corners; START is a dot, END a dot in a ring, CONDITION a circle with a C,
/// JUNCTION a small dot, CHOICE a diamond, FORK and JOIN are bars, histories circles with H and H*,
/// TERMINATE is a cross, an entry point a circle, an exit point a circle with a cross. Transitions
/// with the guard `[false]` are grey. Transitions whose ends do not exist are not drawn.
pub fn to_svg(chart: &Statechart) -> String {
    to_svg_marked(chart, &Highlights::default())
}

/// The same with highlighted parts in the colours of their marks.
pub fn to_svg_marked(chart: &Statechart, marks: &Highlights) -> String {
    draw::document(chart, &layout(chart, marks), marks)
}
