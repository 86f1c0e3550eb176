//! Writer of the XMI dialects.

use yase::Diagnostic;
use yase::statechart::ConstantValue;

use super::{Dialect, Iac, IacNode, IacTransition};
use crate::xmi::{self, XmiWriter, fits_xml};
use aseme::layout::frame_settings;

const STATECHART: &str = "http://statechart/1.0";
const IAC: &str = "http://www.amcl.tuc.gr/aseme/metamodels/IAC";
const IAC_2010: &str = "http://mi.parisdescartes.fr/ASEME/metamodels/IAC";

impl Iac {
    /// The chart in a dialect of XMI. [`Iac::lost_in_xmi`] lists what the dialect cannot represent.
    ///
    /// # Errors
    /// Texts with characters that XML does not have (E0810).
    pub fn to_xmi(&self, dialect: Dialect) -> Result<String, Vec<Diagnostic>> {
        let refused = unwritable(self);
        if !refused.is_empty() {
            return Err(refused);
        }
        Ok(match dialect {
            Dialect::MultiRoot => multi_root(self),
            Dialect::Flat => flat(self),
            Dialect::Nested2012 => nested(self, false),
            Dialect::Nested2018 => nested(self, true),
        })
    }

    /// Parts of the model that a dialect cannot represent (E0850).
    pub fn lost_in_xmi(&self, dialect: Dialect) -> Vec<Diagnostic> {
        let mut lost = LossReport { dialect, found: Vec::new() };
        lost.model(self);
        self.nodes.iter().for_each(|node| lost.node(node));
        if dialect == Dialect::MultiRoot {
            let labels = self.labels();
            let unusual = self.nodes.iter().zip(&labels).filter(|(node, label)| node.label != **label);
            unusual.for_each(|(node, _)| {
                lost.add(node.position, format!("the label `{}` of `{}`", node.label, node.name))
            });
        }
        self.transitions.iter().for_each(|transition| lost.transition(self, transition));
        lost.found
    }
}

impl Dialect {
    /// Its name.
    pub fn name(self) -> &'static str {
        match self {
            Dialect::MultiRoot => "XMI of 2010",
            Dialect::Flat => "flat XMI",
            Dialect::Nested2012 => "XMI of 2012",
            Dialect::Nested2018 => "XMI of 2018",
        }
    }
}

/// Collects what a dialect cannot represent.
struct LossReport {
    dialect: Dialect,
    found: Vec<Diagnostic>,
}

impl LossReport {
    fn add(&mut self, position: yase::expression::TextPosition, what: impl std::fmt::Display) {
        let message = format!("{what}: {} cannot represent it", self.dialect.name());
        self.found.push(Diagnostic::warning("E0850", position.0, message));
    }

    fn model(&mut self, chart: &Iac) {
        let start = yase::expression::TextPosition::default();
        if self.dialect != Dialect::Nested2018 {
            let texts = [("description", &chart.description), ("metadata", &chart.metadata)];
            for (what, text) in texts.into_iter().filter(|(_, text)| !text.is_empty()) {
                self.add(start, format!("the {what} `{text}`"));
            }
        }
        for constant in &chart.constants {
            let value = match &constant.value {
                ConstantValue::Bool(value) => value.to_string(),
                ConstantValue::Number(value) => value.to_string(),
                ConstantValue::Text(text) => format!("\"{text}\""),
            };
            self.add(start, format!("the constant `{} = {value}`", constant.name));
        }
        if self.dialect == Dialect::MultiRoot {
            chart
                .variables
                .iter()
                .for_each(|it| self.add(it.position, format!("the variable `{}`", it.name)));
        }
        if chart.kind == super::ChartKind::Inter {
            self.add(start, "the kind: a chart of a protocol");
        }
    }

