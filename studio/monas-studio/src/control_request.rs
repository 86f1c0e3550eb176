//! Requests of a page that change what a run does.

use monas::records::{Action, Change, Setting};
use serde::Deserialize;
use serde_json::{Map, Value};

/// The longest list of settings of a change.
const MAX_SETTINGS: usize = 256;

/// A request that changes a run, or queries data for such a request. A page numbers its requests to
/// match the replies.
#[derive(Clone, PartialEq, Debug)]
pub(crate) enum ControlRequest {
    /// Changes the agents of a host.
    Change { host: String, change: Box<Change> },
    /// Publishes a message, given as JSON, on a topic of a host.
    Publish { host: String, topic: String, message: Value },
    /// The fields of the messages of a topic.
    Form { topic: String },
}

/// A change of an agent, as the subcommands of `monas agent` and `monas chart raise`.
#[derive(Deserialize)]
#[serde(tag = "action", rename_all = "snake_case", deny_unknown_fields)]
enum AgentAction {
    Start {
        chart: Option<String>,
    },
    Stop {
        chart: Option<String>,
    },
    Pause {},
    Resume {},
    Step {},
    Add {
        file: String,
        text: String,
    },
    Remove {},
    AddActivity {
        activity: String,
        parameters: Option<Map<String, Value>>,
        place: Option<u32>,
    },
    RemoveActivity {
        activity: String,
    },
    MoveActivity {
        activity: String,
        place: u32,
    },
    ReplaceActivity {
        activity: String,
        replacement: String,
        parameters: Option<Map<String, Value>>,
    },
    Set {
        settings: Map<String, Value>,
        chart: Option<String>,
    },
    Swap {
        file: String,
        text: Option<String>,
        chart: Option<String>,
        states: Option<Map<String, Value>>,
        lossy: Option<bool>,
        dry_run: Option<bool>,
    },
    Raise {
        event: String,
        chart: Option<String>,
    },
}

impl ControlRequest {
    /// Whether requests of this type are control requests.
    pub(crate) fn is_type(name: &str) -> bool {
        matches!(name, "change" | "publish" | "form")
    }

    /// Parses a control request: its number, and the request.
    ///
    /// # Errors
    /// A message for people.
    pub(crate) fn read(value: Value) -> (Option<u64>, Result<ControlRequest, String>) {
        let Value::Object(mut fields) = value else { return (None, Err("not an object".into())) };
        let id = fields.remove("id").and_then(|id| id.as_u64());
        let request = match id {
            Some(_) => ControlRequest::of(fields),
            None => Err("the request has no number `id`".into()),
        };
        (id, request)
    }

    fn of(mut fields: Map<String, Value>) -> Result<ControlRequest, String> {
        let mut word = |name: &str| match fields.remove(name) {
            Some(Value::String(text)) => Ok(text),
            Some(_) => Err(format!("`{name}` is not a text")),
            None => Err(format!("`{name}` is missing")),
        };
        match word("type")?.as_str() {
            "change" => {
                let (host, agent) = (word("host")?, word("agent")?);
                let action: AgentAction =
                    serde_json::from_value(Value::Object(fields)).map_err(|error| error.to_string())?;
                Ok(ControlRequest::Change { host, change: Box::new(action.change(agent)?) })
            }
            "publish" => {
                let (host, topic) = (word("host")?, word("topic")?);
                let message = fields.remove("message").ok_or("`message` is missing")?;
                nothing_else(&fields)?;
                Ok(ControlRequest::Publish { host, topic, message })
            }
            "form" => {
                let topic = word("topic")?;
                nothing_else(&fields)?;
                Ok(ControlRequest::Form { topic })
            }
            other => Err(format!("`{other}` is not a request")),
        }
    }
}

fn nothing_else(fields: &Map<String, Value>) -> Result<(), String> {
    fields.keys().next().map_or(Ok(()), |name| Err(format!("unknown field `{name}`")))
}

impl AgentAction {
    fn change(self, agent: String) -> Result<Change, String> {
        let is = |action: Action| Change { action: action.into(), agent, ..Change::default() };
        Ok(match self {
            AgentAction::Start { chart } => {
                Change { chart: chart.unwrap_or_default(), ..is(Action::StartAgent) }
            }
            AgentAction::Stop { chart } => {
                Change { chart: chart.unwrap_or_default(), ..is(Action::StopAgent) }
            }
            AgentAction::Pause {} => is(Action::PauseAgent),
            AgentAction::Resume {} => is(Action::ResumeAgent),
            AgentAction::Step {} => is(Action::StepAgent),
            AgentAction::Add { file, text } => Change { file, text, ..is(Action::AddAgents) },
            AgentAction::Remove {} => is(Action::RemoveAgent),
            AgentAction::AddActivity { activity, parameters, place } => {
                let (settings, place) = (settings(parameters)?, place.unwrap_or_default());
                Change { activity, settings, place, ..is(Action::AddActivity) }
            }
            AgentAction::RemoveActivity { activity } => Change { activity, ..is(Action::RemoveActivity) },
            AgentAction::MoveActivity { activity, place } => {
                Change { activity, place, ..is(Action::MoveActivity) }
            }
            AgentAction::ReplaceActivity { activity, replacement, parameters } => {
                let settings = settings(parameters)?;
                Change { activity, replacement, settings, ..is(Action::ReplaceActivity) }
            }
            AgentAction::Set { settings: given, chart } => {
                let chart = chart.unwrap_or_default();
                Change { settings: settings(Some(given))?, chart, ..is(Action::Set) }
            }
            AgentAction::Swap { file, text, chart, states, lossy, dry_run } => Change {
                file,
                text: text.unwrap_or_default(),
                chart: chart.unwrap_or_default(),
                states: settings(states)?,
                accept_losses: lossy.unwrap_or_default(),
                dry_run: dry_run.unwrap_or_default(),
                ..is(Action::SwapModel)
            },
            AgentAction::Raise { event, chart } => {
                Change { event, chart: chart.unwrap_or_default(), ..is(Action::RaiseEvent) }
            }
        })
    }
}

