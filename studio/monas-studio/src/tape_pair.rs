//! Two recordings on one timeline.

use serde_json::{Value, json};

use crate::source::{Session, Source};
use crate::tape_run::TapeRun;
use crate::tape_session::TapeSession;

/// A recording, and another one that is shown beside it.
pub(crate) struct TapePair {
    tape: TapeRun,
    other: TapeRun,
    /// Events on the timeline: those of the first tape, and the first difference.
    events: Vec<Value>,
}

impl TapePair {
    pub(crate) fn new(tape: TapeRun, other: TapeRun) -> TapePair {
        let mut events = tape.events().to_vec();
        let until = tape.end_seconds().min(other.end_seconds());
        if let Some(difference) = tape.first_difference(&other, until) {
            let (topic, host) = (&difference.topic, &difference.host);
            let text =
                format!("{topic} number {} by {} of {host}", difference.sequence, difference.publisher);
            let time = |event: &Value| event["t"].as_f64().unwrap_or_default();
            let index = events.partition_point(|event| time(event) < difference.time);
            events.insert(index, json!({"t": difference.time, "kind": "first difference", "text": text}));
        }
        TapePair { tape, other, events }
    }
}

impl Source for TapePair {
    fn open(&self) -> Box<dyn Session> {
        Box::new(TapeSession::beside(self.tape.clone(), self.other.clone(), self.events.clone()))
    }
}
