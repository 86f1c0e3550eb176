//! Configurations: the XML reader, and agents read with an empty registry.
#![no_main]

use std::path::Path;

use libfuzzer_sys::fuzz_target;
use monas::Registry;
use monas::config::{self, Element, xml};
use monas_fuzz::assert_findings_fit;
use yase::Source;

fuzz_target!(|text: &str| {
    let source = Source::new("agents.xml", text);
    let (elements, findings) = xml::parse(&source);
    assert_findings_fit(text, &findings);
    elements.iter().for_each(|element| assert_spans_fit(text, element));
    let (_, findings) = config::read(&source, Path::new("no_such_folder/agents.xml"), &Registry::empty());
    assert_findings_fit(text, &findings);
});

fn assert_spans_fit(text: &str, element: &Element) {
    let spans = [element.span(), element.name_span(), element.text_span()];
    let values =
        element.attributes().iter().flat_map(|attribute| [attribute.name_span, attribute.value_span]);
    for span in spans.into_iter().chain(values) {
        assert!(text.get(span.start..span.end).is_some(), "{span:?} of <{}>", element.name());
    }
    element.children().iter().for_each(|child| assert_spans_fit(text, child));
}