    fn node(&mut self, node: &IacNode) {
        let refinement = &node.refinement;
        let priority = if refinement.priority == 0 { String::new() } else { refinement.priority.to_string() };
        let duration = refinement.duration.map_or(String::new(), |duration| format!("{duration:?}"));
        let mut texts = vec![
            ("priority", priority),
            ("duration", duration),
            ("entry action", refinement.entry.clone()),
            ("exit action", refinement.exit.clone()),
            ("deferred events", refinement.defer.clone()),
        ];
        if self.dialect != Dialect::Nested2018 {
            texts.extend([("actions", node.actions.clone()), ("metadata", node.metadata.clone())]);
        }
        for (what, text) in texts.into_iter().filter(|(_, text)| !text.is_empty()) {
            self.add(node.position, format!("the {what} of `{}`, `{text}`", node.name));
        }
        for (key, value) in frame_settings(&node.frame) {
            self.add(node.position, format!("the layout of `{}`, `{key} = {value}`", node.name));
        }
        if let Some(activity) = &refinement.activity {
            self.add(node.position, format!("the activity of `{}`, `{activity}`", node.name));
        }
    }

    fn transition(&mut self, chart: &Iac, transition: &IacTransition) {
        let refinement = &transition.refinement;
        let name =
            || format!("{} -> {}", chart.nodes[transition.source].name, chart.nodes[transition.target].name);
        let said = [
            ("priority", refinement.priority != 0),
            ("weight", refinement.weight.is_some()),
            ("word `interrupts`", refinement.interrupts),
            ("word `internal`", refinement.internal),
            ("layout", !transition.bends.is_empty()),
            ("metadata", !transition.metadata.is_empty() && self.dialect != Dialect::Nested2018),
        ];
        for (what, _) in said.into_iter().filter(|(_, said)| *said) {
            self.add(transition.position, format!("the {what} of `{}`", name()));
        }
    }
}

fn nested(chart: &Iac, with_metadata: bool) -> String {
    let paths = nested_paths(chart);
    let children = chart.children();
    let mut writer = XmiWriter::new();
    writer.root("statechart", "Model", STATECHART);
    writer.attribute_if_any("name", &chart.name);
    if with_metadata {
        writer.attribute_if_any("description", &chart.description);
        writer.attribute_if_any("metadata", &chart.metadata);
    }
    let roots = (0..chart.nodes.len()).filter(|&index| chart.nodes[index].parent.is_none());
    for root in roots {
        tree(chart, &children, root, with_metadata, &mut writer);
    }
    for transition in &chart.transitions {
        writer.open("transitions");
        writer.attribute_if_any("TE", &transition.te);
        writer.attribute_if_any("name", &transition.name);
        writer.attribute("source", &paths[transition.source]);
        writer.attribute("target", &paths[transition.target]);
        if with_metadata {
            writer.attribute_if_any("metadata", &transition.metadata);
        }
        writer.close();
    }
    variables(chart, &mut writer);
    writer.into_text()
}

/// Writes a node and its descendants, up to [`MAX_LEVELS`](super::MAX_LEVELS).
fn tree(chart: &Iac, children: &[Vec<usize>], index: usize, with_metadata: bool, writer: &mut XmiWriter) {
    let node = &chart.nodes[index];
    writer.open(if node.parent.is_none() { "nodes" } else { "Children" });
    writer.attribute_if_any("name", &node.name);
    writer.attribute_if_any("label", &node.label);
    writer.attribute_if_any("type", &node.kind);
    writer.attribute_if_any("activity", &node.functionality);
    writer.attribute_if_any("variables", &variable_paths(node));
    if with_metadata {
        writer.attribute_if_any("actions", &node.actions);
        writer.attribute_if_any("metadata", &node.metadata);
    }
    for &child in &children[index] {
        tree(chart, children, child, with_metadata, writer);
    }
    writer.close();
}

fn nested_paths(chart: &Iac) -> Vec<String> {
    let children = chart.children();
    let mut paths = vec![String::new(); chart.nodes.len()];
    let roots = (0..chart.nodes.len()).filter(|&index| chart.nodes[index].parent.is_none());
    for (number, root) in roots.enumerate() {
        paths[root] = format!("//@nodes.{number}");
    }
    for (index, children) in children.iter().enumerate() {
        for (number, &child) in children.iter().enumerate() {
            paths[child] = format!("{}/@Children.{number}", paths[index]);
        }
    }
    paths
}

