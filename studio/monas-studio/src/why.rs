//! Why a state is active: the transitions that led to it, and what their conditions read.

use std::collections::BTreeMap;

use monas::records::{Chart, Cycle, Delivery};
use narukom::topic_hash;
use prost::Message;
use serde::Serialize;
use serde_json::Value;
use yase::expression::{ConstantValue, Expression, ExpressionKind, Path};
use yase::statechart::StateNames;
use yase::{NodeId, NodeKind, ScopeId, Statechart, TransitionId};

use crate::chart_view::{ChartKey, seconds};
use crate::run_view::CHART;
use crate::tape_run::{TapeChart, TapeRun};

const CYCLE: &str = "monas/cycle";

/// What is asked of a tape.
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

/// Why a state was active at a moment, or was so last.
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
    /// When it was entered, s; none if it was not entered before.
    pub entered: Option<f64>,
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
    /// What its condition read.
    pub reads: Vec<ReadValue>,
}

/// A field, a constant or a timer in a condition.
#[derive(Clone, PartialEq, Debug, Serialize)]
pub struct ReadValue {
    /// As it is written.
    pub name: String,
    /// Its value; null if no message had been delivered, or if it is no field and no constant.
    pub value: Value,
    /// The topic, if it is a field.
    pub topic: Option<String>,
    /// The publisher of the message.
    pub publisher: Option<String>,
    /// The number of the message among those of its publisher.
    pub sequence: Option<u64>,
    /// When it was published, s.
    pub published: Option<f64>,
}

