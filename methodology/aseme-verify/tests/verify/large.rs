//! A role larger than those of a team.

use std::fmt::Write;

/// A role of 100 formulas, each a choice with two guarded branches: about 2,000 states.
pub(crate) fn large() -> String {
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
