//! Parameters of activities: texts by key, checked by the code that queries them.

use std::cell::RefCell;
use std::str::FromStr;
use std::time::Duration;

use yase::diagnostic::nearest;

use crate::duration;

/// The parameters of one activity, as given in a configuration or changed while it runs.
///
/// An activity queries the keys it knows. Keys that it did not query are unknown, and values not of
/// the queried form are malformed; [`faults`](Parameters::faults) lists both, so that activities
/// need not check them.
#[derive(Clone, Debug, Default)]
pub struct Parameters {
    values: Vec<(String, String)>,
    accessed_keys: RefCell<Vec<&'static str>>,
    faults: RefCell<Vec<ParameterFault>>,
}

/// A fault of one parameter.
#[derive(Clone, PartialEq, Eq, Debug, thiserror::Error)]
#[error("{message}")]
pub struct ParameterFault {
    /// The key.
    pub key: String,
    /// Whether the key itself is wrong rather than its value.
    pub unknown: bool,
    /// The message, lower case.
    pub message: String,
    /// The nearest key queried by the activity.
    pub nearest: Option<String>,
}

impl Parameters {
    /// No parameters.
    pub fn new() -> Parameters {
        Parameters::default()
    }

    /// Adds a parameter; a later value replaces an earlier one.
    pub fn with(mut self, key: impl Into<String>, value: impl Into<String>) -> Parameters {
        let (key, value) = (key.into(), value.into());
        match self.values.iter_mut().find(|(known, _)| *known == key) {
            Some(parameter) => parameter.1 = value,
            None => self.values.push((key, value)),
        }
        self
    }

    /// Whether there are none.
    pub fn is_empty(&self) -> bool {
        self.values.is_empty()
    }

    /// The same values, without queried keys.
    pub fn without_accesses(&self) -> Parameters {
        self.iter().fold(Parameters::new(), |all, (key, value)| all.with(key, value))
    }

    /// Whether keys and values are equal, in any order.
    pub(crate) fn has_same_values(&self, other: &Parameters) -> bool {
        let has = |all: &Parameters, one: (&str, &str)| all.iter().any(|known| known == one);
        self.values.len() == other.values.len() && self.iter().all(|one| has(other, one))
    }

    /// Keys and values, in the order they were given.
    pub fn iter(&self) -> impl Iterator<Item = (&str, &str)> {
        self.values.iter().map(|(key, value)| (key.as_str(), value.as_str()))
    }

    /// A text.
    pub fn text(&self, key: &'static str) -> Option<&str> {
        self.accessed_keys.borrow_mut().push(key);
        self.values.iter().find(|(known, _)| known == key).map(|(_, value)| value.as_str())
    }

    /// A finite number.
    pub fn number(&self, key: &'static str) -> Option<f64> {
        self.read(key, "a number", |text| f64::from_str(text).ok().filter(|number| number.is_finite()))
    }

    /// A boolean: `1`, `0`, `true` or `false`.
    pub fn flag(&self, key: &'static str) -> Option<bool> {
        self.read(key, "`1`, `0`, `true` or `false`", |text| match text {
            "1" | "true" => Some(true),
            "0" | "false" => Some(false),
            _ => None,
        })
    }

    /// A duration, such as `100ms`.
    pub fn duration(&self, key: &'static str) -> Option<Duration> {
        self.read(key, "a time such as `300s` or `100ms`", |text| duration::parse(text).ok())
    }

    /// The result of `parse`; if it is none, the parameter is faulty and `expected` describes a
    /// valid value.
    pub fn read<T>(
        &self,
        key: &'static str,
        expected: &str,
        parse: impl FnOnce(&str) -> Option<T>,
    ) -> Option<T> {
        let text = self.text(key)?;
        let value = parse(text.trim());
        if value.is_none() {
            self.refuse(key, &format!("is `{text}`, expected {expected}"));
        }
        value
    }

    /// Rejects the value of a key; `reason` continues the sentence that the key begins.
    pub fn refuse(&self, key: &'static str, reason: &str) {
        let message = format!("parameter `{key}` {reason}");
        let fault = ParameterFault { key: key.into(), unknown: false, message, nearest: None };
        self.faults.borrow_mut().push(fault);
    }

    /// Records that `configure` has failed.
    pub(crate) fn fail(&self, message: String) {
        let fault = ParameterFault { key: String::new(), unknown: false, message, nearest: None };
        self.faults.borrow_mut().push(fault);
    }

    /// Faults since construction: rejected values, then keys not queried.
    pub fn faults(&self) -> Vec<ParameterFault> {
        let asked = self.accessed_keys.borrow();
        let unknown = self.values.iter().filter(|(key, _)| !asked.contains(&key.as_str()));
        let unknown = unknown.map(|(key, _)| ParameterFault {
            key: key.clone(),
            unknown: true,
            message: format!("unknown parameter `{key}`"),
            nearest: nearest(key, asked.iter().copied()).map(str::to_owned),
        });
        self.faults.borrow().iter().cloned().chain(unknown).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn correct_usage_is_no_error() {
        let parameters =
            Parameters::new().with("speed", "0.3").with("far", "1").with("name", "x").with("wait", "2s");
        assert_eq!(parameters.number("speed"), Some(0.3));
        assert_eq!(parameters.flag("far"), Some(true));
        assert_eq!(parameters.text("name"), Some("x"));
        assert_eq!(parameters.duration("wait"), Some(Duration::from_secs(2)));
        assert_eq!(parameters.number("absent"), None);
        assert_eq!(parameters.faults(), []);
    }

    #[test]
    fn a_parameter_takes_every_unit_of_durations() {
        let parameters = Parameters::new().with("wait", "1.5h").with("pause", "1.5d");
        assert_eq!(parameters.duration("wait"), Some(Duration::from_secs(5400)));
        assert_eq!(parameters.duration("pause"), None);
        let messages: Vec<String> = parameters.faults().into_iter().map(|fault| fault.message).collect();
        assert_eq!(messages, ["parameter `pause` is `1.5d`, expected a time such as `300s` or `100ms`"]);
    }

    #[test]
    fn malformed_and_unknown_keys_are_faults_together() {
        let parameters = Parameters::new().with("speed", "quick").with("sped", "1");
        assert_eq!(parameters.number("speed"), None);
        let faults = parameters.faults();
        let messages: Vec<&str> = faults.iter().map(|fault| fault.message.as_str()).collect();
        let expected = ["parameter `speed` is `quick`, expected a number", "unknown parameter `sped`"];
        assert_eq!(messages, expected);
        assert_eq!(faults[1].nearest.as_deref(), Some("speed"));
    }

    #[test]
    fn infinite_numbers_are_refused() {
        let parameters = Parameters::new().with("speed", "inf");
        assert_eq!(parameters.number("speed"), None);
        assert_eq!(parameters.faults().len(), 1);
    }

    #[test]
    fn a_later_value_replaces_an_earlier_one() {
        let parameters = Parameters::new().with("speed", "1").with("speed", "2");
        assert_eq!(parameters.iter().collect::<Vec<_>>(), [("speed", "2")]);
    }
}