/// The steps that entered and left a state last.
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
    /// The reason, in lower case: there is no such host, agent or state, or there are several.
    pub fn explain(&self, question: &WhyQuestion<'_>) -> Result<Explanation, String> {
        let WhyQuestion { host, agent, state, seconds } = question;
        let of_host: Vec<&TapeChart> = self.charts().iter().filter(|chart| chart.host == *host).collect();
        if of_host.is_empty() {
            let mut hosts: Vec<&str> = self.charts().iter().map(|chart| chart.host.as_str()).collect();
            hosts.dedup();
            return Err(format!("no host with charts is named `{host}`; there are `{}`", hosts.join("`, `")));
        }
        let fits = |chart: &&&TapeChart| agent.is_none_or(|agent| chart.agent == agent);
        let mut unknown = format!("`{host}` has no agent `{}` with a chart", agent.unwrap_or_default());
        let mut found = Vec::new();
        for chart in of_host.iter().filter(fits) {
            match StateNames::of(&chart.statechart).find(state) {
                Ok(node) => found.push((*chart, node)),
                Err(error) => unknown = format!("{error} in the chart of `{}`", chart.agent),
            }
        }
        match found[..] {
            [(chart, node)] => {
                let time = (seconds * 1e9).max(0.0) as u64;
                Ok(self.explain_until(chart, node, self.count_until(time)))
            }
            [] => Err(unknown),
            _ => Err(format!("several agents of `{host}` have a state `{state}`: name the agent")),
        }
    }

    /// Why a state is active after `count` messages, or was so last.
    pub(crate) fn explain_until(&self, chart: &TapeChart, node: NodeId, count: usize) -> Explanation {
        let names = StateNames::of(&chart.statechart);
        let last = self.last_entry(chart, node, count);
        let time = |index: Option<usize>| Some(seconds(self.entry(index?)?.0.time));
        let mut explanation = Explanation {
            host: chart.host.clone(),
            agent: chart.agent.clone(),
            state: names.name(node).to_owned(),
            is_active: last.entered.is_some() && last.left.is_none(),
            entered: time(last.entered),
            left: time(last.left),
            segments: Vec::new(),
        };
        let Some(entered) = last.entered else { return explanation };
        // With the composites around it that were entered at the same time, outermost first.
        let statechart = &chart.statechart;
        let mut steps = vec![entered];
        for around in statechart.ancestors(node) {
            let step = last.by_node.get(&around.0).copied();
            if let Some(step) =
                step.filter(|step| time(Some(*step)) == explanation.entered && !steps.contains(step))
            {
                steps.insert(0, step);
            }
        }
        steps.sort_unstable();
        let scopes = statechart.scopes();
        for step in steps {
            let Some(record) = self.step_at(step) else { continue };
            for segment in way_to(statechart, &record, node) {
                let transition = statechart.transition(segment);
                let scope = scopes.get(transition.source.0 as usize).copied().unwrap_or(ScopeId::ROOT);
                let guard = transition.expression.guard.as_ref();
                explanation.segments.push(TakenSegment {
                    source: names.name(transition.source).to_owned(),
                    target: names.name(transition.target).to_owned(),
                    text: transition.expression.to_string(),
                    reads: guard.map(|guard| self.reads(chart, guard, scope, step)).unwrap_or_default(),
                });
            }
        }
        explanation
    }

    fn step_at(&self, index: usize) -> Option<Chart> {
        let (entry, _) = self.entry(index)?;
        Chart::decode(self.bytes(entry)).ok()
    }

    /// The records of a chart's steps, by their positions.
    fn last_entry(&self, chart: &TapeChart, node: NodeId, count: usize) -> LastEntry {
        let mut last = LastEntry { entered: None, left: None, by_node: BTreeMap::new() };
        for index in 0..count {
            let is_step = self.entry(index).is_some_and(|(_, channel)| {
                channel.topic == CHART && channel.host == chart.host && channel.publisher == chart.agent
            });
            let step = self.step_at(index).filter(|step| is_step && step.chart == chart.chart);
            let Some(step) = step else { continue };
            if step.exits.contains(&node.0) && last.entered.is_some() && last.left.is_none() {
                last.left = Some(index);
            }
            if step.entries.contains(&node.0) {
                (last.entered, last.left) = (Some(index), None);
            }
            if last.left.is_none() {
                last.by_node.extend(step.entries.iter().map(|entered| (*entered, index)));
            }
        }
        last
    }

    /// What a condition read in a step, as its scope's blackboard had it.
    fn reads(&self, chart: &TapeChart, guard: &Expression, scope: ScopeId, step: usize) -> Vec<ReadValue> {
        let mut paths: Vec<&Path> = Vec::new();
        guard.find_map::<()>(&mut |part| {
            match &part.kind {
                ExpressionKind::Variable(path)
                | ExpressionKind::Absent(path)
                | ExpressionKind::Present(path)
                | ExpressionKind::TimeoutCheck(path) => paths.push(path),
                _ => {}
            }
            None
        });
        let mut reads: Vec<ReadValue> = Vec::new();
        for path in paths {
            let read =
                self.constant(&chart.statechart, path).or_else(|| self.field(chart, path, scope, step));
            reads.extend(read.filter(|read| !reads.contains(read)));
        }
        reads
    }

    fn constant(&self, chart: &Statechart, path: &Path) -> Option<ReadValue> {
        let constant = chart.constants.iter().find(|constant| Some(constant.name.as_str()) == path.bare())?;
        let value = match &constant.value {
            ConstantValue::Bool(value) => Value::from(*value),
            ConstantValue::Number(value) => Value::from(*value),
            ConstantValue::Text(value) => Value::from(value.as_str()),
        };
        Some(ReadValue {
            name: path.text(),
            value,
            topic: None,
            publisher: None,
            sequence: None,
            published: None,
        })
    }

    /// The field that a path names: a message type, then fields, after a publisher or a host if one
    /// is given. None if no segment is a message type of the host's topics.
    fn field(&self, chart: &TapeChart, path: &Path, scope: ScopeId, step: usize) -> Option<ReadValue> {
        let segments: Vec<&str> = path.segments.iter().map(|name| name.text.as_str()).collect();
        let (place, topic) = segments.iter().enumerate().find_map(|(place, name)| {
            let of_type = self.channels().iter().find(|channel| {
                channel.host == chart.host && channel.message_type.rsplit('.').next() == Some(name)
            });
            Some((place, of_type?.topic.clone()))
        })?;
        let delivery = self.delivery(chart, &topic, scope, step);
        let message = delivery.and_then(|delivery| self.message(chart, &topic, &delivery, step));
        let mut value = match message {
            Some(index) => {
                self.entry(index).map(|(entry, _)| self.decoder().decode(&topic, self.bytes(entry)))
            }
            None => None,
        };
        for field in &segments[place + 1..] {
            value = value.and_then(|value| value.get(*field).cloned());
        }
        let found = message.and_then(|index| self.entry(index));
        Some(ReadValue {
            name: path.text(),
            value: value.unwrap_or(Value::Null),
            topic: Some(topic),
            publisher: found.map(|(_, channel)| channel.publisher.clone()),
            sequence: found.map(|(entry, _)| entry.sequence.into()),
            published: found.map(|(entry, _)| seconds(entry.time)),
        })
    }

    /// The last delivery of a topic to a scope, or else to the chart's own, before a step. The
    /// cycle of a step is recorded at its end.
    fn delivery(&self, chart: &TapeChart, topic: &str, scope: ScopeId, step: usize) -> Option<Delivery> {
        let hash = topic_hash(topic);
        let is_cycle = |index: &usize| {
            self.entry(*index).is_some_and(|(_, channel)| {
                channel.topic == CYCLE && channel.host == chart.host && channel.publisher == chart.agent
            })
        };
        let own = (step..self.len()).find(is_cycle);
        let cycles = own.into_iter().chain((0..step).rev().filter(is_cycle));
        let mut around = None;
        for index in cycles {
            let (entry, _) = self.entry(index)?;
            let Ok(cycle) = Cycle::decode(self.bytes(entry)) else { continue };
            let of_topic = cycle.delivered.into_iter().filter(|delivery| delivery.topic == hash);
            for delivery in of_topic {
                if delivery.region == scope.0 {
                    return Some(delivery);
                }
                around = around.or(Some(delivery).filter(|delivery| delivery.region == ScopeId::ROOT.0));
            }
        }
        around
    }

    /// The message of a delivery.
    fn message(&self, chart: &TapeChart, topic: &str, delivery: &Delivery, step: usize) -> Option<usize> {
        let host = if delivery.host.is_empty() { &chart.host } else { &delivery.host };
        let own = (step + 1..self.len()).take_while(|index| {
            let time = |index: usize| self.entry(index).map(|(entry, _)| entry.time);
            time(*index) == time(step)
        });
        let mut near = (0..=step).rev().chain(own);
        near.find(|index| {
            self.entry(*index).is_some_and(|(entry, channel)| {
                channel.topic == topic
                    && channel.host == *host
                    && u64::from(entry.sequence) == delivery.sequence & u64::from(u32::MAX)
                    && (delivery.publisher.is_empty() || delivery.publisher == channel.publisher)
            })
        })
    }
}

/// The segments of a step that lead to a node or into a composite around it, in order.
fn way_to(chart: &Statechart, step: &Chart, node: NodeId) -> Vec<TransitionId> {
    let count = chart.transitions().len();
    let mut left: Vec<u32> = step.selected.iter().chain(&step.taken).copied().collect();
    left.retain(|segment| (*segment as usize) < count);
    let mut into = |target: NodeId| {
        let place =
            left.iter().position(|segment| chart.transition(TransitionId(*segment)).target == target)?;
        Some(TransitionId(left.remove(place)))
    };
    let mut way = Vec::new();
    let mut next = std::iter::once(node).chain(chart.ancestors(node)).find_map(&mut into);
    while let Some(segment) = next {
        way.insert(0, segment);
        let source = chart.transition(segment).source;
        let is_connector = !matches!(chart.node(source).kind, NodeKind::Basic | NodeKind::Or | NodeKind::And);
        next = if is_connector { into(source) } else { None };
    }
    way
}
