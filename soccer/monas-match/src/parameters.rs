//! Parameters in files: named numbers with unit, range and documentation.

use monas::config::{Element, Grammar, Values};
use monas_sim::Parameter;

/// Sets parameters from the attributes of a checked element: `<field length="6.0" width="4.0"/>`.
pub(crate) fn from_attributes(
    element: &Element,
    grammar: &Grammar,
    known: &[Parameter],
    mut set: impl FnMut(&str, f64),
) {
    let values = Values::of(element, grammar);
    for Parameter { key, .. } in known {
        if let Some(number) = values.number(key) {
            set(key, number);
        }
    }
}

/// Sets parameters from the children of a checked element:
/// `<physics><ball_radius>0.0325</ball_radius></physics>`.
pub(crate) fn from_children(element: &Element, grammar: &Grammar, mut set: impl FnMut(&str, f64)) {
    for child in element.children() {
        let rule = grammar.element(child.name());
        let allowed = rule.is_some_and(|rule| rule.allows_text(child.text()));
        if let (Some(rule), Ok(number), true) = (rule, child.text().parse(), allowed) {
            set(rule.name(), number);
        }
    }
}

/// The text of a documented configuration file with every parameter of the simulator at its
/// default.
pub fn simulator_file() -> String {
    let mut text = String::from(
        "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n\
         <!-- Every number of the simulator, with its default. What is left out keeps its default. -->\n<simulator>\n",
    );
    section(&mut text, "physics", monas_sim::Physics::keys());
    section(&mut text, "rules", monas_sim::MatchRules::keys());
    section(&mut text, "radio", monas_sim::Radio::keys());
    text.push_str("</simulator>\n");
    text
}

fn section(text: &mut String, name: &str, parameters: &[Parameter]) {
    text.push_str(&format!("  <{name}>\n"));
    for Parameter { key, unit, default, doc, .. } in parameters {
        let doc = doc.split_whitespace().collect::<Vec<_>>().join(" ").replace("--", "-");
        text.push_str(&format!("    <!-- {doc} Unit: {unit}. -->\n    <{key}>{default}</{key}>\n"));
    }
    text.push_str(&format!("  </{name}>\n"));
}

#[cfg(test)]
mod tests {
    /// The file in the project equals the one that this crate writes; `MONAS_BLESS=1 cargo test`
    /// updates it.
    #[test]
    fn the_simulator_file_lists_every_parameter() {
        let path = concat!(env!("CARGO_MANIFEST_DIR"), "/../../config/simulator.xml");
        if std::env::var_os("MONAS_BLESS").is_some() {
            std::fs::write(path, super::simulator_file()).unwrap();
        }
        assert_eq!(std::fs::read_to_string(path).unwrap(), super::simulator_file());
    }
}
