//! The language of properties and its semantics on runs.

use std::time::Duration;

use aseme_verify::properties::{
    Monitor, MonitorVerdict, Property, PropertyFormula, PropertyFormulaKind, bind, parse,
};
use proptest::prelude::*;
use yase::expression::{Name, TextPosition, parse_condition};
use yase::{CompiledChart, Diagnostic, Source, TypeEnvironment};

fn formula(kind: PropertyFormulaKind) -> PropertyFormula {
    PropertyFormula { kind, position: TextPosition::default() }
}

fn name(text: &str) -> Name {
    Name { text: text.into(), position: TextPosition::default() }
}

fn atom() -> impl Strategy<Value = PropertyFormula> {
    let names = prop::sample::select(vec!["a", "b", "c", "r/a", "in", "s", "(a|b)", "a.b"]);
    let conditions =
        prop::sample::select(vec!["Ball.found", "Ball.name == \"]\" || x > 2", "!`a]`.b && true"]);
    let kinds: [fn(Name) -> PropertyFormulaKind; 4] = [
        PropertyFormulaKind::In,
        PropertyFormulaKind::Entering,
        PropertyFormulaKind::Leaving,
        PropertyFormulaKind::Event,
    ];
    prop_oneof![
        any::<bool>().prop_map(PropertyFormulaKind::Constant),
        (prop::sample::select(kinds.to_vec()), names).prop_map(|(kind, text)| kind(name(text))),
        conditions.prop_map(|text| PropertyFormulaKind::Condition(parse_condition(text).0.unwrap())),
    ]
    .prop_map(formula)
}

fn any_of(atom: impl Strategy<Value = PropertyFormula> + 'static) -> impl Strategy<Value = PropertyFormula> {
    let bound = || prop::option::of((1..5_000_u64).prop_map(Duration::from_millis));
    atom.prop_recursive(4, 24, 3, move |inner| {
        let one = || inner.clone().prop_map(Box::new);
        let several = || prop::collection::vec(inner.clone(), 2..4);
        prop_oneof![
            one().prop_map(PropertyFormulaKind::Not),
            several().prop_map(PropertyFormulaKind::And),
            several().prop_map(PropertyFormulaKind::Or),
            (one(), one()).prop_map(|(one, other)| PropertyFormulaKind::Implies(one, other)),
            one().prop_map(PropertyFormulaKind::Always),
            (one(), bound()).prop_map(|(inner, bound)| PropertyFormulaKind::Eventually(inner, bound)),
            (one(), one(), bound())
                .prop_map(|(one, other, bound)| PropertyFormulaKind::Until(one, other, bound)),
        ]
        .prop_map(formula)
    })
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 300, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn printing_and_parsing_round_trips(formula in any_of(atom())) {
        let property = Property { name: "it is so".into(), formula, position: TextPosition::default() };
        let text = property.to_string();
        let (again, findings) = parse(&text);
        prop_assert_eq!(findings, [], "{}", text);
        prop_assert_eq!(&again, &[property]);
    }

    #[test]
    fn any_heap_of_words_is_read_and_findings_lie_in_it(
        words in prop::collection::vec(prop::sample::select(vec![
            "property", " \"p\"", ":", " always ", "eventually", " within 2 s", "(", ")", "[", "]", " in ", "ω", "`", "\"", "\n#", " a ", " until ", "not ",
        ]), 0..40)
    ) {
        let text = words.concat();
        for finding in parse(&text).1 {
            prop_assert!(text.get(finding.span.start..finding.span.end).is_some(), "{finding}");
        }
    }

    /// Compared with a direct evaluation of the semantics on a run whose last position repeats.
    #[test]
    fn a_monitor_evaluates_the_semantics_of_its_formula(
        formula in any_of(prop::sample::select(vec!["a", "b", "c"]).prop_map(|state| formula(PropertyFormulaKind::In(name(state))))),
        run in prop::collection::vec((0..8_u64, 0..3_000_u64), 1..8)
    ) {
        let chart = chart("r = a || b || c");
        let property = Property { name: "p".into(), formula: formula.clone(), position: TextPosition::default() };
        let plan = match bind(&property, &chart, &TypeEnvironment::default()) {
            Ok(bound) => bound.plan,
            Err(too_large) => {
                prop_assert_eq!(too_large[0].code, "E0844");
                return Ok(());
            }
        };
        // the bits of a letter are in the order of the atoms
        let bits: Vec<u64> = plan.atoms().iter().map(|atom| match atom {
            aseme_verify::properties::AtomicProposition::In(state) => match chart.statechart().node(*state).name.as_str() {
                "a" => 1,
                "b" => 2,
                _ => 4,
            },
            other => panic!("{other:?}"),
        }).collect();
        let letter = |states: u64| bits.iter().enumerate().fold(0, |letter, (bit, state)| letter | u64::from(states & state != 0) << bit);
        let mut now = 0;
        let mut positions: Vec<(u64, u64)> = Vec::new();
        for (states, later) in run {
            now += later * 1_000_000;
            positions.push((states, now));
        }
        let truth = holds(&formula, &positions, 0);
        let mut monitor = Monitor::new(plan);
        for &(states, now) in &positions {
            let verdict = monitor.step(letter(states), now);
            prop_assert!(verdict != MonitorVerdict::Violated || !truth, "{formula} {positions:?}");
            prop_assert!(verdict != MonitorVerdict::Satisfied || truth, "{formula} {positions:?}");
        }
        let (last, mut now) = positions[positions.len() - 1];
        for _ in 0..6 {
            now += 3_600_000_000_000;
            monitor.step(letter(last), now);
        }
        let verdict = monitor.verdict();
        prop_assert!(verdict == MonitorVerdict::Lost || (matches!(verdict, MonitorVerdict::Satisfied | MonitorVerdict::SoFar) == truth), "{verdict:?}: {formula} {positions:?}");
    }
}

