//! Lenient XML: every text is parsed without failure, and every reported location lies in the text.

use std::time::Duration;

use monas::config::{AttributeRule, Element, ElementRule, Grammar, Kind, Values, xml};
use proptest::prelude::*;
use yase::{Diagnostic, Source, Span};

fn parse(text: &str) -> (Vec<Element>, Vec<Diagnostic>) {
    xml::parse(&Source::new("a.xml", text))
}

/// The elements of a valid text.
fn read(text: &str) -> Vec<Element> {
    let (elements, diagnostics) = parse(text);
    assert_eq!(diagnostics, []);
    elements
}

fn at(text: &str, span: Span) -> &str {
    &text[span.start..span.end]
}

#[test]
fn places_are_those_of_the_text_as_it_was_written() {
    let text = "<?xml version='1.0'?>\n<a x=1 y = 'p &amp; q' z='r & s'>\n  ün\n  <!-- no -->\n  <b/> </a>";
    let elements = read(text);
    let a = &elements[0];
    assert_eq!((a.name(), at(text, a.name_span())), ("a", "a"));
    assert_eq!((a.text(), at(text, a.text_span())), ("ün", "ün"));
    assert!(at(text, a.span()).starts_with("<a x=1") && at(text, a.span()).ends_with("</a>"));
    let attributes: Vec<(&str, &str, &str, &str)> = a
        .attributes()
        .iter()
        .map(|given| (&*given.name, at(text, given.name_span), &*given.value, at(text, given.value_span)))
        .collect();
    let expected = [("x", "x", "1", "1"), ("y", "y", "p & q", "p &amp; q"), ("z", "z", "r & s", "r & s")];
    assert_eq!(attributes, expected);
    assert_eq!(at(text, a.children()[0].span()), "<b/>");
}

#[test]
fn values_without_quotes_end_at_blanks_and_at_the_end_of_the_tag() {
    let elements = read("<a x=1 y=b/><c z=../file.xml>t</c>");
    assert_eq!(elements[0].attributes()[1].value, "b");
    assert_eq!(elements[1].attributes()[0].value, "../file.xml");
}

#[test]
fn texts_are_joined_and_entities_replaced() {
    let elements = read("<a> one &lt; <![CDATA[<two>]]> <!-- not this --> three </a>");
    assert_eq!(elements[0].text(), "one < <two>  three");
}

#[test]
fn references_to_schemas_are_dropped_and_other_prefixes_are_errors() {
    let schema =
        "xmlns:xsi='http://www.w3.org/2001/XMLSchema-instance' xsi:noNamespaceSchemaLocation=\"a.xsd\"";
    let text = format!("<a {schema} xml:lang=\"en\" x=1><b xmlns=\"urn:b\" y=2/></a>");
    let elements = read(&text);
    let x = &elements[0].attributes()[0];
    assert_eq!((elements[0].attributes().len(), &*x.value, at(&text, x.value_span)), (1, "1", "1"));
    let y = &elements[0].children()[0].attributes()[0];
    assert_eq!((&*y.name, at(&text, y.name_span), at(&text, y.value_span)), ("y", "y", "2"));

    let (elements, diagnostics) = parse("<a svg:x=1 svg:x=2 y=3/>");
    let names: Vec<&str> = elements[0].attributes().iter().map(|given| &*given.name).collect();
    let lines: Vec<String> = diagnostics.iter().map(ToString::to_string).collect();
    let reported = |column| {
        format!(
            "a.xml:1:{column}: error[E0301]: attribute `svg:x` belongs to another namespace \
             (a configuration has no namespaces: leave out `svg:`)"
        )
    };
    assert_eq!((names, lines), (vec!["y"], vec![reported(4), reported(12)]));
}

/// A grammar with one element, which has an attribute of every kind.
fn grammar() -> Grammar {
    let attribute = |key, kind| AttributeRule::new(key, kind, "");
    let element = ElementRule::new("a", "an element")
        .attribute(attribute("n", Kind::number_in(0.0, 2.0)))
        .attribute(attribute("i", Kind::whole()).or("7"))
        .attribute(attribute("yes", Kind::Flag))
        .attribute(attribute("no", Kind::Flag).or("1"))
        .attribute(attribute("half", Kind::Duration { min: Duration::ZERO }))
        .attribute(attribute("word", Kind::Word(vec!["left", "right"])))
        .attribute(attribute("color", Kind::Text).required());
    Grammar::default().root(element)
}

