//! What must hold of a chart's structure before it can run.

mod connectors;
mod transitions;

use crate::chart::Layout;
use crate::chart::roles::{Roles, is_state};
use crate::diagnostic::{Diagnostic, Span};
use crate::statechart::{Element, NodeId, NodeKind, Statechart};

impl Statechart {
    /// Checks the structure. Each finding names states by their path; whether a chart can run is decided by its errors.
    ///
    /// | code | finding |
    /// |---|---|
    /// | `M01` | a composite without exactly one START; an AND without regions, or with START or END in it; a START that leads out of its composite; a START that may have no open way (a warning) |
    /// | `M02` | a transition into START or out of END; a trigger where no event is waited for |
    /// | `M03` | a transition whose ends do not exist, or whose source or target cannot be one: the root, the outside of an internal transition's source; a HISTORY that leads out of its composite |
    /// | `M04` | a FORK without two segments out of it, or with a guard or a trigger on one, or whose targets cannot be active together; a JOIN without two sources in different regions of one AND, without exactly one segment out of it, or with a trigger on a segment |
    /// | `M05` | a CHOICE all whose ways have guards (a warning) |
    /// | `M06` | connectors that lead in a circle, nowhere, or on without measure |
    /// | `M23` | weights that are not between 0 and 1, or do not sum to 1 among the segments that leave one node |
    /// | `E0502` | something inside what cannot hold states |
    /// | `E0503` | an activity of what is no BASIC state |
    /// | `E0504` | a root that is no OR; a node whose parent is not the node that holds it |
    ///
    /// What needs every way through the connectors is found by [`compile`](Statechart::compile) only: the targets of a FORK behind further
    /// connectors, and chains of connectors that multiply beyond measure.
    pub fn check(&self) -> Vec<Diagnostic> {
        self.check_elements().into_iter().map(|(diagnostic, _)| diagnostic).collect()
    }

    /// The findings of [`check`](Statechart::check), each with the node or the transition that it is about: whoever knows where that stands in a file can
    /// point there.
    pub fn check_elements(&self) -> Vec<(Diagnostic, Option<Element>)> {
        let found = tree(self);
        if !found.is_empty() {
            return found.into_iter().map(|diagnostic| (diagnostic, None)).collect();
        }
        let layout = Layout::new(self);
        let mut check = Check { chart: self, layout: &layout, found: Vec::new(), about: None };
        check.nodes();
        if check.ends_exist() {
            check.transitions();
        }
        if check.found.is_empty() {
            let roles = Roles::new(self, &layout);
            check.connectors(&roles);
        }
        check.found
    }
}

struct Check<'a> {
    chart: &'a Statechart,
    layout: &'a Layout,
    found: Vec<(Diagnostic, Option<Element>)>,
    /// What is being looked at.
    about: Option<Element>,
}

fn error<'f>(found: &'f mut Vec<Diagnostic>, code: &'static str, message: String) -> &'f mut Diagnostic {
    found.push(Diagnostic::error(code, Span::default(), message));
    let last = found.len() - 1;
    &mut found[last]
}

/// Nodes can be refined in place; their parents must still be the nodes that hold them. Paths make no sense before this is known.
fn tree(chart: &Statechart) -> Vec<Diagnostic> {
    let mut found = Vec::new();
    let root = chart.node(Statechart::ROOT);
    if root.kind != NodeKind::Or || root.parent.is_some() {
        error(&mut found, "E0504", format!("the root of `{}` is not an OR without parent", chart.name));
    }
    for (id, _) in chart.nodes() {
        for &child in chart.children(id) {
            if chart.node(child).parent != Some(id) {
                let message = format!("node {} lies in node {}, which is not its parent", child.0, id.0);
                error(&mut found, "E0504", message);
            }
        }
    }
    found
}

impl Check<'_> {
    fn error(&mut self, code: &'static str, message: String) -> &mut Diagnostic {
        self.report(Diagnostic::error(code, Span::default(), message))
    }

    fn report(&mut self, diagnostic: Diagnostic) -> &mut Diagnostic {
        self.found.push((diagnostic, self.about));
        let last = self.found.len() - 1;
        &mut self.found[last].0
    }

    fn path(&self, node: NodeId) -> String {
        self.chart.path(node)
    }

    fn kind(&self, node: NodeId) -> NodeKind {
        self.chart.node(node).kind
    }

    /// Whether a node lies in another or is it.
    fn contains(&self, outer: NodeId, inner: NodeId) -> bool {
        self.layout.contains(self.layout.place_of(outer), self.layout.place_of(inner))
    }

    fn nodes(&mut self) {
        let chart = self.chart;
        for (id, node) in chart.nodes() {
            self.about = Some(Element::Node(id));
            match node.kind {
                NodeKind::Or => self.composite(id),
                NodeKind::And => self.orthogonal(id),
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
        if !chart.children(id).iter().any(|&child| is_state(self.kind(child))) {
            let message = format!("AND `{}` has no regions", self.path(id));
            self.error("M01", message);
        }
        for &child in chart.children(id) {
            if matches!(self.kind(child), NodeKind::Start | NodeKind::End) {
                let (path, kind) = (self.path(child), kind_name(self.kind(child)));
                let message = format!("{kind} `{path}` stands in an AND");
                self.error("M01", message).hint =
                    Some("the regions of an AND begin and end, each by itself".into());
            }
        }
    }
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
