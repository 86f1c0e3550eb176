//! The requests of a page.

use serde_json::Value;

use crate::control_request::ControlRequest;
use crate::model_request::ModelRequest;

/// A request of a page. Only [`Control`](ViewerRequest::Control) changes what a run does, and only
/// [`Model`](ViewerRequest::Model) writes files.
#[derive(Clone, PartialEq, Debug)]
pub(crate) enum ViewerRequest {
    /// The shapes of a chart; of the tape beside, if it is one of that.
    Picture { key: String, is_beside: bool },
    /// Messages of a topic of a host from now on; none of any other.
    Watch { host: String, topic: String },
    /// No messages from now on.
    Unwatch,
    /// Images of the cameras of a host from now on; of none without one.
    Camera(Option<String>),
    /// The values of a chart from now on, by its key; of none without one.
    Values(Option<String>),
    /// Another speed of simulated time, or of what is played.
    Pace(f64),
    /// The present moment of a run.
    Live,
    /// Another moment of a run or a tape, in seconds.
    Seek(f64),
    /// An explanation why a state is active, or was last active, at the moment of a tape.
    Why { key: String, node: u32 },
    /// An explanation why a transition fired, or did not, at the moment of a tape.
    WhyTransition { key: String, transition: u32 },
    /// The next firing of a transition on a tape, or the one before.
    Jump { key: String, transition: u32, is_backward: bool },
    /// The next step of a chart on a tape, or the one before.
    Step { key: String, is_backward: bool },
    /// A change of the run, or why the request for it cannot be read; with the number of the
    /// request.
    Control(Option<u64>, Result<ControlRequest, String>),
    /// A request about models, or why it cannot be read; with its number.
    Model(Option<u64>, Result<ModelRequest, String>),
}

impl ViewerRequest {
    /// Reads a request.
    pub(crate) fn parse(text: &str) -> Option<ViewerRequest> {
        let value: Value = serde_json::from_str(text).ok()?;
        let word = |key: &str| value[key].as_str().map(str::to_owned);
        let number = |key: &str| value[key].as_u64().and_then(|number| number.try_into().ok());
        match value["type"].as_str()? {
            "picture" => {
                Some(ViewerRequest::Picture { key: word("key")?, is_beside: value["beside"] == true })
            }
            "watch" => Some(ViewerRequest::Watch { host: word("host")?, topic: word("topic")? }),
            "live" => Some(ViewerRequest::Live),
            "camera" => Some(ViewerRequest::Camera(word("host"))),
            "values" => Some(ViewerRequest::Values(word("key"))),
            "unwatch" => Some(ViewerRequest::Unwatch),
            // JSON has no infinity
            "pace" if value["factor"].is_null() => Some(ViewerRequest::Pace(f64::INFINITY)),
            "pace" => Some(ViewerRequest::Pace(value["factor"].as_f64().filter(|factor| *factor >= 0.0)?)),
            "why" => Some(ViewerRequest::Why { key: word("key")?, node: number("node")? }),
            "why transition" => {
                Some(ViewerRequest::WhyTransition { key: word("key")?, transition: number("transition")? })
            }
            "jump" => Some(ViewerRequest::Jump {
                key: word("key")?,
                transition: number("transition")?,
                is_backward: value["back"].as_bool()?,
            }),
            "step" => Some(ViewerRequest::Step { key: word("key")?, is_backward: value["back"].as_bool()? }),
            "seek" => Some(ViewerRequest::Seek(value["seconds"].as_f64().filter(|time| *time >= 0.0)?)),
            name if ControlRequest::is_type(name) => {
                let (id, request) = ControlRequest::read(value);
                Some(ViewerRequest::Control(id, request))
            }
            name if ModelRequest::is_type(name) => {
                let (id, request) = ModelRequest::read(value);
                Some(ViewerRequest::Model(id, request))
            }
            _ => None,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn requests_are_read_and_anything_else_is_none() {
        let watch = ViewerRequest::Watch { host: "a".into(), topic: "b/c".into() };
        let parse = ViewerRequest::parse;
        assert_eq!(parse(r#"{"type":"watch","host":"a","topic":"b/c"}"#), Some(watch));
        assert_eq!(parse(r#"{"type":"pace","factor":null}"#), Some(ViewerRequest::Pace(f64::INFINITY)));
        assert_eq!(parse(r#"{"type":"pace","factor":-1}"#), None);
        for wrong in ["", "1", "[]", r#"{"type":"explode","host":"a"}"#, r#"{"type":"watch","host":1}"#] {
            assert_eq!(parse(wrong), None, "{wrong}");
        }
    }
}
