//! Resolution of the names in a property.

use std::sync::Arc;

use yase::diagnostic::{Suggestions, nearest};
use yase::expression::{
    CompiledTrigger, EventId, EventInterner, Expression, ExpressionKind, Guard, Name, NameScope,
    ScriptInterner, TransitionExpression, parse_transition_at,
};
use yase::vocabulary::TopicEntry;
use yase::{CompiledChart, Diagnostic, NodeId, NodeKind, TypeEnvironment};

use super::compiled_property::{AtomicProposition, CompiledProperty, Lowering};
use super::syntax::{Property, PropertyFormula, PropertyFormulaKind};
use aseme::path::{Path, shortest_path};

/// A property with names resolved in a chart.
#[derive(Clone, Debug)]
#[non_exhaustive]
pub struct BoundProperty {
    /// The property to evaluate.
    pub plan: Arc<CompiledProperty>,
    /// Its negation: the property of violating runs.
    pub(crate) negation: CompiledProperty,
}

/// Resolves the states and events of a property in a chart. Names in conditions are resolved by
/// [`guards`].
///
/// # Errors
/// Names that the chart does not have (E0845, E0846), timers in a condition (E0841), and a property
/// that is too large (E0844).
pub fn bind(
    property: &Property,
    chart: &CompiledChart,
    vocabulary: &TypeEnvironment,
) -> Result<BoundProperty, Vec<Diagnostic>> {
    let mut found = Vec::new();
    let is_lasting = matches!(property.formula.kind, PropertyFormulaKind::Always(_));
    let plan = |holds: bool, found: &mut Vec<Diagnostic>| {
        let lookup = |formula: &PropertyFormula| atom(formula, chart, vocabulary, found);
        Lowering::new(&property.name, is_lasting, lookup).finish(&property.formula, holds)
    };
    let made = plan(true, &mut found);
    let negation = plan(false, &mut Vec::new());
    match (made, negation) {
        (Ok(plan), Ok(negation)) if found.is_empty() => Ok(BoundProperty { plan: Arc::new(plan), negation }),
        (Ok(_), Ok(_)) => Err(found),
        (Err(too_large), _) | (_, Err(too_large)) => {
            let message = format!("`{}` has more than {} {}", property.name, too_large.1, too_large.0);
            let wrong = Diagnostic::error("E0844", property.position.0, message);
            found.push(wrong.with_hint("split it into several properties"));
            Err(found)
        }
    }
}

fn atom(
    formula: &PropertyFormula,
    chart: &CompiledChart,
    vocabulary: &TypeEnvironment,
    found: &mut Vec<Diagnostic>,
) -> Option<AtomicProposition> {
    let looked_up = match &formula.kind {
        PropertyFormulaKind::In(name) => state(name, chart).map(AtomicProposition::In),
        PropertyFormulaKind::Entering(name) => state(name, chart).map(AtomicProposition::Entering),
        PropertyFormulaKind::Leaving(name) => state(name, chart).map(AtomicProposition::Leaving),
        PropertyFormulaKind::Event(name) => event(name, chart, vocabulary).map(AtomicProposition::Event),
        PropertyFormulaKind::Condition(condition) => {
            without_timers(condition, chart).map(AtomicProposition::Condition)
        }
        _ => return None,
    };
    looked_up.map_err(|wrong| found.push(wrong)).ok()
}

/// Resolves the path of a state.
pub(crate) fn state(name: &Name, chart: &CompiledChart) -> Result<NodeId, Diagnostic> {
    let span = name.position.0;
    let path = Path::parse(&name.text).map_err(|wrong| Diagnostic { span, ..wrong })?;
    let statechart = chart.statechart();
    let is_state = |id: NodeId| {
        use NodeKind::{And, Basic, End, Or};
        matches!(statechart.node(id).kind, And | Basic | End | Or)
    };
    let states: Vec<NodeId> = statechart.nodes().map(|(id, _)| id).filter(|&id| is_state(id)).collect();
    let fitting: Vec<NodeId> = states.iter().copied().filter(|&id| path.matches(statechart, id)).collect();
    match fitting.as_slice() {
        [one] => Ok(*one),
        [] => {
            if let Some(named) = chart.names().find(&name.text).ok().filter(|&node| is_state(node)) {
                return Ok(named);
            }
            let message = format!("the chart `{}` has no state `{}`", statechart.name, name.text);
            let names =
                states.iter().map(|&id| statechart.node(id).name.as_str()).filter(|it| !it.is_empty());
            let last = name.text.rsplit('/').next().unwrap_or_default();
            let wrong = Diagnostic::error("E0845", span, message);
            Err(match nearest(last, names) {
                Some(near) => wrong.with_hint(format!("did you mean `{near}`?")),
                None => wrong.with_hint("a state is named by a path of names from its formulas"),
            })
        }
        several => {
            let message = format!("{} states are called `{}`", several.len(), name.text);
            let paths: Vec<String> =
                several.iter().take(3).map(|&id| format!("`{}`", shortest_path(statechart, id))).collect();
            let wrong = Diagnostic::error("E0845", span, message);
            Err(wrong.with_hint(format!("say which: {}", paths.join(", "))))
        }
    }
}

