//! Structural faults: those that the original editors report, and those that prevent a chart.

use yase::{Diagnostic, Span};

use super::Iac;

/// The types in files of the original tools.
const TYPES: [&str; 8] = ["OR", "AND", "BASIC", "START", "END", "CONDITION", "HISTORY", "SHALLOW_HISTORY"];

/// Further types of charts.
const MORE_TYPES: [&str; 7] = ["JUNCTION", "CHOICE", "FORK", "JOIN", "TERMINATE", "ENTRY", "EXIT"];

/// The structural faults of a chart (E0811, E0813, E0814, E0816).
pub(crate) fn faults(chart: &Iac, file: Span) -> Vec<Diagnostic> {
    let mut found = roots(chart, file);
    found.extend(labels(chart));
    found.extend(types(chart));
    found.extend(places(chart));
    found.extend(ends(chart));
    found
}

fn roots(chart: &Iac, file: Span) -> Vec<Diagnostic> {
    let mut roots = chart.nodes.iter().filter(|node| node.parent.is_none());
    let Some(root) = roots.next() else {
        return vec![Diagnostic::error("E0811", file, "the chart has no nodes")];
    };
    let mut found = Vec::new();
    if root.kind != "OR" {
        let message = format!("the root is of the type `{}`, not OR", root.kind);
        found.push(Diagnostic::warning("E0814", root.place.0, message));
    }
    for other in roots {
        let message = format!("`{}` is a second root beside `{}`", other.name, root.name);
        found.push(Diagnostic::error("E0811", other.place.0, message).with_hint("a chart has one root"));
    }
    found
}

fn labels(chart: &Iac) -> Vec<Diagnostic> {
    let usual = chart.labels();
    let wrong = chart.nodes.iter().zip(&usual).filter(|(node, usual)| node.label != **usual);
    let message = |label: &str, usual: &str| match label {
        "" => format!("a node has no label, which would be `{usual}`"),
        label => format!("the label is `{label}` instead of `{usual}`"),
    };
    wrong
        .map(|(node, usual)| Diagnostic::warning("E0813", node.place.0, message(&node.label, usual)))
        .collect()
}

fn types(chart: &Iac) -> Vec<Diagnostic> {
    let known = || TYPES.into_iter().chain(MORE_TYPES);
    let unknown = chart.nodes.iter().filter(|node| !known().any(|kind| kind == node.kind));
    let finding = |node: &super::IacNode| {
        let message = match node.kind.as_str() {
            "" => format!("`{}` has no type", node.name),
            kind => format!("`{kind}` is not a type of nodes"),
        };
        let hint = format!("types are {}", TYPES.join(", "));
        Diagnostic::warning("E0814", node.place.0, message).with_hint(hint).with_nearest(&node.kind, known())
    };
    unknown.map(finding).collect()
}

/// Checks the nesting of types.
fn places(chart: &Iac) -> Vec<Diagnostic> {
    let mut found = Vec::new();
    let mut report = |span, message: String| found.push(Diagnostic::warning("E0816", span, message));
    for (node, children) in chart.nodes.iter().zip(chart.children()) {
        let count = |kind: &str| children.iter().filter(|&&child| chart.nodes[child].kind == kind).count();
        let (name, span) = (&node.name, node.place.0);
        match node.kind.as_str() {
            "OR" if children.is_empty() => report(span, format!("`{name}` is an OR without children")),
            "OR" => {
                if count("START") != 1 {
                    report(span, format!("`{name}` has {} STARTs instead of one", count("START")));
                }
                if count("END") > 1 {
                    report(span, format!("`{name}` has {} ENDs instead of one at most", count("END")));
                }
            }
            "AND" => {
                for &child in children.iter().filter(|&&child| chart.nodes[child].kind != "OR") {
                    let child = &chart.nodes[child];
                    report(child.place.0, format!("`{}` is a child of an AND, but no OR", child.name));
                }
            }
            kind if !children.is_empty() => {
                report(span, format!("`{name}` is of the type {kind}, but has children"))
            }
            _ => {}
        }
    }
    found
}

/// Checks the sources and targets of transitions.
fn ends(chart: &Iac) -> Vec<Diagnostic> {
    let mut found = Vec::new();
    for transition in &chart.transitions {
        let (source, target) = (&chart.nodes[transition.source], &chart.nodes[transition.target]);
        if target.kind == "START" {
            found.push(Diagnostic::warning("E0816", transition.place.0, "a transition leads to a START"));
        }
        if source.kind == "END" {
            found.push(Diagnostic::warning("E0816", transition.place.0, "a transition leaves an END"));
        }
    }
    found
}
