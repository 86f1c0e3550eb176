//! Charts for Graphviz: composites are clusters.

use super::Exported;
use super::highlights::{Highlights, Mark};
use super::ids::Ids;
use super::loss_report::{LossReport, is_box};
use super::notation::{inscription, refinements};
use super::outline::{IndentedText, TreeEvent, constants, is_region, sound_transitions, title, visits};
use super::svg::lettering::{LABEL_SIZE, wrap_condition};
use yase::statechart::{NodeId, NodeKind, Statechart, Transition};

/// Maximum width of a label line, where it can be broken.
const LABEL_WIDTH: f64 = 290.0;

/// Writes the chart as a Graphviz graph for the layout program `dot`.
///
/// Composites are clusters with an invisible point at which their transitions begin and end.
/// Constants are a note.
pub fn to_dot(chart: &Statechart) -> Exported {
    to_dot_marked(chart, &Highlights::default())
}

/// The same with highlighted parts in the colours of their marks.
pub fn to_dot_marked(chart: &Statechart, marks: &Highlights) -> Exported {
    match LossReport::new(chart, "Graphviz") {
        Ok(lost) => {
            lost.with(Dot { chart, marks, ids: Ids::of(chart), lines: IndentedText::default() }.document())
        }
        Err(nothing) => nothing,
    }
}

struct Dot<'a> {
    chart: &'a Statechart,
    marks: &'a Highlights,
    ids: Ids,
    lines: IndentedText,
}