fn checked(text: &str) -> (Vec<Element>, Vec<String>) {
    let (elements, diagnostics) = grammar().read(&Source::new("a.xml", text));
    (elements, diagnostics.iter().map(ToString::to_string).collect())
}

#[test]
fn typed_attributes_are_read_and_have_defaults() {
    let text = "<a n='1.5' I='-3' yes='1' half=' 300s ' word='left' color='red'/>";
    let (elements, findings) = checked(text);
    assert_eq!(findings, [""; 0]);
    let grammar = grammar();
    let values = Values::of(&elements[0], &grammar);
    assert_eq!((values.number("n"), values.number::<i8>("i")), (Some(1.5), Some(-3)));
    assert_eq!((values.flag("yes"), values.flag("no")), (Some(true), Some(true)));
    assert_eq!(values.duration("half"), Some(Duration::from_secs(300)));
    assert_eq!(values.word("word", &[("left", 1), ("right", 2)]), Some(1));
    assert_eq!(values.text("gone"), None);
}

#[test]
fn implausible_attributes_are_reported_and_ignored() {
    let (elements, findings) = checked("<a n='2.5' i='x' word='lefd' colr='red' odd=1 I=3/>");
    let expected = [
        "a.xml:1:7: error[E0306]: `n` is `2.5`, expected a number from 0 to 2",
        "a.xml:1:15: error[E0306]: `i` is `x`, expected a whole number",
        "a.xml:1:24: error[E0306]: `word` is `lefd`, expected one of `left` or `right` (did you mean `left`?)",
        "a.xml:1:30: error[E0304]: unknown attribute `colr` of `a` (did you mean `color`?)",
        "a.xml:1:41: error[E0304]: unknown attribute `odd` of `a` (expected `n`, `i`, `yes`, `no`, `half`, `word` or `color`)",
        "a.xml:1:47: error[E0307]: attribute `i` is repeated (remove one of them)",
        "a.xml:1:2: error[E0305]: `a` lacks the attribute `color` (is `colr` meant to be `color`?)",
    ];
    assert_eq!(findings, expected);
    let grammar = grammar();
    let values = Values::of(&elements[0], &grammar);
    assert_eq!((values.number::<f64>("n"), values.number("i")), (None, Some(7)));
}

#[test]
fn an_unclosed_value_ends_with_its_line() {
    let (elements, diagnostics) = parse("<a>\n<b x=\"1>t</b>\n<c y=\"2\"/>\n</a>");
    assert_eq!(
        diagnostics[0].to_string(),
        "a.xml:2:6: error[E0301]: the value of `x` is not closed (it ends with the quote that it begins with)"
    );
    assert_eq!(diagnostics.len(), 1, "{diagnostics:#?}");
    assert_eq!(elements[0].children()[1].attributes()[0].value, "2");
}

#[test]
fn a_value_in_quotes_may_hold_signs_of_tags() {
    assert_eq!(read("<a x=\"b > c\" y='d < e'/>")[0].attributes()[1].value, "d < e");
}

#[test]
fn a_mark_in_front_of_the_text_means_nothing() {
    assert_eq!(read("\u{feff}<a/>")[0].name(), "a");
    let (_, diagnostics) = parse("\u{feff}<a x/>");
    assert!(diagnostics[0].to_string().starts_with("a.xml:1:4: "), "{}", diagnostics[0]);
}

#[test]
fn nesting_beyond_any_use_is_refused_once() {
    let deep = "<a>".repeat(100_000) + &"</a>".repeat(100_000);
    let (elements, diagnostics) = parse(&deep);
    assert_eq!(elements.len(), 1);
    assert_eq!(diagnostics.iter().filter(|diagnostic| diagnostic.code == "E0302").count(), 1);
}

