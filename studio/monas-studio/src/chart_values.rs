//! Present values of a run's charts: the guards under consideration, timers and blackboards.

use std::sync::{Arc, Mutex, MutexGuard, PoisonError, Weak};

use serde_json::{Value, json};

use crate::chart_view::{ChartKey, seconds};
use crate::message_decoder::MessageDecoder;

/// The values of a chart, shared by its viewers.
#[derive(Debug)]
pub(crate) struct ChartValues {
    pub(crate) key: ChartKey,
    latest: Mutex<LatestValues>,
}

/// The values that the run sent last.
#[derive(Clone, Default, Debug)]
pub(crate) struct LatestValues {
    /// Counts changes.
    pub(crate) revision: u64,
    pub(crate) values: Arc<Value>,
}

impl ChartValues {
    pub(crate) fn latest(&self) -> LatestValues {
        self.lock().clone()
    }

    fn lock(&self) -> MutexGuard<'_, LatestValues> {
        self.latest.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Stores values if they have changed.
    pub(crate) fn set(&self, values: Value) {
        let mut latest = self.lock();
        if *latest.values != values {
            latest.revision += 1;
            latest.values = Arc::new(values);
        }
    }
}

/// The charts whose values are being viewed.
#[derive(Default, Debug)]
pub(crate) struct WatchedCharts(Mutex<Vec<Weak<ChartValues>>>);

impl WatchedCharts {
    /// Watches a chart while the result is held.
    pub(crate) fn watch(&self, key: ChartKey) -> Arc<ChartValues> {
        let mut charts = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        charts.retain(|chart| chart.strong_count() > 0);
        let known = charts.iter().filter_map(Weak::upgrade).find(|chart| chart.key == key);
        known.unwrap_or_else(|| {
            let chart = Arc::new(ChartValues { key, latest: Mutex::default() });
            charts.push(Arc::downgrade(&chart));
            chart
        })
    }

    /// The charts that are being watched.
    pub(crate) fn all(&self) -> Vec<Arc<ChartValues>> {
        let charts = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        charts.iter().filter_map(Weak::upgrade).collect()
    }
}

/// The topics of the messages in `ChartState.values` of a run.
pub(crate) fn topics(values: &Value) -> impl Iterator<Item = &str> {
    messages(values).filter_map(|message| message["topic"].as_str())
}

fn messages(values: &Value) -> impl Iterator<Item = &Value> {
    let scopes = values["scopes"].as_array().into_iter().flatten();
    scopes.flat_map(|scope| scope["messages"].as_array().into_iter().flatten())
}

/// `ChartState.values` of a run as viewers get it: times in seconds, and messages decoded.
pub(crate) fn shown(key: &ChartKey, values: &Value, decoder: &MessageDecoder) -> Value {
    let time = |value: &Value| value.as_u64().map(seconds);
    let list = |value: &Value, object: &dyn Fn(&Value) -> Value| -> Vec<Value> {
        value.as_array().into_iter().flatten().map(object).collect()
    };
    let message = |message: &Value| {
        let topic = message["topic"].as_str().unwrap_or_default();
        let bytes = bytes(message["bytes"].as_str().unwrap_or_default());
        json!({"topic": topic, "host": message["host"], "publisher": message["publisher"],
            "sequence": message["sequence"], "t": time(&message["published"]),
            "message": decoder.decode(topic, &bytes)})
    };
    let timers = list(
        &values["timers"],
        &|timer| json!({"scope": timer["scope"], "name": timer["name"], "due": time(&timer["deadline"])}),
    );
    let scopes = list(&values["scopes"], &|scope| {
        json!({"scope": scope["scope"], "name": scope["name"], "is_lent": scope["is_lent"],
            "messages": list(&scope["messages"], &message)})
    });
    json!({"key": key.text(), "t": time(&values["time"]), "guards": values["guards"], "timers": timers,
        "scopes": scopes})
}

/// The bytes of a hexadecimal text, up to the first invalid digit.
fn bytes(digits: &str) -> Vec<u8> {
    let pairs = (0..digits.len() / 2).map_while(|index| digits.get(2 * index..2 * index + 2));
    pairs.map_while(|pair| u8::from_str_radix(pair, 16).ok()).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_chart_is_watched_while_a_viewer_holds_it() {
        let watched = WatchedCharts::default();
        let key = |chart| ChartKey { host: "a".into(), agent: "b".into(), chart };
        let (one, same, other) = (watched.watch(key(0)), watched.watch(key(0)), watched.watch(key(1)));
        assert!(Arc::ptr_eq(&one, &same) && watched.all().len() == 2);
        one.set(json!({"time": 1}));
        one.set(json!({"time": 1}));
        assert_eq!((same.latest().revision, other.latest().revision), (1, 0));
        drop((one, same));
        assert_eq!(watched.all().iter().map(|chart| chart.key.chart).collect::<Vec<_>>(), [1]);
    }

    #[test]
    fn bytes_are_read_from_hexadecimal_digits() {
        assert_eq!(bytes("00ff7a"), [0, 255, 122]);
        assert_eq!(bytes("00f"), [0]);
        assert_eq!(bytes("12ä"), [0x12]);
        assert_eq!(bytes("zz12"), [0_u8; 0]);
    }
}
