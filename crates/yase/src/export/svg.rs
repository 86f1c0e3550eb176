//! A chart as a drawing.
//!
//! Formulas make series-parallel charts, and those are drawn as boxes in boxes: what follows each other stands below each other,
//! what is chosen from stands side by side, regions have dashed borders. The same layout by ranks draws charts of other origin, less finely:
//! transitions that lead back go around the boxes of their composite, those across borders look for a way of their own. States bear the
//! names they have in the formula.
//!
//! What the chart's [`Layout`](crate::statechart::Layout) has a place for stands there; without any, nothing is looked up.

mod draw;
mod flow;
mod grid;
mod layout;
pub(in crate::export) mod lettering;
mod placed;
mod ranks;
mod rectangle;
mod route;

use super::marks::Marks;
use crate::statechart::Statechart;

/// The chart as an SVG document.
///
/// OR states are titled yellow boxes, AND states blue boxes of dashed regions, BASIC states green boxes with round corners; START is a dot, END a
/// dot in a ring, CONDITION a circle with a C, JUNCTION a small dot, CHOICE a diamond, FORK and JOIN are bars, histories circles with H and H*,
/// TERMINATE is a cross, a point of entry a circle, one of exit a circle with a cross. Transitions whose guard is `[false]` are grey. One
/// whose ends do not exist is not drawn.
pub fn to_svg(chart: &Statechart) -> String {
    to_svg_marked(chart, &Marks::default())
}

/// The same, with the parts that are marked in the colours of their marks.
pub fn to_svg_marked(chart: &Statechart, marks: &Marks) -> String {
    draw::document(chart, &layout::layout(chart, marks), marks)
}
