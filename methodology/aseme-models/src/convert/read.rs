//! Detection and parsing of model files.

use std::sync::Arc;

use yase::{Diagnostic, Source, Span};

use super::{Format, Model};
use crate::aip::Aip;
use crate::document::ItemDocument;
use crate::functionality::FunctionalityTable;
use crate::iac::{self, ChartKind, Dialect, Iac};
use crate::meta::{TypedModel, from_text, from_xmi};
use crate::roles::SystemRoles;
use crate::sag::Sag;
use crate::suc::Suc;
use crate::transformations::{OPEN_OPERATOR, participant_formula};
use crate::xmi;
use aseme::srm::SrmFile;
use aseme::{liveness, text};

/// Reads the model in a file: the model and its format, and all findings; no model if its kind
/// cannot be detected.
pub fn read(source: &Arc<Source>) -> (Option<(Model, Format)>, Vec<Diagnostic>) {
    let (found, mut diagnostics) = match xmi::is_xml(&source.text) {
        true => from_xml(source),
        false => from_words(&source.text),
    };
    diagnostics.sort_by_key(|diagnostic| diagnostic.span);
    (found, diagnostics.into_iter().map(|diagnostic| diagnostic.in_source(source)).collect())
}

type ReadResult = (Option<(Model, Format)>, Vec<Diagnostic>);

fn from_xml(source: &Arc<Source>) -> ReadResult {
    let document = match xmi::parse(&source.text) {
        Ok(document) => document,
        Err(diagnostic) => return (None, vec![diagnostic]),
    };
    let root = document.root_element();
    match root.tag_name().name() {
        "SAGmodel" => typed(Format::Xmi, Model::Sag, from_xmi(Sag::METAMODEL, &document)),
        "SUCmodel" => typed(Format::Xmi, Model::Suc, from_xmi(Suc::METAMODEL, &document)),
        "AIPmodel" => {
            let (found, mut diagnostics) =
                typed(Format::Xmi, Model::Aip, from_xmi(Aip::METAMODEL, &document));
            diagnostics.extend(found.iter().flat_map(|(model, _)| formulas(model, &source.text)));
            (found, diagnostics)
        }
        "SRMmodel" => {
            let (found, mut diagnostics) =
                typed(Format::Xmi, Model::Srm, from_xmi(SystemRoles::METAMODEL, &document));
            diagnostics.extend(found.iter().flat_map(|(model, _)| formulas(model, &source.text)));
            (found, diagnostics)
        }
        "Model" | "XMI" => {
            let (chart, diagnostics) = iac::from_xmi(&document);
            (Some((Model::Chart(chart), Format::Statechart(dialect(root)))), diagnostics)
        }
        "scxml" => scxml(source),
        other => {
            let message = format!("`{other}` is not a kind of model");
            let kinds = ["SAGmodel", "SUCmodel", "AIPmodel", "SRMmodel", "Model", "XMI", "scxml"];
            let hint = format!("models are {}", kinds.join(", "));
            let found = Diagnostic::error("E0801", xmi::tag(root), message).with_hint(hint);
            (None, vec![found.with_nearest(other, kinds)])
        }
    }
}

fn dialect(root: roxmltree::Node<'_, '_>) -> Dialect {
    if xmi::has_many_roots(root) {
        return Dialect::MultiRoot;
    }
    let newer = ["description", "metadata", "actions"];
    let is_newer = |node: roxmltree::Node<'_, '_>| node.attributes().any(|it| newer.contains(&it.name()));
    let is_flat = root.children().any(|child| child.has_attribute("Father_of"));
    match root.tag_name().namespace() {
        Some(uri) if uri.ends_with("/IAC") => Dialect::Flat,
        _ if is_flat => Dialect::Flat,
        _ if root.descendants().any(is_newer) => Dialect::Nested2018,
        _ => Dialect::Nested2012,
    }
}

fn scxml(source: &Arc<Source>) -> ReadResult {
    let (document, mut diagnostics) = yase_scxml::read(source);
    diagnostics.extend(document.as_ref().and_then(beside_the_chart));
    let chart = document.map(|document| Iac::from_statechart(document.statechart(), ChartKind::Intra));
    (chart.map(|chart| (Model::Chart(chart), Format::Scxml)), diagnostics)
}

/// Content of an SCXML document beside its chart, which no other format can represent.
fn beside_the_chart(document: &yase_scxml::Document) -> Option<Diagnostic> {
    let mut plain = yase_scxml::Document::from(document.statechart().clone());
    (plain.name, plain.binding) = (document.name.clone(), document.binding);
    plain.data_model = document.data_model;
    let message =
        "the document has variables, invocations, scripts or final data: a chart cannot represent them";
    (plain != *document).then(|| Diagnostic::warning("E0850", Span::default(), message))
}

