//! Real expressions of robot teams, stored beside the workspace if available.

use std::path::PathBuf;

use crate::parse_transition;

fn expressions() -> Option<Vec<String>> {
    let beside = PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("../../../shared");
    let shared = std::env::var_os("MONAS_SHARED").map_or(beside, PathBuf::from);
    let text = std::fs::read_to_string(shared.join("models/transition_expressions.txt")).ok()?;
    let lines = text.lines().filter_map(|line| line.strip_prefix('"')?.strip_suffix('"'));
    Some(lines.map(|line| line.replace("\\n", "\n").replace("\\\"", "\"")).collect())
}

/// Most of them are valid; the others are mistakes of their authors, or notes.
#[test]
fn real_expressions_are_understood_or_refused_with_a_reason() {
    let Some(expressions) = expressions() else {
        println!("skipped: the real expressions are not here");
        return;
    };
    let mut refused = 0;
    for text in &expressions {
        let (expression, diagnostics) = parse_transition(text);
        if let Some(first) = diagnostics.first() {
            assert!(first.hint.is_some(), "no hint for {text}: {first}");
            println!("refused {text:?}: {first}");
            refused += 1;
            continue;
        }
        let printed = expression.to_string();
        assert!(!expression.is_empty(), "understood as nothing: {text}");
        assert_eq!(parse_transition(&printed), (expression, vec![]), "{text}");
    }
    println!("{} understood, {refused} refused", expressions.len() - refused);
    assert_eq!((expressions.len(), refused), (132, 22));
}
