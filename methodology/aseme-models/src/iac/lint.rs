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
    found.extend(nesting(chart));
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
        found.push(Diagnostic::warning("E0814", root.position.0, message));
    }
    for other in roots {
        let message = format!("`{}` is a second root beside `{}`", other.name, root.name);
        found.push(Diagnostic::error("E0811", other.position.0, message).with_hint("a chart has one root"));
    }
    found
}

/// Checks the labels. A label that continues those before it, or that of its parent, is not
/// reported if these are wrong: they are.
fn labels(chart: &Iac) -> Vec<Diagnostic> {
    let usual = chart.labels();
    // By node: the number of the child that comes next.
    let mut next = vec![1_usize; chart.nodes.len()];
    let mut wrong = Vec::new();
    for (node, usual) in chart.nodes.iter().zip(&usual) {
        let written = node.label.rsplit_once('.').and_then(|(_, number)| number.parse::<usize>().ok());
        let follows = match node.parent.and_then(|parent| Some((chart.nodes.get(parent)?, &mut next[parent])))
        {
            Some((parent, next)) => {
                let follows = node.label == format!("{}.{next}", parent.label);
                *next = written.unwrap_or(*next).saturating_add(1);
                follows
            }
            None => false,
        };
        if node.label != *usual && !follows {
            wrong.push((node, usual));
        }
    }
    let message = |label: &str, usual: &str| match label {
        "" => format!("a node has no label, which would be `{usual}`"),
        label => format!("the label is `{label}` instead of `{usual}`"),
    };
    wrong
        .into_iter()
        .map(|(node, usual)| Diagnostic::warning("E0813", node.position.0, message(&node.label, usual)))
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
        Diagnostic::warning("E0814", node.position.0, message)
            .with_hint(hint)
            .with_nearest(&node.kind, known())
    };
    unknown.map(finding).collect()
}

/// Checks the nesting of types.
fn nesting(chart: &Iac) -> Vec<Diagnostic> {
    let mut found = Vec::new();
    let mut report = |span, message: String| found.push(Diagnostic::warning("E0816", span, message));
    for (node, children) in chart.nodes.iter().zip(chart.children()) {
        let count = |kind: &str| children.iter().filter(|&&child| chart.nodes[child].kind == kind).count();
        let (name, span) = (&node.name, node.position.0);
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
                    report(child.position.0, format!("`{}` is a child of an AND, but no OR", child.name));
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
            found.push(Diagnostic::warning("E0816", transition.position.0, "a transition leads to a START"));
        }
        if source.kind == "END" {
            found.push(Diagnostic::warning("E0816", transition.position.0, "a transition leaves an END"));
        }
    }
    found
}

#[cfg(test)]
mod tests {
    #[test]
    fn a_skipped_label_is_reported_once() {
        let child = |label: &str, inner: &str| {
            format!("<Children name=\"a\" label=\"{label}\" type=\"OR\">{inner}</Children>")
        };
        let report = |children: &str| -> Vec<String> {
            let text = format!(
                "<statechart:Model xmi:version=\"2.0\" xmlns:xmi=\"http://www.omg.org/XMI\" \
                 xmlns:statechart=\"http://statechart/1.0\" name=\"r\"><nodes name=\"r\" label=\"0\" \
                 type=\"OR\">{children}</nodes></statechart:Model>"
            );
            let (_, found) = crate::convert::read(&yase::Source::new("r.stct", text));
            found.into_iter().filter(|it| it.code == "E0813").map(|it| it.message).collect()
        };
        let skipped = [child("0.1", ""), child("0.3", &child("0.3.1", "")), child("0.4", "")].concat();
        assert_eq!(report(&skipped), ["the label is `0.3` instead of `0.2`"]);
        let repeated = [child("0.1", ""), child("0.1", ""), child("0.2", ""), child("", "")].concat();
        assert_eq!(
            report(&repeated),
            ["the label is `0.1` instead of `0.2`", "a node has no label, which would be `0.4`"]
        );
    }
}
