//! What the tests share.

use aseme_models::convert::{self, Format, Model};
use yase::{Diagnostic, Source};

/// The model in a text and the format it is in.
pub(crate) fn read(text: &str) -> (Model, Format, Vec<Diagnostic>) {
    let (found, findings) = convert::read(&Source::new("model", text));
    for finding in &findings {
        assert!(text.get(finding.span.start..finding.span.end).is_some(), "{finding:?}");
    }
    let (model, format) = found.unwrap_or_else(|| panic!("no model: {findings:?}\n{text}"));
    (model, format, findings)
}

/// The model in a text of which nothing is to be said.
pub(crate) fn clean(text: &str) -> Model {
    let (model, _, findings) = read(text);
    assert_eq!(findings, [], "{text}");
    model
}

/// A model in a format that says all of it.
pub(crate) fn whole(model: &Model, format: Format) -> String {
    let written = model.write(format, "<").unwrap_or_else(|refused| panic!("{refused:?}"));
    assert_eq!(written.lost, [], "{format:?}");
    written.text
}

/// The codes of findings, and the places they speak of.
pub(crate) fn told<'a>(text: &'a str, findings: &[Diagnostic]) -> Vec<(&'static str, &'a str)> {
    findings.iter().map(|finding| (finding.code, &text[finding.span.start..finding.span.end])).collect()
}