/// Whether a formula holds at a position, where the last one repeats forever, an hour apart.
fn holds(formula: &PropertyFormula, run: &[(u64, u64)], at: usize) -> bool {
    let until = |left: &dyn Fn(usize) -> bool, right: &dyn Fn(usize) -> bool, bound: Option<Duration>| {
        let bound = bound.map_or(u64::MAX, |bound| bound.as_nanos() as u64);
        let in_time = |later: &usize| run[*later].1 - run[at].1 <= bound;
        (at..run.len()).take_while(in_time).find(|&later| right(later) || !left(later)).is_some_and(right)
    };
    match &formula.kind {
        PropertyFormulaKind::Constant(value) => *value,
        PropertyFormulaKind::In(state) => {
            run[at].0
                & match state.text.as_str() {
                    "a" => 1,
                    "b" => 2,
                    _ => 4,
                }
                != 0
        }
        PropertyFormulaKind::Not(inner) => !holds(inner, run, at),
        PropertyFormulaKind::And(parts) => parts.iter().all(|part| holds(part, run, at)),
        PropertyFormulaKind::Or(parts) => parts.iter().any(|part| holds(part, run, at)),
        PropertyFormulaKind::Implies(one, other) => !holds(one, run, at) || holds(other, run, at),
        PropertyFormulaKind::Always(inner) => (at..run.len()).all(|later| holds(inner, run, later)),
        PropertyFormulaKind::Eventually(inner, bound) => {
            until(&|_| true, &|later| holds(inner, run, later), *bound)
        }
        PropertyFormulaKind::Until(left, right, bound) => {
            until(&|later| holds(left, run, later), &|later| holds(right, run, later), *bound)
        }
        other => panic!("{other:?}"),
    }
}

fn chart(formulas: &str) -> CompiledChart {
    let source = Source::new("r.srm", format!("Role: r\nLiveness:\n{formulas}\n"));
    aseme_models::statechart_of(&source).0.compile(&TypeEnvironment::default()).unwrap()
}

fn monitor(text: &str) -> Monitor {
    let (properties, findings) = parse(&format!("property \"p\": {text}"));
    assert_eq!(findings, []);
    Monitor::new(bind(&properties[0], &chart("r = a . b"), &TypeEnvironment::default()).unwrap().plan)
}

