//! Parser of the XMI dialects with one root.

use std::collections::BTreeMap;

use roxmltree::{Attribute, Document, Node};
use yase::expression::TextPosition;
use yase::{Diagnostic, Span};

use super::multi_root;
use super::{Iac, IacNode, IacTransition, MAX_LEVELS, Variable, lint, without_null};
use crate::xmi::{self, XmiPaths};

/// Parses a chart from XMI; the findings are E0802 to E0819.
pub(crate) fn from_xmi(document: &Document<'_>) -> (Iac, Vec<Diagnostic>) {
    let root = document.root_element();
    let mut reader = Reader::new(document);
    match xmi::has_many_roots(root) {
        true => multi_root::read(&mut reader, root),
        false => reader.model(root),
    }
    let Reader { chart, mut diagnostics, .. } = reader;
    let mut chart = chart.in_order();
    diagnostics.extend(flatten(&mut chart));
    diagnostics.extend(lint::faults(&chart, xmi::tag(root)));
    (chart, diagnostics)
}

/// Moves nodes that nest too deep to the deepest allowed level.
fn flatten(chart: &mut Iac) -> Option<Diagnostic> {
    let mut levels: Vec<usize> = Vec::with_capacity(chart.nodes.len());
    let mut found = None;
    for index in 0..chart.nodes.len() {
        let parent = chart.nodes[index].parent;
        let level = parent.map_or(1, |parent| levels[parent] + 1);
        if level > MAX_LEVELS {
            chart.nodes[index].parent = parent.and_then(|parent| chart.nodes[parent].parent);
            found.get_or_insert_with(|| too_deep(chart.nodes[index].position.0));
        }
        levels.push(level.min(MAX_LEVELS));
    }
    found
}

pub(crate) fn too_deep(span: Span) -> Diagnostic {
    let message = format!("nodes nest more than {MAX_LEVELS} levels deep");
    Diagnostic::error("E0815", span, message).with_hint("flatten the chart")
}

/// The state of the parser.
pub(crate) struct Reader {
    pub(crate) paths: XmiPaths,
    pub(crate) nodes: BTreeMap<usize, usize>,
    pub(crate) variables: BTreeMap<usize, usize>,
    pub(crate) chart: Iac,
    pub(crate) diagnostics: Vec<Diagnostic>,
}

/// The attributes of models, nodes, transitions and variables in all dialects.
pub(crate) const MODEL: [&str; 3] = ["name", "description", "metadata"];
pub(crate) const NODE: [&str; 9] =
    ["name", "label", "type", "activity", "variables", "Father_of", "Father", "actions", "metadata"];
pub(crate) const TRANSITION: [&str; 5] = ["name", "TE", "source", "target", "metadata"];
pub(crate) const VARIABLE: [&str; 2] = ["name", "type"];

const NAMESPACES: [&str; 3] = [
    "http://www.amcl.tuc.gr/aseme/metamodels/IAC",
    "http://statechart/1.0",
    "http://mi.parisdescartes.fr/ASEME/metamodels/IAC",
];

impl Reader {
    fn new(document: &Document<'_>) -> Reader {
        Reader {
            paths: XmiPaths::new(document),
            nodes: BTreeMap::new(),
            variables: BTreeMap::new(),
            chart: Iac::default(),
            diagnostics: Vec::new(),
        }
    }

    pub(crate) fn report(&mut self, diagnostic: Diagnostic) {
        self.diagnostics.push(diagnostic);
    }

