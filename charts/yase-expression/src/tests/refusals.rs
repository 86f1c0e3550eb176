//! Rejected texts: each table pairs a text with its diagnostics.

mod compiling;
mod parsing;

use std::collections::BTreeSet;

use super::test_context::{compile_with, said};
use crate::{EventInterner, parse_condition, parse_transition};
use compiling::COMPILING;
use parsing::PARSING;

type Table = &'static [(&'static str, &'static [&'static str])];

#[test]
fn unreadable_input_is_rejected_with_a_reason() {
    for (text, expected) in PARSING {
        assert_eq!(said(text, &parse_transition(text).1), *expected, "{text}");
    }
}

#[test]
fn meaningless_input_is_rejected_with_a_reason() {
    for (text, expected) in COMPILING {
        let wrong = compile_with(text, &mut EventInterner::new()).expect_err(text);
        assert_eq!(said(text, &wrong), *expected, "{text}");
    }
}

#[test]
fn a_deep_nesting_is_refused_with_a_reason() {
    let text = format!("{}1", "-".repeat(256));
    let expected = "E0112 <1>: the expression is nested deeper than 256 levels (split it up)";
    assert_eq!(said(&text, &parse_condition(&text).1), [expected]);
}

/// The codes listed in the documentation are exactly those that can occur.
#[test]
fn every_code_is_documented_and_occurs() {
    let documentation = include_str!("../lib.rs");
    let listed = documentation.lines().filter_map(|line| line.strip_prefix("//! | E"));
    let documented: BTreeSet<_> = listed.filter_map(|line| line.get(..4)).collect();
    let said = PARSING.iter().chain(COMPILING).flat_map(|(_, said)| *said);
    let mut occurring: BTreeSet<_> = said.map(|said| &said[1..5]).collect();
    occurring.insert("0112");
    assert_eq!(documented, occurring);
}
