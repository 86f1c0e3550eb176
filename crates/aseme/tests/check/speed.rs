//! How much the checks do for a large role.

use std::fmt::Write;

use aseme::check::{Settings, check};
use yase::Source;

/// A role of 100 formulas, each a choice of three out of which two guards lead: about 2,000 states.
fn large() -> String {
    let mut text = String::from("Role: large\nLiveness:\nlarge = ");
    let names: Vec<String> = (0..99).map(|number| format!("f{number}")).collect();
    text += &names.join(" . ");
    text += "\n";
    for name in &names {
        writeln!(text, "{name} = (a{name} . b{name} . [c{name}]) | (d{name}+ . e{name}) | g{name}~").unwrap();
    }
    text += "Transitions:\n";
    for name in &names {
        let first = format!("(a{name}.b{name}.[c{name}])");
        writeln!(text, "{name}/CONDITION -> {first} : [Ball.x > 2 && Ball.y - Ball.x < 1]").unwrap();
        writeln!(text, "{name}/CONDITION -> (d{name}+.e{name}) : [Ball.x <= 2 || Ball.y - Ball.x >= 1]")
            .unwrap();
    }
    text
}

#[test]
fn a_large_role_is_checked() {
    let mut settings = Settings::default();
    settings.states = 100;
    let report = check(&Source::new("large.srm", large()), &settings);
    let what = report.what.clone().unwrap_or_default();
    let nodes: usize = what.split(' ').next().and_then(|count| count.parse().ok()).unwrap_or(0);
    assert!(nodes >= 1_900, "{what}");
    let shadowed = report.findings.iter().filter(|finding| finding.diagnostic.code == "M07").count();
    assert!(shadowed >= 99, "each `g` comes too late: {shadowed}");
    assert!(!report.has_errors());
}