fn flat(chart: &Iac) -> String {
    let mut writer = XmiWriter::new();
    writer.root("IAC", "Model", IAC);
    writer.attribute_if_any("name", &chart.name);
    variables(chart, &mut writer);
    for node in &chart.nodes {
        writer.open("nodes");
        writer.attribute_if_any("name", &node.name);
        writer.attribute_if_any("type", &node.kind);
        writer.attribute_if_any("label", &node.label);
        writer.attribute_if_any("activity", &node.functionality);
        writer.attribute_if_any("variables", &variable_paths(node));
        if let Some(parent) = node.parent {
            writer.attribute("Father_of", &format!("//@nodes.{parent}"));
        }
        writer.close();
    }
    for transition in &chart.transitions {
        writer.open("transitions");
        writer.attribute_if_any("TE", &transition.te);
        writer.attribute("source", &format!("//@nodes.{}", transition.source));
        writer.attribute("target", &format!("//@nodes.{}", transition.target));
        writer.attribute_if_any("name", &transition.name);
        writer.close();
    }
    writer.into_text()
}

/// Nodes first, then transitions, then the model, which lists both.
fn multi_root(chart: &Iac) -> String {
    let null = |text: &str| if text.is_empty() { String::from("null") } else { text.into() };
    let mut writer = XmiWriter::new();
    writer.open("xmi:XMI");
    writer.attribute("xmi:version", "2.0");
    writer.attribute("xmlns:xmi", xmi::XMI);
    writer.attribute("xmlns:IAC", IAC_2010);
    for (node, label) in chart.nodes.iter().zip(chart.labels()) {
        writer.open("IAC:Node");
        writer.attribute_if_any("name", &node.name);
        writer.attribute_if_any("type", &node.kind);
        // The label determines the parent.
        writer.attribute_if_any("label", &label);
        writer.attribute("activity", &null(&node.functionality));
        writer.close();
    }
    for transition in &chart.transitions {
        writer.open("IAC:Transition");
        writer.attribute("TE", &null(&transition.te));
        writer.attribute("source", &format!("#/{}", transition.source));
        writer.attribute("target", &format!("#/{}", transition.target));
        writer.attribute_if_any("name", &transition.name);
        writer.close();
    }
    let list = |from: usize, count: usize| {
        (from..from + count).map(|index| format!("#/{index}")).collect::<Vec<_>>().join(" ")
    };
    writer.open("IAC:Model");
    writer.attribute_if_any("nodes", &list(0, chart.nodes.len()));
    writer.attribute_if_any("transitions", &list(chart.nodes.len(), chart.transitions.len()));
    writer.attribute_if_any("name", &chart.name);
    writer.into_text()
}

fn variables(chart: &Iac, writer: &mut XmiWriter) {
    for variable in &chart.variables {
        writer.open("variables");
        writer.attribute_if_any("name", &variable.name);
        writer.attribute_if_any("type", &variable.kind);
        writer.close();
    }
}

fn variable_paths(node: &IacNode) -> String {
    node.variables.iter().map(|index| format!("//@variables.{index}")).collect::<Vec<_>>().join(" ")
}

fn unwritable(chart: &Iac) -> Vec<Diagnostic> {
    let nodes = chart.nodes.iter().flat_map(|node| {
        let texts = [&node.name, &node.label, &node.kind, &node.functionality, &node.actions, &node.metadata];
        texts.map(|text| (node.position, text))
    });
    let transitions = chart
        .transitions
        .iter()
        .flat_map(|it| [(it.te_position, &it.te), (it.position, &it.name), (it.position, &it.metadata)]);
    let variables = chart.variables.iter().flat_map(|it| [(it.position, &it.name), (it.position, &it.kind)]);
    let model = [&chart.name, &chart.description, &chart.metadata]
        .map(|text| (yase::expression::TextPosition::default(), text));
    let texts = nodes.chain(transitions).chain(variables).chain(model);
    let wrong = texts.filter(|(_, text)| !fits_xml(text));
    wrong
        .map(|(position, text)| {
            let message = format!("{text:?} has a character that XML does not have");
            Diagnostic::error("E0810", position.0, message).with_hint("remove the character")
        })
        .collect()
}