    fn model(&mut self, root: Node<'_, '_>) {
        if let Some(uri) = root.tag_name().namespace().filter(|uri| !NAMESPACES.contains(uri)) {
            let message = format!("`{uri}` is not a namespace of statecharts");
            let hint = format!("it is one of {}", NAMESPACES.map(|uri| format!("`{uri}`")).join(", "));
            self.report(Diagnostic::warning("E0802", xmi::tag(root), message).with_hint(hint));
        }
        self.known(root, "model", &MODEL);
        self.about(root);
        let mut elements = Vec::new();
        for element in xmi::elements(root) {
            match element.tag_name().name() {
                "nodes" => elements.extend(self.tree(element)),
                "variables" => self.variable(element),
                "transitions" => {}
                other => self.unknown_element(
                    "model",
                    other,
                    &["nodes", "transitions", "variables"],
                    xmi::tag(element),
                ),
            }
        }
        for (index, element) in elements.iter().enumerate() {
            self.links(index, *element);
        }
        self.cut_cycles();
        for element in xmi::elements(root).filter(|element| element.tag_name().name() == "transitions") {
            self.transition(element);
        }
    }

    /// Reads the attributes of the model.
    pub(crate) fn about(&mut self, element: Node<'_, '_>) {
        let text = |name| element.attribute(name).unwrap_or_default().to_owned();
        (self.chart.name, self.chart.description) = (text("name").trim().to_owned(), text("description"));
        self.chart.metadata = text("metadata");
    }

    /// A node and its descendants in pre-order.
    fn tree<'a, 'input>(&mut self, element: Node<'a, 'input>) -> Vec<Node<'a, 'input>> {
        let mut open = vec![(element, None, 1)];
        let mut elements = Vec::new();
        while let Some((element, parent, level)) = open.pop() {
            let index = self.node(element, parent);
            elements.push(element);
            let mut children = Vec::new();
            for child in xmi::elements(element) {
                match child.tag_name().name() {
                    "Children" if level >= MAX_LEVELS => self.report(too_deep(xmi::tag(child))),
                    "Children" => children.push((child, Some(index), level + 1)),
                    other => self.unknown_element("node", other, &["Children"], xmi::tag(child)),
                }
            }
            open.extend(children.into_iter().rev());
        }
        elements
    }

    pub(crate) fn node(&mut self, element: Node<'_, '_>, parent: Option<usize>) -> usize {
        self.known(element, "node", &NODE);
        let text = |name| element.attribute(name).unwrap_or_default().to_owned();
        let index = self.chart.nodes.len();
        self.nodes.insert(element.id().get_usize(), index);
        self.chart.nodes.push(IacNode {
            name: text("name"),
            label: text("label"),
            kind: without_null(&text("type")),
            functionality: without_null(&text("activity")),
            parent,
            actions: text("actions"),
            metadata: text("metadata"),
            position: TextPosition(xmi::tag(element)),
            ..IacNode::default()
        });
        index
    }

    /// Reads the references of a node to other nodes.
    pub(crate) fn links(&mut self, index: usize, element: Node<'_, '_>) {
        if let Some(attribute) = element.attribute_node("variables") {
            let span = xmi::value_span(&attribute);
            for word in attribute.value().split_whitespace() {
                match self.paths.find(word).and_then(|id| self.variables.get(&id)) {
                    Some(&variable) => self.chart.nodes[index].variables.push(variable),
                    None => self.dangling(word, "variable", span),
                }
            }
        }
        for name in ["Father_of", "Father"] {
            if let Some(attribute) = element.attribute_node(name) {
                self.father(index, &attribute);
            }
        }
    }

    /// Reads `Father_of`, by which a child names its parent.
    fn father(&mut self, index: usize, attribute: &Attribute<'_, '_>) {
        let span = xmi::value_span(attribute);
        let Some(word) = attribute.value().split_whitespace().next() else { return };
        if attribute.value().split_whitespace().nth(1).is_some() {
            let message = "a node has one parent";
            self.report(Diagnostic::warning("E0812", span, message).with_hint("the first is used"));
        }
        let Some(&father) = self.paths.find(word).and_then(|id| self.nodes.get(&id)) else {
            return self.dangling(word, "node", span);
        };
        match self.chart.nodes[index].parent {
            None => {
                if father >= index {
                    let message = "a node precedes its parent";
                    let hint = "the tools for this dialect require the opposite order";
                    self.report(Diagnostic::warning("E0812", span, message).with_hint(hint));
                }
                self.chart.nodes[index].parent = Some(father);
            }
            Some(parent) if parent == father => {}
            Some(_) => {
                let message = "the nesting of a node contradicts its reference to its parent";
                self.report(Diagnostic::error("E0812", span, message).with_hint("the nesting is used"));
            }
        }
    }

