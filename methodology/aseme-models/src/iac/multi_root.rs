//! Parser of the dialect of 2010: every node, transition and model is a root, in any order, and
//! labels define the nesting.

use std::collections::BTreeMap;

use roxmltree::Node;
use yase::Diagnostic;

use super::from_xmi::{MODEL, Reader};
use crate::xmi;

/// Reads the roots of a document.
pub(crate) fn read(reader: &mut Reader, root: Node<'_, '_>) {
    let of =
        |name: &'static str| xmi::elements(root).filter(move |element| element.tag_name().name() == name);
    for element in xmi::elements(root) {
        let name = element.tag_name().name();
        if !["Node", "Transition", "Model", "Variable"].contains(&name) {
            reader.unknown_element(
                "file",
                name,
                &["Node", "Transition", "Model", "Variable"],
                xmi::tag(element),
            );
        }
    }
    of("Variable").for_each(|element| reader.variable(element));
    let nodes = by_label(of("Node").collect());
    let mut labels: BTreeMap<&str, usize> = BTreeMap::new();
    for (index, element) in nodes.iter().enumerate() {
        let label = element.attribute("label").unwrap_or_default();
        let parent = label.rsplit_once('.').and_then(|(parent, _)| labels.get(parent).copied());
        if parent.is_none() && label.contains('.') {
            let message = format!("no node has the label of the parent of `{label}`");
            reader.report(Diagnostic::error("E0811", xmi::tag(*element), message));
        }
        if labels.insert(label, index).is_some() {
            let message = format!("another node has the label `{label}`");
            reader.report(Diagnostic::error("E0813", xmi::tag(*element), message));
        }
        reader.node(*element, parent);
    }
    for (index, element) in nodes.iter().enumerate() {
        reader.links(index, *element);
    }
    let models: Vec<Node<'_, '_>> = of("Model").collect();
    let order = transitions_in_order(reader, &models, of("Transition").collect());
    order.into_iter().for_each(|element| reader.transition(element));
    match models.as_slice() {
        [] => reader.report(
            Diagnostic::error("E0811", xmi::tag(root), "the file has no model")
                .with_hint("add `<IAC:Model nodes=.. transitions=.. name=../>`"),
        ),
        [model, rest @ ..] => {
            about(reader, *model);
            for second in rest {
                reader.report(Diagnostic::error("E0811", xmi::tag(*second), "the file has a model already"));
            }
        }
    }
}

/// Nodes sorted by label, which puts parents before children.
fn by_label<'a, 'input>(mut nodes: Vec<Node<'a, 'input>>) -> Vec<Node<'a, 'input>> {
    let key = |node: &Node<'_, '_>| -> Vec<u64> {
        let label = node.attribute("label").unwrap_or_default();
        label.split('.').map(|number| number.parse().unwrap_or(u64::MAX)).collect()
    };
    nodes.sort_by_cached_key(key);
    nodes
}

/// The transitions in the order in which the model lists them.
fn transitions_in_order<'a, 'input>(
    reader: &mut Reader,
    models: &[Node<'a, 'input>],
    mut transitions: Vec<Node<'a, 'input>>,
) -> Vec<Node<'a, 'input>> {
    let listed = |name: &str| -> Vec<usize> {
        let values = models.iter().filter_map(|model| model.attribute(name));
        values.flat_map(str::split_whitespace).filter_map(|word| reader.paths.find(word)).collect()
    };
    let place = |ids: &[usize]| -> BTreeMap<usize, usize> {
        ids.iter().zip(0..).map(|(id, position)| (*id, position)).collect()
    };
    let (listed_nodes, listed_transitions) = (place(&listed("nodes")), place(&listed("transitions")));
    transitions.sort_by_key(|element| {
        listed_transitions.get(&element.id().get_usize()).copied().unwrap_or(usize::MAX)
    });
    let mut lost: Vec<Diagnostic> = Vec::new();
    for (id, index) in &reader.nodes {
        if !listed_nodes.contains_key(id) {
            let node = &reader.chart.nodes[*index];
            let message = format!("the model does not list the node `{}`", node.name);
            lost.push(Diagnostic::warning("E0812", node.position.0, message));
        }
    }
    for element in
        transitions.iter().filter(|element| !listed_transitions.contains_key(&element.id().get_usize()))
    {
        let message = "the model does not list this transition";
        lost.push(Diagnostic::warning("E0812", xmi::tag(*element), message));
    }
    reader.diagnostics.extend(lost);
    transitions
}

fn about(reader: &mut Reader, model: Node<'_, '_>) {
    let names: Vec<&str> = MODEL.into_iter().chain(["nodes", "transitions", "variables"]).collect();
    reader.about(model);
    reader.known(model, "model", &names);
    for name in ["nodes", "transitions"] {
        let Some(attribute) = model.attribute_node(name) else { continue };
        let dangling = |word: &&str| reader.paths.find(word).is_none();
        let dangling: Vec<&str> = attribute.value().split_whitespace().filter(dangling).collect();
        for word in dangling {
            reader.dangling(word, name.trim_end_matches('s'), xmi::value_span(&attribute));
        }
    }
}
