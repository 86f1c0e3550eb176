//! Model files of all kinds and formats: detected by content, read, and written in another format
//! of the same kind.
//!
//! | kind | formats |
//! |---|---|
//! | SAG, SUC, AIP | text, XMI |
//! | SRM | text, XMI, and for one role the text that is refined and run |
//! | FT | text |
//! | EAC, IAC, the statechart of a role | text, XMI in four dialects, SCXML; Rust, which is only written |
//!
//! Only the text form stores the layout of a chart: the original editors keep layouts in separate
//! diagram files.
//!
//! [`Model::write`] lists what a format cannot represent.

mod chart;
mod comments;
mod read;
mod scxml;
mod write;

use crate::aip::Aip;
use crate::functionality::FunctionalityTable;
use crate::iac::{Dialect, Iac};
use crate::roles::SystemRoles;
use crate::sag::Sag;
use crate::suc::Suc;
use aseme::srm::SrmFile;

pub(crate) use chart::chart_of;
pub use read::read;
pub(crate) use read::{KINDS, first_word};
pub use write::WrittenModel;

/// A model of any kind.
#[derive(Clone, PartialEq, Debug)]
#[non_exhaustive]
pub enum Model {
    /// Actors and goals.
    Sag(Sag),
    /// Roles and use cases.
    Suc(Suc),
    /// Protocols.
    Aip(Aip),
    /// The roles of a system.
    Srm(SystemRoles),
    /// One role, as it is refined and run.
    Role(Box<SrmFile>),
    /// A functionality table.
    Ft(FunctionalityTable),
    /// A statechart.
    Chart(Iac),
}

/// A file format.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
#[non_exhaustive]
pub enum Format {
    /// The text form that all models share.
    Text,
    /// The text of one role.
    Role,
    /// XMI as the tools write it; for statecharts that of 2018.
    Xmi,
    /// A dialect of XMI for statecharts.
    Statechart(Dialect),
    /// SCXML, for statecharts.
    Scxml,
    /// Rust, for statecharts of events alone: see [`yase_codegen::flatten`].
    Rust,
}

impl Format {
    /// Names of formats on a command line.
    pub const WORDS: [(&'static str, Format); 9] = [
        ("text", Format::Text),
        ("role", Format::Role),
        ("xmi", Format::Xmi),
        ("xmi-2010", Format::Statechart(Dialect::MultiRoot)),
        ("xmi-flat", Format::Statechart(Dialect::Flat)),
        ("xmi-2012", Format::Statechart(Dialect::Nested2012)),
        ("xmi-2018", Format::Statechart(Dialect::Nested2018)),
        ("scxml", Format::Scxml),
        ("rust", Format::Rust),
    ];

    /// Its name on a command line.
    pub fn word(self) -> &'static str {
        Format::WORDS.iter().find(|(_, format)| *format == self).map_or("", |(word, _)| word)
    }

    /// The format of files with this extension, if known: the extensions of the original editors.
    pub fn of_ending(ending: &str) -> Option<Format> {
        Some(match ending {
            "model" => Format::Statechart(Dialect::MultiRoot),
            "stct" => Format::Statechart(Dialect::Nested2018),
            "xmi" => Format::Xmi,
            "scxml" => Format::Scxml,
            "rs" => Format::Rust,
            "txt" => Format::Text,
            _ => return None,
        })
    }
}

impl Model {
    /// The kind of the model.
    pub fn kind(&self) -> &'static str {
        match self {
            Model::Sag(_) => "SAG",
            Model::Suc(_) => "SUC",
            Model::Aip(_) => "AIP",
            Model::Srm(_) | Model::Role(_) => "SRM",
            Model::Ft(_) => "FT",
            Model::Chart(chart) if chart.kind == crate::iac::ChartKind::Inter => "EAC",
            Model::Chart(_) => "IAC",
        }
    }
}
