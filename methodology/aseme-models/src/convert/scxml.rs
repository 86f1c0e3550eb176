//! Conversion of a chart to SCXML, with a list of what SCXML cannot represent.

use std::collections::BTreeMap;

use yase::expression::{Action, Expression, ExpressionKind, TransitionExpression};
use yase::{Diagnostic, Node, NodeId, NodeKind, Statechart, Transition};

use super::WrittenModel;
use crate::iac::Iac;
use aseme::layout::frame_settings;
use aseme::names::encode;

/// The chart as SCXML. If SCXML cannot represent it completely, the text represents the nearest
/// chart.
///
/// # Errors
/// The errors of the chart, or what SCXML cannot represent.
pub(crate) fn write(model: &Iac) -> Result<WrittenModel, Vec<Diagnostic>> {
    let (chart, findings) = model.to_statechart();
    if findings.iter().any(Diagnostic::is_error) {
        return Err(findings);
    }
    let mut lost = beside_the_chart(model, &chart);
    match yase_scxml::write(&with_ids(&chart)) {
        Ok(text) => Ok(WrittenModel { text, lost }),
        Err(refused) => {
            lost.extend(refused);
            let text = yase_scxml::write(&nearest(&chart))?;
            Ok(WrittenModel { text, lost })
        }
    }
}

/// Content of a model file beside the chart, such as labels and names of transitions.
fn beside_the_chart(model: &Iac, chart: &Statechart) -> Vec<Diagnostic> {
    let plain = Iac::from_statechart(chart, model.kind);
    let mut lost = Vec::new();
    let mut add = |position: yase::expression::TextPosition, what: String| {
        let message = format!("{what}: SCXML cannot represent it");
        lost.push(Diagnostic::warning("E0850", position.0, message));
    };
    for (node, usual) in model.nodes.iter().zip(&plain.nodes) {
        let texts = [
            ("label", &node.label, &usual.label),
            ("functionality", &node.functionality, &usual.functionality),
            ("actions", &node.actions, &usual.actions),
            ("metadata", &node.metadata, &usual.metadata),
        ];
        for (what, text, _) in texts.into_iter().filter(|(_, text, usual)| text != usual) {
            add(node.position, format!("the {what} of `{}`, `{text}`", node.name));
        }
        for (key, value) in frame_settings(&node.frame) {
            add(node.position, format!("the layout of `{}`, `{key} = {value}`", node.name));
        }
        if !node.variables.is_empty() {
            add(node.position, format!("the variables of `{}`", node.name));
        }
    }
    for (transition, usual) in model.transitions.iter().zip(&plain.transitions) {
        if transition.name != usual.name {
            add(transition.position, format!("the name of the transition `{}`", transition.name));
        }
        if !transition.bends.is_empty() {
            add(transition.position, format!("the layout of `{}`", transition.name));
        }
        if !transition.metadata.is_empty() {
            add(transition.position, format!("the metadata of `{}`", transition.name));
        }
    }
    model
        .variables
        .iter()
        .for_each(|variable| add(variable.position, format!("the variable `{}`", variable.name)));
    let model_texts = [("description", &model.description), ("metadata", &model.metadata)];
    for (what, text) in model_texts.into_iter().filter(|(_, text)| !text.is_empty()) {
        add(yase::expression::TextPosition::default(), format!("the {what} `{text}`"));
    }
    lost
}

/// The chart with a name for each state that has none: transitions refer to their targets by ids.
fn with_ids(chart: &Statechart) -> Statechart {
    use NodeKind::{And, Basic, DeepHistory, End, Or, ShallowHistory};
    let mut named = chart.clone();
    for ((id, node), name) in chart.nodes().skip(1).zip(ids(chart).into_iter().skip(1)) {
        if node.name.is_empty() && matches!(node.kind, And | Basic | DeepHistory | End | Or | ShallowHistory)
        {
            named.node_mut(id).name = name;
        }
    }
    named
}

