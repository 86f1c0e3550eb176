//! Conversion between an [`Iac`] and a [`Statechart`].

use yase::expression::{Action, TextPosition, TransitionExpression, parse_actions_at, parse_transition_at};
use yase::{Diagnostic, Node, NodeId, NodeKind, Span, Statechart, Transition};
use yase_export::notation::{depth_first, kind_word};

use super::{ChartKind, Iac, IacNode, IacTransition, StateRefinement, TransitionRefinement};
use aseme::names::{decode, encode};
use aseme::srm::events;

/// The kinds of nodes.
pub(crate) const KINDS: [NodeKind; 15] = [
    NodeKind::Or,
    NodeKind::And,
    NodeKind::Basic,
    NodeKind::End,
    NodeKind::Start,
    NodeKind::Condition,
    NodeKind::Junction,
    NodeKind::Choice,
    NodeKind::Fork,
    NodeKind::Join,
    NodeKind::ShallowHistory,
    NodeKind::DeepHistory,
    NodeKind::Terminate,
    NodeKind::EntryPoint,
    NodeKind::ExitPoint,
];

impl Iac {
    /// The statechart of the model: encoded names are decoded to terms of formulas, expressions are
    /// parsed.
    ///
    /// A BASIC node runs the activity of its name unless another is set. Findings concern unknown
    /// types (E0817), actions and events that cannot be parsed (E0818), nodes beside the root
    /// (E0811), and expressions (E0101 and following). Labels, names of transitions,
    /// functionalities, variables and descriptions remain in the model only.
    pub fn to_statechart(&self) -> (Statechart, Vec<Diagnostic>) {
        let mut builder = StatechartBuilder {
            chart: Statechart::new(self.name.clone()),
            ids: Vec::new(),
            diagnostics: Vec::new(),
        };
        builder.chart.constants.clone_from(&self.constants);
        let labels = self.labels();
        for (node, label) in self.nodes.iter().zip(&labels) {
            builder.node(node, label);
        }
        self.transitions.iter().for_each(|transition| builder.transition(transition));
        (builder.chart, builder.diagnostics)
    }

    /// The model of a chart: names encoded, with default labels and names of transitions.
    pub fn from_statechart(chart: &Statechart, kind: ChartKind) -> Iac {
        let labels = chart.labels();
        let mut indices = vec![0; labels.len()];
        let mut iac =
            Iac { kind, name: chart.name.clone(), constants: chart.constants.clone(), ..Iac::default() };
        for (index, id) in depth_first(chart).enumerate() {
            indices[id.0 as usize] = index;
            let parent = chart.node(id).parent.map(|parent| indices[parent.0 as usize]);
            let frame = chart.layout.frames.get(&id).copied().unwrap_or_default();
            let node = node_of(chart.node(id), &labels[id.0 as usize], parent);
            iac.nodes.push(IacNode { frame, ..node });
        }
        for (id, transition) in chart.transitions() {
            let (source, target) =
                (indices[transition.source.0 as usize], indices[transition.target.0 as usize]);
            iac.transitions.push(IacTransition {
                name: iac.usual_name(source, target),
                te: transition.expression.to_string(),
                source,
                target,
                refinement: TransitionRefinement {
                    priority: transition.priority,
                    weight: transition.weight,
                    interrupts: transition.interrupts,
                    internal: transition.internal,
                },
                bends: chart.layout.bends.get(&id).cloned().unwrap_or_default(),
                ..IacTransition::default()
            });
        }
        iac
    }
}

fn node_of(node: &Node, label: &str, parent: Option<usize>) -> IacNode {
    let activity = match (node.kind, &node.activity) {
        (NodeKind::Basic, None) => Some(String::new()),
        (NodeKind::Basic, Some(activity)) if *activity == node.name => None,
        (_, activity) => activity.clone(),
    };
    let refinement = StateRefinement {
        activity,
        priority: node.priority,
        entry: actions_text(&node.entry),
        exit: actions_text(&node.exit),
        defer: node.defer.join(" "),
        duration: node.duration,
    };
    let (name, kind) = (encoded_name(node, label), kind_word(node.kind).to_owned());
    IacNode { name, label: label.into(), kind, parent, refinement, ..IacNode::default() }
}

fn encoded_name(node: &Node, label: &str) -> String {
    let encoded = encode(&node.name);
    let is_term =
        matches!(node.kind, NodeKind::Or | NodeKind::And) && decode(&encoded).as_ref() == Some(&node.name);
    match node.name.as_str() {
        "" => label.into(),
        _ if is_term => encoded,
        name => name.into(),
    }
}

