//! Functions shared by the tests.

use aseme_models::convert::{self, Format, Model};
use yase::{Diagnostic, Source};

/// Parses a text: model, format and findings.
pub(crate) fn read(text: &str) -> (Model, Format, Vec<Diagnostic>) {
    let (found, findings) = convert::read(&Source::new("model", text));
    for finding in &findings {
        assert!(text.get(finding.span.start..finding.span.end).is_some(), "{finding:?}");
    }
    let (model, format) = found.unwrap_or_else(|| panic!("no model: {findings:?}\n{text}"));
    (model, format, findings)
}

/// Parses a text that must have no findings.
pub(crate) fn clean(text: &str) -> Model {
    let (model, _, findings) = read(text);
    assert_eq!(findings, [], "{text}");
    model
}

/// Writes a model in a format that represents it completely.
pub(crate) fn whole(model: &Model, format: Format) -> String {
    let written = model.write(format, "<").unwrap_or_else(|refused| panic!("{refused:?}"));
    assert_eq!(written.lost, [], "{format:?}");
    written.text
}

/// The codes of findings, and the texts at their spans.
pub(crate) fn codes_and_texts<'a>(text: &'a str, findings: &[Diagnostic]) -> Vec<(&'static str, &'a str)> {
    findings.iter().map(|finding| (finding.code, &text[finding.span.start..finding.span.end])).collect()
}
