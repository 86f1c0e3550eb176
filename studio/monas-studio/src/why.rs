//! Explanations why a state is active: the transitions that led to it, and the values that their
//! conditions read.

use std::collections::BTreeMap;

use monas::records::{Chart, Model};
use prost::Message;
use serde::Serialize;
use yase::statechart::StateNames;
use yase::{NodeId, ScopeId, Statechart, TransitionId};

use crate::chart_history::RecordedStep;
use crate::chart_view::{ChartKey, seconds};
use crate::read_value::{ReadMoment, ReadValue};
use crate::run_view::MODEL_TOPIC;
use crate::tape_run::{TapeChart, TapeRun};
use crate::transition_explanation::is_connector;

/// A question about a tape.
#[derive(Clone, PartialEq, Debug)]
pub struct WhyQuestion<'a> {
    /// The host.
    pub host: &'a str,
    /// The agent; not needed if only one of the host has charts with the state.
    pub agent: Option<&'a str>,
    /// The state, by its name or the end of it.
    pub state: &'a str,
    /// The moment, in seconds of the run.
    pub seconds: f64,
}

/// Explanation why a state was active at a moment, or when it was last active.
#[derive(Clone, PartialEq, Debug, Serialize)]
pub struct Explanation {
    /// The host of the agent.
    pub host: String,
    /// The agent.
    pub agent: String,
    /// The short name of the state.
    pub state: String,
    /// Whether it was active at the moment.
    pub is_active: bool,
    /// When it was entered, s; none if the tape does not show that.
    pub entered: Option<f64>,
    /// The time of the chart's first step on the tape, s, if there were earlier ones and the tape
    /// shows no entry.
    pub begins: Option<f64>,
    /// When it was left since, s.
    pub left: Option<f64>,
    /// The transitions that led to it, in the order in which they were taken.
    pub segments: Vec<TakenSegment>,
}

/// A transition that was taken.
#[derive(Clone, PartialEq, Debug, Serialize)]
pub struct TakenSegment {
    /// The short name of the node that it left.
    pub source: String,
    /// The short name of the node that it led to.
    pub target: String,
    /// Its expression.
    pub text: String,
    /// The values that its condition read.
    pub reads: Vec<ReadValue>,
}

/// The steps that entered and left a state last, by their places in the history.
struct LastEntry {
    entered: Option<usize>,
    left: Option<usize>,
    /// By node: the step that entered it last, before the state was left.
    by_node: BTreeMap<u32, usize>,
}

impl TapeChart {
    pub(crate) fn key(&self) -> ChartKey {
        ChartKey { host: self.host.clone(), agent: self.agent.clone(), chart: self.chart }
    }
}

impl TapeRun {
    /// Answers a question.
    ///
    /// # Errors
    /// The reason, in lower case: there is no such host, agent or state, or there are several; the
    /// chart was replaced before the moment.
    pub fn explain(&self, question: &WhyQuestion<'_>) -> Result<Explanation, String> {
        let find = |chart: &TapeChart| {
            let found = StateNames::of(&chart.statechart).find(question.state);
            found.map_err(|error| error.to_string())
        };
        let (chart, node) = self.one_chart(question.host, question.agent, find)?;
        let time = (question.seconds * 1e9).max(0.0) as u64;
        let count = self.count_until(time);
        self.check_unreplaced(chart, count)?;
        Ok(self.explain_until(chart, node, count))
    }

    /// Checks that a chart was not replaced among the first `count` messages: the numbers in its
    /// later records are those of another chart. One with as many nodes and transitions is taken
    /// for the same chart with other guards.
    ///
    /// # Errors
    /// When it was replaced.
    pub(crate) fn check_unreplaced(&self, chart: &TapeChart, count: usize) -> Result<(), String> {
        let mut first = None;
        for (entry, channel) in (0..count).filter_map(|index| self.entry(index)) {
            let is_own = channel.topic == MODEL_TOPIC
                && channel.host == chart.host
                && channel.publisher == chart.agent;
            let model = is_own.then(|| Model::decode(self.bytes(entry)).ok()).flatten();
            let Some(model) = model.filter(|model| model.chart == chart.chart) else { continue };
            let first = first.get_or_insert_with(|| model.clone());
            let counts = |model: &Model| (model.nodes.len(), model.transitions.len());
            if counts(first) != counts(&model) {
                let time = seconds(entry.time);
                let agent = &chart.agent;
                return Err(format!(
                    "the chart of `{agent}` was replaced at {time:.3} s: moments before are explained"
                ));
            }
        }
        Ok(())
    }

