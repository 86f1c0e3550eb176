//! A chart that is checked, with all that is asked of it again and again.

use std::cmp::Reverse;

use yase::export::notation::kind_word;
use yase::expression::{Place, Trigger};
use yase::{Diagnostic, NodeId, NodeKind, Semantics, Span, Statechart, Transition, TransitionId};

use super::places::Places;
use crate::iac::Iac;
use crate::liveness::Liveness;
use crate::srm::Srm;
use crate::{path, transform};

/// Charts up to this size have their parts named as briefly as can be; to find the shortest name takes long in larger ones.
const BRIEF: usize = 400;

/// A chart that is checked.
pub(super) struct Subject {
    pub(super) chart: Statechart,
    pub(super) places: Places,
    /// How it is read.
    pub(super) semantics: Semantics,
    /// The formulas that it was made from.
    pub(super) liveness: Option<Liveness>,
    /// The transitions out of each node, in the order in which they are tried.
    pub(super) outgoing: Vec<Vec<TransitionId>>,
    /// The transitions into each node.
    pub(super) incoming: Vec<Vec<TransitionId>>,
}

/// The chart of a role, as far as it can be made, and what does not fit.
pub(super) fn of_role(role: &Srm) -> (Subject, Vec<Diagnostic>) {
    let (mut chart, mut nodes, mut found) = transform::expanded(&role.liveness);
    if found.iter().any(Diagnostic::is_error) {
        return (Subject::new(chart, Places::default(), Semantics::yase()), found);
    }
    chart.constants.clone_from(&role.constants);
    let (chosen, mut unmatched) = crate::refine::refine_placed(&mut chart, &role.transitions);
    unmatched.extend(crate::refine::refine_states(&mut chart, &role.states));
    found.extend(unmatched.into_iter().map(|unmatched| unmatched.diagnostic));
    // what `history` has added stands where its composite does
    for (_, node) in chart.nodes().skip(nodes.len()) {
        let owner = node.parent.and_then(|parent| nodes.get(parent.0 as usize)).copied();
        nodes.push(owner.unwrap_or_default());
    }
    let place = |id: TransitionId, transition: &Transition| match chosen.get(&id) {
        Some(&entry) => role.transitions[entry].span,
        None => begin(&chart, &nodes, transition),
    };
    let transitions = chart.transitions().map(|(id, transition)| place(id, transition)).collect();
    let guards =
        chart.transitions().map(|(_, transition)| Some(transition.expression.guard.as_ref()?.span()));
    let places = Places { guards: guards.collect(), transitions, nodes };
    let subject = Subject::new(chart, places, Semantics::yase());
    (Subject { liveness: Some(role.liveness.clone()), ..subject }, found)
}

/// A transition that no entry refines stands where the formula names its source, or what it leads to if that is known by its place alone.
fn begin(chart: &Statechart, nodes: &[Span], transition: &Transition) -> Span {
    let named = |node: &NodeId| !chart.node(*node).name.is_empty();
    let node = [transition.source, transition.target].into_iter().find(named).unwrap_or(transition.source);
    nodes.get(node.0 as usize).copied().unwrap_or_default()
}

/// The chart of a file of its own.
pub(super) fn of_chart(iac: &Iac) -> (Subject, Vec<Diagnostic>) {
    let (chart, found) = iac.to_statechart();
    let count = iac.nodes.len();
    let transitions = || iac.transitions.iter().filter(|it| it.source < count && it.target < count);
    let literal = |place: Place, text: &str| place.0.end - place.0.start == text.len();
    let guards = transitions().zip(chart.transitions()).map(|(it, (_, transition))| {
        let guard = transition.expression.guard.as_ref()?.span();
        literal(it.te_place, &it.te).then_some(guard)
    });
    let places = Places {
        nodes: iac.nodes.iter().map(|node| node.place.0).collect(),
        guards: guards.collect(),
        transitions: transitions().map(|transition| transition.place.0).collect(),
    };
    (Subject::new(chart, places, Semantics::yase()), found)
}

/// The chart of an SCXML document, which does not say where its parts stand.
pub(super) fn of_scxml(document: &yase::scxml::Document) -> Subject {
    Subject::new(document.statechart().clone(), Places::default(), Semantics::scxml())
}

