//! Properties of an agent's chart, followed while it runs.
//!
//! A file of [properties](aseme::properties) that exploration decides beforehand is followed here along the one run that happens: each run-to-completion step of
//! the chart is a position. What conditions ask is read on the blackboard of the chart's root. A property that is violated is said in the log, with the agent, the
//! cycle and the time, and stands in the record of the cycle ([`Cycle::violations`](crate::records::Cycle)), so that it is on every tape. If the agent is to,
//! it does then what it does when an activity fails: `stop-agent` and `safe-state` stop it.
//!
//! What has to come within a bound is missed as soon as the time is over, whether or not the chart makes a step then. A property that begins with `always` is followed
//! anew from the next step on, so that each violation is told; any other has been decided.

use std::sync::Arc;

use aseme::properties::{Atom, Monitor, Property, Verdict, bind, guards};
use narukom::{Moment, TopicSlot};
use yase::expression::{EventId, Facts, Guard};
use yase::{Chart, Diagnostic, Machine, NodeId, Occasion, Source, Span, TraceRecord, Vocabulary};

use crate::agent::Policy;
use crate::records::Violation;

/// What happens when a property of an agent's chart is violated, beside that it is said in the log and in the record of the cycle.
#[derive(Clone, Copy, PartialEq, Eq, Debug, Default)]
#[non_exhaustive]
pub enum OnViolation {
    /// Nothing.
    #[default]
    Log,
    /// What happens when an activity of the agent fails: [`Policy`](crate::Policy). `restart` and `skip` go on.
    Policy,
}