    /// The only chart of a host, or of one of its agents, that satisfies a condition.
    pub(crate) fn one_chart<T: Copy>(
        &self,
        host: &str,
        agent: Option<&str>,
        find: impl Fn(&TapeChart) -> Result<T, String>,
    ) -> Result<(&TapeChart, T), String> {
        self.check_chart_host(host)?;
        let fits = |chart: &&TapeChart| chart.host == host && agent.is_none_or(|agent| chart.agent == agent);
        let mut unknown = format!("`{host}` has no agent `{}` with a chart", agent.unwrap_or_default());
        let mut found = Vec::new();
        for chart in self.charts().iter().filter(fits) {
            match find(chart) {
                Ok(part) => found.push((chart, part)),
                Err(error) => unknown = format!("{error} in the chart of `{}`", chart.agent),
            }
        }
        match found[..] {
            [one] => Ok(one),
            [] => Err(unknown),
            _ => Err(format!("several agents of `{host}` have it: name the agent")),
        }
    }

    /// Why a state is active after `count` messages, or was so last.
    pub(crate) fn explain_until(&self, chart: &TapeChart, node: NodeId, count: usize) -> Explanation {
        let names = StateNames::of(&chart.statechart);
        let history = self.history(chart);
        let taken = history.until(count);
        let last = LastEntry::of(taken, node);
        let is_shown = |step: &usize| !taken[*step].is_before;
        let time = |step: usize| Some(seconds(self.entry(taken[step].index)?.0.time));
        let entered = last.entered.filter(is_shown);
        let begins = history.steps.first().filter(|first| first.is_before && entered.is_none());
        let mut explanation = Explanation {
            host: chart.host.clone(),
            agent: chart.agent.clone(),
            state: names.name(node).to_owned(),
            is_active: last.entered.is_some() && last.left.is_none(),
            entered: entered.and_then(time),
            begins: begins.map(|first| seconds(first.step.time)),
            left: last.left.and_then(time),
            segments: Vec::new(),
        };
        let Some(entered) = entered else { return explanation };
        // With the composites around it that were entered at the same time, outermost first.
        let statechart = &chart.statechart;
        let mut steps = vec![entered];
        for around in statechart.ancestors(node) {
            let step = last.by_node.get(&around.0).copied().filter(is_shown);
            if let Some(step) =
                step.filter(|step| time(*step) == explanation.entered && !steps.contains(step))
            {
                steps.insert(0, step);
            }
        }
        steps.sort_unstable();
        let scopes = statechart.scopes();
        for number in steps {
            let RecordedStep { index, step: record, .. } = &taken[number];
            for segment in segments_to(statechart, record, node) {
                let transition = statechart.transition(segment);
                let scope = scopes.get(transition.source.0 as usize).copied().unwrap_or(ScopeId::ROOT);
                let guard = transition.expression.guard.as_ref();
                let moment = ReadMoment {
                    chart,
                    scope,
                    count: *index,
                    is_step: true,
                    time: record.time,
                    steps: &taken[..number],
                };
                explanation.segments.push(TakenSegment {
                    source: names.name(transition.source).to_owned(),
                    target: names.name(transition.target).to_owned(),
                    text: transition.expression.to_string(),
                    reads: guard.map(|guard| self.reads(guard, &moment)).unwrap_or_default(),
                });
            }
        }
        explanation
    }
}

impl LastEntry {
    fn of(steps: &[RecordedStep], node: NodeId) -> LastEntry {
        let mut last = LastEntry { entered: None, left: None, by_node: BTreeMap::new() };
        for (number, RecordedStep { step, .. }) in steps.iter().enumerate() {
            if step.exits.contains(&node.0) && last.entered.is_some() && last.left.is_none() {
                last.left = Some(number);
            }
            if step.entries.contains(&node.0) {
                (last.entered, last.left) = (Some(number), None);
            }
            if last.left.is_none() {
                last.by_node.extend(step.entries.iter().map(|entered| (*entered, number)));
            }
        }
        last
    }
}

/// The segments of a step that lead to a node or into a composite around it, in order.
fn segments_to(chart: &Statechart, step: &Chart, node: NodeId) -> Vec<TransitionId> {
    let count = chart.transitions().len();
    let mut left: Vec<u32> = step.selected.iter().chain(&step.taken).copied().collect();
    left.retain(|segment| (*segment as usize) < count);
    let mut into = |target: NodeId| {
        let position =
            left.iter().position(|segment| chart.transition(TransitionId(*segment)).target == target)?;
        Some(TransitionId(left.remove(position)))
    };
    let mut segments = Vec::new();
    let mut next = std::iter::once(node).chain(chart.ancestors(node)).find_map(&mut into);
    while let Some(segment) = next {
        segments.insert(0, segment);
        let source = chart.transition(segment).source;
        next = if is_connector(chart.node(source).kind) { into(source) } else { None };
    }
    segments
}