fn typed<T: TypedModel>(
    format: Format,
    model: impl Fn(T) -> Model,
    (instance, diagnostics): (crate::meta::ModelInstance, Vec<Diagnostic>),
) -> ReadResult {
    (Some((model(T::from_instance(&instance)), format)), diagnostics)
}

fn from_words(text: &str) -> ReadResult {
    let kind = first_word(text);
    if !KINDS.contains(&kind.as_str()) {
        let (role, diagnostics) = SrmFile::parse(text);
        return (Some((Model::Role(Box::new(role)), Format::Role)), diagnostics);
    }
    let (document, mut diagnostics) = ItemDocument::parse(text);
    let (found, more) = match kind.as_str() {
        "SAG" => typed(Format::Text, Model::Sag, from_text(Sag::METAMODEL, &document)),
        "SUC" => typed(Format::Text, Model::Suc, from_text(Suc::METAMODEL, &document)),
        "AIP" => typed(Format::Text, Model::Aip, from_text(Aip::METAMODEL, &document)),
        "SRM" => typed(Format::Text, Model::Srm, from_text(SystemRoles::METAMODEL, &document)),
        "FT" => typed(Format::Text, Model::Ft, from_text(FunctionalityTable::METAMODEL, &document)),
        _ => {
            let (chart, diagnostics) = iac::from_text(&document);
            (Some((Model::Chart(chart), Format::Text)), diagnostics)
        }
    };
    diagnostics.extend(more);
    diagnostics.extend(found.iter().flat_map(|(model, _)| formulas(model, text)));
    (found, diagnostics)
}

/// The headers that a text in the shared form starts with.
pub(crate) const KINDS: [&str; 7] = ["SAG", "SUC", "AIP", "SRM", "FT", "EAC", "IAC"];

/// The word before the first colon of a text.
pub(crate) fn first_word(text: &str) -> String {
    let blanked = text::without_comments(text);
    let line = blanked.lines().find(|line| !line.trim().is_empty()).unwrap_or_default();
    line.split_once(':').map_or(String::new(), |(word, _)| word.trim().to_owned())
}

/// The errors of the formulas in a model.
fn formulas(model: &Model, text: &str) -> Vec<Diagnostic> {
    match model {
        Model::Srm(srm) => {
            let roles = srm.roles.iter();
            roles.flat_map(|role| role_formulas(&role.liveness, role.liveness_position.0, text)).collect()
        }
        Model::Aip(aip) => {
            let parts = aip.participants.iter().filter(|part| !part.liveness.is_empty());
            parts
                .flat_map(|part| participant_formulas(&part.name, &part.liveness, part.liveness_position.0))
                .collect()
        }
        _ => Vec::new(),
    }
}

fn role_formulas(liveness: &str, span: Span, text: &str) -> Vec<Diagnostic> {
    if liveness.trim().is_empty() {
        let found = Diagnostic::warning("E0233", span, "the role has no formulas");
        return vec![found.with_hint("write `role = activity`")];
    }
    if let Some(found) = open_operators(liveness, span) {
        return vec![found];
    }
    let source = match xmi::is_xml(text) {
        true => xmi::decoded(text, span.start..span.end),
        false => text::without_comments(text),
    };
    let letters = |text: &str| -> String { text.chars().filter(|letter| !letter.is_whitespace()).collect() };
    match source.get(span.start..span.end).is_some_and(|part| letters(part) == letters(liveness)) {
        true => liveness::parse_section(&source, span).1,
        false => within(liveness::parse(liveness).1, span),
    }
}

/// Adds the left-hand side to the first formula of a participant.
fn participant_formulas(name: &str, liveness: &str, span: Span) -> Vec<Diagnostic> {
    if let Some(found) = open_operators(liveness, span) {
        return vec![found];
    }
    within(liveness::parse(&participant_formula(name, liveness)).1, span)
}

/// Operators that are still placeholders.
fn open_operators(liveness: &str, span: Span) -> Option<Diagnostic> {
    let count = liveness.matches(OPEN_OPERATOR).count();
    let hint = "`.` for a sequence, `|` for a choice, `||` for parallel";
    let message = format!("`{OPEN_OPERATOR}` is a placeholder for an operator, {count} times");
    (count > 0).then(|| Diagnostic::warning("E0219", span, message).with_hint(hint))
}

/// Findings about an embedded text, positioned at its span.
fn within(findings: Vec<Diagnostic>, span: Span) -> Vec<Diagnostic> {
    findings.into_iter().map(|finding| Diagnostic { span, ..finding }).collect()
}
