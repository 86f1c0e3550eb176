//! Diagnostics of invalid documents, and the charts of valid ones.

use yase::expression::ActionKind;
use yase::{NodeKind, Severity, Source, Statechart};
use yase_scxml::{Document, read};

/// A document with these states.
fn around(inside: &str) -> String {
    format!("<scxml xmlns='http://www.w3.org/2005/07/scxml' version='1.0'>{inside}</scxml>")
}

/// The diagnostics of a document, as `code [underlined text] message (hint)`.
fn said(text: &str) -> Vec<String> {
    let (_, found) = read(&Source::new("d.scxml", text));
    let texts = found.iter().map(|found| {
        let place = &text[found.span.start..found.span.end];
        let hint = found.hint.as_ref().map(|hint| format!(" ({hint})")).unwrap_or_default();
        format!("{} [{place}] {}{hint}", found.code, found.message)
    });
    texts.collect()
}

#[track_caller]
fn refused(inside: &str, expected: &str) {
    assert_eq!(said(&around(inside)), [expected], "{inside}");
}

fn document(text: &str) -> Document {
    let (document, found) = read(&Source::new("d.scxml", text));
    assert!(found.iter().all(|found| found.severity != Severity::Error), "{found:?}");
    document.unwrap()
}

#[test]
fn misspelt_words_are_reported_with_the_nearest_one() {
    refused(
        "<stat id='a'/><state/>",
        "E0602 [stat] unknown element `stat` in `scxml` (did you mean `state`?)",
    );
    refused("<state ID='a'/>", "E0603 [ID] unknown attribute `ID` of `state` (did you mean `id`?)");
    refused(
        "<state id='a'><transition evnt='e' target='a'/></state>",
        "E0603 [evnt] unknown attribute `evnt` of `transition` (did you mean `event`?)",
    );
    refused(
        "<state><onentry><rise/></onentry></state>",
        "E0602 [rise] unknown element `rise` in `onentry` (did you mean `raise`?)",
    );
    refused(
        "<state id='first'/><state><transition event='e' target='frist'/></state>",
        "E0606 [frist] there is no state `frist` (did you mean `first`?)",
    );
}

#[test]
fn missing_and_superfluous_elements_are_reported() {
    refused("", "E0604 [scxml] the document has no states");
    refused(
        "<state><onentry><raise/></onentry></state>",
        "E0604 [raise] `raise` lacks the attribute `event`",
    );
    refused(
        "<state><onentry><cancel/></onentry></state>",
        "E0604 [cancel] `cancel` lacks the attribute `sendid`",
    );
    refused("<state id='a'/><final id='a'/>", "E0605 [a] two states have the id `a`");
    refused(
        "<state id='1'/>",
        "E0617 [1] `1` is not an id (an id is letters, digits, `_`, `-`, `.` and `:`, and does not begin with a digit)",
    );
    refused("<final><state/></final>", "E0615 [state] `state` cannot stand in `final`");
    refused("<state>words</state>", "E0615 [words] text cannot stand in `state`");
    refused(
        "<state><onentry><send event='e' eventexpr='1'/></onentry></state>",
        "E0608 [send] `send` has event and eventexpr, of which one is too many",
    );
    refused(
        "<state><onentry><send event='e' delay='5'/></onentry></state>",
        "E0609 [5] `5` is not a delay (a delay is a number with its unit, such as `500ms` or `1.5s`)",
    );
    refused(
        "<state><history id='h'/><state/></state>",
        "E0615 [history] `history` has 0 transitions (it has exactly one)",
    );
    refused(
        "<state><onentry><if cond='true'><else/><elseif cond='true'/></if></onentry></state>",
        "E0615 [elseif] nothing comes after `else`",
    );
}

#[test]
fn targets_must_be_possible() {
    let two = "<state id='s'><state id='a'/><state id='b'/></state><state><transition event='e' target='a b'/></state>";
    refused(
        two,
        "E0607 [transition] `a` and `b` cannot be entered together (several targets lie in different regions of one `parallel`)",
    );
    let outside = "<state id='s' initial='t'><state id='a'/></state><state id='t'/>";
    refused(
        outside,
        "E0606 [t] `t` does not lie inside (an initial state, like a history's default, is one of the composite)",
    );
}

#[test]
fn broken_documents_are_reported() {
    for text in [
        "",
        "<scxml",
        "<a></b>",
        "<scxml>&nothing;</scxml>",
        "\u{feff}<scxml>",
        "<!DOCTYPE a [<!ENTITY b 'c'>]><a>&b;</a>",
    ] {
        let said = said(text);
        assert!(said.len() == 1 && said[0].starts_with("E0601"), "{text}: {said:?}");
    }
    assert!(said("<agent/>")[0].starts_with("E0616 [agent] this is a `agent`, not an SCXML document"));
    let deep = format!("{}{}", "<state>".repeat(50_000), "</state>".repeat(50_000));
    assert!(said(&around(&deep))[0].starts_with("E0614 [state] elements nest deeper than"));
}

