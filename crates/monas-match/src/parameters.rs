//! Parameters in files: each a number set by name, with its unit, range and meaning beside it.

use monas::config::xml::{Attribute, Element};
use monas_sim::Parameter;
use yase::Diagnostic;

/// Sets parameters from the attributes of an element: `<field length="6.0" width="4.0"/>`.
pub(crate) fn from_attributes(
    element: &Element,
    known: &[Parameter],
    diagnostics: &mut Vec<Diagnostic>,
    mut set: impl FnMut(&str, f64),
) {
    for Attribute { name, name_span, value, value_span } in element.attributes() {
        match read(name, value, known) {
            Ok(number) => set(name, number),
            Err(Mistake::Name(message)) => {
                let diagnostic = element.error("E0401", *name_span, message);
                diagnostics.push(diagnostic.with_nearest(name, known.iter().map(|parameter| parameter.key)));
            }
            Err(Mistake::Value(message)) => diagnostics.push(element.error("E0402", *value_span, message)),
        }
    }
}

/// Sets parameters from the elements in an element: `<physics><ball_radius>0.0325</ball_radius></physics>`.
pub(crate) fn from_children(
    element: &Element,
    known: &[Parameter],
    diagnostics: &mut Vec<Diagnostic>,
    mut set: impl FnMut(&str, f64),
) {
    for child in element.children() {
        match read(child.name(), child.text(), known) {
            Ok(number) => set(child.name(), number),
            Err(Mistake::Name(message)) => {
                let diagnostic = child.error("E0401", child.name_span(), message);
                diagnostics
                    .push(diagnostic.with_nearest(child.name(), known.iter().map(|parameter| parameter.key)));
            }
            Err(Mistake::Value(message)) => {
                diagnostics.push(child.error("E0402", child.text_span(), message))
            }
        }
    }
}

enum Mistake {
    Name(String),
    Value(String),
}

fn read(key: &str, text: &str, known: &[Parameter]) -> Result<f64, Mistake> {
    let Some(parameter) = known.iter().find(|parameter| parameter.key == key) else {
        return Err(Mistake::Name(format!("there is no parameter `{key}`")));
    };
    let number: f64 = text.trim().parse().map_err(|_| Mistake::Value(format!("`{text}` is not a number")))?;
    if parameter.allows(number) {
        return Ok(number);
    }
    let Parameter { least, most, unit, .. } = parameter;
    Err(Mistake::Value(format!("`{key}` is {number}, but must lie from {least} to {most} ({unit})")))
}

/// Every parameter of the simulator with its default, as the text of a file that documents itself.
pub fn simulator_file() -> String {
    let mut text = String::from(
        "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n\
         <!-- Every number of the simulator, with its default. What is left out keeps its default. -->\n<simulator>\n",
    );
    section(&mut text, "physics", monas_sim::Physics::keys());
    section(&mut text, "rules", monas_sim::Rules::keys());
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
    /// The file in the project is the one that this crate writes: `MONAS_BLESS=1 cargo test` writes it anew.
    #[test]
    fn the_simulator_file_lists_every_parameter() {
        let path = concat!(env!("CARGO_MANIFEST_DIR"), "/../../config/simulator.xml");
        if std::env::var_os("MONAS_BLESS").is_some() {
            std::fs::write(path, super::simulator_file()).unwrap();
        }
        assert_eq!(std::fs::read_to_string(path).unwrap(), super::simulator_file());
    }
}
