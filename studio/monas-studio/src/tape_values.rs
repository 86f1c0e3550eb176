//! Values of a chart at a moment of a tape: guards, timers and blackboards.

use std::collections::{BTreeMap, BTreeSet};

use monas::records::Delivery;
use narukom::topic_hash;
use serde_json::{Value, json};
use yase::{NodeId, ScopeId, StateNames, Transition};

use crate::chart_view::seconds;
use crate::read_value::ReadMoment;
use crate::tape_run::{TapeChart, TapeRun};

/// The number of cycles of an agent before a moment whose deliveries are searched.
const SEARCHED_CYCLES: usize = 1000;

impl TapeRun {
    /// The values of a chart after `count` messages, as a run sends those of the present moment;
    /// `active` are its active nodes.
    pub(crate) fn values_until(
        &self,
        chart: &TapeChart,
        active: &BTreeSet<u32>,
        count: usize,
        time: u64,
    ) -> Value {
        let (statechart, scopes) = (&chart.statechart, chart.statechart.scopes());
        let history = self.history(chart);
        let steps = history.until(count);
        let moment = |scope| ReadMoment { chart, scope, count, is_step: false, time, steps };
        let (mut guards, mut timers) = (Vec::new(), BTreeMap::new());
        let is_active = |node: NodeId| active.contains(&node.0);
        let considered =
            |(_, transition): &(_, &Transition)| statechart.is_considered(transition.source, is_active);
        for (id, transition) in statechart.transitions().filter(considered) {
            let scope = scopes.get(transition.source.0 as usize).copied().unwrap_or(ScopeId::ROOT);
            let Some(guard) = &transition.expression.guard else { continue };
            let moment = moment(scope);
            guards.push(json!({"transition": id.0, "scope": scope.0, "holds": self.truth(guard, &moment)}));
            let reads = self.reads(guard, &moment).into_iter().filter(|read| read.is_timer);
            timers.extend(reads.map(|read| ((scope.0, read.name), read.due)));
        }
        let timers = timers
            .into_iter()
            .map(|((scope, name), due)| json!({"scope": scope, "name": name, "due": due}))
            .collect::<Vec<_>>();
        let scopes = self.blackboards(&scopes, &moment(ScopeId::ROOT));
        json!({"key": chart.key().text(), "t": seconds(time), "guards": guards, "timers": timers,
            "scopes": scopes})
    }

    /// The newest message of each topic on each blackboard of a chart.
    fn blackboards(&self, scopes: &[ScopeId], moment: &ReadMoment<'_>) -> Vec<Value> {
        let topics: BTreeMap<u64, &str> = self
            .channels()
            .iter()
            .map(|channel| (topic_hash(&channel.topic), channel.topic.as_str()))
            .collect();
        let mut newest: BTreeMap<(u32, u64, String, String), Delivery> = BTreeMap::new();
        for delivery in self.cycles(moment).take(SEARCHED_CYCLES).flat_map(|cycle| cycle.delivered) {
            let Delivery { region, topic, host, publisher, .. } = delivery.clone();
            newest.entry((region, topic, host, publisher)).or_insert(delivery);
        }
        let mut messages: BTreeMap<u32, Vec<Value>> = BTreeMap::new();
        for ((region, topic, ..), delivery) in newest {
            let Some(topic) = topics.get(&topic) else { continue };
            let found = self.message(&moment.chart.host, topic, &delivery, moment);
            let Some((entry, channel)) = found.and_then(|index| self.entry(index)) else { continue };
            let content = self.decoder().decode(topic, self.bytes(entry));
            messages.entry(region).or_default().push(json!({"topic": topic, "host": channel.host,
                "publisher": channel.publisher, "sequence": entry.sequence, "t": seconds(entry.time),
                "message": content}));
        }
        let names = StateNames::of(&moment.chart.statechart);
        let first = |scope: u32| scopes.iter().position(|it| it.0 == scope).map(|node| NodeId(node as u32));
        let scopes = messages.into_iter().map(|(scope, messages)| {
            let name = first(scope).map(|node| names.name(node)).unwrap_or_default();
            json!({"scope": scope, "name": name, "is_lent": false, "messages": messages})
        });
        scopes.collect()
    }
}