#[test]
fn the_four_verdicts() {
    let mut never = monitor("always not in a");
    assert_eq!(
        [never.step(0, 0), never.step(1, 1), never.step(0, 2)],
        [MonitorVerdict::SoFar, MonitorVerdict::Violated, MonitorVerdict::Violated]
    );
    let mut once = monitor("eventually in a");
    assert_eq!(
        [once.step(0, 0), once.step(1, 1), once.step(0, 2)],
        [MonitorVerdict::Awaited, MonitorVerdict::Satisfied, MonitorVerdict::Satisfied]
    );
    assert!(!once.try_restart() && never.try_restart());
    assert_eq!(never.step(0, 3), MonitorVerdict::SoFar);
}

#[test]
fn the_oldest_of_several_waits_counts() {
    let mut soon = monitor("always (in a implies eventually in b within 10 ms)");
    let at = |milliseconds: u64| milliseconds * 1_000_000;
    assert_eq!([soon.step(1, 0), soon.step(1, at(5))], [MonitorVerdict::Awaited; 2]);
    assert_eq!(soon.deadline(), Some(at(10)));
    assert_eq!(
        [soon.step(2, at(10)), soon.step(1, at(11)), soon.step(1, at(15))],
        [MonitorVerdict::SoFar, MonitorVerdict::Awaited, MonitorVerdict::Awaited]
    );
    assert_eq!(
        [soon.pass(at(21)), soon.pass(at(21) + 1)],
        [MonitorVerdict::Awaited, MonitorVerdict::Violated]
    );
}

fn refused(text: &str) -> (&'static str, String) {
    let (_, findings) = parse(text);
    assert_eq!(findings.len(), 1, "{text}: {findings:?}");
    let Diagnostic { code, span, .. } = findings[0];
    (code, text[span.start..span.end].to_owned())
}

#[test]
fn each_mistake_has_a_code_and_a_place() {
    let in_property = |formula: &str| refused(&format!("property \"p\": {formula}"));
    let is = |code, text: &str| (code, text.to_owned());
    assert_eq!(refused("always in a"), is("E0840", "always"));
    assert_eq!(refused("property p: true"), is("E0840", "p"));
    assert_eq!(refused("property \"p\" true"), is("E0840", "true"));
    assert_eq!(in_property("always"), is("E0841", ""));
    assert_eq!(in_property("in a && in b"), is("E0841", "&"));
    assert_eq!(in_property("allways in a"), is("E0841", "allways"));
    assert_eq!(in_property("always in a within 2 s"), is("E0841", "within"));
    assert_eq!(in_property("in a until in b until in c"), is("E0841", "until"));
    assert_eq!(in_property("[In(a)]"), is("E0841", "In(a)"));
    assert_eq!(in_property("(in a"), is("E0842", "("));
    assert_eq!(in_property("[Ball.found"), is("E0842", "["));
    assert_eq!(refused("property \"p\": true property \"p\": false"), is("E0843", "property \"p\""));
    assert_eq!(in_property(&("not ".repeat(100) + "true")).0, "E0844");
    assert_eq!(in_property("eventually in a within 2"), is("E0847", "2"));
    assert_eq!(in_property("eventually in a within 0.5 ms"), is("E0847", "0.5"));
    assert_eq!(in_property("[Ball.found = 1]").0, "E0108");
}

#[test]
fn a_mistake_costs_its_property_only() {
    let (properties, findings) =
        parse("property \"a\": in in\nproperty \"b\": eventually in a within 0.5 s # soon\n");
    assert_eq!((properties.len(), findings.len()), (1, 1));
    assert_eq!(properties[0].to_string(), "property \"b\":\n    eventually in a within 500 ms\n");
}

#[test]
fn words_reach_as_far_as_they_can() {
    let text = "property \"p\": always [Ball.found] implies eventually in a or in b within 2 s and in c\n";
    let printed = parse(text).0[0].formula.to_string();
    assert_eq!(printed, "always ([Ball.found] implies ((eventually (in a or in b) within 2 s) and in c))");
}

#[test]
fn a_file_without_properties_is_an_error() {
    for text in ["", "\n", "# property \"p\": in a\n"] {
        let (properties, found) = parse(text);
        let codes: Vec<&str> = found.iter().map(|finding| finding.code).collect();
        assert_eq!((properties.len(), codes), (0, vec!["E0840"]), "{text:?}");
    }
    assert_eq!(parse("always in a\n").1.len(), 1, "once is enough");
}
