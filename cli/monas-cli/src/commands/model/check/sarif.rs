//! Findings as SARIF 2.1.0, the format of editors and code hosts for the results of checks.

use std::collections::BTreeMap;

use aseme_verify::{Finding, check::CHECKS};
use serde_json::{Value, json};
use yase::{Diagnostic, Severity};

const SCHEMA: &str = "https://json.schemastore.org/sarif-2.1.0.json";

/// The paths of states, by their names.
type StatePaths = BTreeMap<String, String>;

/// One run of all checks, with its findings and the paths of the states that each names.
pub(crate) fn document<'a>(findings: impl Iterator<Item = (&'a Finding, StatePaths)>) -> Value {
    let rules: Vec<Value> = CHECKS
        .iter()
        .map(|check| {
            json!({
                "id": check.id,
                "shortDescription": {"text": check.title},
                "defaultConfiguration": {"level": level(check.severity)},
            })
        })
        .collect();
    let driver = json!({"name": "monas", "version": env!("CARGO_PKG_VERSION"), "rules": rules});
    let results: Vec<Value> =
        findings.map(|(finding, states)| result(&finding.diagnostic, &states)).collect();
    let run = json!({"tool": {"driver": driver}, "columnKind": "unicodeCodePoints", "results": results});
    json!({"$schema": SCHEMA, "version": "2.1.0", "runs": [run]})
}

fn level(severity: Severity) -> &'static str {
    match severity {
        Severity::Information => "note",
        Severity::Warning => "warning",
        Severity::Error => "error",
    }
}

fn result(diagnostic: &Diagnostic, states: &StatePaths) -> Value {
    let hint = diagnostic.hint.as_ref().map(|hint| format!(" ({hint})"));
    let text = format!("{}{}", diagnostic.message, hint.unwrap_or_default());
    json!({
        "ruleId": diagnostic.code,
        "level": level(diagnostic.severity),
        "message": {"text": text},
        "locations": location(diagnostic, states).into_iter().collect::<Vec<_>>(),
    })
}

fn location(diagnostic: &Diagnostic, states: &StatePaths) -> Option<Value> {
    let source = diagnostic.source.as_ref()?;
    let (line, column) = source.position(diagnostic.span.start);
    let (end_line, end_column) = source.position(diagnostic.span.end);
    let region =
        json!({"startLine": line, "startColumn": column, "endLine": end_line, "endColumn": end_column});
    let physical = json!({"artifactLocation": {"uri": uri(&source.name)}, "region": region});
    let mut location = json!({"physicalLocation": physical});
    if let (false, Some(fields)) = (states.is_empty(), location.as_object_mut()) {
        let logical = states.iter().map(|(name, path)| json!({"name": name, "fullyQualifiedName": path}));
        fields.insert("logicalLocations".into(), logical.collect());
    }
    Some(location)
}

/// A path as a percent-encoded URI reference, relative to the working directory.
fn uri(path: &str) -> String {
    let mut uri = String::new();
    for byte in path.replace('\\', "/").bytes() {
        match byte {
            b'a'..=b'z' | b'A'..=b'Z' | b'0'..=b'9' | b'/' | b'.' | b'-' | b'_' | b'~' => {
                uri.push(char::from(byte))
            }
            _ => uri.push_str(&format!("%{byte:02X}")),
        }
    }
    uri
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_path_is_a_reference() {
        assert_eq!(uri("models/my role.srm"), "models/my%20role.srm");
        assert_eq!(uri("a/ω.srm"), "a/%CF%89.srm");
    }
}
