//! The names behind numbers in the runtime's records, by the models and topics of the recording.

use std::collections::BTreeMap;

use monas::records::{CHART, CYCLE, MODEL, Model};
use monas::replay::ReplayDifference;
use monas_tape::{Recording, Value};
use narukom::prost::Message as _;

use crate::commands::tape::value_text::plain;

/// The names of one agent on one host.
#[derive(Default)]
pub(crate) struct AgentNames {
    /// The topics that were published, by hash.
    topics: BTreeMap<u64, String>,
    models: Vec<Model>,
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
                names.models.extend(Model::decode(message.bytes));
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
            false => name.map_or_else(|| number.to_string(), short),
        }
    }

    fn name(&self, path: &str, chart: u64, number: u64) -> Option<&str> {
        let field = path.split('[').next().unwrap_or(path);
        if field == "delivered" {
            return path.ends_with(".topic").then(|| self.topics.get(&number)).flatten().map(String::as_str);
        }
        let place = usize::try_from(number).ok()?;
        let model = self.models.iter().find(|model| u64::from(model.chart) == chart)?;
        let name = match field {
            "exits" | "entries" => model.nodes.get(place),
            "selected" | "preempted" | "held" | "taken" => model.transitions.get(place),
            // These count from 1; 0 stands for none.
            "event" => model.events.get(place.checked_sub(1)?),
            "deferred" => model.nodes.get(place.checked_sub(1)?),
            _ => None,
        };
        name.map(String::as_str)
    }
}

/// The name of a node without the path to it, of a transition with those of both ends.
fn short(name: &str) -> String {
    let ends: Vec<&str> = name.split(" -> ").map(short_path).collect();
    ends.join(" -> ")
}

/// The last segment of a path; for a connector also the one before, since several states may have a
/// connector of the same kind.
fn short_path(path: &str) -> &str {
    let last = path.rfind('/').map_or(0, |slash| slash + 1);
    let is_connector = ["START", "END", "CONDITION"].contains(&&path[last..]);
    let outer = path[..last.saturating_sub(1)].rfind('/').map_or(0, |slash| slash + 1);
    &path[if is_connector { outer } else { last }..]
}

#[cfg(test)]
mod tests {
    use super::short;

    #[test]
    fn names_are_short() {
        assert_eq!(short("player/(A.B)/takeAction/kick"), "kick");
        assert_eq!(short("player/(A.B)/kick/START"), "kick/START");
        assert_eq!(short("x/(A|B)/CONDITION -> x/(A|B)/A"), "(A|B)/CONDITION -> A");
        assert_eq!([short("kick"), short("START"), short("topic")], ["kick", "START", "topic"]);
    }
}
