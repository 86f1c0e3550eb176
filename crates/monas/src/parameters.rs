//! Parameters of activities: text by key, checked by who asks for them.

use std::cell::RefCell;
use std::str::FromStr;
use std::time::Duration;

use yase::diagnostic::nearest;

/// The parameters of one activity, as given in a configuration or changed while it runs.
///
/// An activity asks for the keys it knows. What it did not ask for is unknown, and what is not of the form it asked for
/// is malformed; [`faults`](Parameters::faults) lists both, so that no activity has to.
#[derive(Clone, Debug, Default)]
pub struct Parameters {
    values: Vec<(String, String)>,
    asked: RefCell<Vec<&'static str>>,
    faults: RefCell<Vec<ParameterFault>>,
}

/// What is wrong with one parameter.
#[derive(Clone, PartialEq, Eq, Debug, thiserror::Error)]
#[error("{message}")]
pub struct ParameterFault {
    /// The key it is about.
    pub key: String,
    /// Whether the key itself is wrong rather than its value.
    pub unknown: bool,
    /// What is wrong, lower case.
    pub message: String,
    /// The nearest key that the activity knows.
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

    /// The same values, of which nobody has asked anything yet.
    pub(crate) fn fresh(&self) -> Parameters {
        self.iter().fold(Parameters::new(), |all, (key, value)| all.with(key, value))
    }

    /// Whether keys and values are the same, in whatever order.
    pub(crate) fn says_the_same(&self, other: &Parameters) -> bool {
        let has = |all: &Parameters, one: (&str, &str)| all.iter().any(|known| known == one);
        self.values.len() == other.values.len() && self.iter().all(|one| has(other, one))
    }

    /// Keys and values, in the order they were given.
    pub fn iter(&self) -> impl Iterator<Item = (&str, &str)> {
        self.values.iter().map(|(key, value)| (key.as_str(), value.as_str()))
    }

    /// A text.
    pub fn text(&self, key: &'static str) -> Option<&str> {
        self.asked.borrow_mut().push(key);
        self.values.iter().find(|(known, _)| known == key).map(|(_, value)| value.as_str())
    }

    /// A finite number.
    pub fn number(&self, key: &'static str) -> Option<f64> {
        self.read(key, "a number", |text| f64::from_str(text).ok().filter(|number| number.is_finite()))
    }

    /// Yes or no: `1`, `0`, `true` or `false`.
    pub fn flag(&self, key: &'static str) -> Option<bool> {
        self.read(key, "`1`, `0`, `true` or `false`", |text| match text {
            "1" | "true" => Some(true),
            "0" | "false" => Some(false),
            _ => None,
        })
    }

    /// A length of time, such as `100ms`.
    pub fn duration(&self, key: &'static str) -> Option<Duration> {
        self.read(key, "a time such as `300s` or `100ms`", crate::config::duration)
    }

    /// Whatever `parse` makes of the text; if nothing, the parameter is at fault and `expected` says what it should be.
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

    /// Says that the value of a key cannot be used; `reason` continues the sentence that the key begins.
    pub fn refuse(&self, key: &'static str, reason: &str) {
        let message = format!("parameter `{key}` {reason}");
        let fault = ParameterFault { key: key.into(), unknown: false, message, nearest: None };
        self.faults.borrow_mut().push(fault);
    }

    /// Says that who took them has come to nothing.
    pub(crate) fn fail(&self, message: String) {
        let fault = ParameterFault { key: String::new(), unknown: false, message, nearest: None };
        self.faults.borrow_mut().push(fault);
    }

    /// What was found wrong since they were made: refused values, then keys that nobody asked for.
    pub fn faults(&self) -> Vec<ParameterFault> {
        let asked = self.asked.borrow();
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
    fn what_is_asked_for_in_the_right_form_is_no_fault() {
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
