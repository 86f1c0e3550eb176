//! Charts for PlantUML's state diagrams.

use std::collections::BTreeSet;

use super::Exported;
use super::ids::Ids;
use super::loss_report::LossReport;
use super::notation::{kind_word, refinements};
use super::outline::{
    IndentedText, TreeEvent, after_colon, constants, is_region, sibling_number, sound_transitions, title,
    visits,
};
use yase::statechart::{NodeId, NodeKind, Statechart, Transition};

/// Writes the chart as a state diagram of PlantUML.
///
/// Regions are separated by a line, connectors have the stereotypes of UML. Constants are the
/// legend. PlantUML has no transitions between a region and its surroundings; where a chart has
/// one, the regions are states side by side.
pub fn to_plantuml(chart: &Statechart) -> Exported {
    match LossReport::new(chart, "PlantUML") {
        Ok(lost) => {
            let (inside, boxed) = (by_ancestor(chart), boxed(chart));
            PlantUml { chart, ids: Ids::of(chart), inside, boxed, lost, lines: IndentedText::default() }
                .document()
        }
        Err(nothing) => nothing,
    }
}

struct PlantUml<'a> {
    chart: &'a Statechart,
    ids: Ids,
    /// By node: the transitions for which it is the innermost common ancestor.
    inside: Vec<Vec<&'a Transition>>,
    /// By node: whether its regions are states side by side.
    boxed: Vec<bool>,
    lost: LossReport<'a>,
    lines: IndentedText,
}

impl PlantUml<'_> {
    fn document(mut self) -> Exported {
        self.lines.line(format_args!("@startuml"));
        self.lines.line(format_args!("hide empty description"));
        for visit in visits(self.chart) {
            match visit {
                TreeEvent::Enter(id) => self.enter(id),
                TreeEvent::Leave(id) => self.leave(id),
            }
        }
        self.constants();
        self.lines.line(format_args!("@enduml"));
        self.lost.with(self.lines.text)
    }

    fn has_block(&self, id: NodeId) -> bool {
        !self.chart.children(id).is_empty() && !self.is_divided(id)
    }

    /// Whether a node is a region separated by lines.
    fn is_divided(&self, id: NodeId) -> bool {
        let parent = self.chart.node(id).parent;
        is_region(self.chart, id) && parent.is_none_or(|parent| !self.boxed[parent.0 as usize])
    }

    fn enter(&mut self, id: NodeId) {
        let (chart, node) = (self.chart, self.chart.node(id));
        if self.is_divided(id) && sibling_number(chart, id) > 1 {
            self.lines.line(format_args!("--"));
        }
        if is_region(chart, id) && !self.is_divided(id) {
            self.lost.kind(id, "a state beside the other regions");
        }
        match node.kind {
            _ if self.is_divided(id) => self.region(id),
            _ if self.has_block(id) => {
                let title = escaped(&title(chart, id));
                self.lines.line(format_args!("state \"{title}\" as s_{} {{", self.ids.of_node(id)));
                self.lines.depth += 1;
            }
            NodeKind::Or | NodeKind::And | NodeKind::Basic => {
                let title = title(chart, id);
                self.state(id, &title, "");
            }
            NodeKind::Terminate => {
                self.lost.kind(id, "a state");
                let name = if node.name.is_empty() { String::new() } else { format!(" {}", node.name) };
                self.state(id, &format!("×{name}"), "");
            }
            kind => self.connector(id, kind),
        }
    }

    fn region(&mut self, id: NodeId) {
        let said = notes_of(self.chart, id);
        if !said.is_empty() {
            self.lost.of_node(id, "the name");
            self.lines.line(format_args!("' region {}", escaped(&said)));
        }
    }

    /// Connectors have no label in the drawing; their properties are a comment.
    fn connector(&mut self, id: NodeId, kind: NodeKind) {
        let stereotype = match kind {
            NodeKind::Start => "<<start>>",
            NodeKind::End => "<<end>>",
            NodeKind::Fork => "<<fork>>",
            NodeKind::Join => "<<join>>",
            NodeKind::ShallowHistory => "<<history>>",
            NodeKind::DeepHistory => "<<history*>>",
            NodeKind::EntryPoint => "<<entryPoint>>",
            NodeKind::ExitPoint => "<<exitPoint>>",
            _ => "<<choice>>",
        };
        if matches!(kind, NodeKind::Condition | NodeKind::Junction) {
            self.lost.kind(id, "a choice");
        }
        let (word, said) = (kind_word(kind), notes_of(self.chart, id));
        let has_letters = matches!(kind, NodeKind::EntryPoint | NodeKind::ExitPoint);
        if !said.is_empty() && !has_letters {
            self.lost.of_node(id, "the name");
            self.lines.line(format_args!("' {word} {}", escaped(&said)));
        }
        let title = if said.is_empty() { word.into() } else { said };
        self.state(id, &title, stereotype);
    }

    fn state(&mut self, id: NodeId, title: &str, stereotype: &str) {
        let name = self.ids.of_node(id);
        let blank = if stereotype.is_empty() { "" } else { " " };
        self.lines.line(format_args!("state \"{}\" as s_{name}{blank}{stereotype}", escaped(title)));
        if stereotype.is_empty() {
            self.refinements(id);
        }
    }

    fn leave(&mut self, id: NodeId) {
        for transition in std::mem::take(&mut self.inside[id.0 as usize]) {
            self.transition(transition);
        }
        if self.has_block(id) {
            self.lines.depth -= 1;
            self.lines.line(format_args!("}}"));
            self.refinements(id);
        }
    }

    fn refinements(&mut self, id: NodeId) {
        for text in refinements(self.chart.node(id)) {
            self.lines.line(format_args!("s_{} : {}", self.ids.of_node(id), escaped(&text)));
        }
    }

    fn transition(&mut self, transition: &Transition) {
        let (from, to) = (self.ids.of_node(transition.source), self.ids.of_node(transition.target));
        let text = after_colon(transition, escaped);
        let arrow = if transition.expression.is_never() { "-[#aaaaaa]->" } else { "-->" };
        self.lines.line(format_args!("s_{from} {arrow} s_{to}{text}"));
    }

    fn constants(&mut self) {
        let lines: Vec<String> = constants(self.chart).collect();
        if lines.is_empty() {
            return;
        }
        self.lines.line(format_args!("legend"));
        for line in lines {
            self.lines.line(format_args!("  {}", escaped(&line)));
        }
        self.lines.line(format_args!("endlegend"));
    }
}

