//! Writer of the text form.

use yase::statechart::ConstantValue;
use yase_export::notation::duration_text;

use super::path::{NodePaths, name_text};
use super::{ChartKind, Iac, IacNode, IacTransition};
use crate::document::{Item, ItemDocument, reference, value_text};
use aseme::layout::{BENDS_KEY, bends_text, frame_settings};

/// A chart as text: variables, constants, the tree of states, the transitions in their order.
pub(crate) fn to_text(chart: &Iac) -> ItemDocument {
    let names_are_labels = has_labels_as_names(chart);
    let mut items = vec![header(chart, names_are_labels)];
    for variable in &chart.variables {
        let name = if variable.name.is_empty() { String::new() } else { value_text(&variable.name) };
        let mut item = Item::new("Variable", name);
        if !variable.kind.is_empty() {
            item.set("type", &value_text(&variable.kind));
        }
        items.push(item);
    }
    items.extend(constants(chart));
    items.push(states(chart));
    if !chart.transitions.is_empty() {
        items.push(transitions(chart, names_are_labels));
    }
    ItemDocument { items, tail: Vec::new() }
}

fn header(chart: &Iac, names_are_labels: bool) -> Item {
    let word = match chart.kind {
        ChartKind::Intra => "IAC",
        ChartKind::Inter => "EAC",
    };
    let mut header =
        Item::new(word, if chart.name.is_empty() { String::new() } else { value_text(&chart.name) });
    for (key, value) in [("description", &chart.description), ("metadata", &chart.metadata)] {
        set(&mut header, 2, key, value);
    }
    if names_are_labels {
        header.set("transition_names", "labels");
    }
    header
}

fn set(item: &mut Item, indent: usize, key: &str, value: &str) {
    if !value.is_empty() {
        item.line(indent, format!("{key} = {}", value_text(value)));
    }
}

fn constants(chart: &Iac) -> Option<Item> {
    let mut item = Item::new("Constants", String::new());
    for constant in &chart.constants {
        let value = match &constant.value {
            ConstantValue::Bool(value) => value.to_string(),
            ConstantValue::Number(value) => value.to_string(),
            ConstantValue::Text(text) => crate::document::quoted(text),
        };
        item.set(&constant.name, &value);
    }
    (!item.lines.is_empty()).then_some(item)
}

/// The default name of a transition in files of 2010, which consists of labels.
pub(crate) fn label_name(labels: &[String], transition: &IacTransition) -> String {
    format!("{}TO{}", labels[transition.source], labels[transition.target])
}

fn has_labels_as_names(chart: &Iac) -> bool {
    let labels = chart.labels();
    let by_label = |it: &IacTransition| it.name == label_name(&labels, it);
    let usual = |it: &IacTransition| it.name == chart.usual_name(it.source, it.target);
    chart.transitions.iter().all(by_label) && !chart.transitions.iter().all(usual)
}

fn states(chart: &Iac) -> Item {
    let mut item = Item::new("States", String::new());
    let labels = chart.labels();
    let variables = variable_references(chart);
    let mut levels: Vec<usize> = Vec::new();
    for (node, label) in chart.nodes.iter().zip(&labels) {
        let level = node.parent.and_then(|parent| levels.get(parent)).map_or(0, |level| level + 1);
        levels.push(level);
        let indent = 2 + 2 * level;
        item.line(indent, node_line(node, label));
        settings(node, label, &variables, indent + 2, &mut item);
    }
    item
}

fn node_line(node: &IacNode, label: &str) -> String {
    let is_word =
        !node.kind.is_empty() && node.kind.bytes().all(|byte| byte.is_ascii_uppercase() || byte == b'_');
    let kind = if is_word { node.kind.as_str() } else { "NODE" };
    let named_by_label = node.name == label && node.parent.is_some();
    if named_by_label { kind.into() } else { format!("{} {kind}", name_text(node)) }
}

fn settings(node: &IacNode, label: &str, variables: &[String], indent: usize, item: &mut Item) {
    let mut set_text = |key: &str, value: &str| set(item, indent, key, value);
    if node_line(node, label).ends_with("NODE") {
        set_text("type", &node.kind);
    }
    if node.label != *label {
        let label = if node.label.is_empty() { "\"\"".into() } else { value_text(&node.label) };
        item.line(indent, format!("label = {label}"));
    }
    let refinement = &node.refinement;
    if let Some(activity) = &refinement.activity {
        item.line(indent, format!("activity = {}", value_text(activity)));
    }
    if refinement.priority != 0 {
        item.line(indent, format!("priority = {}", refinement.priority));
    }
    let texts = [("entry", &refinement.entry), ("exit", &refinement.exit), ("defer", &refinement.defer)];
    texts.into_iter().for_each(|(key, value)| set(item, indent, key, value));
    if let Some(duration) = refinement.duration {
        item.line(indent, format!("duration = {}", duration_text(duration)));
    }
    for (key, value) in frame_settings(&node.frame) {
        item.line(indent, format!("{key} = {value}"));
    }
    if !node.variables.is_empty() {
        let names = node.variables.iter().filter_map(|&index| variables.get(index).map(String::as_str));
        item.line(indent, format!("variables = {}", names.collect::<Vec<_>>().join(", ")));
    }
    let texts =
        [("functionality", &node.functionality), ("actions", &node.actions), ("metadata", &node.metadata)];
    texts.into_iter().for_each(|(key, value)| set(item, indent, key, value));
}

/// The reference to each variable.
fn variable_references(chart: &Iac) -> Vec<String> {
    let mut seen = std::collections::BTreeMap::new();
    let refer = |variable: &super::Variable| {
        let number: &mut usize = seen.entry(variable.name.clone()).or_default();
        *number += 1;
        reference(&variable.name, *number)
    };
    chart.variables.iter().map(refer).collect()
}

fn transitions(chart: &Iac, names_are_labels: bool) -> Item {
    let mut item = Item::new("Transitions", String::new());
    let (paths, labels) = (NodePaths::new(chart), chart.labels());
    let shortest: Vec<String> = (0..chart.nodes.len()).map(|node| paths.shortest(node)).collect();
    for transition in &chart.transitions {
        let refinement = &transition.refinement;
        let mut line = format!("{} -> {}", shortest[transition.source], shortest[transition.target]);
        if refinement.priority != 0 {
            line.push_str(&format!(" !{}", refinement.priority));
        }
        if let Some(weight) = refinement.weight {
            line.push_str(&format!(" %{weight}"));
        }
        line.push_str(if refinement.interrupts { " interrupts" } else { "" });
        line.push_str(if refinement.internal { " internal" } else { "" });
        if !transition.te.is_empty() {
            line.push_str(&format!(" : {}", value_text(&transition.te)));
        }
        item.line(2, line);
        let usual = match names_are_labels {
            true => label_name(&labels, transition),
            false => chart.usual_name(transition.source, transition.target),
        };
        if transition.name != usual {
            item.line(4, format!("name = {}", value_text(&transition.name)));
        }
        set(&mut item, 4, "metadata", &transition.metadata);
        if !transition.bends.is_empty() {
            item.line(4, format!("{BENDS_KEY} = {}", bends_text(&transition.bends)));
        }
    }
    item
}
