//! The names behind numbers in the runtime's records, by the models and topics of the recording.

use std::collections::BTreeMap;

use monas::records::{CHART, CYCLE, MODEL, Model};
use monas::replay::ReplayDifference;
use monas_tape::{Recording, Value};
use narukom::prost::Message as _;
use yase::StateNames;

use crate::commands::tape::value_text::plain;

/// The names of one agent on one host.
#[derive(Default)]
pub(crate) struct AgentNames {
    /// The topics that were published, by hash.
    topics: BTreeMap<u64, String>,
    models: Vec<(Model, StateNames)>,
}

impl AgentNames {
    /// The names that a difference refers to.
    pub(crate) fn of(recording: &Recording, difference: &ReplayDifference) -> AgentNames {
        let mut names = AgentNames::default();
        if ![CHART.path(), CYCLE.path()].contains(&&*difference.topic) {
            return names;
        }
        for message in recording.messages().into_iter().flatten().map_while(Result::ok) {
            let channel = &message.channel;
            let topic = names.topics.entry(narukom::topic_hash(&channel.topic));
            topic.or_insert_with(|| channel.topic.clone());
            if channel.host != difference.host || channel.received_by.is_some() {
                continue;
            }
            if channel.topic == MODEL.path() && channel.publisher == difference.agent {
                let model = Model::decode(message.bytes);
                names.models.extend(model.map(|model| {
                    let short = StateNames::from_paths(model.nodes.iter().map(String::as_str));
                    (model, short)
                }));
            }
        }
        names
    }

    /// A value as text: the name behind a number, if there is one.
    pub(crate) fn value_text(&self, path: &str, chart: u64, value: &Value) -> String {
        let Value::Uint(number) = value else { return plain(value) };
        let name = self.name(path, chart, *number);
        match path.ends_with(".topic") {
            true => name.map_or_else(|| number.to_string(), str::to_owned),
            false => name.map_or_else(|| number.to_string(), |name| self.short(chart, name)),
        }
    }

    fn name(&self, path: &str, chart: u64, number: u64) -> Option<&str> {
        let field = path.split('[').next().unwrap_or(path);
        if field == "delivered" {
            return path.ends_with(".topic").then(|| self.topics.get(&number)).flatten().map(String::as_str);
        }
        let index = usize::try_from(number).ok()?;
        let (model, _) = self.models.iter().find(|(model, _)| u64::from(model.chart) == chart)?;
        let name = match field {
            "exits" | "entries" => model.nodes.get(index),
            "selected" | "preempted" | "held" | "taken" => model.transitions.get(index),
            // These count from 1; 0 stands for none.
            "event" => model.events.get(index.checked_sub(1)?),
            "deferred" => model.nodes.get(index.checked_sub(1)?),
            _ => None,
        };
        name.map(String::as_str)
    }

    /// The short name of a state, or of a transition by those of both ends.
    fn short(&self, chart: u64, name: &str) -> String {
        let found = self.models.iter().find(|(model, _)| u64::from(model.chart) == chart);
        found.map_or_else(|| name.to_owned(), |(_, names)| names.short_transition(name))
    }
}