/// For each node the transitions for which it is the innermost common ancestor.
fn by_ancestor(chart: &Statechart) -> Vec<Vec<&Transition>> {
    let mut inside = vec![Vec::new(); chart.nodes().len()];
    for (_, transition) in sound_transitions(chart) {
        let holds_target = |&id: &NodeId| chart.ancestors(transition.target).any(|ancestor| ancestor == id);
        let around = chart.ancestors(transition.source).find(holds_target).unwrap_or(Statechart::ROOT);
        inside[around.0 as usize].push(transition);
    }
    inside
}

/// For each node whether a transition connects one of its regions with its surroundings.
fn boxed(chart: &Statechart) -> Vec<bool> {
    let mut boxed = vec![false; chart.nodes().len()];
    let regions = |id: NodeId| -> BTreeSet<NodeId> {
        std::iter::once(id).chain(chart.ancestors(id)).filter(|&id| is_region(chart, id)).collect()
    };
    for (_, transition) in sound_transitions(chart) {
        let (of_source, of_target) = (regions(transition.source), regions(transition.target));
        for region in of_source.symmetric_difference(&of_target) {
            if let Some(parent) = chart.node(*region).parent {
                boxed[parent.0 as usize] = true;
            }
        }
        for end in [transition.source, transition.target].into_iter().filter(|&end| is_region(chart, end)) {
            if let Some(parent) = chart.node(end).parent {
                boxed[parent.0 as usize] = true;
            }
        }
    }
    boxed
}

/// Name and refinements.
fn notes_of(chart: &Statechart, id: NodeId) -> String {
    let node = chart.node(id);
    let said = std::iter::once(node.name.clone()).chain(refinements(node));
    let said: Vec<String> = said.filter(|text| !text.is_empty()).collect();
    said.join(", ")
}

/// A text on one line. PlantUML reads `<U+0022>` as a character; characters with a special meaning
/// are written this way.
fn escaped(text: &str) -> String {
    let mut escaped = String::with_capacity(text.len());
    let mut last = ' ';
    let mut characters = text.chars().map(plain).peekable();
    while let Some(character) = characters.next() {
        let next = characters.peek().copied().unwrap_or(' ');
        let special = match character {
            '"' | '\\' | '~' | '$' | '\'' | '{' | '}' | '#' => true,
            // a tag, or a preprocessor function
            '<' => !matches!(next, ' ' | '='),
            '%' => !next.is_ascii_digit(),
            // a doubled sign changes the font or begins a link
            '*' | '/' | '_' | '-' | '[' | ']' => character == last,
            _ => false,
        };
        if special {
            escaped.push_str(&format!("<U+{:04X}>", character as u32));
        } else {
            escaped.push(character);
        }
        last = character;
    }
    escaped
}

fn plain(character: char) -> char {
    if character.is_control() { ' ' } else { character }
}
