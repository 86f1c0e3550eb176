//! Charts for Mermaid's state diagrams.

use super::Exported;
use super::ids::Ids;
use super::loss_report::LossReport;
use super::notation::{kind_word, refinements};
use super::outline::{
    IndentedText, TreeEvent, after_colon, by_parent, constants, is_region, one_line, sibling_number, title,
    visits,
};
use yase::statechart::{NodeId, NodeKind, Statechart, Transition};

/// Writes the chart as a state diagram of Mermaid (`stateDiagram-v2`).
///
/// Nodes without a Mermaid symbol become states or choices named after their kind. Transitions
/// between composites are at the end.
pub fn to_mermaid(chart: &Statechart) -> Exported {
    let lost = match LossReport::new(chart, "Mermaid") {
        Ok(lost) => lost,
        Err(nothing) => return nothing,
    };
    let (inside, across) = by_parent(chart);
    let bracketed = bracketed(chart, &inside, &across);
    Mermaid { chart, ids: Ids::of(chart), inside, across, bracketed, lost, lines: IndentedText::default() }
        .document()
}

struct Mermaid<'a> {
    chart: &'a Statechart,
    ids: Ids,
    /// Transitions between the children of each node.
    inside: Vec<Vec<&'a Transition>>,
    /// All other transitions.
    across: Vec<&'a Transition>,
    /// By node: whether it is written as `[*]`.
    bracketed: Vec<bool>,
    lost: LossReport<'a>,
    lines: IndentedText,
}

impl Mermaid<'_> {
    fn document(mut self) -> Exported {
        self.lines.line(format_args!("stateDiagram-v2"));
        self.lines.depth += 1;
        for constant in constants(self.chart) {
            self.lines.line(format_args!("%% {}", escaped(&constant)));
        }
        self.lost.constants();
        for visit in visits(self.chart) {
            match visit {
                TreeEvent::Enter(id) => self.enter(id),
                TreeEvent::Leave(id) => self.leave(id),
            }
        }
        for transition in std::mem::take(&mut self.across) {
            self.transition(transition);
        }
        self.lost.with(self.lines.text)
    }

    fn enter(&mut self, id: NodeId) {
        let (chart, node) = (self.chart, self.chart.node(id));
        if is_region(chart, id) && sibling_number(chart, id) > 1 {
            self.lines.line(format_args!("--"));
        }
        match node.kind {
            _ if is_region(chart, id) => self.region(id),
            _ if !chart.children(id).is_empty() => self.open(id),
            NodeKind::Or | NodeKind::And | NodeKind::Basic => self.state(id, &title(chart, id)),
            NodeKind::Start | NodeKind::End if self.bracketed[id.0 as usize] => {}
            NodeKind::Condition | NodeKind::Choice | NodeKind::Junction => self.sign(id, "choice"),
            NodeKind::Fork => self.sign(id, "fork"),
            NodeKind::Join => self.sign(id, "join"),
            kind => {
                let word = kind_word(kind);
                let title =
                    if node.name.is_empty() { word.into() } else { format!("{} ({word})", node.name) };
                self.lost.kind(id, "a state");
                self.state(id, &title);
            }
        }
    }

    fn region(&mut self, id: NodeId) {
        let node = self.chart.node(id);
        let said = std::iter::once(node.name.clone()).chain(refinements(node));
        let said: Vec<String> = said.filter(|text| !text.is_empty()).collect();
        if !said.is_empty() {
            self.lost.of_node(id, "the name");
            self.lines.line(format_args!("%% region {}", escaped(&said.join(", "))));
        }
    }

    fn open(&mut self, id: NodeId) {
        let title = escaped_title(&title(self.chart, id));
        self.lines.line(format_args!("state \"{title}\" as s_{} {{", self.ids.of_node(id)));
        self.lines.depth += 1;
    }

    fn state(&mut self, id: NodeId, title: &str) {
        let title = escaped_title(title);
        self.lines.line(format_args!("state \"{title}\" as s_{}", self.ids.of_node(id)));
        for text in refinements(self.chart.node(id)) {
            self.lines.line(format_args!("s_{} : {}", self.ids.of_node(id), escaped(&text)));
        }
    }

    /// A node without a label: its name is a comment.
    fn sign(&mut self, id: NodeId, sign: &str) {
        let node = self.chart.node(id);
        let word = kind_word(node.kind);
        if sign == "choice" && node.kind != NodeKind::Choice {
            self.lost.kind(id, "a choice");
        }
        let said = std::iter::once(node.name.clone()).chain(refinements(node));
        let said: Vec<String> = said.filter(|text| !text.is_empty()).collect();
        if !said.is_empty() {
            self.lost.of_node(id, "the name");
        }
        if node.kind != NodeKind::Choice || !said.is_empty() {
            let text = format!("{word} {}", escaped(&said.join(", ")));
            self.lines.line(format_args!("%% {}", text.trim_end()));
        }
        self.lines.line(format_args!("state s_{} <<{sign}>>", self.ids.of_node(id)));
    }

    fn leave(&mut self, id: NodeId) {
        let has_children = !self.chart.children(id).is_empty();
        for transition in std::mem::take(&mut self.inside[id.0 as usize]) {
            self.transition(transition);
        }
        if !has_children || is_region(self.chart, id) {
            return;
        }
        self.lines.depth -= 1;
        self.lines.line(format_args!("}}"));
        let notes = refinements(self.chart.node(id));
        if !notes.is_empty() {
            let text = escaped(&notes.join(", "));
            self.lines.line(format_args!("note right of s_{} : {text}", self.ids.of_node(id)));
        }
    }

    fn transition(&mut self, transition: &Transition) {
        let (from, to) = (self.end(transition.source), self.end(transition.target));
        let text = after_colon(transition, escaped);
        self.lines.line(format_args!("{from} --> {to}{text}"));
    }

    fn end(&mut self, id: NodeId) -> String {
        if is_region(self.chart, id) {
            self.lost.end(id);
            let parent = self.chart.node(id).parent.unwrap_or(id);
            return format!("s_{}", self.ids.of_node(parent));
        }
        match self.bracketed[id.0 as usize] {
            true => "[*]".into(),
            false => format!("s_{}", self.ids.of_node(id)),
        }
    }
}

