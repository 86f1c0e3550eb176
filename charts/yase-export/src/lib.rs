//! Charts as drawings, and as text for other tools.
//!
//! [`to_svg`] draws a chart, [`to_svg_marked`] with highlighted parts; [`compact`] leaves out what
//! only formulas need, [`to_picture`] gives a viewer the shapes with the numbers of nodes and
//! transitions. The other functions write it for a tool: [`to_xstate`] for XState and
//! compatible libraries, [`to_mermaid`] and [`to_plantuml`] for documents, [`to_dot`] for Graphviz.
//! [`Exported::lost`] lists everything that the tool cannot express, by node and transition:
//! nothing is omitted silently.
//!
//! All functions accept any chart, even an invalid one, and give equal texts for equal charts.
//!
//! ```
//! use yase::expression::parse_transition;
//! use yase::{Node, NodeKind, Statechart, Transition};
//!
//! let mut lamp = Statechart::new("lamp");
//! let start = lamp.add(Statechart::ROOT, Node::new(NodeKind::Start, ""));
//! let off = lamp.add(Statechart::ROOT, Node::new(NodeKind::Basic, "off"));
//! let on = lamp.add(Statechart::ROOT, Node::new(NodeKind::Basic, "on"));
//! for (source, target, text) in [(start, off, ""), (off, on, "button [!broken]"), (on, off, "button")] {
//!     lamp.connect(Transition { expression: parse_transition(text).0, ..Transition::new(source, target) });
//! }
//!
//! let mermaid = yase_export::to_mermaid(&lamp);
//! assert_eq!(mermaid.lost, []);
//! assert_eq!(mermaid.text, r#"stateDiagram-v2
//!   state "lamp" as s_lamp {
//!     state "off" as s_off
//!     state "on" as s_on
//!     [*] --> s_off
//!     s_off --> s_on : button [!broken]
//!     s_on --> s_off : button
//!   }
//! "#);
//! ```
//!
//! # What is lost
//!
//! | code | what the target cannot represent |
//! |---|---|
//! | E0701 | a kind of node; it is shown as another |
//! | E0702 | a property of a node; it is shown without effect |
//! | E0703 | a property of a transition; it is shown without effect |
//! | E0704 | constants; they become a comment |
//! | E0705 | an end of a transition; it is shown at the state around it |
//! | E0706 | a transition: it is omitted (an error) |
//! | E0707 | the time at which a transition is taken |
//! | E0708 | the chart: its tree is broken, and there is no text (an error) |

mod compact;
mod dot;
mod highlights;
mod ids;
mod json;
mod loss_report;
mod mermaid;
pub mod notation;
mod outline;
mod picture;
mod plantuml;
mod svg;
mod xstate;

pub use compact::compact;
pub use dot::{to_dot, to_dot_marked};
pub use highlights::{Highlights, Mark};
pub use mermaid::to_mermaid;
pub use picture::to_picture;
pub use plantuml::to_plantuml;
pub use svg::{to_svg, to_svg_marked};
pub use xstate::to_xstate;

use yase::diagnostic::Diagnostic;

/// A chart as text for another tool.
#[derive(Clone, PartialEq, Eq, Debug)]
pub struct Exported {
    /// The text.
    pub text: String,
    /// Losses: properties of the chart that the tool cannot express. The spans of these diagnostics
    /// are empty; they name nodes by their paths.
    pub lost: Vec<Diagnostic>,
}