/// The chart without what SCXML cannot say: connectors that branch are states that are left at
/// once, names are ids, and activities and actions that it has no words for are gone. A guard that
/// it has no words for is `false`: what would be taken only sometimes is not taken always.
fn nearest(chart: &Statechart) -> Statechart {
    let mut plain = Statechart::new(chart.name.clone());
    let (names, labels) = (ids(chart), chart.labels());
    let mut new_ids: Vec<NodeId> = Vec::new();
    let mut outgoing: BTreeMap<NodeId, Vec<&Transition>> = BTreeMap::new();
    for (_, transition) in chart.transitions() {
        outgoing.entry(transition.source).or_default().push(transition);
    }
    // A START with a guard is followed by a state that evaluates it.
    let mut deciders: BTreeMap<NodeId, NodeId> = BTreeMap::new();
    for (id, node) in chart.nodes() {
        let made = plain_node(node, &names[id.0 as usize]);
        let Some(parent) = node.parent else {
            *plain.node_mut(Statechart::ROOT) = made;
            new_ids.push(Statechart::ROOT);
            continue;
        };
        let parent = new_ids[parent.0 as usize];
        let new = plain.add(parent, made);
        new_ids.push(new);
        let transitions = outgoing.get(&id).map(Vec::as_slice).unwrap_or_default();
        if node.kind == NodeKind::Start && !is_plain_start(transitions) {
            let name = format!("start_{}", labels[id.0 as usize].replace('.', "_"));
            let decider = plain.add(parent, Node::new(NodeKind::Basic, name));
            plain.connect(Transition::new(new, decider));
            deciders.insert(id, decider);
        }
    }
    for (_, transition) in chart.transitions() {
        let source =
            deciders.get(&transition.source).copied().unwrap_or(new_ids[transition.source.0 as usize]);
        let target = new_ids[transition.target.0 as usize];
        let expression = plain_expression(&transition.expression);
        plain.connect(Transition {
            expression,
            internal: transition.internal,
            ..Transition::new(source, target)
        });
    }
    plain
}

fn is_plain_start(transitions: &[&Transition]) -> bool {
    matches!(transitions, [transition] if transition.expression.guard.is_none() && transition.expression.trigger.is_none())
}

fn plain_node(node: &Node, name: &str) -> Node {
    use NodeKind::{And, Basic, DeepHistory, End, Fork, Or, ShallowHistory, Start, Terminate};
    let kind = match node.kind {
        Or | And | Basic | End | Start | ShallowHistory | DeepHistory | Fork => node.kind,
        Terminate => End,
        _ => Basic,
    };
    let name = if matches!(kind, Start | Fork) { "" } else { name };
    let is_state = matches!(kind, Or | And | Basic | End);
    let kept = |actions: &[Action]| -> Vec<Action> {
        actions.iter().filter(|action| is_state && can_say_action(action)).cloned().collect()
    };
    Node { entry: kept(&node.entry), exit: kept(&node.exit), ..Node::new(kind, name) }
}

fn plain_expression(expression: &TransitionExpression) -> TransitionExpression {
    TransitionExpression {
        trigger: expression.trigger.clone(),
        guard: expression.guard.clone().map(|guard| match can_say_guard(&guard) {
            true => guard,
            false => Expression { kind: ExpressionKind::Bool(false), ..guard },
        }),
        actions: expression.actions.iter().filter(|action| can_say_action(action)).cloned().collect(),
    }
}

fn can_say_guard(guard: &Expression) -> bool {
    can_say(TransitionExpression { guard: Some(guard.clone()), ..TransitionExpression::default() })
}

fn can_say_action(action: &Action) -> bool {
    can_say(TransitionExpression { actions: vec![action.clone()], ..TransitionExpression::default() })
}

/// Whether a chart of one state can have this expression on a transition.
fn can_say(expression: TransitionExpression) -> bool {
    let mut chart = Statechart::new("c");
    let start = chart.add(Statechart::ROOT, Node::new(NodeKind::Start, ""));
    let state = chart.add(Statechart::ROOT, Node::new(NodeKind::Basic, "s"));
    chart.connect(Transition::new(start, state));
    chart.connect(Transition { expression, ..Transition::new(state, state) });
    yase_scxml::write(&chart).is_ok()
}

/// A unique name for each node, of letters, digits and underscores.
fn ids(chart: &Statechart) -> Vec<String> {
    let mut seen: BTreeMap<String, ()> = BTreeMap::new();
    let id = |(node, label): (&Node, String)| {
        let encoded = encode(&node.name);
        let mut id: String =
            encoded.chars().map(|letter| if letter.is_ascii_alphanumeric() { letter } else { '_' }).collect();
        if node.kind == NodeKind::End && node.name.is_empty() {
            id.push_str("END");
        } else if id.is_empty() || id.starts_with(|letter: char| letter.is_ascii_digit()) {
            id.insert(0, 's');
        }
        if node.name.is_empty() || seen.contains_key(&id) {
            id = format!("{id}_{}", label.replace('.', "_"));
        }
        while seen.insert(id.clone(), ()).is_some() {
            id.push('_');
        }
        id
    };
    chart.nodes().map(|(_, node)| node).zip(chart.labels()).map(id).collect()
}
