//! What must hold of a chart's structure before it can run.

use std::collections::BTreeSet;

use crate::diagnostic::{Diagnostic, Span};
use crate::statechart::{NodeId, NodeKind, Statechart, Transition, TransitionId};

/// No compound transition is made of more segments.
const MAX_SEGMENTS: usize = 256;

impl Statechart {
    /// Checks the structure. Each finding names states by their path; whether a chart can run is decided by its errors.
    ///
    /// | code | finding |
    /// |---|---|
    /// | `M01` | a composite without exactly one START; an AND without regions, or with something else in it; a START that leads out of its composite; a START that may have no open way (a warning) |
    /// | `M02` | a transition into START or out of END; a trigger where no event is waited for |
    /// | `M03` | a transition whose ends do not exist, or whose source or target cannot be one: the root, a sibling region, the outside of an internal transition's source |
    /// | `M06` | connectors that lead in a circle, nowhere, or on without measure |
    /// | `E0501` | what the machine does not run: CHOICE, FORK, JOIN, history, entry and exit points, weights |
    /// | `E0502` | something inside what cannot hold states |
    /// | `E0503` | an activity of what is no BASIC state |
    /// | `E0504` | a root that is no OR; a node whose parent is not the node that holds it |
    ///
    /// Transitions between sibling regions and chains of connectors that multiply beyond measure are found by
    /// [`compile`](Statechart::compile) only.
    pub fn check(&self) -> Vec<Diagnostic> {
        let mut check = Check { chart: self, found: Vec::new() };
        check.tree();
        if check.found.is_empty() {
            check.nodes();
            check.transitions();
        }
        if check.found.is_empty() {
            check.connectors();
        }
        if check.found.is_empty() {
            check.starts();
        }
        check.found
    }
}

/// Whether a transition may end or begin there without coming to rest.
pub(super) fn is_connector(kind: NodeKind) -> bool {
    matches!(kind, NodeKind::Condition | NodeKind::Junction)
}

struct Check<'a> {
    chart: &'a Statechart,
    found: Vec<Diagnostic>,
}