/// Settings, of which each value is a text.
fn settings(given: Option<Map<String, Value>>) -> Result<Vec<Setting>, String> {
    let given = given.unwrap_or_default();
    if given.len() > MAX_SETTINGS {
        return Err(format!("no more than {MAX_SETTINGS} settings"));
    }
    let setting = |(key, value): (String, Value)| match value {
        Value::String(value) => Ok(Setting { key, value }),
        _ => Err(format!("the value of `{key}` is not a text")),
    };
    given.into_iter().map(setting).collect()
}

#[cfg(test)]
mod tests {
    use serde_json::json;

    use super::*;

    fn read(value: Value) -> Result<ControlRequest, String> {
        ControlRequest::read(value).1
    }

    #[test]
    fn changes_are_those_of_the_command_line() {
        let request = json!({"type": "change", "id": 3, "host": "a", "agent": "Mind", "action": "set",
            "settings": {"frequency": "100"}, "chart": "2"});
        let (id, request) = ControlRequest::read(request);
        let setting = Setting { key: "frequency".into(), value: "100".into() };
        let change = Change {
            action: Action::Set.into(),
            agent: "Mind".into(),
            settings: vec![setting],
            chart: "2".into(),
            ..Change::default()
        };
        assert_eq!(
            (id, request),
            (Some(3), Ok(ControlRequest::Change { host: "a".into(), change: Box::new(change) }))
        );
        let of = |action: Value| {
            let mut all = json!({"type": "change", "id": 1, "host": "a", "agent": "b"});
            all.as_object_mut().unwrap().extend(action.as_object().unwrap().clone());
            match read(all) {
                Ok(ControlRequest::Change { change, .. }) => change.action(),
                other => panic!("{other:?}"),
            }
        };
        assert_eq!(of(json!({"action": "pause"})), Action::PauseAgent);
        assert_eq!(of(json!({"action": "step"})), Action::StepAgent);
        assert_eq!(of(json!({"action": "start"})), Action::StartAgent);
        assert_eq!(of(json!({"action": "move_activity", "activity": "x", "place": 2})), Action::MoveActivity);
        assert_eq!(
            of(json!({"action": "swap", "file": "x.srm", "text": "", "lossy": true})),
            Action::SwapModel
        );
        assert_eq!(of(json!({"action": "raise", "event": "go"})), Action::RaiseEvent);
    }

    #[test]
    fn requests_that_are_not_exactly_such_ones_are_refused() {
        let change = |more: Value| {
            let mut all = json!({"type": "change", "id": 1, "host": "a", "agent": "b"});
            all.as_object_mut().unwrap().extend(more.as_object().unwrap().clone());
            read(all).unwrap_err()
        };
        assert!(change(json!({"action": "explode"})).contains("explode"));
        assert!(change(json!({"action": "pause", "chart": "1"})).contains("chart"));
        assert!(change(json!({"action": "set", "settings": {"a": 1}})).contains("`a` is not a text"));
        assert!(change(json!({"action": "step", "number": 7})).contains("number"));
        assert!(change(json!({"action": "move_activity", "activity": "x", "place": -1})).contains("-1"));
        assert!(change(json!({})).contains("action"));
        let many: Map<String, Value> = (0..=MAX_SETTINGS).map(|n| (n.to_string(), "".into())).collect();
        assert!(change(json!({"action": "set", "settings": many})).contains("no more than"));
        let publish = json!({"type": "publish", "id": 1, "host": "a", "topic": "b"});
        assert!(read(publish).unwrap_err().contains("`message`"));
        assert!(read(json!({"type": "form", "topic": "a"})).unwrap_err().contains("`id`"));
        assert!(read(json!({"type": "form", "id": 1, "topic": 2})).unwrap_err().contains("not a text"));
        assert!(read(json!({"type": "form", "id": 1, "topic": "a", "x": 2})).unwrap_err().contains("`x`"));
        assert!(read(json!([])).is_err());
    }
}
