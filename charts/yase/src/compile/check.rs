//! Checks the structure of a chart.

mod connectors;
mod transitions;

use crate::compile::NodeOrder;
use crate::compile::node_roles::{NodeRoles, is_state};
use crate::diagnostic::{Diagnostic, Span};
use crate::semantics::{Semantics, StructureRules};
use crate::statechart::{BriefNames, Element, NodeId, NodeKind, Statechart};

impl Statechart {
    /// Checks the structure. Each diagnostic names states by their path; errors prevent execution.
    ///
    /// | code | finding |
    /// |---|---|
    /// | `M01` | a composite without exactly one START; an AND without regions, or with START or END in it; a START that leads out of its composite; a START that may have no enabled transition (a warning) |
    /// | `M02` | a transition into START or out of END; a trigger where no event is awaited |
    /// | `M03` | a transition whose ends do not exist, or whose source or target is invalid: the root, a target outside the source of an internal transition; a HISTORY that leads out of its composite |
    /// | `M04` | a FORK without two segments out of it, or with a guard or a trigger on one, or whose targets cannot be active together; a JOIN without two sources in different regions of one AND, without exactly one segment out of it, or with a trigger on a segment |
    /// | `M05` | a CHOICE whose transitions all have guards (a warning) |
    /// | `M06` | connectors that form a cycle, lead nowhere, or form chains that are too long |
    /// | `M23` | weights that are not between 0 and 1, or do not sum to 1 among the segments that leave one node |
    /// | `E0502` | a child of a node that cannot have children |
    /// | `E0503` | an activity of a node that is not a BASIC state |
    /// | `E0504` | a root that is not an OR; a node whose parent is not the node that contains it |
    ///
    /// These are the rules of [`StructureRules::Strict`]. [`check_for`](Statechart::check_for)
    /// checks a chart for any semantics.
    ///
    /// Two errors that require the enumeration of all paths through connectors are found by
    /// [`compile`](Statechart::compile) only: invalid targets of a FORK behind further connectors,
    /// and too many combinations of connectors.
    pub fn check(&self) -> Vec<Diagnostic> {
        self.check_for(&Semantics::yase())
    }

    /// Checks the structure for a semantics.
    pub fn check_for(&self, semantics: &Semantics) -> Vec<Diagnostic> {
        self.check_elements(semantics).into_iter().map(|(diagnostic, _)| diagnostic).collect()
    }

    /// The diagnostics of [`check_for`](Statechart::check_for), each with the node or transition
    /// that it concerns, so that the caller can add its location in a file.
    pub fn check_elements(&self, semantics: &Semantics) -> Vec<(Diagnostic, Option<Element>)> {
        let found = tree(self);
        if !found.is_empty() {
            return found.into_iter().map(|diagnostic| (diagnostic, None)).collect();
        }
        let layout = NodeOrder::new(self);
        let mut check = ChartValidator {
            chart: self,
            names: BriefNames::new(self),
            layout: &layout,
            is_strict: semantics.structure == StructureRules::Strict,
            found: Vec::new(),
            about: None,
        };
        check.nodes();
        if check.ends_exist() {
            check.transitions();
        }
        if check.found.is_empty() {
            let roles = NodeRoles::new(self, &layout, semantics);
            check.connectors(&roles);
        }
        check.found
    }
}

struct ChartValidator<'a> {
    chart: &'a Statechart,
    names: BriefNames<'a>,
    layout: &'a NodeOrder,
    /// Whether the forms that only UML allows are errors.
    is_strict: bool,
    found: Vec<(Diagnostic, Option<Element>)>,
    /// The element under examination.
    about: Option<Element>,
}

fn error<'f>(found: &'f mut Vec<Diagnostic>, code: &'static str, message: String) -> &'f mut Diagnostic {
    found.push(Diagnostic::error(code, Span::default(), message));
    let last = found.len() - 1;
    &mut found[last]
}

/// Nodes can be modified in place; their parents must still be the nodes that contain them. Paths
/// are meaningless before this is checked.
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

impl ChartValidator<'_> {
    fn error(&mut self, code: &'static str, message: String) -> &mut Diagnostic {
        self.report(Diagnostic::error(code, Span::default(), message))
    }

    fn report(&mut self, diagnostic: Diagnostic) -> &mut Diagnostic {
        self.found.push((diagnostic, self.about));
        let last = self.found.len() - 1;
        &mut self.found[last].0
    }

    fn path(&self, node: NodeId) -> String {
        self.names.name(node)
    }

    fn kind(&self, node: NodeId) -> NodeKind {
        self.chart.node(node).kind
    }

    /// Whether a node is inside another or is it.
    fn contains(&self, outer: NodeId, inner: NodeId) -> bool {
        self.layout.contains(self.layout.index_of(outer), self.layout.index_of(inner))
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
            let may_run = match node.kind {
                NodeKind::Or | NodeKind::And => {
                    let parent = node.parent.map(|parent| self.kind(parent));
                    !self.is_strict && parent.is_some_and(|kind| kind != NodeKind::And)
                }
                kind => kind == NodeKind::Basic,
            };
            if node.activity.is_some() && !may_run {
                let message =
                    format!("`{}` is a {} and cannot have an activity", self.path(id), kind_name(node.kind));
                self.error("E0503", message);
            }
        }
    }

    fn composite(&mut self, id: NodeId) {
        let starts =
            self.chart.children(id).iter().filter(|&&child| self.kind(child) == NodeKind::Start).count();
        if starts != 1 && (self.is_strict || starts > 1) {
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