impl OnViolation {
    /// Each with its name in configurations.
    pub const NAMES: [(&'static str, OnViolation); 2] =
        [("log", OnViolation::Log), ("policy", OnViolation::Policy)];
}

/// Properties that an agent is to keep to.
#[derive(Clone, Debug)]
pub(crate) struct Rules {
    /// The file they were read from; empty if from none.
    pub(crate) file: String,
    pub(crate) properties: Vec<Property>,
    pub(crate) on_violation: OnViolation,
    /// The text that their places are in, if it is known.
    pub(crate) source: Option<Arc<Source>>,
}

/// The properties of one chart.
pub(crate) struct Monitors {
    followed: Vec<Followed>,
    /// What conditions read, in order.
    topics: Vec<TopicSlot>,
    /// The properties that were violated and of which nobody has been told.
    violated: Vec<usize>,
}

struct Followed {
    monitor: Monitor,
    /// By atom: how a condition is read.
    guards: Vec<Option<Guard>>,
    acts: bool,
}

/// What has happened in a step.
#[derive(Default)]
pub(crate) struct Seen {
    entered: Vec<NodeId>,
    left: Vec<NodeId>,
    events: Vec<EventId>,
}

impl Seen {
    /// Takes note of a micro-step.
    pub(crate) fn note(&mut self, record: &TraceRecord<'_>) {
        if let Occasion::Event(event) = record.occasion {
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
    /// Makes properties ready to be followed along a chart.
    ///
    /// # Errors
    /// Names that the chart or the program does not have, and conditions on what other hosts publish.
    pub(crate) fn new(
        rules: &[Rules],
        chart: &Chart,
        vocabulary: &Vocabulary,
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
        let read = followed.iter().flat_map(|one: &Followed| one.guards.iter().flatten());
        let mut topics: Vec<TopicSlot> =
            read.flat_map(|guard| guard.reads()).map(|topic| TopicSlot::new(topic.0)).collect();
        topics.sort_unstable();
        topics.dedup();
        let violated = Vec::with_capacity(followed.len());
        Ok(Monitors { followed, topics, violated })
    }

    /// The topics that conditions read.
    pub(crate) fn topics(&self) -> &[TopicSlot] {
        &self.topics
    }

    /// The chart has made a step.
    pub(crate) fn step(&mut self, machine: &Machine, seen: &Seen, facts: &impl Facts, now: Moment) {
        for (place, one) in self.followed.iter_mut().enumerate() {
            let letter = letter(one, machine, seen, facts);
            let was_open = one.monitor.is_open();
            let verdict = one.monitor.step(letter, now.as_nanos());
            if was_open && matches!(verdict, Verdict::Violated | Verdict::Lost) {
                self.violated.push(place);
            }
        }
    }

    /// Whether time has gone by that something had to come in.
    pub(crate) fn lapse(&mut self, now: Moment) -> bool {
        for (place, one) in self.followed.iter_mut().enumerate() {
            let is_over = one.monitor.deadline().is_some_and(|deadline| deadline < now.as_nanos());
            if is_over && one.monitor.pass(now.as_nanos()) == Verdict::Violated {
                self.violated.push(place);
            }
        }
        !self.violated.is_empty()
    }

    /// When something has to be looked at again, though the chart makes no step.
    pub(crate) fn due(&self) -> Moment {
        let deadlines = self.followed.iter().filter_map(|one| one.monitor.deadline());
        deadlines.min().map_or(Moment::MAX, |deadline| Moment::from_nanos(deadline.saturating_add(1)))
    }

    /// The properties that were found violated since it was last asked. Takes no memory if there are none.
    pub(crate) fn broken(&mut self) -> Vec<Broken> {
        let mut broken = Vec::new();
        for place in self.violated.drain(..) {
            let Some(one) = self.followed.get_mut(place) else { continue };
            let is_lost = one.monitor.verdict() == Verdict::Lost;
            let property = one.monitor.plan().name().to_owned();
            broken.push(Broken { property, is_lost, acts: one.acts && !is_lost });
            if !is_lost {
                one.monitor.begin_anew();
            }
        }
        broken
    }
}

/// A property that was found violated.
pub(crate) struct Broken {
    pub(crate) property: String,
    /// Nothing is known of it any more.
    is_lost: bool,
    acts: bool,
}

impl Broken {
    /// As records have it.
    pub(crate) fn record(&self) -> Violation {
        Violation { property: self.property.clone(), lost: self.is_lost }
    }

    /// Says it in the log.
    fn say(&self, robot: &str, agent: &str, cycle: u64, now: Moment) {
        let property = &self.property;
        match self.is_lost {
            true => {
                tracing::warn!(%robot, %agent, cycle, %property, "property is followed no more at {now}: too much of it is open")
            }
            false => tracing::error!(%robot, %agent, cycle, %property, "property violated at {now}"),
        }
    }
}

/// Says in the log what was violated in a cycle.
///
/// # Errors
/// Why the agent is to stop.
pub(crate) fn answer(
    broken: &[Broken],
    (robot, agent): (&str, &str),
    policy: Policy,
    cycle: u64,
    now: Moment,
) -> Result<(), String> {
    broken.iter().for_each(|one| one.say(robot, agent, cycle, now));
    match (broken.iter().find(|one| one.acts), policy) {
        (Some(one), Policy::StopAgent | Policy::SafeState) => {
            Err(format!("the property `{}` was violated in cycle {cycle}", one.property))
        }
        _ => Ok(()),
    }
}

fn one(
    property: &Property,
    chart: &Chart,
    vocabulary: &Vocabulary,
    on_violation: OnViolation,
) -> Result<Followed, Vec<Diagnostic>> {
    let plan = bind(property, chart)?.plan;
    let guards = guards(&plan, chart, vocabulary)?;
    let is_foreign =
        |guard: &Guard| guard.sources().iter().any(|it| it.origin != yase::expression::Origin::Own);
    if guards.iter().flatten().any(is_foreign) {
        let message =
            format!("the property `{}` reads what a certain host or activity publishes", property.name);
        let wrong = Diagnostic::error("E0325", property.formula.span(), message);
        return Err(vec![
            wrong.with_hint("a property reads messages of its own host, whoever publishes them"),
        ]);
    }
    Ok(Followed { monitor: Monitor::new(plan), guards, acts: on_violation == OnViolation::Policy })
}

/// What is true of a step. A condition without a value does not hold.
fn letter(one: &Followed, machine: &Machine, seen: &Seen, facts: &impl Facts) -> u64 {
    let atoms = one.monitor.plan().atoms().iter().zip(&one.guards).enumerate();
    atoms.fold(0, |letter, (bit, (atom, guard))| {
        let holds = match (atom, guard) {
            (Atom::In(node), _) => machine.is_active(*node),
            (Atom::Entering(node), _) => seen.entered.contains(node),
            (Atom::Leaving(node), _) => seen.left.contains(node),
            (Atom::Event(event), _) => seen.events.contains(event),
            (_, Some(guard)) => guard.evaluate(facts).unwrap_or(false),
            (_, None) => false,
        };
        letter | u64::from(holds) << bit
    })
}

/// What keeps an agent from having monitors: they are of its one chart.
pub(crate) fn needs_one_chart(agent: &str, charts: usize) -> Option<Diagnostic> {
    let message =
        format!("agent `{agent}` has {charts} statecharts: nobody knows whose properties these are");
    let hint = match charts {
        0 => "give the properties to an agent with a statechart",
        _ => "put the `monitor` into the `statechart` that is to keep to it",
    };
    (charts != 1).then(|| Diagnostic::error("E0324", Span::default(), message).with_hint(hint))
}
