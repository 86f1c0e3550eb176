//! The models of the ASEME method: formats, conversions and transformations.
//!
//! | model | type |
//! |---|---|
//! | system actors and goals (SAG) | [`Sag`] |
//! | use cases (SUC) | [`Suc`] |
//! | agent interaction protocols (AIP) | [`Aip`] |
//! | roles of a system (SRM) | [`SystemRoles`]; one refined role is [`aseme::SrmFile`] |
//! | functionality table (FT) | [`FunctionalityTable`] |
//! | statecharts of protocols and roles (EAC, IAC) | [`Iac`] |
//!
//! Each model has a text form, and the XMI of the method's original tools. [`convert`] detects the
//! kind and format of a file, reads it, and writes it in another format with a list of what that
//! format cannot represent. [`transformations`] derives one model from another, from goals to
//! charts. [`diff`] compares two statecharts, [`regenerate`] carries refinements over to a
//! regenerated chart, and [`ontology`] lists the messages that a chart uses. [`edit`] makes edits
//! of a model as few replacements of its text.
//!
//! An [`Iac`] keeps a model file as it is written, faults included, so that reading a file never
//! changes it; a [`Statechart`] is its meaning. Models are data, and all functions here take text
//! as an argument: the crate opens no file.
//!
//! ```
//! use aseme_models::convert::{Format, Model};
//! use aseme_models::{convert, statechart_of};
//! use yase::Source;
//!
//! let source = Source::new("patrol.srm", "patrol = (look . walk)~");
//! let (chart, findings) = statechart_of(&source);
//! assert_eq!(findings, []);
//! assert_eq!(chart.name, "patrol");
//!
//! let Some((Model::Role(role), Format::Role)) = convert::read(&source).0 else { panic!("a role") };
//! let system = Model::Role(role).write(Format::Xmi, "").expect("roles can be written as XMI");
//! assert!(system.text.contains("liveness=\"patrol"));
//! ```

pub mod aip;
pub mod convert;
pub mod diagram;
pub mod diff;
mod document;
mod drawing;
pub mod edit;
pub mod functionality;
pub mod iac;
mod meta;
pub mod ontology;
pub mod regenerate;
pub mod roles;
pub mod sag;
pub mod suc;
pub mod transformations;
mod xmi;

pub use aip::Aip;
pub use drawing::drawable_chart_of;
pub use functionality::FunctionalityTable;
pub use iac::Iac;
pub use roles::SystemRoles;
pub use sag::Sag;
pub use suc::Suc;

use std::sync::Arc;

use yase::{Diagnostic, Source, Statechart};

/// The statechart that a model describes, in any format, and all findings about the text, in its
/// order.
///
/// The model is a role, a system of one role, or a chart (IAC, EAC); for a model of another kind
/// the chart is empty and a finding says so. A single role is read by
/// [`aseme::statechart_of_role`].
pub fn statechart_of(source: &Arc<Source>) -> (Statechart, Vec<Diagnostic>) {
    let Some((chart, mut diagnostics)) = convert::chart_of(source) else {
        return aseme::statechart_of_role(source);
    };
    diagnostics.sort_by_key(|diagnostic| diagnostic.span);
    (chart, diagnostics.into_iter().map(|diagnostic| diagnostic.in_source(source)).collect())
}
