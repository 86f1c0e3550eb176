//! A chart as a drawing.
//!
//! Formulas make series-parallel charts, and those are drawn as boxes in boxes: what follows each other stands below each other,
//! what is chosen from stands side by side, regions have dashed borders. The same layout by ranks draws charts of other origin, less finely:
//! transitions that lead back or across borders go around the boxes. States bear the names they have in the formula.

mod draw;
mod flow;
mod layout;
mod lettering;
mod ranks;

use yase::Statechart;

/// The chart as an SVG document.
///
/// OR states are titled yellow boxes, AND states blue boxes of dashed regions, BASIC states green boxes with round corners; START is a dot, END a
/// dot in a ring, CONDITION a circle with a C. Transitions whose guard is `[false]` are grey.
pub fn to_svg(chart: &Statechart) -> String {
    draw::document(chart, &layout::layout(chart))
}
