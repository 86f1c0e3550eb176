//! Explanations why a transition fired at a moment, or did not.

use monas::records::Model;
use prost::Message;
use serde::Serialize;
use yase::expression::{Path, Trigger};
use yase::statechart::StateNames;
use yase::{NodeId, NodeKind, ScopeId, Statechart, TransitionId};

use crate::chart_history::{ChartHistory, RecordedStep};
use crate::chart_view::seconds;
use crate::guard_atom::GuardAtom;
use crate::message_chain::{ChainFinder, MessageChain};
use crate::read_value::ReadMoment;
use crate::run_view::MODEL_TOPIC;
use crate::tape_run::{TapeChart, TapeRun};

/// A question about a transition.
#[derive(Clone, PartialEq, Debug)]
pub struct TransitionQuestion<'a> {
    /// The host.
    pub host: &'a str,
    /// The agent; not needed if only one of the host has a chart with the transition.
    pub agent: Option<&'a str>,
    /// The transition: its number, or `A -> B` with the ends of the names of its nodes.
    pub transition: &'a str,
    /// The moment, in seconds of the run.
    pub seconds: f64,
}

/// The outcome for a transition when its source was last exited, or so far.
#[derive(Clone, Copy, PartialEq, Eq, Debug, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Verdict {
    /// It fired.
    Fired,
    /// Another one fired instead.
    Instead,
    /// Its source is active, and it has not fired.
    Waits,
    /// Its source was not active before.
    NotReached,
}

/// Explanation why a transition fired at a moment, or did not.
#[derive(Clone, PartialEq, Debug, Serialize)]
pub struct TransitionExplanation {
    /// The host of the agent.
    pub host: String,
    /// The agent.
    pub agent: String,
    /// The number of the transition in its chart.
    pub number: u32,
    /// The short name of the node that it leaves.
    pub source: String,
    /// The short name of the node to which it leads.
    pub target: String,
    /// Its expression.
    pub text: String,
    /// The result.
    pub verdict: Verdict,
    /// The outcome in words.
    pub reason: String,
    /// The time of the values, s; none if its source was not active before.
    pub judged: Option<f64>,
    /// When it fired last, s.
    pub fired: Option<f64>,
    /// When it fires next, s.
    pub next: Option<f64>,
    /// Its triggers.
    pub triggers: Vec<TriggerArrival>,
    /// Whether its guard held; none without a guard, and if that is unknown.
    pub guard: Option<bool>,
    /// The parts of its guard.
    pub atoms: Vec<GuardAtom>,
    /// The transitions that fired instead.
    pub instead: Vec<String>,
    /// The activity of its source for which it had to wait.
    pub held_by: Option<String>,
    /// The messages behind the values, back to sensors.
    pub chains: Vec<MessageChain>,
}

/// An event that triggers a transition.
#[derive(Clone, PartialEq, Debug, Serialize)]
pub struct TriggerArrival {
    /// As it is written.
    pub text: String,
    /// When it was dispatched, or a message of it was published, last; s.
    pub arrived: Option<f64>,
}

impl TapeRun {
    /// Answers a question about a transition.
    ///
    /// # Errors
    /// The reason, in lower case: there is no such host, agent or transition, or there are several.
    pub fn explain_transition(
        &self,
        question: &TransitionQuestion<'_>,
    ) -> Result<TransitionExplanation, String> {
        let (chart, transition) = self.transition(question.host, question.agent, question.transition)?;
        let time = (question.seconds * 1e9).max(0.0) as u64;
        let count = self.count_until(time);
        self.check_unreplaced(chart, count)?;
        self.explain_transition_until(chart, transition, count, time)
            .ok_or_else(|| format!("there is no transition {}", transition.0))
    }

    /// The only transition with a name or number in the charts of a host.
    ///
    /// # Errors
    /// As of [`explain_transition`](Self::explain_transition).
    pub fn transition(
        &self,
        host: &str,
        agent: Option<&str>,
        name: &str,
    ) -> Result<(&TapeChart, TransitionId), String> {
        self.one_chart(host, agent, |chart| find(&chart.statechart, name))
    }

