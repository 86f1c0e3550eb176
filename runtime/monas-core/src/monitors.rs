//! Monitors properties of an agent's chart while it runs.
//!
//! A file of [properties](aseme_verify::properties), which exploration verifies for all runs, is
//! evaluated here for the actual run: each run-to-completion step of the chart is a position.
//! Conditions read the blackboard of the chart's root scope. A violation is logged with the agent,
//! the cycle and the time, and recorded with the cycle
//! ([`Cycle::violations`](crate::records::Cycle)), so that every tape contains it. Optionally the
//! agent then applies its failure policy: `stop-agent` and `safe-state` stop it.
//!
//! A deadline is violated as soon as its time has passed, even if the chart makes no step. A
//! property that begins with `always` is monitored again from the next step on, so that every
//! violation is reported; any other property is decided.

use std::sync::Arc;
use std::time::Duration;

use aseme_verify::properties::{AtomicProposition, Monitor, MonitorVerdict, Property, bind, guards};
use narukom::{Timestamp, TopicSlot};
use yase::expression::{EvalContext, EventId, Guard};
use yase::{
    CompiledChart, Diagnostic, Machine, MicroStepCause, NodeId, Source, Span, TraceRecord, TypeEnvironment,
};

use crate::agent::FailurePolicy;
use crate::records::Violation;

/// Reaction to a violation of a property of an agent's chart, in addition to the log and the record
/// of the cycle.
#[derive(Clone, Copy, PartialEq, Eq, Debug, Default)]
#[non_exhaustive]
pub enum ViolationResponse {
    /// No reaction.
    #[default]
    Log,
    /// Applies the agent's [`FailurePolicy`]. With `restart` and `skip` it
    /// continues.
    Policy,
}

