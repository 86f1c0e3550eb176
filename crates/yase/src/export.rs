//! Charts as pictures, and as the text of other tools.
//!
//! [`to_svg`] draws a chart, [`to_svg_marked`] with some of its parts set apart. The other functions write it for a tool: [`to_xstate`] for XState and whatever reads its machines, [`to_mermaid`] and
//! [`to_plantuml`] for documents, [`to_dot`] for Graphviz. What such a tool cannot say is in [`Exported::lost`], node by node and transition by
//! transition: nothing vanishes in silence.
//!
//! All of them take any chart, also one that would not run, and give the same text for the same chart.
//!
//! ```
//! use yase::expression::parse_transition;
//! use yase::{Node, NodeKind, Statechart, Transition, export};
//!
//! let mut lamp = Statechart::new("lamp");
//! let start = lamp.add(Statechart::ROOT, Node::new(NodeKind::Start, ""));
//! let off = lamp.add(Statechart::ROOT, Node::new(NodeKind::Basic, "off"));
//! let on = lamp.add(Statechart::ROOT, Node::new(NodeKind::Basic, "on"));
//! for (source, target, text) in [(start, off, ""), (off, on, "button [!broken]"), (on, off, "button")] {
//!     lamp.connect(Transition { expression: parse_transition(text).0, ..Transition::new(source, target) });
//! }
//!
//! let mermaid = export::to_mermaid(&lamp);
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
//! | code | what the target cannot say |
//! |---|---|
//! | E0701 | a kind of node; it is shown as another |
//! | E0702 | something that is said of a node; it is shown and means nothing |
//! | E0703 | something that is said of a transition; it is shown and means nothing |
//! | E0704 | constants; they stand in a comment |
//! | E0705 | an end of a transition; it is shown at the state around it |
//! | E0706 | a transition at all: it is left out (an error) |
//! | E0707 | the moment at which a transition happens; it may happen earlier, later or otherwise |
//! | E0708 | the chart at all: its tree is broken, and there is no text (an error) |

mod dot;
mod ids;
mod json;
mod lost;
mod marks;
mod mermaid;
pub mod notation;
mod outline;
mod plantuml;
mod svg;
mod xstate;

pub use dot::{to_dot, to_dot_marked};
pub use marks::{Mark, Marks};
pub use mermaid::to_mermaid;
pub use plantuml::to_plantuml;
pub use svg::{to_svg, to_svg_marked};
pub use xstate::to_xstate;

use crate::diagnostic::Diagnostic;

/// A chart as text for another tool.
#[derive(Clone, PartialEq, Eq, Debug)]
pub struct Exported {
    /// The text.
    pub text: String,
    /// What of the chart the tool cannot say. The places of these findings are empty: they name nodes by their paths.
    pub lost: Vec<Diagnostic>,
}
