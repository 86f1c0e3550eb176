//! The values that a condition reads, from the blackboard of its scope at that moment.

use monas::records::{Cycle, Delivery};
use narukom::topic_hash;
use prost::Message;
use serde::Serialize;
use serde_json::Value;
use yase::expression::{Action, ActionKind, ConstantValue, Expression, ExpressionKind, Path};
use yase::{NodeId, ScopeId, Statechart};

use crate::chart_history::RecordedStep;
use crate::chart_view::seconds;
use crate::run_view::CYCLE_TOPIC;
use crate::tape_run::{TapeChart, TapeRun};

/// A field, a constant or a timer in a condition.
#[derive(Clone, PartialEq, Default, Debug, Serialize)]
pub struct ReadValue {
    /// The name as written.
    pub name: String,
    /// Its value; null if no message had been delivered. That of a timer is whether it has expired;
    /// null if it was never started.
    pub value: Value,
    /// The topic, if it is a field.
    pub topic: Option<String>,
    /// The host of the publisher, if it is a field.
    pub host: Option<String>,
    /// The publisher of the message.
    pub publisher: Option<String>,
    /// The number of the message among those of its publisher.
    pub sequence: Option<u64>,
    /// When it was published, s.
    pub published: Option<f64>,
    /// When the timer expires, s, if it is one.
    pub due: Option<f64>,
    /// Whether it is a timer.
    pub is_timer: bool,
    /// The index of the message on the tape.
    #[serde(skip)]
    pub(crate) message: Option<usize>,
}

/// A chart at one moment.
#[derive(Clone, Copy)]
pub(crate) struct ReadMoment<'a> {
    pub(crate) chart: &'a TapeChart,
    /// The scope whose blackboard is read.
    pub(crate) scope: ScopeId,
    /// The number of messages on the tape before the moment.
    pub(crate) count: usize,
    /// Whether a step begins at this moment, whose cycle is recorded at its end.
    pub(crate) is_step: bool,
    /// Nanoseconds.
    pub(crate) time: u64,
    /// The steps before.
    pub(crate) steps: &'a [RecordedStep],
}

