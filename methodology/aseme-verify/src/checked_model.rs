//! A chart that is checked, with its formulas, its positions in the source and indexed transitions.

mod source_spans;
pub(crate) mod timers;

use std::cmp::Reverse;
use std::sync::Arc;

use yase::expression::{TextPosition, Trigger};
use yase::{Diagnostic, NodeId, NodeKind, Semantics, Source, Span, Statechart, Transition, TransitionId};

use aseme::liveness::Liveness;
use aseme::srm::Srm;
use aseme::transform;
use aseme_models::convert::{self, Model};
use aseme_models::iac::Iac;
use source_spans::SourceSpans;

use crate::diagnostic_names::DiagnosticNames;

/// A chart that is checked.
pub(crate) struct CheckedModel {
    pub(crate) chart: Statechart,
    pub(crate) spans: SourceSpans,
    /// The semantics in which the chart is interpreted.
    pub(crate) semantics: Semantics,
    /// The formulas that the chart was generated from.
    pub(crate) liveness: Option<Liveness>,
    /// The transitions out of each node, in selection order.
    pub(crate) outgoing: Vec<Vec<TransitionId>>,
    /// The transitions into each node.
    pub(crate) incoming: Vec<Vec<TransitionId>>,
    /// By node: its number in a walk through the tree, and the number after those inside it.
    extents: Vec<(u32, u32)>,
    /// The names of the nodes in diagnostics.
    pub(crate) names: Arc<DiagnosticNames>,
}

/// Builds the chart of a role as far as possible, and reports what does not fit.
pub(crate) fn of_role(role: &Srm) -> (CheckedModel, Vec<Diagnostic>) {
    let (mut chart, mut nodes, mut found) = transform::expanded(&role.liveness);
    if found.iter().any(Diagnostic::is_error) {
        return (CheckedModel::new(chart, SourceSpans::default(), Semantics::yase()), found);
    }
    chart.constants.clone_from(&role.constants);
    let (chosen, mut unmatched) = aseme::refine::refine_placed(&mut chart, &role.transitions);
    unmatched.extend(aseme::refine::refine_states(&mut chart, &role.states));
    found.extend(unmatched.into_iter().map(|unmatched| unmatched.diagnostic));
    // a HISTORY node has the span of its composite
    for (_, node) in chart.nodes().skip(nodes.len()) {
        let owner = node.parent.and_then(|parent| nodes.get(parent.0 as usize)).copied();
        nodes.push(owner.unwrap_or_default());
    }
    let span_of = |id: TransitionId, transition: &Transition| match chosen.get(&id) {
        Some(&entry) => role.transitions[entry].span,
        None => begin(&chart, &nodes, transition),
    };
    let transitions = chart.transitions().map(|(id, transition)| span_of(id, transition)).collect();
    let guards =
        chart.transitions().map(|(_, transition)| Some(transition.expression.guard.as_ref()?.span()));
    let spans = SourceSpans { guards: guards.collect(), transitions, nodes };
    let subject = CheckedModel::new(chart, spans, Semantics::yase());
    (CheckedModel { liveness: Some(role.liveness.clone()), ..subject }, found)
}

/// The span of a transition without a refinement: its source in the formula, or its target if only
/// that has a span.
fn begin(chart: &Statechart, nodes: &[Span], transition: &Transition) -> Span {
    let named = |node: &NodeId| !chart.node(*node).name.is_empty();
    let node = [transition.source, transition.target].into_iter().find(named).unwrap_or(transition.source);
    nodes.get(node.0 as usize).copied().unwrap_or_default()
}

/// The chart of a model in the format IAC.
pub(crate) fn of_chart(iac: &Iac) -> (CheckedModel, Vec<Diagnostic>) {
    let (chart, found) = iac.to_statechart();
    let count = iac.nodes.len();
    let transitions = || iac.transitions.iter().filter(|it| it.source < count && it.target < count);
    let literal = |position: TextPosition, text: &str| position.0.end - position.0.start == text.len();
    let guards = transitions().zip(chart.transitions()).map(|(it, (_, transition))| {
        let guard = transition.expression.guard.as_ref()?.span();
        literal(it.te_position, &it.te).then_some(guard)
    });
    let spans = SourceSpans {
        nodes: iac.nodes.iter().map(|node| node.position.0).collect(),
        guards: guards.collect(),
        transitions: transitions().map(|transition| transition.position.0).collect(),
    };
    (CheckedModel::new(chart, spans, Semantics::yase()), found)
}

/// The chart of an SCXML document, which has no spans.
pub(crate) fn of_scxml(document: &yase_scxml::Document) -> CheckedModel {
    CheckedModel::new(document.statechart().clone(), SourceSpans::default(), Semantics::scxml())
}

/// The chart of a model, and the position of each of its transitions in the text.
///
/// # Errors
/// The errors that prevent reading the model.
pub(crate) fn chart_and_transition_spans(
    source: &Arc<Source>,
) -> Result<(Statechart, Vec<Span>), Vec<Diagnostic>> {
    let CheckedModel { chart, spans, .. } = subject_of(source)?;
    Ok((chart, spans.transitions))
}