/// Resolves an event, spelled as a trigger spells it: a name (`kick`), or a message whose arrival
/// the chart awaits (`receiver.ready.Signal.Ready`).
pub(crate) fn event(
    name: &Name,
    chart: &CompiledChart,
    vocabulary: &TypeEnvironment,
) -> Result<EventId, Diagnostic> {
    let events = chart.events();
    if let Some(event) = events.find(&name.text).or_else(|| awaited(name, chart, vocabulary)) {
        return Ok(event);
    }
    let message = format!("the chart `{}` has no event `{}`", chart.statechart().name, name.text);
    let wrong = Diagnostic::error("E0846", name.position.0, message);
    let spelled = |event: EventId| spelling(event, chart, vocabulary);
    let known: Vec<String> = events.ids().map(spelled).collect();
    Err(match nearest(&name.text, known.iter().map(String::as_str)) {
        Some(near) => wrong.with_hint(format!("did you mean `{near}`?")),
        None => wrong.with_hint("the events of a chart are those that its triggers and actions name"),
    })
}

/// The event of the chart that a trigger with this text denotes.
fn awaited(name: &Name, chart: &CompiledChart, vocabulary: &TypeEnvironment) -> Option<EventId> {
    let (expression, wrong) = parse_transition_at(&name.text, name.position.0.start);
    if wrong.iter().any(Diagnostic::is_error) {
        return None;
    }
    let mut events = chart.events().clone();
    let trigger = TransitionExpression { trigger: expression.trigger, ..TransitionExpression::default() };
    let compiled = trigger.compile(&mut NameScope {
        vocabulary,
        constants: &chart.statechart().constants,
        timers: &[],
        events: &mut events,
        scripts: &mut ScriptInterner::new(),
        states: &|_| None,
        suggestions: &Suggestions::default(),
    });
    match compiled.ok()?.trigger? {
        CompiledTrigger::OneOf(ids) if ids.len() == 1 => {
            ids.first().copied().filter(|id| (id.0 as usize) < chart.events().len())
        }
        _ => None,
    }
}

/// The form in which a trigger names an event.
fn spelling(event: EventId, chart: &CompiledChart, vocabulary: &TypeEnvironment) -> String {
    let events = chart.events();
    let topic = events.topic(event).and_then(|id| vocabulary.topics.iter().find(|topic| topic.id == id));
    let Some(topic) = topic else { return events.name(event).to_owned() };
    let last = topic.path.rsplit('/').next().unwrap_or(&topic.path);
    let is_alone = |it: &&TopicEntry| it.path.rsplit('/').next() == Some(last);
    let name = match vocabulary.topics.iter().filter(is_alone).nth(1) {
        None => last.to_owned(),
        Some(_) => format!("`{}`", topic.path.replace('/', ".")),
    };
    let host = events.host(event).map_or(String::new(), |host| format!("{host}."));
    format!("{host}{name}.{:?}.{}", topic.kind, topic.message)
}

/// Rejects timers of the chart in a condition: exploration and monitors would evaluate them
/// differently.
fn without_timers(condition: &Expression, chart: &CompiledChart) -> Result<Expression, Diagnostic> {
    let timer = condition.find_map(&mut |part| match &part.kind {
        ExpressionKind::Variable(path) => {
            path.bare().filter(|name| chart.timers().any(|(_, it)| it == *name))
        }
        _ => None,
    });
    match timer {
        None => Ok(condition.clone()),
        Some(timer) => {
            let message =
                format!("`{timer}` is a timer of the chart and cannot occur in the condition of a property");
            let wrong = Diagnostic::error("E0841", condition.span(), message);
            Err(wrong.with_hint("use `within` after `eventually` or `until`"))
        }
    }
}

/// The compiled conditions of a property in the order of its atoms; `None` for other atoms.
///
/// # Errors
/// The errors of a guard with such a condition.
pub fn guards(
    plan: &CompiledProperty,
    chart: &CompiledChart,
    vocabulary: &TypeEnvironment,
) -> Result<Vec<Option<Guard>>, Vec<Diagnostic>> {
    let (mut guards, mut found) = (Vec::new(), Vec::new());
    for atom in plan.atoms() {
        let AtomicProposition::Condition(condition) = atom else {
            guards.push(None);
            continue;
        };
        let expression = TransitionExpression { guard: Some(condition.clone()), ..Default::default() };
        let compiled = expression.compile(&mut NameScope {
            vocabulary,
            constants: &chart.statechart().constants,
            timers: &[],
            events: &mut EventInterner::new(),
            scripts: &mut ScriptInterner::new(),
            states: &|_| None,
            suggestions: &Suggestions::default(),
        });
        match compiled {
            Ok(compiled) => guards.push(compiled.guard),
            Err(wrong) => found.extend(wrong),
        }
    }
    if found.is_empty() { Ok(guards) } else { Err(found) }
}