    /// Why a transition fired, or did not, among the first `count` messages; none if the chart has
    /// no such transition.
    pub(crate) fn explain_transition_until(
        &self,
        chart: &TapeChart,
        id: TransitionId,
        count: usize,
        time: u64,
    ) -> Option<TransitionExplanation> {
        let statechart = &chart.statechart;
        if id.0 as usize >= statechart.transitions().len() {
            return None;
        }
        let (names, transition) = (StateNames::of(statechart), statechart.transition(id));
        let history = self.history(chart);
        let steps = history.until(count);
        let (verdict, decided) = verdict(statechart, steps, id);
        let scopes = statechart.scopes();
        let moment = ReadMoment {
            chart,
            scope: scopes.get(transition.source.0 as usize).copied().unwrap_or(ScopeId::ROOT),
            count: decided.map_or(count, |step| steps[step].index),
            is_step: decided.is_some(),
            time: decided.map_or(time, |step| steps[step].step.time),
            steps: &steps[..decided.unwrap_or(steps.len())],
        };
        let guard = transition.expression.guard.as_ref().filter(|_| verdict != Verdict::NotReached);
        let atoms = guard.map(|guard| self.atoms(guard, &moment)).unwrap_or_default();
        let name = |segment: TransitionId| {
            let other = statechart.transition(segment);
            format!("{} -> {}", names.name(other.source), names.name(other.target))
        };
        let others = decided.filter(|_| verdict == Verdict::Instead);
        let others = others.map(|step| instead(statechart, &steps[step], id)).unwrap_or_default();
        let time_of = |step: Option<&RecordedStep>| step.map(|step| seconds(step.step.time));
        let mut explanation = TransitionExplanation {
            host: chart.host.clone(),
            agent: chart.agent.clone(),
            number: id.0,
            source: names.name(transition.source).to_owned(),
            target: names.name(transition.target).to_owned(),
            text: transition.expression.to_string(),
            verdict,
            reason: String::new(),
            judged: (verdict != Verdict::NotReached).then(|| seconds(moment.time)),
            fired: time_of(steps.iter().rfind(|step| step.has_fired(id))),
            next: time_of(history.since(count).iter().find(|step| step.has_fired(id))),
            triggers: self.arrivals(chart, transition.expression.trigger.as_ref(), steps, count),
            guard: guard.and_then(|guard| self.truth(guard, &moment)),
            chains: self.chains(&atoms),
            atoms,
            instead: others.into_iter().map(name).collect(),
            held_by: held_by(statechart, steps, id, verdict),
        };
        let was_preempted = decided.is_some_and(|step| steps[step].step.preempted.contains(&id.0));
        explanation.reason = reason(&explanation, guard.is_some(), was_preempted);
        Some(explanation)
    }

    /// The chain of each message that atoms read.
    fn chains(&self, atoms: &[GuardAtom]) -> Vec<MessageChain> {
        let mut messages: Vec<usize> =
            atoms.iter().flat_map(|atom| &atom.reads).filter_map(|read| read.message).collect();
        messages.sort_unstable();
        messages.dedup();
        let mut finder = ChainFinder::new(self);
        messages.into_iter().map(|message| finder.chain(message)).collect()
    }

    fn arrivals(
        &self,
        chart: &TapeChart,
        trigger: Option<&Trigger>,
        steps: &[RecordedStep],
        count: usize,
    ) -> Vec<TriggerArrival> {
        let paths: &[Path] = match trigger {
            None => &[],
            Some(Trigger::Any) => {
                let last = steps.iter().rev().find(|step| step.step.event > 0);
                let arrived = last.map(|step| seconds(step.step.time));
                return vec![TriggerArrival { text: "*".into(), arrived }];
            }
            Some(Trigger::Not(path)) => std::slice::from_ref(path),
            Some(Trigger::OneOf(paths)) => paths,
        };
        let events = self.events_of(chart);
        let arrival = |path: &Path| {
            let text = path.text();
            let event = events.iter().position(|event| *event == text);
            let dispatched =
                event.and_then(|event| steps.iter().rev().find(|step| step.step.event as usize == event + 1));
            let last_name = path.segments.last().map_or("", |name| name.text.as_str());
            let published = || {
                (0..count).rev().find_map(|index| {
                    let (entry, channel) = self.entry(index)?;
                    let is_it = channel.host == chart.host
                        && (channel.topic == text
                            || channel.topic.rsplit('/').next() == Some(last_name)
                            || channel.message_type.rsplit('.').next() == Some(last_name));
                    is_it.then(|| seconds(entry.time))
                })
            };
            let arrived = dispatched.map(|step| seconds(step.step.time)).or_else(published);
            TriggerArrival { text, arrived }
        };
        paths.iter().map(arrival).collect()
    }

    /// The names of a chart's events.
    fn events_of(&self, chart: &TapeChart) -> Vec<String> {
        let models = (0..self.len()).rev().find_map(|index| {
            let (entry, channel) = self.entry(index)?;
            let is_own = channel.topic == MODEL_TOPIC
                && channel.host == chart.host
                && channel.publisher == chart.agent;
            let model = is_own.then(|| Model::decode(self.bytes(entry)).ok()).flatten()?;
            (model.chart == chart.chart).then_some(model.events)
        });
        models.unwrap_or_default()
    }
}

/// The result for a transition, and the step that decided it; without a step it is undecided.
fn verdict(chart: &Statechart, steps: &[RecordedStep], id: TransitionId) -> (Verdict, Option<usize>) {
    let source = chart.transition(id).source;
    let fired = steps.iter().rposition(|step| step.has_fired(id));
    let is_last = |step: usize| steps.last().is_some_and(|last| last.step.time == steps[step].step.time);
    if let Some(step) = fired.filter(|step| is_last(*step)) {
        return (Verdict::Fired, Some(step));
    }
    if ChartHistory::is_active(steps, source) {
        return (Verdict::Waits, None);
    }
    let passed = |step: &RecordedStep| {
        step.step.exits.contains(&source.0) || segments_of(chart, step, source).next().is_some()
    };
    match steps.iter().rposition(passed) {
        Some(step) if fired == Some(step) => (Verdict::Fired, Some(step)),
        Some(step) => (Verdict::Instead, Some(step)),
        None => (Verdict::NotReached, None),
    }
}

