//! Configurations: the XML reader, and agents read with an empty registry.

use std::path::Path;

use monas::Registry;
use monas::config::{self, Element, xml};
use yase::Source;

use crate::{assert_findings_fit, text_of};

/// Checks the documented guarantees for one input.
pub fn configuration(data: &[u8]) {
    let text = text_of(data);
    let source = Source::new("agents.xml", text);
    let (elements, findings) = xml::parse(&source);
    assert_findings_fit(text, &findings);
    elements.iter().for_each(|element| assert_spans_fit(text, element));
    let (_, findings) = config::read(&source, Path::new("no_such_folder/agents.xml"), &Registry::empty());
    assert_findings_fit(text, &findings);
}

fn assert_spans_fit(text: &str, element: &Element) {
    let spans = [element.span(), element.name_span(), element.text_span()];
    let values =
        element.attributes().iter().flat_map(|attribute| [attribute.name_span, attribute.value_span]);
    for span in spans.into_iter().chain(values) {
        assert!(text.get(span.start..span.end).is_some(), "{span:?} of <{}>", element.name());
    }
    element.children().iter().for_each(|child| assert_spans_fit(text, child));
}