impl Subject {
    fn new(chart: Statechart, places: Places, semantics: Semantics) -> Subject {
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
        for ways in &mut outgoing {
            ways.sort_by_key(|&id: &TransitionId| {
                let transition = chart.transition(id);
                let is_unguarded = guarded_first && transition.expression.guard.is_none();
                (Reverse(transition.priority), is_unguarded)
            });
        }
        Subject { chart, places, semantics, liveness: None, outgoing, incoming }
    }

    pub(super) fn kind(&self, node: NodeId) -> NodeKind {
        self.chart.node(node).kind
    }

    pub(super) fn outgoing(&self, node: NodeId) -> &[TransitionId] {
        &self.outgoing[node.0 as usize]
    }

    pub(super) fn incoming(&self, node: NodeId) -> &[TransitionId] {
        &self.incoming[node.0 as usize]
    }

    pub(super) fn transition(&self, id: TransitionId) -> &Transition {
        self.chart.transition(id)
    }

    pub(super) fn is_state(&self, node: NodeId) -> bool {
        matches!(self.kind(node), NodeKind::Or | NodeKind::And | NodeKind::Basic)
    }

    /// Whether a node lies in another or is it.
    pub(super) fn contains(&self, outer: NodeId, inner: NodeId) -> bool {
        outer == inner || self.chart.ancestors(inner).any(|ancestor| ancestor == outer)
    }

    /// Whether a node is a region of an AND.
    pub(super) fn is_region(&self, node: NodeId) -> bool {
        self.chart.node(node).parent.is_some_and(|parent| self.kind(parent) == NodeKind::And)
    }

    /// The AND in two different regions of which two nodes lie, and these regions.
    pub(super) fn apart(&self, one: NodeId, other: NodeId) -> Option<(NodeId, NodeId, NodeId)> {
        let way = |node: NodeId| -> Vec<NodeId> {
            let mut way: Vec<NodeId> = std::iter::once(node).chain(self.chart.ancestors(node)).collect();
            way.reverse();
            way
        };
        let (one, other) = (way(one), way(other));
        let fork = one.iter().zip(&other).position(|(one, other)| one != other)?;
        let around = *one.get(fork.checked_sub(1)?)?;
        (self.kind(around) == NodeKind::And).then_some((around, one[fork], other[fork]))
    }

    /// What a node is called.
    pub(super) fn path(&self, node: NodeId) -> String {
        match self.chart.nodes().len() <= BRIEF {
            true if !self.chart.node(node).name.is_empty() || node == Statechart::ROOT => {
                path::shortest_path(&self.chart, node)
            }
            true => self.place_in_parent(node),
            false => self.chart.path(node),
        }
    }

    /// A node without a name, by its kind and the composite around it.
    fn place_in_parent(&self, node: NodeId) -> String {
        let kind = self.kind(node);
        let Some(parent) = self.chart.node(node).parent else { return String::new() };
        let siblings = self.chart.children(parent);
        let alike: Vec<NodeId> = siblings
            .iter()
            .copied()
            .filter(|&it| self.kind(it) == kind && self.chart.node(it).name.is_empty())
            .collect();
        let number = alike.iter().position(|&it| it == node).unwrap_or(0) + 1;
        let word = match alike.len() {
            1 => kind_word(kind).to_owned(),
            _ if self.is_region(node) => number.to_string(),
            _ => format!("{}[{number}]", kind_word(kind)),
        };
        let is_alone =
            self.chart.nodes().filter(|(_, it)| it.kind == kind && it.name.is_empty()).count() == 1;
        if is_alone { word } else { format!("{}/{word}", self.path(parent)) }
    }

    /// `a -> b`
    pub(super) fn arrow(&self, id: TransitionId) -> String {
        let transition = self.transition(id);
        format!("{} -> {}", self.path(transition.source), self.path(transition.target))
    }

    /// The events that a node of the chart waits for in a trigger, written out.
    pub(super) fn trigger(&self, id: TransitionId) -> Option<&Trigger> {
        self.transition(id).expression.trigger.as_ref()
    }

    /// A warning about a node.
    pub(super) fn warn(&self, code: &'static str, node: NodeId, message: String) -> Diagnostic {
        Diagnostic::warning(code, self.places.node(node), message)
    }

    /// A warning about a transition.
    pub(super) fn warn_of(&self, code: &'static str, id: TransitionId, message: String) -> Diagnostic {
        Diagnostic::warning(code, self.places.transition(id), message)
    }
}