/// The segments that left a node in a step.
fn segments_of<'a>(
    chart: &'a Statechart,
    step: &'a RecordedStep,
    source: NodeId,
) -> impl Iterator<Item = TransitionId> + 'a {
    let count = chart.transitions().len();
    step.fired()
        .filter(move |segment| (segment.0 as usize) < count && chart.transition(*segment).source == source)
}

/// The segments that fired instead of another: of its source, or else of a composite around it.
fn instead(chart: &Statechart, step: &RecordedStep, id: TransitionId) -> Vec<TransitionId> {
    let source = chart.transition(id).source;
    let around = std::iter::once(source).chain(chart.ancestors(source));
    let of = |node| segments_of(chart, step, node).collect::<Vec<_>>();
    around.map(of).find(|found| !found.is_empty()).unwrap_or_default()
}

/// The activity for which a transition that waits was held in the latest step that says so.
fn held_by(chart: &Statechart, steps: &[RecordedStep], id: TransitionId, verdict: Verdict) -> Option<String> {
    let source = chart.transition(id).source;
    let entered = steps.iter().rposition(|step| step.step.entries.contains(&source.0))?;
    let held = steps[entered..].iter().any(|step| step.step.held.contains(&id.0));
    let is_waiting = verdict == Verdict::Waits;
    let inside = chart.nodes().filter(|(node, _)| {
        *node == source
            || (chart.ancestors(*node).any(|around| around == source)
                && ChartHistory::is_active(steps, *node))
    });
    let activities: Vec<&str> = inside.filter_map(|(_, node)| node.activity.as_deref()).collect();
    (held && is_waiting && !activities.is_empty()).then(|| activities.join(", "))
}

fn reason(why: &TransitionExplanation, has_guard: bool, was_preempted: bool) -> String {
    let failed = |value: Option<bool>| {
        let texts = why.atoms.iter().filter(|atom| atom.value == value);
        texts.map(|atom| format!("`{}`", atom.text)).collect::<Vec<_>>().join(", ")
    };
    let guard = match why.guard {
        Some(false) => format!("its guard was false: {} did not hold", failed(Some(false))),
        None if has_guard => format!("its guard was unknown: {} has no value", failed(None)),
        _ => String::new(),
    };
    match why.verdict {
        Verdict::Fired => "it fired".to_owned(),
        Verdict::NotReached => format!("{} was not active before", why.source),
        Verdict::Instead => {
            let others = match why.instead.is_empty() {
                true => format!("{} was left without it", why.source),
                false => format!("instead of it fired {}", why.instead.join(", ")),
            };
            let how = if was_preempted { ", which pre-empted it" } else { "" };
            match guard.is_empty() {
                true => format!("{others}{how}"),
                false => format!("{others}{how}; {guard}"),
            }
        }
        Verdict::Waits if !guard.is_empty() => guard,
        Verdict::Waits => match (&why.held_by, &why.triggers[..]) {
            (Some(activity), _) => format!("it is held until the activity {activity} has returned"),
            (None, []) => format!("the activity of {} has not returned", why.source),
            (None, triggers) => {
                let texts: Vec<&str> = triggers.iter().map(|trigger| trigger.text.as_str()).collect();
                format!("it waits for `{}`", texts.join("` or `"))
            }
        },
    }
}

/// The transition that a text names.
fn find(chart: &Statechart, text: &str) -> Result<TransitionId, String> {
    let names = StateNames::of(chart);
    let count = chart.transitions().len();
    if let Ok(number) = text.trim_start_matches('#').parse::<u32>() {
        return match (number as usize) < count {
            true => Ok(TransitionId(number)),
            false => Err(format!("there is no transition {number}; the last is {}", count.saturating_sub(1))),
        };
    }
    let Some((source, target)) = text.split_once("->").map(|(source, target)| (source.trim(), target.trim()))
    else {
        return Err(format!("`{text}` is neither `A -> B` nor the number of a transition"));
    };
    let fits = |node: NodeId, text: &str| {
        let name = names.name(node);
        name == text || name.strip_suffix(text).is_some_and(|before| before.ends_with('/'))
    };
    let found: Vec<TransitionId> = chart
        .transitions()
        .filter(|(_, transition)| fits(transition.source, source) && fits(transition.target, target))
        .map(|(id, _)| id)
        .collect();
    match found[..] {
        [one] => Ok(one),
        [] => Err(format!("there is no transition `{text}`")),
        _ => {
            let all: Vec<String> = found
                .iter()
                .map(|id| {
                    let transition = chart.transition(*id);
                    format!(
                        "{} ({} -> {})",
                        id.0,
                        names.name(transition.source),
                        names.name(transition.target)
                    )
                })
                .collect();
            Err(format!("several transitions are named `{text}`: {}", all.join(", ")))
        }
    }
}

/// Whether a node is passed through in a step.
pub(crate) fn is_connector(kind: NodeKind) -> bool {
    !matches!(kind, NodeKind::Basic | NodeKind::Or | NodeKind::And)
}
