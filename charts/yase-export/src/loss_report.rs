//! Report of the properties that a tool cannot express.

use super::Exported;
use yase::diagnostic::{Diagnostic, Span};
use yase::statechart::{BriefNames, NodeId, NodeKind, Statechart, Transition};

/// The losses recorded for one tool.
pub(crate) struct LossReport<'a> {
    chart: &'a Statechart,
    names: BriefNames<'a>,
    tool: &'static str,
    found: Vec<Diagnostic>,
}

impl<'a> LossReport<'a> {
    /// A report that contains the transitions whose ends do not exist.
    ///
    /// # Errors
    /// The nodes of the chart do not form a tree; no text can be written.
    pub(crate) fn new(chart: &'a Statechart, tool: &'static str) -> Result<LossReport<'a>, Exported> {
        if !is_tree(chart) {
            let message = format!("`{}` is not a tree: a node is not a child of its parent", chart.name);
            let lost = vec![Diagnostic::error("E0708", Span::default(), message)];
            return Err(Exported { text: String::new(), lost });
        }
        let mut lost = LossReport { chart, names: BriefNames::new(chart), tool, found: Vec::new() };
        for (id, transition) in chart.transitions() {
            if !has_ends(chart, transition) {
                lost.report_omitted(format!("transition {} connects nodes that do not exist", id.0));
            }
        }
        Ok(lost)
    }

    /// Reports a kind of node that the tool does not have.
    pub(crate) fn kind(&mut self, id: NodeId, shown_as: &str) {
        let word = super::notation::kind_word(self.chart.node(id).kind);
        let (path, tool) = (self.names.name(id), self.tool);
        let message = format!("`{path}` has the kind {word}; in {tool} it is {shown_as}");
        self.found.push(Diagnostic::warning("E0701", Span::default(), message));
    }

    /// Reports a property of a node.
    pub(crate) fn of_node(&mut self, id: NodeId, what: &str) {
        self.warn("E0702", format!("{what} of `{}`", self.names.name(id)));
    }

    /// Reports a property of a transition.
    pub(crate) fn of_transition(&mut self, transition: &Transition, what: &str) {
        self.warn("E0703", format!("{what} of {}", self.arrow(transition)));
    }

    /// Reports the chart's constants, if there are any.
    pub(crate) fn constants(&mut self) {
        if !self.chart.constants.is_empty() {
            self.warn("E0704", format!("the constants of `{}`", self.chart.name));
        }
    }

    /// Reports an end of a transition that is not a state in the tool.
    pub(crate) fn end(&mut self, id: NodeId) {
        self.warn("E0705", format!("`{}` as an end of transitions", self.names.name(id)));
    }

    /// Reports an omitted transition with its reason.
    pub(crate) fn report_omitted(&mut self, why: String) {
        let message = format!("{why}: omitted for {}", self.tool);
        self.found.push(Diagnostic::error("E0706", Span::default(), message));
    }

    /// Reports a difference in when a transition is taken.
    pub(crate) fn moment(&mut self, message: String) {
        self.found.push(Diagnostic::warning("E0707", Span::default(), message));
    }

    fn warn(&mut self, code: &'static str, what: String) {
        let message = format!("{} cannot represent {what}", self.tool);
        self.found.push(Diagnostic::warning(code, Span::default(), message));
    }

    /// A transition as diagnostics name it.
    pub(crate) fn arrow(&self, transition: &Transition) -> String {
        format!("`{}` -> `{}`", self.names.name(transition.source), self.names.name(transition.target))
    }

    /// The text with all losses, without duplicates.
    pub(crate) fn with(self, text: String) -> Exported {
        let mut lost = Vec::with_capacity(self.found.len());
        let mut said = std::collections::BTreeSet::new();
        for finding in self.found {
            if said.insert(finding.message.clone()) {
                lost.push(finding);
            }
        }
        Exported { text, lost }
    }
}

/// Whether each node is a child of its parent and of no other node.
fn is_tree(chart: &Statechart) -> bool {
    let root_is_free = chart.node(Statechart::ROOT).parent.is_none();
    root_is_free
        && chart
            .nodes()
            .all(|(id, _)| chart.children(id).iter().all(|&child| chart.node(child).parent == Some(id)))
}

/// Whether both ends of a transition exist.
pub(crate) fn has_ends(chart: &Statechart, transition: &Transition) -> bool {
    let count = chart.nodes().len();
    [transition.source, transition.target].iter().all(|end| (end.0 as usize) < count)
}

/// Whether a node is drawn around other nodes.
pub(crate) fn is_box(chart: &Statechart, id: NodeId) -> bool {
    matches!(chart.node(id).kind, NodeKind::Or | NodeKind::And) || !chart.children(id).is_empty()
}