impl Check<'_> {
    fn error(&mut self, code: &'static str, message: String) -> &mut Diagnostic {
        self.found.push(Diagnostic::error(code, Span::default(), message));
        let last = self.found.len() - 1;
        &mut self.found[last]
    }

    fn path(&self, node: NodeId) -> String {
        self.chart.path(node)
    }

    /// Nodes can be refined in place; their parents must still be the nodes that hold them. Paths make no sense before this is known.
    fn tree(&mut self) {
        let chart = self.chart;
        let root = chart.node(Statechart::ROOT);
        if root.kind != NodeKind::Or || root.parent.is_some() {
            self.error("E0504", format!("the root of `{}` is not an OR without parent", chart.name));
        }
        for (id, _) in chart.nodes() {
            for &child in chart.children(id) {
                if chart.node(child).parent != Some(id) {
                    self.error(
                        "E0504",
                        format!("node {} lies in node {}, which is not its parent", child.0, id.0),
                    );
                }
            }
        }
    }

    fn nodes(&mut self) {
        let chart = self.chart;
        for (id, node) in chart.nodes() {
            match node.kind {
                NodeKind::Or => self.composite(id),
                NodeKind::And => self.orthogonal(id),
                kind if !is_run(kind) => {
                    let message = format!("`{}` is a {}, which is not run", self.path(id), kind_name(kind));
                    self.error("E0501", message);
                }
                kind if !chart.children(id).is_empty() => {
                    let message =
                        format!("`{}` is a {} and cannot hold states", self.path(id), kind_name(kind));
                    self.error("E0502", message);
                }
                _ => {}
            }
            if node.activity.is_some() && node.kind != NodeKind::Basic {
                let message =
                    format!("`{}` is a {} and cannot have an activity", self.path(id), kind_name(node.kind));
                self.error("E0503", message);
            }
        }
    }

    fn composite(&mut self, id: NodeId) {
        let starts =
            self.chart.children(id).iter().filter(|&&child| self.kind(child) == NodeKind::Start).count();
        if starts != 1 {
            let message = match starts {
                0 => format!("composite `{}` has no START", self.path(id)),
                _ => format!("composite `{}` has {starts} STARTs", self.path(id)),
            };
            self.error("M01", message).hint = Some("a composite has exactly one START".into());
        }
    }

    fn orthogonal(&mut self, id: NodeId) {
        let chart = self.chart;
        if chart.children(id).is_empty() {
            let message = format!("AND `{}` has no regions", self.path(id));
            self.error("M01", message);
        }
        for &child in chart.children(id) {
            if self.kind(child) != NodeKind::Or {
                let message = format!(
                    "`{}` stands in an AND but is a {}",
                    self.path(child),
                    kind_name(self.kind(child))
                );
                self.error("M01", message).hint =
                    Some("the children of an AND are its regions, each an OR".into());
            }
        }
    }

    fn transitions(&mut self) {
        let chart = self.chart;
        for (id, transition) in chart.transitions() {
            let count = chart.nodes().len();
            let missing = |node: NodeId| node.0 as usize >= count;
            if missing(transition.source) || missing(transition.target) {
                self.error("M03", format!("transition {} names a node that does not exist", id.0));
                continue;
            }
            self.direction(transition);
            self.trigger_and_weight(transition);
            self.internal(transition);
        }
    }

    fn direction(&mut self, transition: &Transition) {
        let (source, target) = (transition.source, transition.target);
        let nowhere = match self.kind(source) {
            NodeKind::End | NodeKind::Terminate => Some("M02"),
            _ if source == Statechart::ROOT && !transition.internal => Some("M03"),
            _ => None,
        };
        if let Some(code) = nowhere {
            let message = format!("no transition can leave `{}`", self.path(source));
            self.error(code, message);
        }
        if self.kind(target) == NodeKind::Start {
            let message = format!("no transition can enter `{}`", self.path(target));
            self.error("M02", message).hint = Some("enter the composite: it begins at its START".into());
        } else if target == Statechart::ROOT && !transition.internal {
            let message = format!("no transition can enter the root `{}`", self.path(target));
            self.error("M03", message);
        }
    }

    fn trigger_and_weight(&mut self, transition: &Transition) {
        let source = transition.source;
        let kind = self.kind(source);
        if transition.expression.trigger.is_some() && (kind == NodeKind::Start || is_connector(kind)) {
            let message = format!("a transition out of `{}` cannot wait for an event", self.path(source));
            self.error("M02", message).hint = Some("write the trigger where the way begins".into());
        }
        if transition.weight.is_some() {
            let message =
                format!("the transition out of `{}` has a weight, which is not run", self.path(source));
            self.error("E0501", message);
        }
    }

    fn internal(&mut self, transition: &Transition) {
        let (source, target) = (transition.source, transition.target);
        let within = source == target || self.chart.ancestors(target).any(|ancestor| ancestor == source);
        if transition.internal && !within {
            let message = format!("`{}` does not lie in `{}`", self.path(target), self.path(source));
            self.error("M03", message).hint = Some("an internal transition stays inside its source".into());
        }
    }

    /// Follows the ways through connectors: none may lead in a circle, end nowhere, or be endlessly long.
    fn connectors(&mut self) {
        let chart = self.chart;
        let mut outgoing: Vec<Vec<NodeId>> = vec![Vec::new(); chart.nodes().len()];
        for (_, transition) in chart.transitions() {
            outgoing[transition.source.0 as usize].push(transition.target);
        }
        let mut lengths: Vec<Length> = vec![Length::Unknown; chart.nodes().len()];
        for (id, node) in chart.nodes() {
            if is_connector(node.kind) && lengths[id.0 as usize] == Length::Unknown {
                self.follow(id, &outgoing, &mut lengths);
            }
        }
    }

    fn follow(&mut self, from: NodeId, outgoing: &[Vec<NodeId>], lengths: &mut [Length]) {
        let mut open = vec![(from, 0)];
        lengths[from.0 as usize] = Length::Open;
        while let Some((node, visited)) = open.pop() {
            let targets = &outgoing[node.0 as usize];
            let Some(&target) = targets.get(visited) else {
                self.close(node, targets, lengths);
                continue;
            };
            open.push((node, visited + 1));
            if !is_connector(self.kind(target)) {
                continue;
            }
            match lengths[target.0 as usize] {
                Length::Unknown => {
                    lengths[target.0 as usize] = Length::Open;
                    open.push((target, 0));
                }
                Length::Open => self.circle(target, &open),
                Length::Known(_) => {}
            }
        }
    }

    fn close(&mut self, node: NodeId, targets: &[NodeId], lengths: &mut [Length]) {
        if targets.is_empty() {
            let message = format!("no way leads on from `{}`", self.path(node));
            self.error("M06", message);
        }
        let longest = targets.iter().map(|target| match lengths[target.0 as usize] {
            Length::Known(length) => length,
            _ => 0,
        });
        let length = longest.max().unwrap_or(0) + 1;
        lengths[node.0 as usize] = Length::Known(length);
        if length == MAX_SEGMENTS {
            let message =
                format!("more than {MAX_SEGMENTS} connectors follow one another at `{}`", self.path(node));
            self.error("M06", message);
        }
    }

    fn circle(&mut self, target: NodeId, open: &[(NodeId, usize)]) {
        let begin = open.iter().position(|&(node, _)| node == target).unwrap_or(0);
        let circle: Vec<String> =
            open[begin..].iter().map(|&(node, _)| node).chain([target]).map(|node| self.path(node)).collect();
        self.error("M06", format!("connectors lead in a circle: `{}`", circle.join("` -> `")));
    }

    /// Where STARTs lead, and whether they may lead nowhere.
    fn starts(&mut self) {
        let chart = self.chart;
        let mut outgoing: Vec<Vec<TransitionId>> = vec![Vec::new(); chart.nodes().len()];
        for (id, transition) in chart.transitions() {
            outgoing[transition.source.0 as usize].push(id);
        }
        for (id, node) in chart.nodes() {
            if node.kind != NodeKind::Start {
                continue;
            }
            let (targets, sure) = self.reach(id, &outgoing);
            for target in targets {
                self.start_target(id, target);
            }
            if !sure {
                let message =
                    format!("every way out of `{}` has a guard: the chart may stay there", self.path(id));
                self.found.push(Diagnostic::warning("M01", Span::default(), message));
            }
        }
    }

    fn start_target(&mut self, start: NodeId, target: NodeId) {
        let parent = self.chart.node(start).parent;
        if self.kind(target) != NodeKind::Terminate
            && !self.chart.ancestors(target).any(|ancestor| Some(ancestor) == parent)
        {
            let message =
                format!("`{}` leads out of its composite, to `{}`", self.path(start), self.path(target));
            self.error("M01", message);
        }
    }

    /// Where the ways out of a START end, and whether one of them is without a guard.
    fn reach(&self, start: NodeId, outgoing: &[Vec<TransitionId>]) -> (BTreeSet<NodeId>, bool) {
        let (mut targets, mut sure) = (BTreeSet::new(), false);
        let mut open = vec![(start, true)];
        let mut seen = BTreeSet::new();
        while let Some((node, unguarded)) = open.pop() {
            for &id in &outgoing[node.0 as usize] {
                let transition = self.chart.transition(id);
                let unguarded = unguarded && transition.expression.guard.is_none();
                if !is_connector(self.kind(transition.target)) {
                    targets.insert(transition.target);
                    sure |= unguarded;
                } else if seen.insert((transition.target, unguarded)) {
                    open.push((transition.target, unguarded));
                }
            }
        }
        (targets, sure)
    }

    fn kind(&self, node: NodeId) -> NodeKind {
        self.chart.node(node).kind
    }
}

/// How many connectors follow one another from a connector on.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Length {
    Unknown,
    Open,
    Known(usize),
}

fn is_run(kind: NodeKind) -> bool {
    use NodeKind::{And, Basic, Condition, End, Junction, Or, Start, Terminate};
    matches!(kind, Or | And | Basic | End | Start | Condition | Junction | Terminate)
}

fn kind_name(kind: NodeKind) -> &'static str {
    match kind {
        NodeKind::Or => "OR",
        NodeKind::And => "AND",
        NodeKind::Basic => "BASIC state",
        NodeKind::End => "END",
        NodeKind::Start => "START",
        NodeKind::Condition => "CONDITION",
        NodeKind::Junction => "JUNCTION",
        NodeKind::Choice => "CHOICE",
        NodeKind::Fork => "FORK",
        NodeKind::Join => "JOIN",
        NodeKind::ShallowHistory => "shallow HISTORY",
        NodeKind::DeepHistory => "deep HISTORY",
        NodeKind::Terminate => "TERMINATE",
        NodeKind::EntryPoint => "entry point",
        NodeKind::ExitPoint => "exit point",
    }
}
