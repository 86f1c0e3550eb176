//! Elements that cannot be represented in Rust, and texts that are no chart.

use aseme_codegen::generate::{RustBindings, generate};
use yase::{Diagnostic, Source, TypeEnvironment};

use crate::words::soccer;

fn refused(transitions: &str, words: &RustBindings) -> Vec<String> {
    let model = format!("Liveness:\np = a . b\nTransitions:\n{transitions}\n");
    let (chart, found) = aseme_models::statechart_of(&Source::new("p.srm", model));
    assert_eq!(found, []);
    let found = generate(&chart, words).expect_err("it is refused");
    found.iter().map(|Diagnostic { code, message, .. }| format!("{code} {message}")).collect()
}

#[test]
fn misspelt_names_are_reported_before_generation() {
    let found = refused("a -> b : [Ball.fund]", &soccer());
    assert_eq!(found, ["E0134 the message `Ball` has no field `fund` (from `p/a` to `p/b`)"]);
}

#[test]
fn a_message_without_a_type_is_refused() {
    let words = RustBindings { messages: [].into(), ..soccer() };
    let found = refused("a -> b : [Ball.found]", &words);
    assert_eq!(found, ["E0921 the Rust type of the message `Ball` is unknown"]);
}

#[test]
fn a_script_has_no_counterpart() {
    let vocabulary = TypeEnvironment { scripts: true, ..TypeEnvironment::default() };
    let found =
        refused("a -> b : [script(\"x > 1\")]", &RustBindings { vocabulary, ..RustBindings::default() });
    assert_eq!(found, ["E0920 an expression of the chart `p` is a script"]);
}

#[test]
fn two_activities_that_would_have_one_name_are_refused() {
    let (chart, found) = aseme_models::statechart_of(&Source::new("p.srm", "p = passBall . PassBall"));
    assert_eq!(found, []);
    let found = generate(&chart, &RustBindings { registers: true, ..RustBindings::default() })
        .expect_err("it is refused");
    assert_eq!(
        found[0].message,
        "the activity `passBall` and another would have one name in Rust: `PassBall`"
    );
}