    /// Turns nodes that contain themselves into roots, which is reported as another fault.
    fn cut_cycles(&mut self) {
        let mut settled = vec![false; self.chart.nodes.len()];
        for start in 0..self.chart.nodes.len() {
            let (mut indices, mut at) = (Vec::new(), Some(start));
            while let Some(index) = at.filter(|&index| !settled[index]) {
                settled[index] = true;
                indices.push(index);
                at = self.chart.nodes[index].parent;
            }
            if let (Some(again), Some(&last)) = (at, indices.last())
                && indices.contains(&again)
            {
                let node = &mut self.chart.nodes[last];
                node.parent = None;
                let message = format!("`{}` lies in itself", node.name);
                let span = node.position.0;
                self.report(Diagnostic::error("E0812", span, message).with_hint("one node has no parent"));
            }
        }
    }

    pub(crate) fn variable(&mut self, element: Node<'_, '_>) {
        self.known(element, "variable", &VARIABLE);
        let text = |name| element.attribute(name).unwrap_or_default().to_owned();
        self.variables.insert(element.id().get_usize(), self.chart.variables.len());
        let position = TextPosition(xmi::tag(element));
        self.chart.variables.push(Variable { name: text("name"), kind: text("type"), position });
    }

    pub(crate) fn transition(&mut self, element: Node<'_, '_>) {
        self.known(element, "transition", &TRANSITION);
        let text = |name| element.attribute(name).unwrap_or_default().to_owned();
        let te_place =
            element.attribute_node("TE").map_or(xmi::tag(element), |attribute| xmi::value_span(&attribute));
        let ends = (self.end(element, "source"), self.end(element, "target"));
        let (Some(source), Some(target)) = ends else { return };
        self.chart.transitions.push(IacTransition {
            name: text("name"),
            te: without_null(&text("TE")),
            source,
            target,
            metadata: text("metadata"),
            position: TextPosition(xmi::tag(element)),
            te_position: TextPosition(te_place),
            ..IacTransition::default()
        });
    }

    fn end(&mut self, element: Node<'_, '_>, name: &str) -> Option<usize> {
        let Some(attribute) = element.attribute_node(name) else {
            let message = format!("a transition has no `{name}`");
            let hint = format!("add `{name}=\"//@nodes.0\"` or remove the transition");
            self.report(Diagnostic::error("E0809", xmi::tag(element), message).with_hint(hint));
            return None;
        };
        let found = self.paths.find(attribute.value().trim()).and_then(|id| self.nodes.get(&id).copied());
        if found.is_none() {
            self.dangling(attribute.value(), "node", xmi::value_span(&attribute));
        }
        found
    }

    pub(crate) fn dangling(&mut self, word: &str, what: &str, span: Span) {
        let message = format!("`{word}` is not a {what} of the model");
        let hint = "references count from 0 and change when an earlier element is removed";
        self.report(Diagnostic::error("E0807", span, message).with_hint(hint));
    }

    /// Reports attributes that no dialect has.
    pub(crate) fn known(&mut self, element: Node<'_, '_>, what: &str, names: &[&str]) {
        for attribute in xmi::features(element).filter(|attribute| !names.contains(&attribute.name())) {
            let message = format!("a {what} has no `{}`", attribute.name());
            let found = Diagnostic::error("E0804", attribute.range_qname(), message);
            self.report(found.with_nearest(attribute.name(), names.iter().copied()));
        }
    }

    pub(crate) fn unknown_element(&mut self, what: &str, name: &str, names: &[&str], span: Span) {
        let found = Diagnostic::error("E0803", span, format!("a {what} has no `{name}`"));
        self.report(found.with_nearest(name, names.iter().copied()));
    }
}
