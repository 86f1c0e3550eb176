//! From a liveness formula to a statechart: the models of AMOLA, the modeling language of the ASEME method, as text.
//!
//! What a role does is written as formulas over activities, each operator of which has a template of states and
//! transitions. [`Srm`] is a role read from text, [`srm_to_iac`] turns it into a [`Statechart`], which `yase` checks and runs:
//!
//! 1. [`liveness`] reads formulas (`decision = Wait . (Search | act)`) into a flat arena of terms.
//! 2. [`transform`] expands them, term by term, into states, connectors and transitions.
//! 3. [`refine`] puts onto the transitions what the role says of them: event, guard, actions.
//!
//! A transition is named by the states it joins, as they stand in the formula ([`path`]), never by a label or an index. That is why a
//! formula can be edited while its refinements stay in force; those that no longer fit are named, none is dropped. For the same reason
//! a chart keeps names as they were written, and the labels and encoded [`names`] of the thesis's model files are computed when
//! one is written: [`to_json`] for tools, [`to_text`] and [`to_svg`] for people.
//!
//! Around the role stand the other models of the method: actors and goals ([`Sag`]), use cases ([`Suc`]), protocols ([`Aip`]), all roles of a
//! system ([`SystemRoles`]), the functionality table ([`FunctionalityTable`]), and statecharts as model files have them ([`Iac`], for protocols too).
//! Each has a text form, and the XMI of the method's original tools; [`convert`] tells files apart, reads them, and writes them in another format, with a
//! list of what that cannot say. [`transformations`] leads from one to the next, from goals to charts.
//!
//! [`check`] looks for what no grammar sees: in structure, in what guards say, and in all that a chart can do.
//!
//! Reading never fails. Every function that reads returns what it understood, and what was wrong as [`Diagnostic`]s with a code, a place
//! and a hint. Nothing here opens a file but [`build`], which is for build scripts, and nothing here knows how a chart is run.
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
//! let (chart, findings) = aseme::statechart_of(&source);
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

pub mod aip;
pub mod build;
pub mod check;
mod components;
pub mod convert;
pub mod diff;
mod document;
pub mod functionality;
pub mod generate;
pub mod iac;
mod json;
mod layout;
pub mod liveness;
mod meta;
pub mod mutation;
pub mod names;
pub mod ontology;
mod outline;
pub mod path;
pub mod properties;
pub mod refine;
pub mod regenerate;
pub mod roles;
pub mod sag;
pub mod scenario;
pub mod srm;
pub mod suc;
mod text;
pub mod transform;
pub mod transformations;
mod xmi;

pub use aip::Aip;
pub use functionality::FunctionalityTable;
pub use iac::Iac;
pub use json::to_json;
pub use liveness::Liveness;
pub use outline::to_text;
pub use roles::SystemRoles;
pub use sag::Sag;
pub use srm::{Srm, SrmFile};
pub use suc::Suc;
pub use transform::{liveness_to_statechart, srm_to_iac};
pub use yase::export::to_svg;

use std::sync::Arc;

use yase::{Diagnostic, Source, Statechart};

/// The statechart that a model's text describes, with every finding about the text: a role's, a protocol's, or one in a file of its own, in any format.
///
/// If the formulas themselves have errors, the refinements are not judged: what they name is not known.
pub fn statechart_of(source: &Arc<Source>) -> (Statechart, Vec<Diagnostic>) {
    let (chart, mut diagnostics) = convert::chart_of(source).unwrap_or_else(|| role_statechart(source));
    diagnostics.sort_by_key(|diagnostic| diagnostic.span);
    (chart, diagnostics.into_iter().map(|diagnostic| diagnostic.in_source(source)).collect())
}

fn role_statechart(source: &Source) -> (Statechart, Vec<Diagnostic>) {
    let (file, mut diagnostics) = SrmFile::parse(source.text.as_str());
    let (chart, findings) = match diagnostics.iter().any(is_about_formulas) {
        true => liveness_to_statechart(&file.srm().liveness),
        false => srm_to_iac(file.srm()),
    };
    diagnostics.extend(findings);
    (chart, diagnostics)
}

fn is_about_formulas(diagnostic: &Diagnostic) -> bool {
    diagnostic.is_error() && ("E0200".."E0220").contains(&diagnostic.code)
}