impl Dot<'_> {
    fn document(mut self) -> String {
        self.lines.line(format_args!("digraph {} {{", quoted(&self.chart.name)));
        self.lines.depth += 1;
        self.lines.line(format_args!("compound=true; fontname=\"sans-serif\"; fontsize=11; rankdir=TB"));
        self.lines.line(format_args!("node [fontname=\"sans-serif\", fontsize=11, shape=box]"));
        self.lines.line(format_args!("edge [fontname=\"sans-serif\", fontsize=9, arrowsize=0.7]"));
        for visit in visits(self.chart) {
            match visit {
                TreeEvent::Enter(id) if is_box(self.chart, id) => self.open(id),
                TreeEvent::Enter(id) => self.leaf(id),
                TreeEvent::Leave(id) if is_box(self.chart, id) => self.close(),
                TreeEvent::Leave(_) => {}
            }
        }
        self.constants();
        sound_transitions(self.chart).for_each(|(_, transition)| self.edge(transition));
        self.close();
        self.lines.text
    }

    fn open(&mut self, id: NodeId) {
        let style = match self.chart.node(id).kind {
            _ if is_region(self.chart, id) => "style=dashed",
            NodeKind::And => "style=\"rounded,filled\", fillcolor=\"#f2f6fd\"",
            _ => "style=\"rounded,filled\", fillcolor=\"#fffdf2\"",
        };
        self.lines.line(format_args!("subgraph \"cluster_{}\" {{", self.ids.of_node(id)));
        self.lines.depth += 1;
        let (label, colour) = (self.label(id), colour(self.marks.of_node(id)));
        self.lines.line(format_args!("graph [label={label}, {style}{colour}]"));
        self.lines.line(format_args!("{} [shape=point, style=invis, width=0, label=\"\"]", self.anchor(id)));
    }

    fn close(&mut self) {
        self.lines.depth -= 1;
        self.lines.line(format_args!("}}"));
    }

    /// Name and refinements.
    fn label(&self, id: NodeId) -> String {
        let mut label = vec![title(self.chart, id)];
        label.extend(refinements(self.chart.node(id)));
        quoted(&label.join("\n"))
    }

    fn leaf(&mut self, id: NodeId) {
        let node = self.chart.node(id);
        let look = match node.kind {
            NodeKind::Start => {
                "shape=circle, style=filled, fillcolor=black, width=0.16, fixedsize=true, label=\"\""
            }
            NodeKind::End => {
                "shape=doublecircle, style=filled, fillcolor=black, width=0.12, fixedsize=true, label=\"\""
            }
            NodeKind::Condition => "shape=circle, width=0.3, fixedsize=true, label=\"C\"",
            NodeKind::Junction => {
                "shape=circle, style=filled, fillcolor=black, width=0.1, fixedsize=true, label=\"\""
            }
            NodeKind::Choice => "shape=diamond, width=0.35, height=0.35, fixedsize=true, label=\"\"",
            NodeKind::Fork | NodeKind::Join => {
                "style=filled, fillcolor=black, width=0.8, height=0.06, fixedsize=true, label=\"\""
            }
            NodeKind::ShallowHistory => "shape=circle, width=0.3, fixedsize=true, label=\"H\"",
            NodeKind::DeepHistory => "shape=circle, width=0.3, fixedsize=true, label=\"H*\"",
            NodeKind::Terminate => "shape=plaintext, width=0.3, height=0.3, label=\"×\"",
            NodeKind::EntryPoint => "shape=circle, width=0.2, fixedsize=true, label=\"\"",
            NodeKind::ExitPoint => "shape=circle, width=0.2, fixedsize=true, label=\"×\"",
            NodeKind::Basic | NodeKind::Or | NodeKind::And => {
                "style=\"rounded,filled\", fillcolor=\"#dcf3dc\""
            }
        };
        let beside = match (node.kind, node.name.is_empty() && refinements(node).is_empty()) {
            (NodeKind::Basic, _) => format!(", label={}", self.label(id)),
            (_, true) => String::new(),
            (_, false) => format!(", xlabel={}", self.label(id)),
        };
        let colour = colour(self.marks.of_node(id));
        self.lines.line(format_args!("\"{}\" [{look}{beside}{colour}]", self.ids.of_node(id)));
    }

    fn constants(&mut self) {
        let lines: Vec<String> = constants(self.chart).collect();
        if !lines.is_empty() {
            let label = quoted(&lines.join("\n"));
            self.lines.line(format_args!("\"constants:\" [shape=note, label={label}]"));
        }
    }

    fn edge(&mut self, transition: &Transition) {
        let (source, target) = (transition.source, transition.target);
        let mut attributes = Vec::new();
        let label = wrap_condition(&inscription(transition), LABEL_SIZE, LABEL_WIDTH);
        if !label.is_empty() {
            attributes.push(format!("label={}", quoted(&label.join("\n"))));
        }
        if let Some(mark) = self.marks.of_transition(transition) {
            let colour = mark.colour();
            attributes.push(format!("color=\"{colour}\", fontcolor=\"{colour}\", penwidth=2"));
        } else if transition.expression.is_never() {
            attributes.push("color=gray, fontcolor=gray".into());
        }
        // Graphviz clips an arrow at a cluster border unless its other end is inside
        if is_box(self.chart, source) && !self.holds(source, target) {
            attributes.push(format!("ltail=\"cluster_{}\"", self.ids.of_node(source)));
        }
        if is_box(self.chart, target) && !self.holds(target, source) {
            attributes.push(format!("lhead=\"cluster_{}\"", self.ids.of_node(target)));
        }
        let (tail, head) = (self.end(source), self.end(target));
        match attributes.is_empty() {
            true => self.lines.line(format_args!("{tail} -> {head}")),
            false => self.lines.line(format_args!("{tail} -> {head} [{}]", attributes.join(", "))),
        }
    }

    fn holds(&self, outer: NodeId, inner: NodeId) -> bool {
        outer == inner || self.chart.ancestors(inner).any(|ancestor| ancestor == outer)
    }

    fn end(&self, id: NodeId) -> String {
        if is_box(self.chart, id) { self.anchor(id) } else { format!("\"{}\"", self.ids.of_node(id)) }
    }

    /// The point that represents a cluster; no other name contains a colon.
    fn anchor(&self, id: NodeId) -> String {
        format!("\"{}:\"", self.ids.of_node(id))
    }
}

fn colour(mark: Option<Mark>) -> String {
    mark.map_or(String::new(), |mark| format!(", color=\"{}\", penwidth=2.5", mark.colour()))
}

/// A text in double quotes. Graphviz interprets HTML entities in labels.
fn quoted(text: &str) -> String {
    let mut quoted = String::from("\"");
    for character in text.chars() {
        match character {
            '"' => quoted.push_str("\\\""),
            '\\' => quoted.push_str("\\\\"),
            '&' => quoted.push_str("&amp;"),
            '\n' => quoted.push_str("\\n"),
            _ if character.is_control() => quoted.push(' '),
            _ => quoted.push(character),
        }
    }
    quoted.push('"');
    quoted
}
