//! The list of what a tool cannot say.

use super::Exported;
use crate::diagnostic::{Diagnostic, Span};
use crate::statechart::{NodeId, NodeKind, Statechart, Transition};

/// What has been lost so far on the way to one tool.
pub(super) struct Lost<'a> {
    chart: &'a Statechart,
    tool: &'static str,
    found: Vec<Diagnostic>,
}

impl<'a> Lost<'a> {
    /// The list for a tool, with the transitions whose ends do not exist.
    ///
    /// # Errors
    /// For a chart whose nodes do not lie where they say: nothing can be said of it.
    pub(super) fn new(chart: &'a Statechart, tool: &'static str) -> Result<Lost<'a>, Exported> {
        if !is_tree(chart) {
            let message = format!("`{}` is no tree: a node does not lie in its parent", chart.name);
            let lost = vec![Diagnostic::error("E0708", Span::default(), message)];
            return Err(Exported { text: String::new(), lost });
        }
        let mut lost = Lost { chart, tool, found: Vec::new() };
        for (id, transition) in chart.transitions() {
            if !has_ends(chart, transition) {
                lost.left_out(format!("transition {} joins nodes that do not exist", id.0));
            }
        }
        Ok(lost)
    }

    /// A node of a kind that the tool does not have.
    pub(super) fn kind(&mut self, id: NodeId, shown_as: &str) {
        let word = super::notation::kind_word(self.chart.node(id).kind);
        let (path, tool) = (self.chart.path(id), self.tool);
        let message = format!("`{path}` is of the kind {word}; for {tool} it is {shown_as}");
        self.found.push(Diagnostic::warning("E0701", Span::default(), message));
    }

    /// Something said of a node.
    pub(super) fn of_node(&mut self, id: NodeId, what: &str) {
        self.warn("E0702", format!("{what} of `{}`", self.chart.path(id)));
    }

    /// Something said of a transition.
    pub(super) fn of_transition(&mut self, transition: &Transition, what: &str) {
        self.warn("E0703", format!("{what} of {}", self.arrow(transition)));
    }

    /// The chart's constants, if there are any.
    pub(super) fn constants(&mut self) {
        if !self.chart.constants.is_empty() {
            self.warn("E0704", format!("the constants of `{}`", self.chart.name));
        }
    }

    /// An end of a transition that is no state there.
    pub(super) fn end(&mut self, id: NodeId) {
        self.warn("E0705", format!("`{}` as an end of transitions", self.chart.path(id)));
    }

    /// A transition, because of something.
    pub(super) fn left_out(&mut self, why: String) {
        let message = format!("{why}: left out for {}", self.tool);
        self.found.push(Diagnostic::error("E0706", Span::default(), message));
    }

    /// When a transition happens.
    pub(super) fn moment(&mut self, message: String) {
        self.found.push(Diagnostic::warning("E0707", Span::default(), message));
    }

    fn warn(&mut self, code: &'static str, what: String) {
        let message = format!("{} has no way to say {what}", self.tool);
        self.found.push(Diagnostic::warning(code, Span::default(), message));
    }

    /// A transition as findings name it.
    pub(super) fn arrow(&self, transition: &Transition) -> String {
        format!("`{}` -> `{}`", self.chart.path(transition.source), self.chart.path(transition.target))
    }

    /// The text, with all that it lacks, each thing once.
    pub(super) fn with(self, text: String) -> Exported {
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

/// Whether each node lies in its parent and nowhere else.
fn is_tree(chart: &Statechart) -> bool {
    let root_is_free = chart.node(Statechart::ROOT).parent.is_none();
    root_is_free
        && chart
            .nodes()
            .all(|(id, _)| chart.children(id).iter().all(|&child| chart.node(child).parent == Some(id)))
}

/// Whether both ends of a transition are nodes of the chart.
pub(super) fn has_ends(chart: &Statechart, transition: &Transition) -> bool {
    let count = chart.nodes().len();
    [transition.source, transition.target].iter().all(|end| (end.0 as usize) < count)
}

/// Whether something is drawn around other nodes.
pub(super) fn is_box(chart: &Statechart, id: NodeId) -> bool {
    matches!(chart.node(id).kind, NodeKind::Or | NodeKind::And) || !chart.children(id).is_empty()
}