fn actions_text(actions: &[Action]) -> String {
    let expression = TransitionExpression { actions: actions.to_vec(), ..TransitionExpression::default() };
    expression.to_string().trim_start_matches(['/', ' ']).to_owned()
}

struct StatechartBuilder {
    chart: Statechart,
    /// The statechart node of each node of the model.
    ids: Vec<NodeId>,
    diagnostics: Vec<Diagnostic>,
}

impl StatechartBuilder {
    fn report(&mut self, diagnostic: Diagnostic) {
        self.diagnostics.push(diagnostic);
    }

    fn node(&mut self, node: &IacNode, label: &str) {
        let kind = KINDS.into_iter().find(|kind| kind_word(*kind) == node.kind);
        if kind.is_none() {
            let message = format!("`{}` has the unknown type `{}`", node.name, node.kind);
            let found = Diagnostic::error("E0817", node.position.0, message);
            self.report(found.with_nearest(&node.kind, KINDS.into_iter().map(kind_word)));
        }
        let made = self.made(node, kind.unwrap_or(NodeKind::Basic), label);
        let parent = node.parent.and_then(|parent| self.ids.get(parent).copied());
        let id = match parent {
            Some(parent) => self.chart.add(parent, made),
            None if self.ids.is_empty() => {
                *self.chart.node_mut(Statechart::ROOT) = made;
                Statechart::ROOT
            }
            // A second root was reported when the model was parsed.
            None => self.chart.add(Statechart::ROOT, made),
        };
        if !node.frame.is_empty() {
            self.chart.layout.frames.insert(id, node.frame);
        }
        self.ids.push(id);
    }

    fn made(&mut self, node: &IacNode, kind: NodeKind, label: &str) -> Node {
        let named_by_label = node.parent.is_some() && (node.name == label || node.name == node.label);
        let name = match kind {
            _ if named_by_label && kind != NodeKind::Basic => String::new(),
            NodeKind::Or | NodeKind::And => decode(&node.name).unwrap_or_else(|| node.name.clone()),
            _ => node.name.clone(),
        };
        let refinement = &node.refinement;
        let own = (kind == NodeKind::Basic).then(|| name.clone());
        let activity = refinement.activity.clone().or(own).filter(|activity| !activity.is_empty());
        Node {
            activity,
            priority: refinement.priority,
            entry: self.actions(&refinement.entry, node),
            exit: self.actions(&refinement.exit, node),
            defer: self.events(&refinement.defer, node),
            duration: refinement.duration,
            ..Node::new(kind, name)
        }
    }

    fn actions(&mut self, text: &str, node: &IacNode) -> Vec<Action> {
        if text.is_empty() {
            return Vec::new();
        }
        let (actions, findings) = parse_actions_at(text, 0);
        self.diagnostics
            .extend(findings.into_iter().map(|finding| Diagnostic { span: node.position.0, ..finding }));
        actions
    }

    fn events(&mut self, text: &str, node: &IacNode) -> Vec<String> {
        if text.is_empty() {
            return Vec::new();
        }
        events(text).unwrap_or_else(|| {
            let message = format!("`{text}` names no events");
            self.report(
                Diagnostic::error("E0818", node.position.0, message)
                    .with_hint("names of events, separated by blanks"),
            );
            Vec::new()
        })
    }

    fn transition(&mut self, transition: &IacTransition) {
        let ends = (self.ids.get(transition.source), self.ids.get(transition.target));
        let (Some(&source), Some(&target)) = ends else { return };
        let (expression, findings) = self.expression(transition);
        self.diagnostics.extend(findings);
        let TransitionRefinement { priority, weight, interrupts, internal } = transition.refinement.clone();
        let made = Transition {
            expression,
            priority,
            weight,
            interrupts,
            internal,
            ..Transition::new(source, target)
        };
        let id = self.chart.connect(made);
        if !transition.bends.is_empty() {
            self.chart.layout.bends.insert(id, transition.bends.clone());
        }
    }

    /// Positions within an expression are exact only if the file contains its text verbatim;
    /// otherwise they are the whole expression.
    fn expression(&self, transition: &IacTransition) -> (TransitionExpression, Vec<Diagnostic>) {
        let TextPosition(span) = transition.te_position;
        let literal = span.end - span.start == transition.te.len() && span != Span::default();
        let (expression, findings) =
            parse_transition_at(&transition.te, if literal { span.start } else { 0 });
        let placed = |finding| if literal { finding } else { Diagnostic { span, ..finding } };
        (expression, findings.into_iter().map(placed).collect())
    }
}