impl ViolationResponse {
    /// Each response with its name in configurations.
    pub const NAMES: [(&'static str, ViolationResponse); 2] =
        [("log", ViolationResponse::Log), ("policy", ViolationResponse::Policy)];
}

/// A set of properties of an agent.
#[derive(Clone, Debug)]
pub struct PropertySet {
    /// The file they were read from; empty if none.
    pub file: String,
    /// The properties.
    pub properties: Vec<Property>,
    /// The reaction to a violation.
    pub on_violation: ViolationResponse,
    /// The text of their spans, if known.
    pub source: Option<Arc<Source>>,
}

/// The monitored properties of one chart.
pub struct Monitors {
    properties: Vec<MonitoredProperty>,
    /// Topics read by conditions, in order.
    topics: Vec<TopicSlot>,
    /// Properties that were violated and not yet reported.
    violated: Vec<usize>,
}

struct MonitoredProperty {
    monitor: Monitor,
    /// By atom: the guard that evaluates the condition.
    guards: Vec<Option<Guard>>,
    acts: bool,
    violated_at: Option<Timestamp>,
}

/// Observations of a step.
#[derive(Default)]
pub(crate) struct StepObservation {
    entered: Vec<NodeId>,
    left: Vec<NodeId>,
    events: Vec<EventId>,
}

impl StepObservation {
    /// Adds a micro-step.
    pub(crate) fn note(&mut self, record: &TraceRecord<'_>) {
        if let MicroStepCause::Event(event) = record.cause {
            self.events.push(event);
        }
        self.entered.extend(record.entries);
        self.left.extend(record.exits);
    }

    pub(crate) fn clear(&mut self) {
        self.entered.clear();
        self.left.clear();
        self.events.clear();
    }
}

impl Monitors {
    /// Prepares properties for monitoring a chart.
    ///
    /// # Errors
    /// Names unknown to the chart or the program, and conditions on messages of other hosts.
    pub(crate) fn new(
        rules: &[PropertySet],
        chart: &CompiledChart,
        vocabulary: &TypeEnvironment,
    ) -> Result<Monitors, Vec<Diagnostic>> {
        let (mut followed, mut found) = (Vec::new(), Vec::new());
        for (rules, property) in rules.iter().flat_map(|it| it.properties.iter().map(move |one| (it, one))) {
            match one(property, chart, vocabulary, rules.on_violation) {
                Ok(one) => followed.push(one),
                Err(wrong) => found.extend(wrong.into_iter().map(|diagnostic| match &rules.source {
                    Some(source) => diagnostic.in_source(source),
                    None => diagnostic,
                })),
            }
        }
        if !found.is_empty() {
            return Err(found);
        }
        let read = followed.iter().flat_map(|one: &MonitoredProperty| one.guards.iter().flatten());
        let mut topics: Vec<TopicSlot> =
            read.flat_map(|guard| guard.reads()).map(|topic| TopicSlot::new(topic.0)).collect();
        topics.sort_unstable();
        topics.dedup();
        let violated = Vec::with_capacity(followed.len());
        Ok(Monitors { properties: followed, topics, violated })
    }

    /// Topics read by conditions.
    pub(crate) fn topics(&self) -> &[TopicSlot] {
        &self.topics
    }

    /// Evaluates a step of the chart.
    pub(crate) fn step(
        &mut self,
        machine: &Machine,
        seen: &StepObservation,
        facts: &impl EvalContext,
        now: Timestamp,
    ) {
        for (index, one) in self.properties.iter_mut().enumerate() {
            let letter = evaluate_step(one, machine, seen, facts);
            let was_open = one.monitor.is_open();
            let verdict = one.monitor.step(letter, now.as_nanos());
            if was_open && matches!(verdict, MonitorVerdict::Violated | MonitorVerdict::Lost) {
                self.violated.push(index);
            }
        }
    }

    /// Whether a deadline has passed.
    pub(crate) fn check_deadlines(&mut self, now: Timestamp) -> bool {
        for (index, one) in self.properties.iter_mut().enumerate() {
            let is_over = one.monitor.deadline().is_some_and(|deadline| deadline < now.as_nanos());
            if is_over && one.monitor.pass(now.as_nanos()) == MonitorVerdict::Violated {
                self.violated.push(index);
            }
        }
        !self.violated.is_empty()
    }

    /// The next deadline at which properties must be evaluated without a step.
    pub(crate) fn due(&self) -> Timestamp {
        let deadlines = self.properties.iter().filter_map(|one| one.monitor.deadline());
        deadlines.min().map_or(Timestamp::MAX, |deadline| Timestamp::from_nanos(deadline.saturating_add(1)))
    }

    /// Takes the violations found since the last call. Does not allocate if there are none.
    pub(crate) fn take_violations(&mut self, now: Timestamp) -> Vec<PropertyViolation> {
        let mut broken = Vec::new();
        for index in self.violated.drain(..) {
            let Some(one) = self.properties.get_mut(index) else { continue };
            let is_lost = one.monitor.verdict() == MonitorVerdict::Lost;
            let property = one.monitor.plan().name().to_owned();
            let earlier = one.violated_at.replace(now);
            let is_repeated = !is_lost && earlier.is_some_and(|earlier| now.since(earlier) < LOG_INTERVAL);
            broken.push(PropertyViolation { property, is_lost, is_repeated, acts: one.acts && !is_lost });
            if !is_lost {
                one.monitor.try_restart();
            }
        }
        broken
    }
}

/// A violated property.
pub struct PropertyViolation {
    pub(crate) property: String,
    /// Set if the property can no longer be monitored.
    is_lost: bool,
    /// Whether it follows another violation of the property within [`LOG_INTERVAL`].
    is_repeated: bool,
    acts: bool,
}

/// A property that is violated again within this time is not logged again.
const LOG_INTERVAL: Duration = Duration::from_secs(1);

impl PropertyViolation {
    /// Its form in records.
    pub fn record(&self) -> Violation {
        Violation { property: self.property.clone(), lost: self.is_lost }
    }

    /// Writes it to the log.
    fn log_violation(&self, robot: &str, agent: &str, cycle: u64, now: Timestamp) {
        let property = &self.property;
        match self.is_lost {
            _ if self.is_repeated => {}
            true => {
                tracing::warn!(%robot, %agent, cycle, %property, "property is no longer monitored at {now}: too many open obligations")
            }
            false => tracing::error!(%robot, %agent, cycle, %property, "property violated at {now}"),
        }
    }
}

/// Logs the violations of a cycle.
///
/// # Errors
/// The reason for which the agent must stop.
pub(crate) fn handle_violations(
    broken: &[PropertyViolation],
    (robot, agent): (&str, &str),
    policy: FailurePolicy,
    cycle: u64,
    now: Timestamp,
) -> Result<(), String> {
    broken.iter().for_each(|one| one.log_violation(robot, agent, cycle, now));
    match broken.iter().find(|one| one.acts) {
        Some(one) if policy.stops_agent() => {
            Err(format!("the property `{}` was violated in cycle {cycle}", one.property))
        }
        _ => Ok(()),
    }
}

fn one(
    property: &Property,
    chart: &CompiledChart,
    vocabulary: &TypeEnvironment,
    on_violation: ViolationResponse,
) -> Result<MonitoredProperty, Vec<Diagnostic>> {
    let plan = bind(property, chart, vocabulary)?.plan;
    let guards = guards(&plan, chart, vocabulary)?;
    let is_foreign =
        |guard: &Guard| guard.sources().iter().any(|it| it.origin != yase::expression::Origin::Own);
    if guards.iter().flatten().any(is_foreign) {
        let message =
            format!("the property `{}` reads the message of a specific host or activity", property.name);
        let wrong = Diagnostic::error("E0325", property.formula.span(), message);
        return Err(vec![wrong.with_hint("a property reads messages of its own host from any publisher")]);
    }
    Ok(MonitoredProperty {
        monitor: Monitor::new(plan),
        guards,
        acts: on_violation == ViolationResponse::Policy,
        violated_at: None,
    })
}

/// Evaluates the atoms of a step. A condition without a value is false.
fn evaluate_step(
    one: &MonitoredProperty,
    machine: &Machine,
    seen: &StepObservation,
    facts: &impl EvalContext,
) -> u64 {
    let atoms = one.monitor.plan().atoms().iter().zip(&one.guards).enumerate();
    atoms.fold(0, |letter, (bit, (atom, guard))| {
        let holds = match (atom, guard) {
            (AtomicProposition::In(node), _) => machine.is_active(*node),
            (AtomicProposition::Entering(node), _) => seen.entered.contains(node),
            (AtomicProposition::Leaving(node), _) => seen.left.contains(node),
            (AtomicProposition::Event(event), _) => seen.events.contains(event),
            (_, Some(guard)) => guard.evaluate(facts).unwrap_or(false),
            (_, None) => false,
        };
        letter | u64::from(holds) << bit
    })
}

/// A diagnostic if the agent does not have exactly one chart.
pub fn needs_one_chart(agent: &str, charts: usize) -> Option<Diagnostic> {
    let message = format!("agent `{agent}` has {charts} statecharts: the properties are ambiguous");
    let hint = match charts {
        0 => "give the properties to an agent with a statechart",
        _ => "put the `monitor` into one `statechart`",
    };
    (charts != 1).then(|| Diagnostic::error("E0324", Span::default(), message).with_hint(hint))
}
