//! Liveness formulas, roles, and their transformation into statecharts.
//!
//! A role is text: formulas over activities, and refinements of the statechart that the formulas
//! describe. [`Srm`] is a role as data, [`role_to_statechart`] transforms it into a
//! [`Statechart`], which `yase` compiles and runs. The transformation has three steps:
//!
//! 1. [`liveness`] parses formulas (`decision = Wait . (Search | act)`) into a flat arena of terms.
//! 2. [`transform`] expands each term by the template of its operator into states, connectors and
//!    transitions.
//! 3. [`refine`] applies the role's entries to the transitions and states: events, guards,
//!    actions, priorities.
//!
//! Entries refer to states by their names in the formula ([`path`]), never by label or index, so
//! they stay valid when the formula is edited. Entries that no longer match are reported; none is
//! dropped. For the same reason a chart keeps names as they are written. The labels and encoded
//! [`names`] of the thesis's model files are computed on output: [`to_json`] for tools, [`to_text`]
//! for people.
//!
//! Parsing never fails: each parser returns what it understood and a list of [`Diagnostic`]s, each
//! with a code, a position and a hint. The crate opens no file and does not run charts. The other
//! models of the ASEME method are in `aseme-models`, verification is in `aseme-verify`, and
//! generated Rust code in `aseme-codegen`.
//!
//! ```
//! use yase::Source;
//!
//! let source = Source::new("walker.srm", "
//! Role: walker
//! Liveness:
//! walker = Stand . ( Search | approach )   # one of the two
//! approach = Walkω
//! Constants:
//! near = 25 cm
//! Transitions:
//! CONDITION -> Search : [!Ball.found]
//! CONDITION -> approach : [Ball.distance > near]
//! *~ -> END : [false]
//! ");
//! let (chart, findings) = aseme::statechart_of_role(&source);
//! assert_eq!(findings, []);
//! assert_eq!(aseme::to_text(&chart), "\
//! walker OR
//!   START
//!     -> Stand
//!   Stand BASIC
//!     -> (Search|approach)
//!   (Search|approach) OR
//!     -> END
//!     START
//!       -> CONDITION
//!     CONDITION
//!       -> Search : [!Ball.found]
//!       -> approach : [Ball.distance > near]
//!     Search BASIC
//!       -> END
//!     approach OR
//!       -> END : [false]
//!       START
//!         -> Walk
//!       Walk BASIC
//!         -> Walk
//!     END
//!   END
//! near = 0.25
//! ");
//! ```

mod json;
pub mod layout;
pub mod liveness;
pub mod names;
pub mod path;
pub mod refine;
pub mod srm;
pub mod text;
pub mod transform;
mod tree_text;
pub mod xmi;

pub use json::to_json;
pub use liveness::Liveness;
pub use srm::{Srm, SrmFile};
pub use transform::{liveness_to_statechart, role_to_statechart};
pub use tree_text::to_text;

use std::sync::Arc;

use yase::{Diagnostic, Source, Statechart};

/// The statechart that the text of a role describes, and all findings about the text, in its order.
///
/// If the formulas have errors, the refinements are not checked, because the states they refer to
/// are unknown.
pub fn statechart_of_role(source: &Arc<Source>) -> (Statechart, Vec<Diagnostic>) {
    let (file, mut diagnostics) = SrmFile::parse(source.text.as_str());
    let (chart, findings) = match have_formula_errors(&diagnostics) {
        true => liveness_to_statechart(&file.srm().liveness),
        false => role_to_statechart(file.srm()),
    };
    diagnostics.extend(findings);
    diagnostics.sort_by_key(|diagnostic| diagnostic.span);
    (chart, diagnostics.into_iter().map(|diagnostic| diagnostic.in_source(source)).collect())
}

/// Whether findings about a role include errors of its formulas, from which more would follow: the
/// states that its refinements refer to are not known.
pub fn have_formula_errors(findings: &[Diagnostic]) -> bool {
    findings.iter().any(|finding| finding.is_error() && ("E0200".."E0220").contains(&finding.code))
}