/// Fragments of XML, in any order.
fn pieces() -> impl Strategy<Value = String> {
    let piece = prop_oneof![
        Just("<a>"),
        Just("</a>"),
        Just("<b x=1 "),
        Just("/>"),
        Just(">"),
        Just("<"),
        Just("="),
        Just("\""),
        Just("'"),
        Just("&"),
        Just("&amp;"),
        Just("&#x41;"),
        Just("&#0;"),
        Just("<!--"),
        Just("-->"),
        Just("<![CDATA["),
        Just("]]>"),
        Just("<?"),
        Just("?>"),
        Just("<!D"),
        Just("x='ü'"),
        Just("xmlns"),
        Just("xmlns:x"),
        Just("xsi:y"),
        Just("x:y"),
        Just("xml:a=1"),
        Just(" "),
        Just("\n"),
        Just("ω"),
        Just("\u{0}"),
        Just("]]"),
    ];
    prop::collection::vec(piece, 0..40).prop_map(|pieces| pieces.concat())
}

fn check_places(text: &str) {
    let (elements, diagnostics) = parse(text);
    let spans = diagnostics.iter().map(|diagnostic| diagnostic.span);
    for span in spans.chain(elements.iter().flat_map(all_spans)) {
        assert!(
            span.start <= span.end && span.end <= text.len() + 1,
            "{span:?} of {} in {text:?}",
            text.len()
        );
    }
}

fn all_spans(element: &Element) -> Vec<Span> {
    let own = [element.span(), element.name_span(), element.text_span()];
    let attributes = element.attributes().iter().flat_map(|given| [given.name_span, given.value_span]);
    own.into_iter().chain(attributes).chain(element.children().iter().flat_map(all_spans)).collect()
}

proptest! {
    #![proptest_config(ProptestConfig { failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn any_text_is_read_without_failing(text in ".*") {
        check_places(&text);
    }

    #[test]
    fn any_pieces_of_xml_are_read_without_failing(text in pieces()) {
        check_places(&text);
    }

    #[test]
    fn any_value_in_quotes_is_read_back(value in "[^\"&\n\r\t\u{0}-\u{1f}\u{fffe}\u{ffff}]*") {
        let text = format!("<a x=\"{value}\"/>");
        let elements = parse(&text).0;
        prop_assert_eq!(&elements[0].attributes()[0].value, &value);
        prop_assert_eq!(at(&text, elements[0].attributes()[0].value_span), &value);
    }
}

/// Whether every reported location lies in the text, on character boundaries.
fn places_lie_in(text: &str) -> Result<(), String> {
    let source = Source::new("any.xml", text);
    let (elements, diagnostics) = xml::parse(&source);
    let spans =
        elements.iter().flat_map(spans_of).chain(diagnostics.iter().map(|diagnostic| diagnostic.span));
    for span in spans {
        if text.get(span.start..span.end).is_none() {
            return Err(format!("{span:?} is not a place in {text:?}: {diagnostics:?}"));
        }
    }
    Ok(())
}

fn spans_of(element: &Element) -> Vec<Span> {
    let own = [element.name_span(), element.span(), element.text_span()];
    let attributes = element.attributes().iter().flat_map(|one| [one.name_span, one.value_span]);
    own.into_iter().chain(attributes).chain(element.children().iter().flat_map(spans_of)).collect()
}

#[test]
fn places_lie_in_the_text_even_where_it_is_cut_off() {
    for text in [
        "<agents>",
        "<agent",
        "<agent na",
        "</",
        "<agent>]]>",
        "<a>é",
        "<!--",
        "<![CDATA[",
        "<a b=\"é",
        "<?é",
    ] {
        places_lie_in(text).unwrap();
    }
}

#[test]
fn invalid_xml_is_reported_without_positions_in_the_repaired_text() {
    let source = Source::new("b.xml", "<agent>]]></agent>");
    let (_, diagnostics) = xml::parse(&source);
    assert!(diagnostics[0].message.starts_with("not XML: "), "{diagnostics:?}");
    assert!(!diagnostics[0].message.contains(" at "), "{diagnostics:?}");
}

proptest::proptest! {
    #[test]
    fn places_lie_in_any_text(text in "[<>/=\"'&a-c!\\[\\]?é \n-]{0,60}") {
        proptest::prop_assert_eq!(places_lie_in(&text), Ok(()));
    }
}