impl TapeRun {
    /// The values that a condition reads at a moment.
    pub(crate) fn reads(&self, condition: &Expression, moment: &ReadMoment<'_>) -> Vec<ReadValue> {
        let mut paths: Vec<&Path> = Vec::new();
        condition.find_map::<()>(&mut |part| {
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
            reads.extend(self.read(path, moment).filter(|read| !reads.contains(read)));
        }
        reads
    }

    /// The value of a name; none for a value of an enumeration, and for a function.
    pub(crate) fn read(&self, path: &Path, moment: &ReadMoment<'_>) -> Option<ReadValue> {
        constant(&moment.chart.statechart, path)
            .or_else(|| timer(path, moment))
            .or_else(|| self.field(path, moment))
    }

    /// The field that a path names: a message type, then fields, after a publisher or a host if one
    /// is given. None if no segment is a message type of the host's topics.
    fn field(&self, path: &Path, moment: &ReadMoment<'_>) -> Option<ReadValue> {
        let chart = moment.chart;
        let segments: Vec<&str> = path.segments.iter().map(|name| name.text.as_str()).collect();
        let (index, topic) = segments.iter().enumerate().find_map(|(index, name)| {
            let of_type = self.channels().iter().find(|channel| {
                channel.host == chart.host && channel.message_type.rsplit('.').next() == Some(name)
            });
            Some((index, of_type?.topic.clone()))
        })?;
        let message = self.delivered(&topic, &segments[..index], moment);
        let mut value = match message {
            Some(index) => {
                self.entry(index).map(|(entry, _)| self.decoder().decode(&topic, self.bytes(entry)))
            }
            None => None,
        };
        for field in &segments[index + 1..] {
            value = value.and_then(|value| value.get(*field).cloned());
        }
        let found = message.and_then(|index| self.entry(index));
        Some(ReadValue {
            name: path.text(),
            value: value.unwrap_or(Value::Null),
            topic: Some(topic),
            host: found.map(|(_, channel)| channel.host.clone()),
            publisher: found.map(|(_, channel)| channel.publisher.clone()),
            sequence: found.map(|(entry, _)| entry.sequence.into()),
            published: found.map(|(entry, _)| seconds(entry.time)),
            message,
            ..ReadValue::default()
        })
    }

    /// The message of a topic that a scope's blackboard had at a moment, or else the chart's own;
    /// of any publisher of the host, or of those that are named.
    fn delivered(&self, topic: &str, named: &[&str], moment: &ReadMoment<'_>) -> Option<usize> {
        let (hash, mut around) = (topic_hash(topic), None);
        let is_named = |delivery: &Delivery| {
            [&delivery.host, &delivery.publisher]
                .iter()
                .all(|origin| origin.is_empty() || named.contains(&origin.as_str()))
        };
        for cycle in self.cycles(moment) {
            let fitting = cycle.delivered.iter().filter(|delivery| delivery.topic == hash);
            for delivery in fitting.filter(|delivery| is_named(delivery)) {
                if delivery.region == moment.scope.0 {
                    return self.message(&moment.chart.host, topic, delivery, moment);
                }
                if around.is_none() && delivery.region == ScopeId::ROOT.0 {
                    around = Some(delivery.clone());
                }
            }
        }
        self.message(&moment.chart.host, topic, &around?, moment)
    }

    /// The cycles of the chart's agent up to a moment, the latest first.
    pub(crate) fn cycles<'a>(&'a self, moment: &ReadMoment<'a>) -> impl Iterator<Item = Cycle> + use<'a> {
        let TapeChart { host, agent, .. } = moment.chart;
        let is_cycle = move |index: &usize| {
            self.entry(*index).is_some_and(|(_, channel)| {
                channel.topic == CYCLE_TOPIC && channel.host == *host && channel.publisher == *agent
            })
        };
        // If the tape is held between a step and the cycle that it belongs to, this cycle counts.
        let (time, is_step) = (moment.time, moment.is_step);
        let is_near =
            move |index: &usize| is_step || self.entry(*index).is_some_and(|(entry, _)| entry.time <= time);
        let own = (moment.count..self.len()).take_while(is_near).find(is_cycle);
        let indices = own.into_iter().chain((0..moment.count).rev().filter(is_cycle));
        indices.filter_map(|index| Cycle::decode(self.bytes(self.entry(index)?.0)).ok())
    }

    /// The message of a delivery to a host.
    pub(crate) fn message(
        &self,
        host: &str,
        topic: &str,
        delivery: &Delivery,
        moment: &ReadMoment<'_>,
    ) -> Option<usize> {
        let host = if delivery.host.is_empty() { host } else { &delivery.host };
        let at_once = (moment.count..self.len())
            .take_while(|index| self.entry(*index).is_some_and(|(entry, _)| entry.time <= moment.time));
        let mut near = (0..moment.count).rev().chain(at_once);
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

fn constant(chart: &Statechart, path: &Path) -> Option<ReadValue> {
    let constant = chart.constants.iter().find(|constant| Some(constant.name.as_str()) == path.bare())?;
    let value = match &constant.value {
        ConstantValue::Bool(value) => Value::from(*value),
        ConstantValue::Number(value) => Value::from(*value),
        ConstantValue::Text(value) => Value::from(value.as_str()),
    };
    Some(ReadValue { name: path.text(), value, ..ReadValue::default() })
}

/// A timer that an action of the chart starts.
fn timer(path: &Path, moment: &ReadMoment<'_>) -> Option<ReadValue> {
    let (name, chart) = (path.text(), &moment.chart.statechart);
    let scopes = chart.scopes();
    // Blackboards have timers of their own.
    let is_own = |node: NodeId| scopes.get(node.0 as usize) == Some(&moment.scope);
    let delay = |actions: &[Action]| {
        actions.iter().rev().find_map(|action| match &action.kind {
            ActionKind::StartTimeout { timer, delay, .. } if timer.text() == name => Some(*delay),
            _ => None,
        })
    };
    let of_segments = chart
        .transitions()
        .any(|(_, transition)| is_own(transition.source) && delay(&transition.expression.actions).is_some());
    let is_timer = of_segments
        || chart
            .nodes()
            .any(|(id, node)| is_own(id) && (delay(&node.entry).is_some() || delay(&node.exit).is_some()));
    if !is_timer {
        return None;
    }
    let count = chart.transitions().len();
    let started = moment.steps.iter().rev().find_map(|recorded| {
        let fired = recorded.fired().filter(|segment| (segment.0 as usize) < count);
        let of_segments = fired.map(|segment| chart.transition(segment));
        let mut delays = of_segments.filter(|segment| is_own(segment.source));
        let of_segment = delays.find_map(|segment| delay(&segment.expression.actions));
        let of_nodes = |nodes: &[u32], is_entry: bool| {
            let known = nodes.iter().map(|node| NodeId(*node)).filter(|node| is_own(*node));
            known
                .map(|node| chart.node(node))
                .find_map(|node| delay(if is_entry { &node.entry } else { &node.exit }))
        };
        let found = of_nodes(&recorded.step.entries, true)
            .or(of_segment)
            .or_else(|| of_nodes(&recorded.step.exits, false))?;
        Some(recorded.step.time.saturating_add(u64::try_from(found.as_nanos()).unwrap_or(u64::MAX)))
    });
    Some(ReadValue {
        name,
        value: started.map_or(Value::Null, |due| Value::from(due <= moment.time)),
        due: started.map(seconds),
        is_timer: true,
        ..ReadValue::default()
    })
}
