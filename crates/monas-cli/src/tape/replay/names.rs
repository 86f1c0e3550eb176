//! What numbers in the records of the runtime stand for, by what hosts and charts said of themselves.

use monas::records::{CHART, CYCLE, HOST, Host, MODEL, Model};
use monas::replay::Difference;
use monas_tape::{Recording, Value};
use narukom::prost::Message as _;

/// The names on one host, of one agent.
#[derive(Default)]
pub(super) struct Names {
    topics: Vec<String>,
    models: Vec<Model>,
}

impl Names {
    /// The names that a difference is to be told in.
    pub(super) fn of(recording: &Recording, difference: &Difference) -> Names {
        let mut names = Names::default();
        if ![CHART.path(), CYCLE.path()].contains(&&*difference.topic) {
            return names;
        }
        for message in recording.messages().into_iter().flatten().map_while(Result::ok) {
            let channel = &message.channel;
            if channel.host != difference.host || channel.received_by.is_some() {
                continue;
            }
            if channel.topic == HOST.path() {
                names.topics = Host::decode(message.bytes).map(|host| host.topics).unwrap_or_default();
            } else if channel.topic == MODEL.path() && channel.publisher == difference.agent {
                names.models.extend(Model::decode(message.bytes));
            }
        }
        names
    }

    /// A value as it is told: the name that a number stands for, if it stands for one.
    pub(super) fn told(&self, path: &str, chart: u64, value: &Value) -> String {
        let Value::Uint(number) = value else { return super::super::text::plain(value) };
        let name = self.name(path, chart, *number);
        match path.ends_with(".topic") {
            true => name.map_or_else(|| number.to_string(), str::to_owned),
            false => name.map_or_else(|| number.to_string(), short),
        }
    }

    fn name(&self, path: &str, chart: u64, number: u64) -> Option<&str> {
        let field = path.split('[').next().unwrap_or(path);
        let place = usize::try_from(number).ok()?;
        if field == "delivered" {
            return path.ends_with(".topic").then(|| self.topics.get(place)).flatten().map(String::as_str);
        }
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

/// The last segment of a path; of a connector also the one before, since every state may have such a one.
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
