//! Writing of model files.

use yase::{Diagnostic, Semantics, Span};
use yase_codegen::flatten::flatten;

use super::{Format, Model, comments, scxml};
use crate::document::ItemDocument;
use crate::iac::{self, Dialect};
use crate::meta::{TypedModel, to_text, to_xmi};
use crate::roles::SystemRoles;
use crate::xmi;
use aseme::srm::SrmFile;
use aseme::text;

/// Charts with more states are not written as flat Rust: the code would be unreadable.
const MOST_STATES: usize = 1_000;

/// A model as text, and what the format cannot represent.
#[derive(Clone, PartialEq, Debug)]
pub struct WrittenModel {
    /// The text.
    pub text: String,
    /// Parts that the format cannot represent, with positions in the file that was read (E0620,
    /// E0850).
    pub lost: Vec<Diagnostic>,
}

type WriteResult = Result<WrittenModel, Vec<Diagnostic>>;

impl Model {
    /// The model in the text form shared by all models; a refined role has its own form.
    pub fn to_text(&self) -> String {
        match (self.document(), self) {
            (Some(document), _) => document.to_string(),
            (None, Model::Role(role)) => role.text().into(),
            (None, _) => String::new(),
        }
    }

    /// The model in a format, as far as the format can represent it. Comments of the original text
    /// are kept if the format has comments.
    ///
    /// # Errors
    /// The format does not exist for this kind of model (E0851), or the model cannot be written.
    pub fn write(&self, format: Format, original: &str) -> WriteResult {
        let mut written = match (self, format) {
            (Model::Role(role), Format::Role | Format::Text) => return Ok(WrittenModel::of(role.text())),
            (Model::Role(role), Format::Xmi) => {
                let (roles, lost) = SystemRoles::from_role(role.srm());
                WrittenModel { lost, ..xmi(&roles)? }
            }
            (Model::Role(role), Format::Scxml | Format::Rust | Format::Statechart(_)) => {
                return chart_of_role(role)?.write(format, original);
            }
            (Model::Srm(roles), Format::Role) => {
                roles.to_role().map(|(text, lost)| WrittenModel { text, lost })?
            }
            (Model::Chart(chart), Format::Rust) => return rust(chart, original),
            (_, Format::Text) => return Ok(self.with_comments(original)),
            (Model::Sag(model), Format::Xmi) => xmi(model)?,
            (Model::Suc(model), Format::Xmi) => xmi(model)?,
            (Model::Aip(model), Format::Xmi) => xmi(model)?,
            (Model::Srm(model), Format::Xmi) => xmi(model)?,
            (Model::Chart(chart), Format::Xmi) => chart_xmi(chart, Dialect::Nested2018)?,
            (Model::Chart(chart), Format::Statechart(dialect)) => chart_xmi(chart, dialect)?,
            (Model::Chart(chart), Format::Scxml) => scxml::write(chart)?,
            _ => return Err(vec![self.no_format(format)]),
        };
        written.lost.extend(lost_comments(original));
        Ok(written)
    }

    fn no_format(&self, format: Format) -> Diagnostic {
        let message = format!("there is no {} of the kind {}", format.word(), self.kind());
        let formats = match self {
            Model::Sag(_) | Model::Suc(_) | Model::Aip(_) => "text and xmi",
            Model::Srm(_) => "text, role and xmi",
            Model::Role(_) => "text, role, xmi, and those of its statechart",
            Model::Ft(_) => "text",
            Model::Chart(_) => "text, xmi, xmi-2010, xmi-flat, xmi-2012, xmi-2018, scxml and rust",
        };
        let hint = format!("formats of this kind: {formats}");
        Diagnostic::error("E0851", Span::default(), message).with_hint(hint)
    }

    fn document(&self) -> Option<ItemDocument> {
        Some(match self {
            Model::Sag(model) => document(model),
            Model::Suc(model) => document(model),
            Model::Aip(model) => document(model),
            Model::Srm(model) => document(model),
            Model::Ft(model) => document(model),
            Model::Chart(chart) => iac::to_text(chart),
            Model::Role(_) => return None,
        })
    }

    fn with_comments(&self, original: &str) -> WrittenModel {
        let Some(mut document) = self.document() else { return WrittenModel::of(&self.to_text()) };
        if !xmi::is_xml(original) {
            comments::transfer_comments(&ItemDocument::parse(original).0, &mut document);
        }
        WrittenModel::of(&document.to_string())
    }
}

impl WrittenModel {
    fn of(text: &str) -> WrittenModel {
        WrittenModel { text: text.into(), lost: Vec::new() }
    }
}

/// The statechart that a role describes.
fn chart_of_role(role: &SrmFile) -> Result<Model, Vec<Diagnostic>> {
    let (chart, findings) = aseme::role_to_statechart(role.srm());
    match findings.iter().any(Diagnostic::is_error) {
        true => Err(findings),
        false => Ok(Model::Chart(iac::Iac::from_statechart(&chart, iac::ChartKind::Intra))),
    }
}

fn document<T: TypedModel>(model: &T) -> ItemDocument {
    to_text(T::METAMODEL, &model.to_instance())
}

fn xmi<T: TypedModel>(model: &T) -> WriteResult {
    to_xmi(T::METAMODEL, &model.to_instance()).map(|text| WrittenModel { text, lost: Vec::new() })
}

fn chart_xmi(chart: &iac::Iac, dialect: Dialect) -> WriteResult {
    Ok(WrittenModel { text: chart.to_xmi(dialect)?, lost: chart.lost_in_xmi(dialect) })
}

/// The chart as Rust code.
fn rust(chart: &iac::Iac, original: &str) -> WriteResult {
    let (chart, findings) = chart.to_statechart();
    if findings.iter().any(Diagnostic::is_error) {
        return Err(findings);
    }
    let semantics = if is_scxml(original) { Semantics::scxml() } else { Semantics::yase() };
    Ok(WrittenModel::of(&flatten(&chart, semantics, MOST_STATES)?.to_rust()))
}

fn is_scxml(original: &str) -> bool {
    xmi::is_xml(original)
        && xmi::parse(original).is_ok_and(|document| document.root_element().tag_name().name() == "scxml")
}

/// Reports comments, because the editors of models drop XML comments.
fn lost_comments(original: &str) -> Vec<Diagnostic> {
    if xmi::is_xml(original) {
        return Vec::new();
    }
    let comments = text::comments(original);
    let lost = |(span, comment): (Span, &str)| {
        let message = format!("the comment `{comment}`: the editors of models drop XML comments");
        Diagnostic::warning("E0850", span, message)
    };
    comments.into_iter().map(lost).collect()
}