/// The chart of a model, prepared for checks.
pub(crate) fn subject_of(source: &Arc<Source>) -> Result<CheckedModel, Vec<Diagnostic>> {
    let (found, mut read) = convert::read(source);
    let (subject, made) = match found {
        Some((Model::Role(_), _)) if aseme::have_formula_errors(&read) => {
            return Err(in_source(source, read));
        }
        Some((Model::Role(file), _)) => of_role(file.srm()),
        Some((Model::Chart(chart), _)) => of_chart(&chart),
        Some((model, _)) => {
            let message = format!("a model of the kind {} has no statechart", model.kind());
            return Err(in_source(source, vec![Diagnostic::error("E0230", Span::default(), message)]));
        }
        None => return Err(read),
    };
    read.extend(made);
    if read.iter().any(Diagnostic::is_error) {
        return Err(in_source(source, read));
    }
    Ok(subject)
}

pub(crate) fn in_source(source: &Arc<Source>, found: Vec<Diagnostic>) -> Vec<Diagnostic> {
    found.into_iter().map(|diagnostic| diagnostic.in_source(source)).collect()
}

impl CheckedModel {
    fn new(chart: Statechart, spans: SourceSpans, semantics: Semantics) -> CheckedModel {
        let count = chart.nodes().len();
        let (mut outgoing, mut incoming) = (vec![Vec::new(); count], vec![Vec::new(); count]);
        let exists = |node: NodeId| (node.0 as usize) < count;
        for (id, transition) in chart.transitions() {
            if exists(transition.source) && exists(transition.target) {
                outgoing[transition.source.0 as usize].push(id);
                incoming[transition.target.0 as usize].push(id);
            }
        }
        let guarded_first = semantics.order == yase::SegmentOrder::GuardedFirst;
        for transitions in &mut outgoing {
            transitions.sort_by_key(|&id: &TransitionId| {
                let transition = chart.transition(id);
                let is_unguarded = guarded_first && transition.expression.guard.is_none();
                (Reverse(transition.priority), is_unguarded)
            });
        }
        let extents = extents(&chart);
        let names = Arc::new(DiagnosticNames::new(&chart));
        CheckedModel { chart, spans, semantics, liveness: None, outgoing, incoming, extents, names }
    }

    pub(crate) fn kind(&self, node: NodeId) -> NodeKind {
        self.chart.node(node).kind
    }

    pub(crate) fn outgoing(&self, node: NodeId) -> &[TransitionId] {
        &self.outgoing[node.0 as usize]
    }

    pub(crate) fn incoming(&self, node: NodeId) -> &[TransitionId] {
        &self.incoming[node.0 as usize]
    }

    pub(crate) fn transition(&self, id: TransitionId) -> &Transition {
        self.chart.transition(id)
    }

    pub(crate) fn is_state(&self, node: NodeId) -> bool {
        matches!(self.kind(node), NodeKind::Or | NodeKind::And | NodeKind::Basic)
    }

    /// Whether a node is another or lies inside it.
    pub(crate) fn contains(&self, outer: NodeId, inner: NodeId) -> bool {
        let ((first, end), (number, _)) = (self.extents[outer.0 as usize], self.extents[inner.0 as usize]);
        (first..end).contains(&number)
    }

    /// Whether a node is a region of an AND.
    pub(crate) fn is_region(&self, node: NodeId) -> bool {
        self.chart.node(node).parent.is_some_and(|parent| self.kind(parent) == NodeKind::And)
    }

    /// The number of a node in a walk through the tree, and the number after those inside it.
    pub(crate) fn extent(&self, node: NodeId) -> (u32, u32) {
        self.extents[node.0 as usize]
    }

    /// The AND that separates two nodes into different regions, with these regions.
    pub(crate) fn apart(&self, one: NodeId, other: NodeId) -> Option<(NodeId, NodeId, NodeId)> {
        let path_to = |node: NodeId| -> Vec<NodeId> {
            let mut nodes: Vec<NodeId> = std::iter::once(node).chain(self.chart.ancestors(node)).collect();
            nodes.reverse();
            nodes
        };
        let (one, other) = (path_to(one), path_to(other));
        let fork = one.iter().zip(&other).position(|(one, other)| one != other)?;
        let around = *one.get(fork.checked_sub(1)?)?;
        (self.kind(around) == NodeKind::And).then_some((around, one[fork], other[fork]))
    }

    /// The name of a node in diagnostics.
    pub(crate) fn path(&self, node: NodeId) -> String {
        self.names.name(node)
    }

    /// `a -> b`
    pub(crate) fn arrow(&self, id: TransitionId) -> String {
        self.names.transition(id)
    }

    /// The trigger of a transition, with inherited events resolved.
    pub(crate) fn trigger(&self, id: TransitionId) -> Option<&Trigger> {
        self.transition(id).expression.trigger.as_ref()
    }

    /// A warning about a node.
    pub(crate) fn warn(&self, code: &'static str, node: NodeId, message: String) -> Diagnostic {
        Diagnostic::warning(code, self.spans.node(node), message)
    }

    /// A warning about a transition.
    pub(crate) fn warn_of(&self, code: &'static str, id: TransitionId, message: String) -> Diagnostic {
        Diagnostic::warning(code, self.spans.transition(id), message)
    }
}

/// The extent of each node in a walk that visits a node before those inside it.
fn extents(chart: &Statechart) -> Vec<(u32, u32)> {
    let mut extents = vec![(0, 0); chart.nodes().len()];
    let (mut number, mut open) = (0, vec![(Statechart::ROOT, false)]);
    while let Some((node, is_left)) = open.pop() {
        let extent = &mut extents[node.0 as usize];
        if is_left {
            extent.1 = number;
            continue;
        }
        extent.0 = number;
        number += 1;
        open.push((node, true));
        open.extend(chart.children(node).iter().map(|&child| (child, false)));
    }
    extents
}