/// For each node whether it is the `[*]` of its block: the only START or END there, without a name
/// and connected only to siblings.
fn bracketed(chart: &Statechart, inside: &[Vec<&Transition>], across: &[&Transition]) -> Vec<bool> {
    let mut bracketed = vec![false; chart.nodes().len()];
    for (id, _) in chart.nodes() {
        for kind in [NodeKind::Start, NodeKind::End] {
            let mut alike = chart.children(id).iter().filter(|&&child| chart.node(child).kind == kind);
            if let (Some(&only), None) = (alike.next(), alike.next()) {
                bracketed[only.0 as usize] = is_plain(chart, only);
            }
        }
    }
    for transition in across {
        bracketed[transition.source.0 as usize] = false;
        bracketed[transition.target.0 as usize] = false;
    }
    for transition in inside.iter().flatten() {
        if chart.node(transition.target).kind == NodeKind::Start {
            bracketed[transition.target.0 as usize] = false;
        }
        if chart.node(transition.source).kind == NodeKind::End {
            bracketed[transition.source.0 as usize] = false;
        }
    }
    bracketed
}

fn is_plain(chart: &Statechart, id: NodeId) -> bool {
    let node = chart.node(id);
    node.name.is_empty() && refinements(node).is_empty() && chart.children(id).is_empty()
}

/// A text on one line. Mermaid reads `#59;` as a character; characters with a special meaning are
/// written this way.
fn escaped(text: &str) -> String {
    let line = one_line(text);
    let mut escaped = String::with_capacity(line.len());
    let mut last = ' ';
    for (at, character) in line.char_indices() {
        let special = matches!(
            character,
            ':' | ';' | '#' | '"' | '\\' | '<' | '>' | '%' | '`' | '*' | '{' | '}' | '$' | '~'
        );
        // two dashes are an arrow, and a line with a direction statement would change the layout
        if special || character == '-' && last == '-' || begins_with(&line[at..], b"direction") {
            escaped.push_str(&format!("#{};", character as u32));
        } else {
            escaped.push(character);
        }
        last = character;
    }
    escaped
}

fn begins_with(text: &str, word: &[u8]) -> bool {
    text.as_bytes().get(..word.len()).is_some_and(|start| start.eq_ignore_ascii_case(word))
}

/// A text in double quotes, where brackets are special too.
fn escaped_title(text: &str) -> String {
    escaped(text).replace('[', "#91;").replace(']', "#93;")
}