#[test]
fn other_languages_are_refused() {
    let text = around("<state/>").replace("version", "datamodel='xpath' version");
    assert_eq!(
        said(&text),
        [
            "E0612 [xpath] the data model `xpath` is not supported (the data models are `null` and `ecmascript`)"
        ]
    );
    let outside = "is outside the subset of ECMAScript that is understood";
    refused(
        "<state><transition cond='new Date() > 1' target='a'/></state><state id='a'/>",
        &format!("E0610 [new] `new` {outside}"),
    );
    refused(
        "<state><onentry><script>x = 1; while (x) {}</script></onentry></state>",
        &format!("E0610 [while] `while` {outside}"),
    );
    refused(
        "<state><onentry><assign location='a' expr='Math.random()'/></onentry></state>",
        &format!("E0610 [Math.random] `Math.random` {outside}"),
    );
    refused(
        "<datamodel><data id='a'><b/></data></datamodel><state/>",
        "E0610 [b] XML as a value needs a DOM, which is outside the subset",
    );
    let null = |inside: &str| said(&around(inside).replace("version", "datamodel='null' version"));
    assert!(
        null("<state><transition cond=\"!In('a') || true\" target='a'/></state><state id='a'/>").is_empty()
    );
    let cond = null("<state><transition cond='x == 1' target='a'/></state><state id='a'/>");
    assert!(
        cond[0].starts_with("E0613 [x == 1] there is an expression in a document of the null data model"),
        "{cond:?}"
    );
    let data = null("<datamodel><data id='x'/></datamodel><state/>");
    assert!(data[0].starts_with("E0613 [data] there is a variable"), "{data:?}");
}

#[test]
fn invalid_ecmascript_is_a_warning() {
    let (document, found) =
        read(&Source::new("d", around("<state><onentry><log expr='1 +'/></onentry></state>")));
    assert!(document.is_some());
    assert_eq!((found[0].code, found[0].severity), ("E0611", Severity::Warning));
}

#[test]
fn errors_inside_invoked_documents_have_their_place() {
    refused(
        "<state><invoke><content><scxml><state id='x' color='red'/></scxml></content></invoke></state>",
        "E0603 [color] unknown attribute `color` of `state`",
    );
}

#[test]
fn foreign_elements_are_skipped_and_reported() {
    refused(
        "<state><b:box xmlns:b='urn:b'/></state>",
        "E0618 [b:box] `box` is not an element of SCXML and is left out",
    );
}

#[test]
fn data_free_charts_need_no_scripts() {
    let text = around(
        "<state id='a'><onentry><raise event='x.y'/><raise event='z'/></onentry>
         <transition event='p q.* *' cond=\"In('b') &amp;&amp; !In('a')\" target='b'/></state><state id='b'/>",
    );
    let document = document(&text);
    let chart = document.statechart();
    let a = chart.find("a").unwrap();
    let raised: Vec<String> = chart.node(a).entry.iter().map(ToString::to_string).collect();
    assert_eq!(raised, ["raise(x.y)", "raise(z)"]);
    let transition =
        chart.transitions().map(|(_, transition)| transition).find(|one| one.source == a).unwrap();
    assert_eq!(transition.expression.to_string(), "* [In(b) && !In(a)]");
}

#[test]
fn states_become_nodes() {
    let text = around(
        "<state id='or'><initial><transition target='deep'><log label='l'/></transition></initial>
           <parallel id='and'><state id='deep'/><state/></parallel>
           <history id='h' type='deep'><transition target='and'/></history>
           <transition event='e' type='internal' target='and'/><transition event='f'/>
         </state><final id='end'/>",
    );
    let document = document(&text);
    let chart = document.statechart();
    let kind = |name: &str| chart.node(chart.find(name).unwrap()).kind;
    assert_eq!((kind("or"), kind("and"), kind("deep")), (NodeKind::Or, NodeKind::And, NodeKind::Basic));
    assert_eq!(
        (kind("h"), kind("end"), kind("state.1")),
        (NodeKind::DeepHistory, NodeKind::End, NodeKind::Basic)
    );
    let start = chart.children(chart.find("or").unwrap())[0];
    assert_eq!(chart.node(start).kind, NodeKind::Start);
    let transitions: Vec<_> =
        chart.transitions().map(|(_, transition)| transition).filter(|it| it.source == start).collect();
    let ActionKind::Script(text) = &transitions[0].expression.actions[0].kind else { panic!("no script") };
    assert_eq!(text, "<log label=\"l\"/>");
    let internal = chart.transitions().filter(|(_, it)| it.internal);
    assert_eq!(internal.count(), 2);
    assert_eq!(chart.transitions().filter(|(_, it)| it.source == Statechart::ROOT).count(), 0);
}

#[test]
fn an_internal_transition_of_a_parallel_is_external() {
    let text = around(
        "<parallel id='p'><state id='a'/><state id='b'/><transition event='e' type='internal' target='a'/></parallel>",
    );
    let document = document(&text);
    assert!(document.statechart().transitions().all(|(_, transition)| !transition.internal));
}
