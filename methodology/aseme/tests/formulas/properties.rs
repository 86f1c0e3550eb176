//! Properties of all texts and formulas.

use std::fmt::Write;

use aseme::liveness::{self, Liveness, Term};
use proptest::prelude::*;
use yase::{Diagnostic, Source};

/// Parses a text as a model and writes its chart in every form.
fn exercise(text: String) -> Vec<Diagnostic> {
    let (chart, findings) = aseme::statechart_of_role(&Source::new("any", text));
    for finding in &findings {
        let length = finding.source.as_ref().map_or(0, |source| source.text.len());
        assert!(finding.span.start <= finding.span.end && finding.span.end <= length, "{finding}");
    }
    let json = serde_json::to_value(aseme::to_json(&chart)).expect("JSON");
    assert_eq!(json["nodes"].as_array().map(Vec::len), Some(chart.nodes().len()));
    assert!(aseme::to_text(&chart).lines().count() >= chart.nodes().len());
    let svg = yase_export::to_svg(&chart);
    roxmltree::Document::parse(&svg).expect("well-formed");
    findings
}

fn terms(liveness: &Liveness) -> Vec<String> {
    liveness
        .formulas()
        .iter()
        .filter_map(|formula| formula.expression)
        .map(|term| liveness.compact(term))
        .collect()
}

/// The right-hand side of a formula over random names.
fn expression() -> impl Strategy<Value = String> {
    "[a-f][a-z0-9_]{0,3}".prop_recursive(5, 60, 4, |inner| {
        let list = |separator: &'static str, inner| {
            prop::collection::vec(inner, 2..4)
                .prop_map(move |items: Vec<String>| format!("({})", items.join(separator)))
        };
        prop_oneof![
            list(" . ", inner.clone().boxed()),
            list(" | ", inner.clone().boxed()),
            list(" || ", inner.clone().boxed()),
            inner.clone().prop_map(|x| format!("[{x}]")),
            (inner.clone(), prop::sample::select(vec!["*", "+", "~", "ω", "^ω"]))
                .prop_map(|(x, op)| format!("{x}{op}")),
            (inner, 1..4_u32).prop_map(|(x, count)| format!("| {x}~|{count}")),
        ]
    })
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 200, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn any_text_is_read_without_panic(text in any::<String>()) {
        exercise(text);
    }

    #[test]
    fn any_heap_of_tokens_is_read_without_panic(words in prop::collection::vec(prop::sample::select(TOKENS.to_vec()), 0..60)) {
        exercise(words.concat());
    }

    #[test]
    fn printing_and_parsing_give_the_formula_back(text in expression()) {
        let (first, findings) = liveness::parse(&format!("root={text}"));
        prop_assert_eq!(findings, []);
        let (second, findings) = liveness::parse(&first.to_string());
        prop_assert_eq!(findings, []);
        prop_assert_eq!(terms(&first), terms(&second));
        prop_assert_eq!(first.to_string(), second.to_string());
    }

    #[test]
    fn mixed_operators_print_to_what_they_mean(operators in prop::collection::vec(prop::sample::select(vec![".", "|", "||"]), 1..8)) {
        let mut text = String::from("root = a");
        operators.iter().for_each(|operator| { let _ = write!(text, " {operator} b"); });
        let (first, findings) = liveness::parse(&text);
        prop_assert!(findings.iter().all(|finding| finding.code == "E0210"));
        let (second, _) = liveness::parse(&first.to_string());
        prop_assert_eq!(terms(&first), terms(&second));
    }

    #[test]
    fn a_well_formed_formula_has_a_chart_with_one_way_in_everywhere(text in expression()) {
        let (liveness, _) = liveness::parse(&format!("root={text}"));
        let (chart, findings) = aseme::liveness_to_statechart(&liveness);
        prop_assert_eq!(findings, []);
        for (id, node) in chart.nodes() {
            let starts = chart.children(id).iter().filter(|child| chart.node(**child).kind == yase::NodeKind::Start).count();
            prop_assert_eq!(starts, usize::from(node.kind == yase::NodeKind::Or));
            let regions = chart.children(id).iter().all(|child| chart.node(*child).kind == yase::NodeKind::Or);
            prop_assert!(node.kind != yase::NodeKind::And || regions);
        }
        exercise(format!("root={text}"));
    }
}

const TOKENS: [&str; 44] = [
    "Role: r",
    "Protocols:",
    "Liveness:",
    "Constants:",
    "Transitions:",
    "States:",
    "Layout:",
    "at = 0 40",
    ", size = 9 9",
    "via = 1 2, 3 4",
    "\n",
    "\n",
    "\n",
    " ",
    "a",
    "b",
    "r",
    "=",
    " = ",
    ".",
    "|",
    "||",
    "*",
    "+",
    "~",
    "ω",
    "^",
    "(",
    ")",
    "[",
    "]",
    "|a~|2",
    "->",
    " : ",
    "START",
    "END",
    "CONDITION",
    "*~",
    "/",
    "!2",
    "%0.5",
    "[false]",
    "# c\n",
    "\"",
];

#[test]
fn a_hundred_thousand_brackets_are_read_printed_and_dropped() {
    let depth = 100_000;
    for (open, close) in [("(", ")"), ("[", "]"), ("| ", "~|2"), ("", "~")] {
        let text = format!("r={}a{}", open.repeat(depth), close.repeat(depth));
        let (liveness, findings) = liveness::parse(&text);
        assert!(findings.is_empty(), "{open}: {:?}", findings[0]);
        let root = liveness.formulas()[0].expression.expect("an expression");
        assert!(liveness.compact(root) == text[2..].replace(' ', ""), "{open}");
        let (_, findings) = aseme::liveness_to_statechart(&liveness);
        assert_eq!(findings.is_empty(), open == "(", "groups are not levels of a chart");
    }
    for text in [
        "(".repeat(depth),
        ")".repeat(depth),
        "[(".repeat(depth),
        "a.(".repeat(depth),
        "|a".repeat(depth),
        format!("{}{}", "[".repeat(depth), ")".repeat(depth)),
    ] {
        let (_, findings) = liveness::parse(&format!("r={text}"));
        assert!(findings.iter().any(Diagnostic::is_error));
    }
}

#[test]
fn a_long_chain_of_formulas_is_checked_without_recursion() {
    let count = 100_000;
    let chain: String = (0..count).fold(String::new(), |mut text, n| {
        let _ = writeln!(text, "x{n} = x{}", n + 1);
        text
    });
    let (liveness, findings) = liveness::parse(&chain);
    assert_eq!(findings, []);
    assert_eq!(liveness.formulas().len(), count);
    let (_, findings) = liveness::parse(&format!("{chain}x{count} = x0"));
    assert_eq!(findings.iter().map(|finding| finding.code).collect::<Vec<_>>(), ["E0214"]);
}

#[test]
fn terms_know_their_place() {
    let text = "r = (alpha . beta)~ || gamma";
    let (liveness, _) = liveness::parse(text);
    let root = liveness.formulas()[0].expression.expect("an expression");
    let Term::Parallel(regions) = liveness.term(root) else { panic!("{:?}", liveness.term(root)) };
    let spans = regions.iter().map(|&region| liveness.span(region)).map(|span| &text[span.start..span.end]);
    assert_eq!(spans.collect::<Vec<_>>(), ["(alpha . beta)~", "gamma"]);
}
